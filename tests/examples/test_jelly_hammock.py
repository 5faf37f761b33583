"""A jelly drops on a cloth over a tray of sand: accepted, each of both feels the other, and without the drop nothing is caught."""

from __future__ import annotations

import argparse
import sqlite3
from pathlib import Path

import pytest
from worldagent.examples.jelly_hammock import FRAMES, PROMPT, jelly_spec, run
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.patch import parse_spec


def test_the_specification_passes_the_audit() -> None:
    report = audit(parse_spec({"prompt": PROMPT, **jelly_spec()}))
    assert report.passed, [r for r in report.rows if r.status == "fail"]


@pytest.mark.slow
def test_the_jelly_is_caught_and_accepted(tmp_path: Path) -> None:
    found = run(argparse.Namespace(out=str(tmp_path), frames=FRAMES, no_render=True))
    assert found["accepted"], found
    with sqlite3.connect(tmp_path / "jelly_hammock" / "ledger.sqlite") as ledger:
        rows = dict(ledger.execute("select id, status from matrix").fetchall())
    for row in (
        "causal:without:drops:caught",
        "category:cloth:solids:cloth",
        "category:elastic:exchange:bodies",
        "category:elastic:together:bodies",
        "category:particles:inside:grains",
    ):
        assert rows[row] == "pass", row
