"""Worlds of a server that leaves checks out for an evaluation: taken to the end, marked everywhere, accepted by nobody."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.stories.conftest import Agent
from worldagent.tests.stories.inline_jobs import run_jobs_inline
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.workflow.session import Session
from worldagent.workflow.verify_folder import verify_folder
from worldagent.worlds.ablation import ABLATIONS, ENV_ABLATION
from worldagent.worlds.errors import RefusedError

MARK = "no acceptance: an evaluation without "
OFF = {"static": "interpenetration, support", "causal": "causal"}


def overlapping() -> dict[str, Any]:
    """The small world with a crate that stands in the shelf."""
    spec = small_spec()
    crate = {**spec["entities"]["shelf"], "role": "crate", "dimensions": {"size": [0.2, 0.2, 0.2]}}
    crate |= {"parts": {"body": {"shape": {"kind": "box", "size": [0.2, 0.2, 0.2]}}}, "pose": {"position": [-0.3, 0.2, 0.1]}}
    spec["entities"]["crate"] = crate
    spec["graph"]["relations"]["crate_on_floor"] = {"kind": "supports", "a": "floor", "b": "crate"}
    spec["simulation"]["solvers"]["rigid"]["members"].append("crate")
    return spec


@pytest.mark.slow
@pytest.mark.parametrize(("name", "spec"), [("static", overlapping()), ("causal", small_spec()), ("all", overlapping())])
def test_a_world_without_a_check_goes_to_the_end_and_is_no_acceptance(
    name: str, spec: dict[str, Any], agent: Agent, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run_jobs_inline(monkeypatch)
    monkeypatch.setenv(ENV_ABLATION, name)
    mark = MARK + OFF.get(name, ", ".join(sorted(ABLATIONS[name])))
    made = agent.call("edit_spec", world="w", prompt=PROMPT, spec=spec)
    assert made["audit"]["passed"]
    assert made["ablation"] == mark
    assert agent.call("place_object", world="w")["static_passed"]
    assert agent.call("probe_sim", world="w")["passed"]
    assert agent.call("bake_sim", world="w")["passed"]
    verdict = agent.call("run_checks", world="w", scope="acceptance")
    assert (verdict["verdict"], verdict["says"], verdict["ablation"]) == ("ablated", mark, mark)
    assert "bundle" not in verdict
    session = Session.open(tmp_path, "w")
    rows = session.ledger.rows()
    assert {r.evidence["ablation"] for r in rows} == {name}
    off = [r for r in rows if r.check in ABLATIONS[name]]
    assert {r.status for r in off} == {"not_applicable"}
    accepted = session.ledger.acceptance()
    assert accepted is not None
    assert accepted["record"]["ablation"] == name
    with pytest.raises(RefusedError, match="verify needs every check"):
        verify_folder(tmp_path / "w", replay=False)

    monkeypatch.delenv(ENV_ABLATION)
    with pytest.raises(RefusedError, match=f"'w' is {mark}"):
        verify_folder(tmp_path / "w", replay=False)
    assert mark in agent.refused("run_checks", world="w", scope="static")
    (tmp_path / "w" / "ledger.sqlite").unlink()
    with pytest.raises(RefusedError, match=f"'w' is {mark}"):
        verify_folder(tmp_path / "w", replay=False)


def test_the_same_world_stops_at_its_overlap_where_every_check_judges(agent: Agent) -> None:
    agent.call("edit_spec", world="w", prompt=PROMPT, spec=overlapping())
    placed = agent.call("place_object", world="w", detail="full")
    assert not placed["static_passed"]
    assert {r["check"] for r in placed["open_rows"] if r["status"] == "fail"} == {"interpenetration"}


def test_a_world_that_every_check_judged_is_closed_to_an_ablation(agent: Agent, monkeypatch: pytest.MonkeyPatch) -> None:
    agent.call("edit_spec", world="w", prompt=PROMPT, spec=small_spec())
    monkeypatch.setenv(ENV_ABLATION, "causal")
    assert "was judged by every check, and this server has WORLDAGENT_ABLATION='causal'" in agent.refused(
        "run_checks", world="w", scope="audit"
    )
