"""A cannonball breaches a wall under a flag: accepted, broken by the ball and by nothing before, and without the gust nothing whips."""

from __future__ import annotations

import argparse
import sqlite3
from pathlib import Path

import pytest
from worldagent.examples.siege import PROMPT, SECONDS, run, siege_spec
from worldagent.worlds.audit import audit
from worldagent.worlds.patch import parse_spec


def test_the_specification_passes_the_audit() -> None:
    report = audit(parse_spec({"prompt": PROMPT, **siege_spec()}))
    assert report.passed, [r for r in report.rows if r.status == "fail"]


@pytest.mark.slow
def test_the_wall_is_breached_and_accepted(tmp_path: Path) -> None:
    found = run(argparse.Namespace(out=str(tmp_path), edge=0.05, seconds=SECONDS, no_render=True))
    assert found["accepted"], found
    with sqlite3.connect(tmp_path / "siege" / "ledger.sqlite") as ledger:
        rows = dict(ledger.execute("select id, status from matrix").fetchall())
    for row in (
        "requirement:whole",
        "beat:breaches",
        "beat:collapses",
        "beat:whips",
        "causal:without:strikes:breaches",
        "contact:wall:wall",
        "category:cloth:energy:silk",
    ):
        assert rows[row] == "pass", row
