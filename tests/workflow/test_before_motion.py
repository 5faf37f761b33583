"""While only geometry has failed, the story may still be written anew; what a failing row offers may be done (R113, R157)."""

from __future__ import annotations

import sqlite3
from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.verifiers.delivery.bundle import compare_history
from worldagent.workflow.answers import weaker_told
from worldagent.workflow.bundles import history_of
from worldagent.workflow.creation import create
from worldagent.workflow.jobs import _require_whole_history
from worldagent.workflow.session import Session
from worldagent.worlds.canonical import spec_digest
from worldagent.worlds.errors import EvidenceError, RefusedError
from worldagent.worlds.patch import apply_patch
from worldagent.worlds.requirements import Correction, Row


def _failed(row_id: str, check: str, **more: Any) -> Row:
    base = {"id": row_id, "check": check, "group": "physical", "question": row_id, "subject": ("b1",)}
    return Row.model_validate({**base, "predicate": "p", "status": "fail", "measured": 2.0, "bound": 1.0, **more})


def _made(workspace: Path) -> Session:
    workspace.mkdir(exist_ok=True)
    session, _ = create(workspace, "w", PROMPT, small_spec())
    session.audit()
    session.check_static()
    return session


def _edit(session: Session, path: str, value: Any, **more: Any) -> dict[str, Any]:
    patch = [{"op": "add", "path": path, "value": value}]
    return session.commit(apply_patch(session.spec, patch), patch=patch, **more)


def test_the_story_is_no_weaker_by_what_only_geometry_has_failed_on(tmp_path: Path) -> None:
    session = _made(tmp_path)
    session.ledger.put_rows([_failed("support:grip:b1", "support")], revision=session.revision, stage="static")
    told = _edit(session, "/simulation/frames", 30, hypothesis="shorter is enough for the story that is told")
    assert "weakenings_recorded" not in told
    assert session.ledger.weakenings() == []


def test_before_anything_is_judged_no_edit_is_a_weakening_and_after_it_is(tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    session, _ = create(tmp_path / "a", "w", PROMPT, small_spec())
    session.audit()
    _edit(session, "/simulation/limits/support_drift", 0.02, hypothesis="things may creep farther here")
    assert session.ledger.weakenings() == []
    session.check_static()
    told = _edit(session, "/simulation/limits/support_drift", 0.04, hypothesis="things may creep farther still")
    assert session.ledger.weakenings() != [], told


def test_a_history_tells_what_was_made_easier_before_there_was_evidence(tmp_path: Path) -> None:
    """The comparison that acceptance and `verify` make; whoever empties a list of weakenings, or calls a later one early, is found."""
    (tmp_path / "a").mkdir()
    session, _ = create(tmp_path / "a", "w", PROMPT, small_spec())
    session.audit()
    _edit(session, "/simulation/limits/support_drift", 0.02, hypothesis="things may creep farther here")
    session.check_static()
    _require_whole_history(session)
    _edit(session, "/simulation/limits/support_drift", 0.04, hypothesis="things may creep farther still")
    _require_whole_history(session)
    told = history_of(session.ledger, session.revision)
    first, second = told["revisions"][1:]
    assert [bool(r[k]) for r in (first, second) for k in ("early", "weakenings")] == [True, False, False, True]
    assert compare_history(told, spec_digest(session.spec)) == []
    second["early"], second["weakenings"] = second["weakenings"], []
    assert "revision 3 hides weakenings" in compare_history(told, spec_digest(session.spec))[0]
    with sqlite3.connect(session.ledger.path) as db:
        db.execute("UPDATE revisions SET weakenings='[]'")
    with pytest.raises(EvidenceError, match="is not what was written"):
        session.ledger.weakenings()
    with sqlite3.connect(session.ledger.path) as db:
        db.execute("DELETE FROM meta WHERE key LIKE 'seal:%'")
    with pytest.raises(EvidenceError, match="was taken away"):
        session.ledger.weakenings()
    with sqlite3.connect(session.ledger.path) as db:
        db.execute("DELETE FROM meta WHERE key='seals'")  # now it looks like the ledger of an older server
    with pytest.raises(RefusedError, match="hides weakenings"):
        _require_whole_history(session)


def test_after_a_motion_that_failed_it_is(tmp_path: Path) -> None:
    session = _made(tmp_path)
    session.ledger.put_rows([_failed("beat:hit", "beat")], revision=session.revision, stage="probe")
    with pytest.raises(RefusedError, match=r"/simulation/frames \d+ -> 30"):
        _edit(session, "/simulation/frames", 30, hypothesis="shorter is enough for the story that is told")


def test_any_kind_of_edit_that_a_failing_row_offers_is_taken(tmp_path: Path) -> None:
    """The diagnosis names a class, and a correction of another class stands beside it."""
    session = _made(tmp_path)
    offered = [
        Correction(cause="hidden", edit_class=c, group=g, action="do it", pointers=(), patch=())
        for c, g in (("solver", "mass"), ("scene", "shape"))
    ]
    row = _failed("scale:hidden:b1", "scale", corrections=offered, evidence={"edit_classes": ["solver"]})
    session.ledger.put_rows([row], revision=session.revision, stage="static")
    part = next(iter(session.spec.entities["b1"].parts))
    size = [0.9 * s for s in session.spec.entities["b1"].parts[part].shape.size]
    assert _edit(session, f"/entities/b1/parts/{part}/shape/size", size, hypothesis="a smaller block hides nothing")["revision"]
    other = _made(tmp_path / "other")
    other.ledger.put_rows([row.model_copy(update={"corrections": tuple(offered[:1])})], revision=other.revision, stage="static")
    with pytest.raises(RefusedError, match="ask for a solver edit"):
        _edit(other, f"/entities/b1/parts/{part}/shape/size", size, hypothesis="a smaller block hides nothing")


def test_what_the_acceptance_prints_is_told_with_the_edit(tmp_path: Path) -> None:
    """Nothing has failed, and a bound is looser than when the world was judged: the reply says so."""
    session = _made(tmp_path)
    told = _edit(session, "/simulation/limits/support_drift", 0.04, hypothesis="things may creep farther still")
    assert told["weakenings_recorded"] == session.ledger.weakenings()[0]["weakenings"]
    assert "printed with the acceptance: /simulation/limits/support_drift" in weaker_told(told)[0]
