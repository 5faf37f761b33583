"""A jelly drops into a tank of water: accepted, each of both feels the other."""

from __future__ import annotations

import argparse
import sqlite3
from pathlib import Path

import pytest
from worldagent.examples.jelly_tank import FRAMES, PROMPT, run, tank_of_jelly
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.patch import parse_spec


def test_the_specification_passes_the_audit() -> None:
    report = audit(parse_spec({"prompt": PROMPT, **tank_of_jelly()}))
    assert report.passed, [r for r in report.rows if r.status == "fail"]


@pytest.mark.slow
def test_the_jelly_bobs_and_is_accepted(tmp_path: Path) -> None:
    found = run(argparse.Namespace(out=str(tmp_path), frames=FRAMES, no_render=True))
    assert found["accepted"], found
    with sqlite3.connect(tmp_path / "jelly_tank" / "ledger.sqlite") as ledger:
        rows = dict(ledger.execute("select id, status from matrix").fetchall())
    for row in (
        "category:elastic:exchange:rigid",
        "category:liquid:buoyancy:water",
        "category:liquid:energy:water",
        "category:liquid:exchange:water",
        "category:liquid:inside:water",
    ):
        assert rows[row] == "pass", row
