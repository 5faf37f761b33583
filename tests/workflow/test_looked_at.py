"""Frames that were looked at count as evidence, though the run was cancelled before its rows were written (R113, R157)."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import pytest
from worldagent.construction import build_world, built_paths
from worldagent.execution import Cancelled, run_inline
from worldagent.simulation.freeze import open_freeze
from worldagent.simulation.probe import run_probe
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.workflow.measurements import measured
from worldagent.workflow.session import Session
from worldagent.worlds.canonical import spec_digest
from worldagent.worlds.errors import RefusedError
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.ledger import Ledger
from worldagent.worlds.patch import apply_patch, parse_spec

WHY = "the ball is too slow, a faster one pushes the row off"
REASON = "the prompt asks for a fall of any height"


@pytest.fixture(scope="module")
def cancelled_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A world whose probe was cancelled when its frames were there: the ball is too slow, no row says so."""
    document = small_spec()
    document["entities"]["ball"]["physics"] |= {"linear_velocity": [0.3, 0, 0], "angular_velocity": [0, 15, 0]}
    spec = parse_spec({**document, "prompt": PROMPT})
    folder = WorldFolder(tmp_path_factory.mktemp("cancelled") / "w")
    folder.root.mkdir()
    folder.assets.mkdir()
    text = spec.model_dump_json(exclude_none=True)
    Ledger(folder.ledger_path).add_revision(text, spec_digest(spec), expected=0, hypothesis="created")
    folder.spec_path.write_text(text)
    built, _ = build_world(folder, spec)
    run_probe(folder, open_freeze(folder, spec, built, built_paths(folder, spec), 1))
    return folder.root


@pytest.fixture
def session(cancelled_folder: Path, tmp_path: Path) -> Session:
    return Session.at(WorldFolder.at(shutil.copytree(cancelled_folder, tmp_path / "w")))


def _set(session: Session, path: str, value: Any, **more: Any) -> dict[str, Any]:
    patch = [{"op": "replace", "path": path, "value": value}]
    return session.commit(apply_patch(session.spec, patch), patch=patch, **more)


def _lower(session: Session, **more: Any) -> dict[str, Any]:
    return _set(session, "/story/beats/fall/predicate/min", 0.05, **more)


def _faster(session: Session, **more: Any) -> dict[str, Any]:
    return _set(session, "/entities/ball/physics/linear_velocity", [0.5, 0, 0], **more)


def _look(session: Session, last: int = 20) -> dict[str, Any]:
    return measured(session, "events", entities=None, frames=(0, last), limit=5, offset=0)


def test_a_run_that_nobody_looked_at_is_no_evidence(session: Session) -> None:
    assert "weakenings_recorded" not in _lower(session)
    _faster(session)
    assert session.ledger.looks() == []


def test_who_looked_at_a_cancelled_run_repairs_by_the_rules(session: Session) -> None:
    assert "counts as evidence" in _look(session, 20)["unjudged"]
    _look(session, 8)
    (look,) = session.ledger.looks()
    assert (look["stage"], look["last"], look["revision"]) == ("probe", 20, 1)
    with pytest.raises(RefusedError, match=r"frames 0..20 of the probe .* were looked at.*weakening_reason"):
        _lower(session)
    with pytest.raises(RefusedError, match=r"were looked at.*run_checks\(scope='probe'\).*name its hypothesis"):
        _faster(session)
    step = [{"op": "replace", "path": "/simulation/solvers/rigid/settings/step", "value": 0.00025}]
    fast = [{"op": "replace", "path": "/entities/ball/physics/linear_velocity", "value": [0.5, 0, 0]}]
    with pytest.raises(RefusedError, match="2 causal parameter groups"):
        session.commit(apply_patch(session.spec, [*step, *fast]), patch=[*step, *fast], hypothesis=WHY)
    assert _lower(session, weakening_reason=REASON)["weakenings_recorded"]
    (told,) = session.ledger.weakenings()
    assert told["reason"] == REASON
    _faster(session, hypothesis=WHY)


def test_a_later_probe_tests_the_repair_and_what_was_seen_stays_evidence(session: Session) -> None:
    _look(session)
    _faster(session, hypothesis=WHY)
    session.ledger.put_freeze("a" * 64, session.revision, passed=True, detail={"digest": "other"})
    _set(session, "/simulation/solvers/rigid/settings/step", 0.00025)
    with pytest.raises(RefusedError, match="were looked at"):
        _lower(session)


def test_judging_what_was_seen_puts_its_rows_in_the_place_of_the_look(session: Session) -> None:
    _look(session)
    answer = run_inline("worldagent.workflow.jobs:check", {"folder": str(session.folder.root), "scope": "probe"})
    assert "beat:fall" in [r["id"] for r in answer["open_rows"]]
    assert session.ledger.looks() == []
    assert "unjudged" not in _look(session)
    assert session.ledger.looks() == []
    with pytest.raises(RefusedError, match="after evidence against it"):
        _lower(session)
    assert json.loads((session.folder.spec_path).read_text())["story"]["beats"]["fall"]["predicate"]["min"] == 0.15


# ---------------------------------------------------------------- runs that are ended before their verdict


def _payload(session: Session) -> dict[str, Any]:
    return {"folder": str(session.folder.root)}


def _ended_at(session: Session, frame: int, kind: str = "probe", **more: Any) -> None:
    """Run a job and cancel it as soon as so many frames are there."""
    begun = session.folder.candidate(session.freeze()) / {"bake": "bake"}.get(kind, kind) / "rigid"

    def cancelled() -> bool:
        return len(list(begun.glob("frame_*.npz"))) > frame

    with pytest.raises(Cancelled):
        run_inline(f"worldagent.workflow.jobs:{kind}", {**_payload(session), **more}, cancel_asked=cancelled)


@pytest.fixture
def fresh(cancelled_folder: Path, tmp_path: Path) -> Session:
    """The slow ball, before anything ran."""
    folder = shutil.copytree(cancelled_folder, tmp_path / "w")
    shutil.rmtree(folder / "candidates")
    return Session.at(WorldFolder.at(folder))


def test_a_probe_that_is_cancelled_leaves_how_far_it_ran_and_a_reason_is_asked(
    fresh: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("worldagent.workflow.probes.judge_begun", lambda *_: None)  # a world that no check looks over in time
    _ended_at(fresh, 4)
    (ran,) = fresh.ledger.looks()
    assert ran["stage"] == "probe:ran"
    assert ran["last"] >= 4
    with pytest.raises(RefusedError, match=r"probe .* \(revision 1\) ran to frame \d+ and was not judged.*weakening_reason"):
        _lower(fresh)
    _faster(fresh)  # a repair of what nobody saw fail needs no hypothesis
    assert _lower(fresh, weakening_reason=REASON)["weakenings_recorded"]
    assert [w["reason"] for w in fresh.ledger.weakenings()] == [REASON]


def test_what_the_frames_of_a_cancelled_probe_decide_is_judged_yet(fresh: Session) -> None:
    """The window of the beat is over when the run is cancelled: its row fails, as it would have if the run had gone on."""
    _set(fresh, "/story/beats/strike/frames", [1, 3])
    _ended_at(fresh, 6)
    rows = {r.id: r.status for r in fresh.ledger.rows()}
    assert rows["beat:strike"] == "fail"
    with pytest.raises(RefusedError, match="name its hypothesis"):
        _faster(fresh)
    with pytest.raises(RefusedError, match="weakening_reason"):
        _set(fresh, "/story/beats/strike/frames", [1, 30])


def test_a_probe_that_is_judged_leaves_rows_in_the_place_of_its_run(fresh: Session) -> None:
    run_inline("worldagent.workflow.jobs:probe", _payload(fresh))
    assert fresh.ledger.looks() == []
    assert fresh.ledger.ever_failed()


def test_a_sketch_that_is_cancelled_is_on_record_too(fresh: Session) -> None:
    _ended_at(fresh, 3, "sketch", sketch={"until": 30})
    assert [r["stage"] for r in fresh.ledger.looks()] == ["sketch:ran"]
    with pytest.raises(RefusedError, match=r"sketch .* ran to frame"):
        _lower(fresh)


def test_the_next_probe_does_not_settle_what_a_cancelled_bake_showed(fresh: Session) -> None:
    fresh.ledger.add_look("f" * 64, "full:ran", 1, 30)
    fresh.ledger.put_freeze("f" * 64, 1, passed=True, detail={})
    assert [r["stage"] for r in fresh.ledger.looks()] == ["full:ran"]
    assert fresh.ledger.looks(untested=True) == []
    fresh.ledger.put_bake("f" * 64, 1, "digest", {})
    assert fresh.ledger.looks() == []


def test_a_run_whose_frames_were_judged_before_leaves_nothing_new(fresh: Session) -> None:
    run_inline("worldagent.workflow.jobs:probe", _payload(fresh))
    shutil.rmtree(fresh.folder.candidate(fresh.freeze()) / "probe")
    _ended_at(fresh, 4)
    assert fresh.ledger.looks() == []
