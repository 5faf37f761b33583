"""A stored world of version 1 opens, is edited in everything but its clauses, simulated, checked and accepted; nothing judges its clauses."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.stories.bundle_forgery import Forgery, forged
from worldagent.tests.stories.inline_jobs import run_jobs_inline
from worldagent.tests.stories.small_run import MARKED
from worldagent.tests.stories.version_1 import old_spec, store_old
from worldagent.workflow.verify_bundle import verify_bundle

JUDGED = "physics accepted; prompt judged by clauses"


@pytest.fixture
def old(agent: Any, monkeypatch: pytest.MonkeyPatch) -> Any:
    """A client whose workspace holds such a world."""
    run_jobs_inline(monkeypatch)
    store_old(agent.workspace)
    return agent


def test_it_opens_with_its_prompt_unmarked_and_no_row_about_it(old: Any) -> None:
    assert old.call("run_checks", world="w", scope="audit")["counts"]["fail"] == 0
    rows = {r["id"] for r in old.pages("rows", part="matrix")}
    assert not rows & {"audit:clauses", "audit:claims"}
    told = old.call("inspect_world", world="w", part="claims")
    assert told["marked"] == old_spec()["prompt"]
    assert "[ball](thing" in told["claims_to_make"]
    assert "nothing judges the words of its prompt" in told["summary"]


def test_everything_but_its_clauses_is_edited(old: Any, patch: Any) -> None:
    assert old.edit(("/look/exposure", 0.5))["revision"] == 2
    for change in (
        patch(("/clauses/c2", {"unmet": "not wanted any more"})),
        [{"op": "remove", "path": "/clauses/c1"}],
        patch(("/clauses/c1/met_by/0", "/entities/b1")),
    ):
        text = old.refused("edit_spec", world="w", patch=change)
        assert "clauses are of spec_version '1' and judged by nothing: they can no longer be written" in text
        assert "edit_spec(world='w', claims='A [ball](thing ball)" in text


def test_claims_make_it_version_2_and_there_is_no_way_back(old: Any, patch: Any) -> None:
    events = (
        ("/story/beats/roll/predicate", {"kind": "rolls", "entity": "ball"}),
        ("/story/beats/fall/predicate", {"kind": "falls", "entity": "b3"}),
    )
    assert old.edit(*events, claims=MARKED)["audit"]["passed"]
    document = json.loads((old.workspace / "w" / "world.json").read_text())
    assert document["spec_version"] == "2"
    assert "clauses" not in document
    back = [*patch(("/spec_version", "1"), ("/clauses", old_spec()["clauses"])), {"op": "remove", "path": "/claims"}]
    assert "can no longer be written" in old.refused("edit_spec", world="w", patch=back)


@pytest.mark.slow
def test_its_physics_is_accepted_and_its_bundle_verifies_as_that(old: Any, tmp_path: Path) -> None:
    old.call("place_object", world="w")
    assert old.call("probe_sim", world="w")["passed"]
    old.call("bake_sim", world="w")
    verdict = old.call("run_checks", world="w", scope="acceptance")
    assert (verdict["verdict"], verdict["says"], verdict["unmet_clauses"]) == ("accepted", JUDGED, {})
    (bundle,) = (old.workspace / "w" / "acceptance").glob("*.zip")
    found = verify_bundle(bundle, seed=0, intervals=3)
    assert (found["verdict"], found["says"], found["problems"], found["differences"]) == ("accepted", JUDGED, [], [])

    def judged_then(made: Forgery) -> None:
        """The row of the clauses, as earlier versions of the program wrote it."""
        made.edit(
            "verdict.json", lambda v: v["rows"].append({**v["rows"][0], "id": "audit:clauses", "question": "audit:clauses"})
        )

    found = verify_bundle(forged(bundle, tmp_path / "old.zip", judged_then), seed=0, intervals=3)
    assert (found["verdict"], found["says"], found["differences"]) == ("accepted", JUDGED, [])
