"""Rows that come in a line, where the room of a reply is used up, still say why they fail."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.workflow.rows import WHY_CHARACTERS, brief, shaped, why_line
from worldagent.worlds.requirements import Row


def _row(n: int, status: str = "fail", **evidence: Any) -> dict[str, Any]:
    row = Row(
        id=f"causal:a:b{n}", check="causal", group="temporal", predicate="p", status=status, artifact="x", evidence=evidence
    )  # type: ignore[arg-type]
    return brief(row)


def test_every_row_of_a_long_reply_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [_row(n, explanation=f"effect {n} never came true: " + "it slides too little, " * 12) for n in range(9)]
    told = shaped(rows, room=1200)
    assert len(told) == 9
    assert all(r["why"].startswith(f"effect {n} never came") for n, r in enumerate(told))
    assert "corrections" not in told[-1]
    assert len(told[-1]["why"]) <= WHY_CHARACTERS + 3


def test_a_row_that_passes_gives_no_reason() -> None:
    assert "why" not in why_line({**_row(1, "pass"), "evidence": {"explanation": "all well"}})


def test_problems_and_what_made_a_row_stale_are_reasons_too() -> None:
    assert why_line(_row(1, problems=["one", "two"]))["why"] == "one; two"
    assert why_line(_row(1, "unverified", stale="story changed in revision 2"))["why"] == "stale: story changed in revision 2"
