"""Files that a job leaves for others to read: whole at every moment, and about what was judged."""

from __future__ import annotations

import hashlib
import zipfile
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import worldagent.rendering as rendering
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.tools.edit_spec import edit_spec
from worldagent.workflow import bundles, jobs, pictures
from worldagent.workflow.session import Session
from worldagent.workflow.work import Work
from worldagent.worlds.bundle import open_bundle
from worldagent.worlds.errors import RefusedError
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.requirements import Row


def test_a_contact_sheet_that_is_drawn_anew_can_be_read_meanwhile(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A client follows the link of the last probe while the next one draws its sheet under the same name."""
    sheet = tmp_path / "pictures" / "probe.jpg"
    sheet.parent.mkdir()
    sheet.write_bytes(b"old sheet")
    seen: list[bytes] = []
    write = Path.write_bytes

    def half(self: Path, data: bytes) -> int:
        write(self, data[: len(data) // 2])
        seen.append(sheet.read_bytes())
        return write(self, data)

    picture = np.zeros((2, 2, 3), np.uint8)
    monkeypatch.setattr(rendering, "PreviewRenderer", lambda candidate: None)
    monkeypatch.setattr(rendering, "preview", lambda *_, **__: picture)
    monkeypatch.setattr(rendering, "contact_sheet", lambda *_, **__: b"new sheet")
    monkeypatch.setattr(Path, "write_bytes", half)
    candidate = SimpleNamespace(last_frame=8, spec=SimpleNamespace(simulation=SimpleNamespace(fps=24)))
    pictures.motion_sheet(candidate, WorldFolder(tmp_path), "probe.jpg")
    assert (seen, sheet.read_bytes()) == ([b"old sheet"], b"new sheet")


def test_a_bundle_is_of_the_world_that_was_judged_though_it_is_edited_meanwhile(
    context: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    edit_spec(context, world="w", prompt=PROMPT, spec=small_spec())
    judge = bundles.judged

    def judged_then_edited(*arguments: Any, **more: Any) -> dict[str, Any]:
        record = judge(*arguments, **more)
        edit_spec(context, world="w", patch=[{"op": "replace", "path": "/title", "value": "Later"}])
        return record

    monkeypatch.setattr(bundles, "judged", judged_then_edited)
    bundle = open_bundle(Path(bundles.bundle_world(tmp_path / "w")["bundle"]))
    record, history = bundle.json("verdict.json"), bundle.json("history.json")
    with zipfile.ZipFile(bundle.path) as archive:
        assert hashlib.sha256(archive.read("world/world.json")).hexdigest() == record["spec_digest"]
    assert [r["digest"] for r in history["revisions"]] == [record["spec_digest"]]


def test_acceptance_of_a_world_that_was_edited_before_it_was_judged_is_no_verdict_about_the_candidate(
    context: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    edit_spec(context, world="w", prompt=PROMPT, spec=small_spec())
    session = Session.open(tmp_path, "w")
    session.ledger.put_bake("f" * 64, 1, "d", {})
    monkeypatch.setattr(jobs, "open_work", lambda payload, **_: Work(session, "f" * 64, {}))
    monkeypatch.setattr(jobs, "require_true_geometry", lambda session, built: None)
    monkeypatch.setattr(jobs, "plates_of", lambda *_, **__: None)
    monkeypatch.setattr("worldagent.verifiers.acceptance.WaitingJudge", nullcontext)
    monkeypatch.setattr(
        "worldagent.verifiers.acceptance.judge_fresh",
        lambda *_, **__: {"spec_digest": "of another", "rows": [], "verdict": "accepted", "subject": "s", "freeze": "f" * 64},
    )
    quiet = SimpleNamespace(progress=lambda *_: None, check=lambda: None)
    with pytest.raises(RefusedError, match="edited before it was judged"):
        jobs.accept({"folder": str(tmp_path / "w")}, quiet)
    assert session.ledger.acceptance() is None


def test_a_judgement_that_is_killed_amid_its_entry_leaves_the_change_untested(
    context: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    edit_spec(context, world="w", prompt=PROMPT, spec=small_spec())
    session = Session.open(tmp_path, "w")
    failed = Row(id="beat:roll", check="beat", group="temporal", predicate="p", status="fail", artifact="x")
    session.ledger.add_iteration(1, "it rolls too slowly", "velocities", [failed])
    candidate = SimpleNamespace(last_frame=35, frame_count=36, digest="d", spec=session.spec, caches={})
    monkeypatch.setattr(jobs, "open_work", lambda payload: Work(session, "f" * 64, {}))
    monkeypatch.setattr("worldagent.workflow.probes.with_variants", lambda candidate, *_: candidate)
    monkeypatch.setattr("worldagent.worlds.candidate.open_candidate", lambda *_: candidate)
    monkeypatch.setattr("worldagent.verifiers.checks.run_checks", lambda *_, **__: [failed])

    def killed(*_: Any, **__: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Session, "record", killed)
    quiet = SimpleNamespace(progress=lambda *_: None, check=lambda: None)
    with pytest.raises(KeyboardInterrupt):
        jobs.check({"folder": str(tmp_path / "w"), "scope": "probe"}, quiet)
    assert [i["hypothesis"] for i in session.ledger.open_iterations()] == ["it rolls too slowly"]
