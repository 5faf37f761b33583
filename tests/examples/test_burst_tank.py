"""The tank bursts: gate, flood and swept crates are accepted, and without the gate's lift nothing floods."""

from __future__ import annotations

import argparse
import sqlite3
from pathlib import Path

import numpy as np
import pytest
from worldagent.construction.build import build_entity
from worldagent.examples.burst_tank import CRATE, CRATES, PROMPT, flood_spec, run
from worldagent.worlds.arrays import pose_of
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.spec import WorldSpec


def test_the_specification_passes_the_audit() -> None:
    report = audit(WorldSpec.model_validate({"prompt": PROMPT, **flood_spec(0.05)}))
    assert report.passed, [r for r in report.rows if r.status == "fail"]


def test_the_crates_stand_flat_on_the_street_without_skids(tmp_path: Path) -> None:
    """The whole underside of each, two skins above the floor: the flood has to move it as it stands."""
    spec = WorldSpec.model_validate({"prompt": PROMPT, **flood_spec(0.05)})
    skin = spec.simulation.rigid["bodies"].settings.skin
    assert len(CRATES) == 3
    for name in CRATES:
        built = build_entity(spec, name, tmp_path)
        points = np.concatenate([pose_of(spec.entities[name].pose).apply(part.render.vertices) for part in built.parts])
        bottom = points[points[:, 2] < points[:, 2].min() + skin]
        assert np.ptp(bottom[:, :2], axis=0) == pytest.approx(CRATE[:2]), name
        assert 0 <= points[:, 2].min() <= 2 * skin + 1e-9, name
        assert len(built.parts) == 1, name


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
