"""Collapsing columns and drained heaps of grains against measured ones, at the resolution that a CPU does in a minute or two.

The same at 25 and 40 diameters across, in the round, too: `python -m worldagent.bench.grains_collapse --device cuda`.
"""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.bench.grain_columns import BANDS, Column, collapse, exponents, front, planar_column
from worldagent.bench.grain_heaps import drain, heap, zhou
from worldagent.bench.grain_scenes import SAND
from worldagent.simulation.particles.setup import GrainSetup

BARE = GrainSetup(
    np.full(3, -1.0),
    np.full(3, 1.0),
    (SAND,),
    np.zeros((0, 3)),
    np.zeros((0, 3)),
    np.zeros(0),
    np.zeros(0, np.int32),
    np.zeros(3),
)
REPOSE = 2.0
"""[degrees] Own choice: error of an angle of repose."""


@pytest.mark.slow
@pytest.mark.parametrize("aspect", [0.5, 1.0])
def test_a_column_in_a_channel_runs_as_far_as_measured_ones(aspect: float) -> None:
    found = collapse(planar_column(25, aspect, "cpu"))
    assert found["lost"] == 0
    low, high = found["gate"]
    assert low <= found["run_out"] <= high, found


@pytest.mark.slow
def test_beads_that_drain_leave_the_slope_that_was_measured() -> None:
    found = drain(heap(0.01, "cpu"))
    assert abs(found["slope"] - zhou(0.01)) < REPOSE, found


def test_bands_of_run_outs_hold_both_measurements() -> None:
    """Law: the published fits at their own points."""
    lube, lajeunesse = BANDS["round"]
    assert (lube(1.0), lajeunesse(0.5)) == (1.24, 0.5)
    assert lube(4.0) == pytest.approx(3.2)
    assert lajeunesse(4.0) == pytest.approx(4.0)
    assert [BANDS["planar"][0](a) for a in (1.0, 8.0)] == pytest.approx([1.2, 7.6])
    assert zhou(1e-3) == pytest.approx(29.6)


def test_exponents_are_fitted_on_both_sides_of_the_change_of_the_law() -> None:
    """Law: run-outs of a published fit give its exponents back; the wrong law, or one column alone, does not pass."""
    lube = [{"case": "round", "aspect": a, "run_out": BANDS["round"][0](a)} for a in (0.5, 1.0, 2.0, 4.0, 8.0)]
    small, large = exponents(lube)
    assert (small["exponent"], large["exponent"]) == pytest.approx((1.0, 0.5))
    assert (small["columns"], large["columns"], large["from"], large["to"]) == (2, 3, 2.0, 8.0)
    assert small["within"]
    assert large["within"]
    far = [{"case": "planar", "aspect": a, "run_out": 2.0 * a**0.9} for a in (3.0, 4.0, 8.0)]
    assert [f["within"] for f in exponents(far)] == [False]
    assert exponents(far[:1]) == []


@pytest.mark.parametrize("width", [0.0, 0.05])
def test_the_front_is_where_half_the_ground_is_bare(width: float) -> None:
    d, across = 0.004, 0.1
    rng = np.random.default_rng(5)
    n = 60_000
    if width == 0:
        way, angle = across * np.sqrt(rng.random(n)), 2 * np.pi * rng.random(n)
        place = np.stack([way * np.cos(angle), way * np.sin(angle), np.zeros(n)], axis=1)
    else:
        place = np.stack([across * rng.random(n), width * (rng.random(n) - 0.5), np.zeros(n)], axis=1)
    stray = np.array([[2 * across, 0.0, 0.0], [0.0, 3 * across, 0.0]])[: 1 if width else 2]
    c = {"position": np.concatenate([place, stray]), "radius": np.full(n + len(stray), d / 2)}
    column = Column(BARE, 1, across, width, d)
    assert front(column, c) == pytest.approx(across, abs=0.6 * d)
