"""A failed row about what a thing is said to be is not mended by saying that it is something else (R157)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.workflow.creation import create
from worldagent.workflow.session import Session
from worldagent.workflow.siblings import easier_beside
from worldagent.worlds.errors import RefusedError
from worldagent.worlds.patch import apply_patch, parse_spec

REASON = "the prompt asks for blocks, I called it a table by mistake"


def _made(workspace: Path, role: str) -> Session:
    document = small_spec()
    document["entities"]["b1"]["role"] = role
    session, _ = create(workspace, "w", PROMPT, document)
    session.audit()
    session.check_static()
    return session


def _role(session: Session, role: str, **more: Any) -> dict[str, Any]:
    patch = [{"op": "replace", "path": "/entities/b1/role", "value": role}]
    return session.commit(apply_patch(session.spec, patch), patch=patch, **more)


def test_renaming_a_thing_of_a_failed_kind_needs_a_reason_that_is_kept(tmp_path: Path) -> None:
    session = _made(tmp_path, "dining table")
    rows = {r.id: r.status for r in session.ledger.rows()}
    assert rows["scale:kind:b1"] == "fail"
    with pytest.raises(
        RefusedError, match=r"/entities/b1/role 'dining table' -> 'block', by which a failing row was asked.*weakening_reason"
    ):
        _role(session, "block")
    assert _role(session, "block", weakening_reason=REASON)["weakenings_recorded"]
    (told,) = session.ledger.weakenings()
    assert told["reason"] == REASON


def test_a_world_beside_the_failed_one_that_says_so_is_told(tmp_path: Path) -> None:
    _made(tmp_path, "dining table")
    other = parse_spec({**small_spec(), "prompt": PROMPT})
    lines = easier_beside(tmp_path, "v", other)
    assert [line for line in lines if "/entities/b1/role 'dining table' -> 'block 1'" in line]


def test_a_role_may_change_where_no_row_about_it_failed(tmp_path: Path) -> None:
    session = _made(tmp_path, "block 1")
    assert "scale:kind:b1" not in {r.id for r in session.ledger.rows()}
    assert "weakenings_recorded" not in _role(session, "wooden block")
    assert session.ledger.weakenings() == []
    assert session.ledger.revisions(1, 1)[0]["reason"] == "", "the first world of a prompt has nothing to give a reason for"
