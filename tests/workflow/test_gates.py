"""The gate of the bake: the record of a probe against what its specification demands."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.verifiers.stored import demanded_of_motion
from worldagent.workflow.creation import create
from worldagent.workflow.gates import _open_of_record, stored_rows
from worldagent.worlds.probe_length import probe_frames
from worldagent.worlds.requirements import Row


@pytest.mark.parametrize(
    ("mandatory", "status", "left"), [(True, "fail", ["beat:fall"]), (False, "fail", []), (False, "pass", [])]
)
def test_a_beat_that_is_not_mandatory_keeps_no_bake_back(mandatory: bool, status: str, left: list[str], tmp_path: Path) -> None:
    """The gate asks for its row, and for no verdict of it; it took the row for a missing one, so that probe and bake sent agents to and fro."""
    session, _ = create(tmp_path, "w", PROMPT, small_spec())

    def row(name: str) -> Row:
        given = {"mandatory": mandatory, "status": status} if name == "beat:fall" else {"status": "pass"}
        return Row.model_validate({"id": name, "check": name.split(":")[0], "group": "temporal", "predicate": "p", **given})

    rows = [row(name) for name in sorted(demanded_of_motion(session.spec))]
    known: dict[str, Any] = {"detail": {"rows": stored_rows(rows, probe_frames(session.spec) - 1)}, "revision": 1}
    assert _open_of_record(session, known) == left
    known["detail"]["rows"] = stored_rows(rows[1:], probe_frames(session.spec) - 1)
    assert rows[0].id in _open_of_record(session, known), "a row that is not there is missed, whatever it is"
