"""Inflows and outflows that hold a level: what they read, and what a stream and a bath do by it."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest
from worldagent.simulation.liquid.dfsph.engine import Dfsph
from worldagent.simulation.liquid.engine import Engine, Inflow, LiquidSetup, Outflow, Stage
from worldagent.simulation.liquid.flip.engine import Flip
from worldagent.simulation.liquid.stages import Stages

from .flip_setup import advance, block, tank

CELL = 0.05
WIDE, DEEP = 0.4, 0.25
ALONG = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""An opening that looks along +x, its own x along y."""


def of(level: float, *, x: float = 0.5) -> Stages:
    """An inflow and an outflow that hold a level, read at (x, 0.5)."""
    stage = Stage(x, 0.5, level)
    inflow = Inflow("in", 0, np.zeros(3), np.eye(3), (0.1, 0.1), False, 1.0, stage=stage)
    outflow = Outflow("out", np.zeros(3), np.eye(3), (0.1, 0.1, 0.1), stage)
    setup = tank((1.0, 1.0, 1.0), np.zeros((0, 3)), CELL, inflows=(inflow,), outflows=(outflow,))
    return Stages(setup)


def shares(depth: float, *, x: float = 0.5, low: float = 0.0) -> tuple[float, float]:
    """Open shares of both, at the first look at water of a depth from x = `low` on, for a level of 0.5 m."""
    water, stages = block((low, 0, 0), (1.0, 1.0, depth), CELL / 4), of(0.5, x=x)
    stages.look(water, np.full(len(water), (CELL / 4) ** 3), 0.0)
    return float(stages.inflow[0]), float(stages.outflow[0])


@pytest.mark.parametrize(
    ("high", "inflow", "outflow"),
    [(-3.0, 0.875, 0.0), (-0.25, 0.5625, 0.25), (0.0, 0.5, 0.5), (0.25, 0.4375, 0.75), (1.0, 0.0, 1.0)],
)
def test_an_inflow_gives_more_the_lower_the_surface_and_an_outflow_takes_more_the_higher(
    high: float, inflow: float, outflow: float
) -> None:
    """Heights in spacings over the level; 1.5 at most are seen, and an inflow is shut from one on."""
    assert shares(0.5 + high * CELL) == pytest.approx((inflow, outflow), abs=0.01)


def test_banks_beside_the_gauge_do_not_count() -> None:
    """The right half of the column alone holds water."""
    assert shares(0.5, x=0.5, low=0.5) == pytest.approx(shares(0.5), abs=0.01)


def test_a_dry_gauge_opens_the_inflow_and_shuts_the_outflow() -> None:
    assert shares(0.1) == pytest.approx((0.875, 0.0))


def test_what_is_missing_for_long_opens_an_inflow_wholly() -> None:
    stages, water = of(0.5), block((0, 0, 0), (1.0, 1.0, 0.475), CELL / 4)
    for _ in range(24):
        stages.look(water, np.full(len(water), (CELL / 4) ** 3), 0.1)
    assert stages.inflow[0] == pytest.approx(1.0)


def test_what_holds_no_level_is_open() -> None:
    inflow = Inflow("in", 0, np.zeros(3), np.eye(3), (0.1, 0.1), False, 1.0)
    stages = Stages(tank((1.0, 1.0, 1.0), np.zeros((0, 3)), CELL, inflows=(inflow,)))
    assert not stages.acts
    assert stages.inflow.tolist() == [1.0]


def flume(depth: float) -> LiquidSetup:
    """A channel 2 m long that falls off at its far end, fed by a mouth 1.5 m/s strong that holds 0.25 m, 0.3 m from it."""
    mouth = Inflow(
        "head", 0, np.array([0.0, WIDE / 2, 0.15]), ALONG, (WIDE / 2, 0.15), False, 1.5, stage=Stage(0.3, WIDE / 2, DEEP)
    )
    sides = ("closed", "open", "closed", "closed", "closed", "closed")
    setup = tank((2.0, WIDE, 0.6), block((0, 0, 0), (2.0, WIDE, depth), CELL / 2), CELL / 2, sides=sides, inflows=(mouth,))
    return LiquidSetup(**{**vars(setup), "spacing": CELL})


@pytest.mark.parametrize("depth", [0.15, 0.25])
def test_a_stream_keeps_its_stage_while_it_runs_off(depth: float) -> None:
    """Five cells deep: mean of the last two of seven seconds within a quarter of a cell; every kilogram is booked."""
    engine, seen, balance = Flip(flume(depth)), [], 1000 * 2.0 * WIDE * depth
    for _ in range(7 * 12):
        for report in advance(engine, 1 / 12):
            balance += report.added["head"] - report.removed["domain"]
        found = engine.particles()
        seen.append(found.volume[np.abs(found.position[:, 0] - 0.3) < 0.1].sum() / (0.2 * WIDE))
    assert np.mean(seen[-24:]) == pytest.approx(DEEP, abs=0.25 * CELL)
    assert np.std(seen[-24:]) < 0.25 * CELL
    assert 1000 * found.volume.sum() == pytest.approx(balance, rel=1e-9)


def test_a_run_that_holds_a_level_goes_on_from_a_checkpoint_with_the_same_bytes() -> None:
    one, two = Flip(flume(0.15)), Flip(flume(0.15))
    advance(one, 0.5)
    state = one.checkpoint()
    advance(one, 0.25)
    two.restore(state)
    advance(two, 0.25)
    assert one.checkpoint() == two.checkpoint()


def bath(start: float, spacing: float) -> LiquidSetup:
    """0.6 m square, with a plug hole in the middle of its floor that drains down to 0.3 m."""
    drain = Outflow("drain", np.array([0.3, 0.3, 0.05]), np.eye(3), (0.1, 0.1, 0.05), Stage(0.15, 0.15, 0.3))
    setup = tank((0.6, 0.6, 0.8), block((0, 0, 0), (0.6, 0.6, start), spacing), spacing, outflows=(drain,))
    return LiquidSetup(**{**vars(setup), "spacing": CELL})


@pytest.mark.parametrize(("engine", "spacing"), [(Flip, CELL / 2), (Dfsph, CELL)])
def test_a_bath_drains_to_its_level_and_no_farther(engine: Callable[[LiquidSetup], Engine], spacing: float) -> None:
    """From 0.4 m: within a spacing of 0.3 m after a second, and there for another; the mass is booked."""
    run, start = engine(bath(0.4, spacing)), 0.4
    gone = sum(r.removed.get("drain", 0.0) for r in advance(run, 1.0))
    middle = run.particles().volume.sum() / 0.36
    gone += sum(r.removed.get("drain", 0.0) for r in advance(run, 1.0))
    end = run.particles().volume.sum() / 0.36
    assert middle == pytest.approx(0.3, abs=CELL)
    assert end == pytest.approx(middle, abs=0.2 * CELL)
    assert gone / 1000 / 0.36 == pytest.approx(start - end, abs=1e-6)


def test_a_bath_below_its_level_keeps_its_water() -> None:
    run = Flip(bath(0.25, CELL / 2))
    assert sum(r.removed["drain"] for r in advance(run, 0.3)) == 0.0
    open_run = Flip(
        dataclasses.replace(bath(0.25, CELL / 2), outflows=(dataclasses.replace(bath(0.25, CELL / 2).outflows[0], stage=None),))
    )
    assert sum(r.removed["drain"] for r in advance(open_run, 0.3)) > 0.0
