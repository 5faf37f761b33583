"""The ledger says how far a world has come, and when that stops being true."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import pytest
from worldagent.simulation.freeze import engine_versions, solver_source
from worldagent.tests.page.conftest import Made, row
from worldagent.workflow.standing import STAGES, standing
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.ledger import Ledger

FREEZE = "ab" * 32


def states(folder: WorldFolder) -> dict[str, str]:
    return {s.name: s.state for s in standing(folder, Ledger(folder.ledger_path)).steps}


def frozen(folder: WorldFolder, *, passed: bool = True, **record: Any) -> Ledger:
    """The ledger after a probe of the present settings."""
    ledger = Ledger(folder.ledger_path)
    failing = [] if passed else ["beat:fall"]
    ledger.put_freeze(FREEZE, ledger.revision(), passed=passed, detail={"failing": failing})
    root = folder.candidate(FREEZE)
    (root / "bake").mkdir(parents=True, exist_ok=True)
    (root / "candidate.json").write_text(json.dumps({"versions": engine_versions(), "source": solver_source()} | record))
    return ledger


def accepted(folder: WorldFolder, verdict: str = "accepted") -> Ledger:
    ledger = frozen(folder)
    ledger.put_bake(FREEZE, ledger.revision(), "cache-1", {"failing": []})
    record: dict[str, Any] = {"verdict": verdict, "cache_digest": "cache-1", "rows": [row("x").model_dump(mode="json")]}
    record["prompt"] = {"claimed": 0.7, "filler": 0.3, "waived": 0.0, "read_by": "nobody"}
    record["spec_digest"] = (ledger.revision_spec(ledger.revision()) or ("", ""))[1]
    ledger.add_acceptance(FREEZE, ledger.revision(), "subject", verdict, record)
    film = folder.candidate(FREEZE) / "final" / "final.webm"
    film.parent.mkdir(parents=True, exist_ok=True)
    film.write_bytes(b"film")
    return ledger


def test_a_new_world_is_specified_and_audited_and_nothing_else(made: Made) -> None:
    folder = made.world("w")
    found = states(folder)
    assert [found[s] for s in STAGES] == ["done", "done", "missing", "missing", "missing", "missing", "missing"]
    assert standing(folder, Ledger(folder.ledger_path)).reached == "audited"


def test_an_accepted_and_rendered_world_has_every_stage(made: Made) -> None:
    folder = made.world("w")
    accepted(folder)
    assert set(states(folder).values()) == {"done"}
    assert standing(folder, Ledger(folder.ledger_path)).reached == "rendered"


def test_a_failed_probe_freezes_nothing(made: Made) -> None:
    folder = made.world("w")
    frozen(folder, passed=False)
    found = states(folder)
    assert (found["probed"], found["frozen"]) == ("failed", "missing")


def test_an_edit_of_the_motion_makes_all_that_follows_stale(made: Made) -> None:
    folder = made.world("w")
    accepted(folder)
    made.edit("w", ("/simulation/solvers/rigid/settings/step", 0.00025))
    found = states(folder)
    assert [found[s] for s in STAGES] == ["done", "done", "stale", "stale", "stale", "stale", "stale"]


def test_an_edit_of_the_look_makes_only_the_film_stale(made: Made) -> None:
    folder = made.world("w")
    accepted(folder)
    made.edit("w", ("/look/samples", 4))
    assert {k for k, v in states(folder).items() if v == "stale"} == {"rendered"}


def test_an_edit_of_the_shots_keeps_the_bake_and_drops_the_verdict(made: Made) -> None:
    folder = made.world("w")
    accepted(folder)
    made.edit("w", ("/shots/only/intent", "something else"))
    found = states(folder)
    assert (found["baked"], found["accepted"]) == ("done", "stale")


def test_a_specification_edited_by_hand_is_stale_from_the_first_stage(made: Made) -> None:
    folder = made.world("w")
    folder.spec_path.write_text(folder.spec_path.read_text().replace('"fps": 24', '"fps": 25'))
    assert states(folder)["specified"] == "stale"
    assert standing(folder, Ledger(folder.ledger_path)).reached is None


@pytest.mark.parametrize("verdict", ["refused", "incomplete"])
def test_a_verdict_other_than_accepted_is_a_failed_stage(made: Made, verdict: str) -> None:
    folder = made.world("w")
    accepted(folder, verdict)
    found = states(folder)
    assert (found["accepted"], found["rendered"]) == ("failed", "stale")


def test_a_bake_that_was_made_again_with_another_outcome_drops_the_verdict(made: Made) -> None:
    folder = made.world("w")
    ledger = accepted(folder)
    ledger.put_bake(FREEZE, 1, "cache-2", {"failing": []})
    assert states(folder)["accepted"] == "stale"


def test_caches_that_are_gone_are_no_bake(made: Made) -> None:
    folder = made.world("w")
    accepted(folder)
    shutil.rmtree(folder.candidate(FREEZE) / "bake")
    found = states(folder)
    assert (found["baked"], found["accepted"]) == ("stale", "stale")


def test_a_probe_of_other_engine_versions_is_stale(made: Made) -> None:
    folder = made.world("w")
    frozen(folder, versions={"mujoco": "3.9"})
    step = standing(folder, Ledger(folder.ledger_path)).step("probed")
    assert (step.state, step.note) == ("stale", "made by another version of the engines")


def test_reading_a_world_writes_nothing(made: Made) -> None:
    folder = made.world("w")
    accepted(folder)

    def files() -> dict[Path, int]:
        return {p: p.stat().st_mtime_ns for p in sorted(made.root.rglob("*")) if p.is_file()}

    before = files()
    standing(folder, Ledger(folder.ledger_path))
    assert files() == before


def test_the_reason_why_a_probe_is_stale_is_that_of_the_bake_too(made: Made) -> None:
    folder = made.world("w")
    accepted(folder)
    made.edit("w", ("/simulation/solvers/rigid/settings/step", 0.00025))
    notes = {s.name: s.note for s in standing(folder, Ledger(folder.ledger_path)).steps}
    assert {notes[n] for n in ("probed", "frozen", "baked")} == {"the motion was changed since"}
    assert notes["accepted"] == "the specification was changed since"
