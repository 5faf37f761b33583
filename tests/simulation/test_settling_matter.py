"""Cloth, grains and floating bodies come to rest before frame 0, and stay there; a run goes on from there alike."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.simulation.probe import replay
from worldagent.testing.worlds.by_category import spec_of
from worldagent.testing.worlds.simulated_worlds import simulate
from worldagent.testing.worlds.small_cloth import drape_spec
from worldagent.testing.worlds.small_grains import SAND_PROMPT, sand_spec
from worldagent.testing.worlds.small_liquids import CRATE, tank_spec
from worldagent.testing.worlds.small_liquids import PROMPT as TANK
from worldagent.verifiers.checks import run_checks
from worldagent.verifiers.scene.settled import settled_rows
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.spec import Settle, WorldSpec

pytestmark = pytest.mark.slow


def _settled(spec: WorldSpec, **plan: Any) -> WorldSpec:
    """The specification without drivers, with everything settling."""
    given = {"settle": Settle(max_time=10.0), "drivers": {}, "preroll": 0.0, **plan}
    return spec.model_copy(update={"simulation": spec.simulation.model_copy(update=given)})


def _sound(candidate: Candidate) -> None:
    rows = run_checks(candidate, only=("numerical",), reruns=False)
    asked = [r for r in rows if r.question == "numerical:settled"]
    assert asked
    assert {r.status for r in asked} == {"pass"}, [r.evidence for r in asked]
    starts = [
        r for r in rows if r.question in ("numerical:placed", "numerical:started", "numerical:amount") and r.status == "fail"
    ]
    assert not starts, [r.evidence for r in starts]
    results = replay(candidate, intervals=1, seed=1)
    assert results
    assert all(r["identical"] for r in results)


def test_a_cloth_hangs_over_a_ball_at_frame_0(tmp_path: Path) -> None:
    spec = _settled(spec_of(drape_spec(frames=12, resolution=0.07), "A cloth falls on a ball."))
    candidate = simulate(tmp_path, spec, stage="full")
    _sound(candidate)
    places = candidate.deforming["cloth"].positions(0)
    assert places[:, 2].max() > 0.5, "it lies on the ball"
    assert places[:, 2].min() < 0.2, "its corners hang down"


def test_a_cloth_whose_time_is_too_short_is_still_falling(tmp_path: Path) -> None:
    spec = _settled(spec_of(drape_spec(frames=6, resolution=0.1), "A cloth falls on a ball."), settle=Settle(max_time=0.5))
    (row,) = settled_rows(simulate(tmp_path, spec))
    assert (row.status, row.first_failing_entity) == ("fail", "cloth")
    assert row.corrections[0].patch


def test_a_bed_of_grains_lies_still_at_frame_0(tmp_path: Path) -> None:
    spec = _settled(spec_of(sand_spec(frames=12, radius=0.016, ball_at=None), SAND_PROMPT))
    candidate = simulate(tmp_path, spec, stage="full")
    _sound(candidate)
    first, last = (candidate.caches["grains"].read(k)["particle/position"] for k in (0, 11))
    assert np.abs(first - last).max() < 1e-4, "contacts keep what they bore, so that nothing sags"


def test_a_crate_floats_at_its_draught_at_frame_0(tmp_path: Path) -> None:
    candidate = simulate(tmp_path, _settled(spec_of(tank_spec(frames=12, crate_at=0.2, spacing=0.03), TANK)), stage="full")
    _sound(candidate)
    water = candidate.caches["water"].read(0)
    level = float(np.quantile(water["origin"][2] + water["particle/position"][:, 2], 0.98))
    draught = level - (candidate.pose("crate", 0).position[2] - CRATE / 2)
    assert draught == pytest.approx(0.5 * CRATE, abs=0.03), "half as dense as water, within a spacing"
