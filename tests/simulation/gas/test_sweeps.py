"""Sweeps of amounts: into how many parts a step falls, and what cells hold on the way; launches that are kept."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from worldagent.simulation.gas.engine import SOOT, Gas
from worldagent.simulation.gas.settings import GasSettings
from worldagent.simulation.gas.transport import MOST_TAKEN
from worldagent.simulation.passes import Waves
from worldagent.worlds.arrays import F64

SHAPE = (7, 6, 5)


def strained(seed: int) -> Gas:
    """A gas in an open box whose flow is a random one, of no divergence but for rounding, that is stretched along an axis."""
    gas = Gas(SHAPE, 1.0, ("open",) * 6, GasSettings(), gravity=(0.0, 0.0, 0.0))
    speeds = np.random.default_rng(seed).uniform(-1.0, 1.0, (8, 7, 6, 3)).astype(np.float32)
    speeds[..., 2] += np.arange(6)
    gas.velocity = speeds
    gas.solve(1e-6, 60)
    return gas


def taken(speeds: F64, seconds: float, order: tuple[int, ...]) -> float:
    """Largest share of what a cell holds at its begin that a sweep takes out of it, sweep by sweep."""
    volume, most = np.ones(SHAPE), 0.0
    inner = tuple(slice(0, n) for n in SHAPE)
    for axis in order:
        upper = tuple(slice(1, n + 1) if a == axis else slice(0, n) for a, n in enumerate(SHAPE))
        below, above = seconds * speeds[inner][..., axis], seconds * speeds[upper][..., axis]
        most = max(most, float(((np.maximum(-below, 0.0) + np.maximum(above, 0.0)) / volume).max()))
        volume = volume + below - above
        if (volume <= 0.0).any():
            return np.inf
    return most


@pytest.mark.parametrize("seed", range(4))
def test_a_step_has_as_many_parts_as_it_takes_and_no_more(seed: int) -> None:
    gas = strained(seed)
    seconds = 1.5
    parts = gas.transport.parts(seconds, gas._face("velocity"), gas._opening, gas._room)
    speeds = gas.velocity.astype(np.float64)
    orders = ((0, 1, 2), (2, 1, 0))
    assert parts > 1
    assert max(taken(speeds, seconds / parts, order) for order in orders) <= MOST_TAKEN + 1e-5
    assert max(taken(speeds, seconds / (parts - 1), order) for order in orders) > MOST_TAKEN


@pytest.mark.parametrize(("sides", "turn"), [*itertools.product((("open",) * 6, ("periodic",) * 4 + ("closed", "open")), (0, 1))])
def test_what_sweeps_carry_is_what_cells_lose_and_what_is_even_stays_even(sides: tuple[str, ...], turn: int) -> None:
    """Soot of one concentration everywhere, with what comes in bare of it: cells away from open sides keep theirs."""
    gas = Gas((9, 8, 11), 1.0, sides, GasSettings(expands=False), gravity=(0.0, 0.0, 0.0))  # type: ignore[arg-type]
    speeds = np.random.default_rng(3).uniform(-1.0, 1.0, (10, 9, 12, 3)).astype(np.float32)
    gas.velocity = speeds
    gas.solve(1e-7, 60)
    state = np.zeros((9, 8, 11, 4), np.float32)
    state[..., SOOT] = 0.25
    gas.state = state
    gas.border.take()
    gas.steps = turn
    before = gas.totals()[SOOT]
    gas._transport("velocity", 0.3, None)
    gone = gas.border.take()[SOOT]
    assert before - gas.totals()[SOOT] == pytest.approx(gone, abs=1e-5)
    assert gas.state[3:6, 3:5, 3:6, SOOT] == pytest.approx(0.25, rel=2e-6)


@pytest.mark.parametrize("sides", [("open",) * 6, ("closed", "open", *("periodic",) * 4)])
def test_sweeps_over_slices_of_layers_give_what_sweeps_over_all_do(sides: tuple[str, ...]) -> None:
    """The pressure's multigrid cycle, to the last bit: slices go through all sweeps, then what is left around their ends."""
    shape = (70, 5, 6)
    gas = Gas(shape, 1.0, sides, GasSettings())  # type: ignore[arg-type]
    gas.solve(1e-6, 1)
    fine = gas._levels.fine
    waves = [one for one in gas._levels._cycle if isinstance(one, Waves)]
    assert len(waves) >= 2
    assert all(one.sliced for one in waves)
    draw = np.random.default_rng(5).standard_normal(fine.elements).astype(np.float32)
    found = []
    for sliced in (True, False):
        for name, values in (("right", draw), ("x", 0.5 * draw), ("left", 0.0 * draw)):
            getattr(fine, name).assign(values)
        for wave in waves:
            for one in [wave] if sliced else wave.passes:
                one()
        found.append(np.stack([fine.x.numpy(), fine.left.numpy()]))
    assert np.abs(found[0]).max() > 1.0
    np.testing.assert_array_equal(found[0], found[1])


def test_launches_are_kept_with_their_numbers_changed() -> None:
    """A step of another length gives what it gives in a gas that has made none before."""
    first, second = strained(1), strained(1)
    speeds = first.velocity
    first.step(0.2)
    for gas in (first, second):
        gas.velocity, gas.state, gas.steps, gas._last = speeds, np.zeros((*SHAPE, 4), np.float32), 0, 0.0
        gas.emit(np.full(SHAPE, 0.1), (0.3, 0.01, 0.0, 0.0))
        gas.step(0.05)
    assert np.array_equal(first.velocity, second.velocity)
    assert np.array_equal(first.state, second.state)
