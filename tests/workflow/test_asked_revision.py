"""A job judges the revision for which it was asked, files its evidence under it, and says so (R115, R157)."""

from __future__ import annotations

import shutil
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest
from worldagent.construction import build_world
from worldagent.execution import Job, run_inline
from worldagent.simulation.freeze import freeze_hash
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.workflow.session import Session
from worldagent.workflow.standing import standing
from worldagent.workflow.waiting import ended_data
from worldagent.worlds.canonical import spec_digest
from worldagent.worlds.errors import RefusedError
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.ledger import Ledger
from worldagent.worlds.patch import apply_patch, parse_spec


@pytest.fixture
def session(tmp_path: Path) -> Session:
    """A world at revision 1, with a start so slow that its probe fails."""
    document = small_spec()
    document["entities"]["ball"]["physics"] |= {"linear_velocity": [0.3, 0, 0], "angular_velocity": [0, 15, 0]}
    spec = parse_spec({**document, "prompt": PROMPT})
    folder = WorldFolder(tmp_path / "w")
    folder.root.mkdir()
    folder.assets.mkdir()
    text = spec.model_dump_json(exclude_none=True)
    Ledger(folder.ledger_path).add_revision(text, spec_digest(spec), expected=0, hypothesis="created")
    folder.spec_path.write_text(text)
    return Session.at(folder)


def _asked(session: Session, **more: Any) -> dict[str, Any]:
    """Payload of a job that is asked for now."""
    return {"folder": str(session.folder.root), "revision": session.revision, "stamp": session.stamp(), **more}


def _faster(session: Session) -> Session:
    patch = [{"op": "replace", "path": "/entities/ball/physics/linear_velocity", "value": [1.0, 0, 0]},
             {"op": "replace", "path": "/entities/ball/physics/angular_velocity", "value": [0, 50, 0]}]  # fmt: skip
    other = Session.at(session.folder)
    other.commit(apply_patch(other.spec, patch), patch=patch)
    return other


def test_a_probe_that_begins_after_an_edit_runs_what_it_was_asked_for(session: Session) -> None:
    payload = _asked(session)
    later = _faster(session)
    answer = run_inline("worldagent.workflow.jobs:probe", payload)
    assert not answer["passed"], "revision 2 would have passed"
    built, _ = build_world(session.folder, session.spec)
    assert answer["freeze"] == freeze_hash(session.spec, built)[:16]
    (known,) = session.ledger.freezes()
    assert known["revision"] == 1
    rows = {r.id: r for r in session.ledger.rows()}
    assert rows["beat:fall"].evidence["was"] == "fail"
    assert "changed in revision 2" in rows["beat:fall"].evidence["stale"]
    assert standing(session.folder, later.ledger).step("probed").state == "stale"


@pytest.mark.parametrize(("kind", "named"), [("accept", "acceptance"), ("final", "film"), ("review", "review")])
def test_what_is_about_the_present_world_is_not_begun_on_an_edited_one(session: Session, kind: str, named: str) -> None:
    payload = _asked(session)
    _faster(session)
    with pytest.raises(RefusedError, match=f"edited before the {named} of revision 1 began: it is at revision 2 now"):
        run_inline(f"worldagent.workflow.jobs:{kind}", payload)


def test_a_world_that_was_made_anew_is_not_the_one_that_was_asked_for(session: Session) -> None:
    payload = _asked(session)
    for wrong in ({"stamp": "1.5"}, {"revision": 7}):
        with pytest.raises(RefusedError, match="is not there any more"):
            run_inline("worldagent.workflow.jobs:probe", {**payload, **wrong})


def test_the_stamp_is_that_of_the_revision_that_was_read(session: Session) -> None:
    before = session.stamp()
    assert _faster(session).stamp() != before
    assert session.stamp() == before


def test_a_result_names_its_revision_and_says_when_the_world_moved_on(session: Session) -> None:
    told = {"id": "j1", "kind": "probe", "world": "w", "payload": _asked(session), "state": "done", "result": {"passed": True}}
    job = Job(**{**{f.name: None for f in fields(Job)}, **told})  # type: ignore[arg-type]
    assert ended_data(job) == {"job_id": "j1", "revision": 1, "passed": True}
    _faster(session)
    assert ended_data(job)["warnings"] == ["this is about revision 1: the world has moved on to revision 2 since"]
    shutil.rmtree(session.folder.root)
    assert ended_data(job)["revision"] == 1
