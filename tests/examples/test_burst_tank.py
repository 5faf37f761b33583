"""The tank bursts: gate, flood and swept crates are accepted, and without the gate's lift nothing floods."""

from __future__ import annotations

import argparse
import sqlite3
from pathlib import Path

import pytest
from worldagent.examples.burst_tank import flood_spec, run
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.spec import WorldSpec


def test_the_specification_passes_the_audit() -> None:
    from worldagent.examples.burst_tank import PROMPT

    report = audit(WorldSpec.model_validate({"prompt": PROMPT, **flood_spec(0.05)}))
    assert report.passed, [r for r in report.rows if r.status == "fail"]


@pytest.mark.slow
def test_the_flood_is_accepted(tmp_path: Path) -> None:
    found = run(argparse.Namespace(out=str(tmp_path), spacing=0.05, engine="dfsph", no_render=True))
    assert found["accepted"], found
    with sqlite3.connect(tmp_path / "burst_tank" / "ledger.sqlite") as ledger:
        rows = dict(ledger.execute("select id, status from matrix").fetchall())
    for row in (
        "causal:bursts:sweeps",
        "causal:without:bursts:sweeps",
        "category:liquid:leak:water",
        "category:liquid:exchange:water",
    ):
        assert rows[row] == "pass", row
