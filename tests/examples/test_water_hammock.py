"""Water drops on a cloth between four posts: accepted, none of it goes through, each of both feels the other."""

from __future__ import annotations

import argparse
import sqlite3
from pathlib import Path

import pytest
from worldagent.examples.water_hammock import FRAMES, PROMPT, held_spec, run
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.patch import parse_spec


def test_the_specification_passes_the_audit() -> None:
    report = audit(parse_spec({"prompt": PROMPT, **held_spec()}))
    assert report.passed, [r for r in report.rows if r.status == "fail"]


@pytest.mark.slow
def test_the_cloth_holds_the_water_and_is_accepted(tmp_path: Path) -> None:
    found = run(argparse.Namespace(out=str(tmp_path), frames=FRAMES, no_render=True))
    assert found["accepted"], found
    with sqlite3.connect(tmp_path / "water_hammock" / "ledger.sqlite") as ledger:
        rows = dict(ledger.execute("select id, status from matrix").fetchall())
    for row in (
        "category:cloth:pins:cloth",
        "category:liquid:energy:water",
        "category:liquid:exchange:water",
        "category:liquid:leak:water",
        "category:liquid:received:water",
    ):
        assert rows[row] == "pass", row
