"""An active box that follows a gas: the same flow as in the whole box, nothing lost, and grown before anything arrives at its sides."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from worldagent.simulation.gas.active import OFTEN, ActiveGas
from worldagent.simulation.gas.engine import LIGHTNESS, SOOT, Gas
from worldagent.simulation.gas.far import MANY, coarse
from worldagent.simulation.gas.settings import GasSettings, Side
from worldagent.simulation.gas.solids import Solids, corners_of, cut, enclosed
from worldagent.simulation.gas.window import BLOCK, Window, bounds_of, fitted, shrunk
from worldagent.worlds.arrays import F64

CELL = 0.05
SHAPE = (40, 40, 64)
SIDES: tuple[Side, ...] = ("open", "open", "open", "open", "closed", "open")
SMOKE = (0.4, 1e-3, 0.0, 0.0)
RATE = 0.02
"""[m^3/s]"""
FRAME = 1.0 / 24.0


def around(*place: float, radius: float = 0.14, shape: tuple[int, int, int] = SHAPE) -> F64:
    """Rate per volume of a ball that lets out `RATE` [1/s]."""
    middles = corners_of(shape, CELL, np.zeros(3))[:-1, :-1, :-1] + 0.5 * CELL
    inside = np.linalg.norm(middles - np.array(place), axis=-1) < radius
    return np.where(inside, RATE / (inside.sum() * CELL**3), 0.0)


LOW = around(1.0, 1.0, 0.2)


def active(rate: F64 = LOW, scheme: str = "reflection", **known: object) -> ActiveGas:
    """Smoke that rises in still air."""
    gas = ActiveGas(SHAPE, CELL, SIDES, GasSettings(scheme=scheme), start=rate > 0.0, **known)  # type: ignore[arg-type]
    gas.emit(rate, SMOKE)
    return gas


def whole(scheme: str = "reflection") -> Gas:
    """The same in the whole box."""
    gas = Gas(SHAPE, CELL, SIDES, GasSettings(scheme=scheme))  # type: ignore[arg-type]
    gas.emit(LOW, SMOKE)
    return gas


def edge(gas: ActiveGas, width: int = 2) -> float:
    """Most of the source's soot or lightness in cells along the inner sides."""
    state, inner, found = gas.near.state, gas.window.inner(SHAPE), [0.0]
    for side in np.flatnonzero(inner):
        cells = np.moveaxis(state, side // 2, 0)[-width:] if side % 2 else np.moveaxis(state, side // 2, 0)[:width]
        found += [float(np.abs(cells[..., q]).max()) / SMOKE[q] for q in (LIGHTNESS, SOOT)]
    return max(found)


def apart(a: F64, b: F64) -> float:
    """Share of the soot of one that lies elsewhere in the other."""
    return 0.5 * float(np.abs(a - b).sum() / a.sum())


@pytest.mark.parametrize("scheme", ["reflection", "maccormack"])
def test_it_flows_as_in_the_whole_box(scheme: str) -> None:
    """Law: the flow outside has no eddies, and coarse cells tell it. Own bounds: measured 2e-4 of the soot, 1 % of the speeds."""
    near, all_of_it = active(scheme=scheme), whole(scheme)
    for gas in (near, all_of_it):
        for _ in range(18):
            gas.advance(FRAME)
    assert near.window.shape[2] < SHAPE[2]
    assert min(near.window.shape[:2]) < SHAPE[0]
    assert apart(all_of_it.state[..., SOOT].astype(float), near.state[..., SOOT].astype(float)) < 1e-3
    at = near.window.elements
    off = np.abs(all_of_it.velocity[at] - near.velocity[at])
    assert float(off.max()) < 0.03 * float(np.abs(all_of_it.velocity).max())


def test_coarse_air_is_nearer_to_the_whole_box_than_ambient_pressure_at_the_sides(monkeypatch: pytest.MonkeyPatch) -> None:
    full = whole()
    full.advance(12 * FRAME)
    found = {}
    for far in (True, False):
        monkeypatch.setattr(ActiveGas, "far_field", far)
        gas = active()
        gas.advance(12 * FRAME)
        at = gas.window.elements
        found[far] = float(np.sqrt(np.square(full.velocity[at] - gas.velocity[at]).mean()))
    assert found[True] < 0.5 * found[False]


def test_nothing_is_lost_and_nothing_arrives_before_it_has_grown() -> None:
    gas = active()
    windows, worst, slipped, left = [gas.window], 0.0, np.zeros(5), np.zeros(5)
    time = 0.0
    while time < 2.0:
        dt = min(gas.longest(), 0.03)
        gas.step(dt)
        time += dt
        worst = max(worst, edge(gas))
        slipped, left = slipped + gas.slipped(), left + gas.take()
        windows.append(gas.window)
    made = RATE * time * np.array(SMOKE[:2])
    held = gas.totals()[:2] * CELL**3
    # Gas that expands is as light as the air that it takes the place of: all its lightness stays.
    assert held + left[:2] * CELL**3 == pytest.approx(made, rel=1e-6)
    assert worst < 1e-6
    assert np.abs(slipped[:2] * CELL**3 / made).max() < 1e-12
    assert windows[-1].shape[2] >= windows[0].shape[2] + 2 * BLOCK
    assert all(low % BLOCK == 0 for w in windows for low in w.low)


def test_air_outside_is_at_rest_and_ambient() -> None:
    gas = active()
    gas.advance(4 * FRAME)
    outside = np.ones(SHAPE, bool)
    outside[gas.window.cells] = False
    assert outside.any()
    assert not gas.state[outside].any()
    assert (gas.temperature[outside] == gas.settings.ambient_temperature).all()
    assert gas.near.velocity.any()
    assert gas.state.shape == (*SHAPE, 4)
    assert gas.velocity.shape == (41, 41, 65, 3)


def test_without_growth_smoke_leaves_through_inner_sides_and_is_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Smoke that slips out is part of all that has left, so that the sums hold and a row can tell."""
    monkeypatch.setattr(ActiveGas, "_follow", lambda self, changed: None)
    gas = active()
    gas.advance(40 * FRAME)
    out, slipped = gas.take() * CELL**3, gas.slipped() * CELL**3
    made = RATE * 40 * FRAME * SMOKE[SOOT]
    assert slipped[SOOT] > 0.01 * made
    assert out[SOOT] == slipped[SOOT]
    assert gas.totals()[SOOT] * CELL**3 + out[SOOT] == pytest.approx(made, rel=1e-6)


def test_a_source_that_starts_outside_is_in_it_before_it_lets_anything_out() -> None:
    gas = active()
    gas.advance(3 * FRAME)
    assert gas.window.high[2] < 48
    other = around(1.0, 1.0, 2.6)
    gas.emit(LOW + other, SMOKE)
    gas.step(0.01)
    cells = bounds_of(other > 0.0)
    assert cells is not None
    assert all(a <= b for a, b in zip(gas.window.low, cells.low, strict=True))
    assert all(a >= b for a, b in zip(gas.window.high, cells.high, strict=True))
    assert gas.totals()[SOOT] * CELL**3 == pytest.approx(RATE * SMOKE[SOOT] * (3 * FRAME + 0.02), rel=1e-6)


def _plate(height: float) -> Callable[[float], Solids]:
    """A block that comes down from a height with 1 m/s."""
    points = corners_of(SHAPE, CELL, np.zeros(3))

    def at(time: float) -> Solids:
        far = np.abs(points - np.array([1.0, 1.0, height - time])) - np.array([0.3, 0.3, 0.1])
        found = cut(np.minimum(far.max(axis=-1), 0.2))
        found.velocity[..., 2] = np.where(far.max(axis=-1) < CELL, -1.0, 0.0)
        return found

    return at


def test_a_body_that_moves_is_in_it() -> None:
    at = _plate(2.8)
    gas = active(solids=at(0.0), moves=True)
    assert gas.window.high[2] < 40
    gas.step(0.02, at(0.02))
    assert gas.window.high[2] >= 58
    for n in range(2, 20):
        gas.step(0.02, at(0.02 * n))
    made = RATE * 0.02 * 19 * SMOKE[SOOT]
    assert (gas.totals()[SOOT] + gas.take()[SOOT]) * CELL**3 == pytest.approx(made, rel=1e-5)
    inside = tuple(slice(0, n) for n in SHAPE)
    assert np.array_equal(gas.room, enclosed(SHAPE, SIDES, at(0.38), widen=False).room[inside])


def test_a_run_goes_on_from_its_state_to_the_bit_across_growth() -> None:
    gas = active()
    gas.advance(4 * FRAME)
    kept = {k: np.array(v) for k, v in gas.pack().items()}
    gas.unpack(kept)
    other = active()
    other.unpack(kept)
    before = gas.window
    for one in (gas, other):
        for _ in range(12):
            one.advance(FRAME)
    assert gas.window != before
    ends = [one.pack() for one in (gas, other)]
    assert all(np.array_equal(ends[0][name], ends[1][name]) for name in ActiveGas.packed)


def test_one_that_is_too_large_comes_in_and_drops_nothing_that_counts() -> None:
    """As after a body has moved far from the gas. Smoke leaves a thin trail, which is followed as long as it is there."""
    gas = active()
    gas.advance(2 * FRAME)
    needed = gas.window
    state = dict(gas.pack())
    large = ActiveGas(SHAPE, CELL, SIDES, GasSettings(), start=np.ones(SHAPE, bool))
    large.emit(LOW, SMOKE)
    assert large.window.shape == SHAPE
    large.near.state = gas.state
    large.near.velocity = gas.velocity
    steps = 0
    while large.window.shape == SHAPE and steps <= OFTEN:
        large.step(0.01)
        steps += 1
    assert large.window.shape[2] < SHAPE[2]
    assert all(a <= b for a, b in zip(large.window.low, needed.low, strict=True))
    made = RATE * (2 * FRAME + 0.01 * steps) * SMOKE[SOOT]
    dropped = large.slipped()[SOOT] * CELL**3
    assert abs(dropped) < 1e-6 * made
    assert large.totals()[SOOT] * CELL**3 + dropped == pytest.approx(made, rel=1e-6)
    assert state["active"].tolist() == [list(needed.low), list(needed.high)]


def test_a_sealed_room_is_in_it_as_a_whole() -> None:
    """Its gas has one pressure, whose volume has to be known."""
    points = corners_of(SHAPE, CELL, np.zeros(3))
    outer = (np.abs(points - np.array([1.0, 1.0, 1.6])) - np.array([0.8, 0.8, 1.4])).max(axis=-1)
    inner = (np.abs(points - np.array([1.0, 1.0, 1.6])) - np.array([0.65, 0.65, 1.25])).max(axis=-1)
    gas = active(around(1.0, 1.0, 0.6), solids=cut(-np.minimum(-outer, inner)))
    assert gas.window.high[2] >= 56
    report = gas.step(0.01)
    assert report.divergence < 1e-5
    before = float(gas.near.pressure[16 - gas.window.low[0], 16 - gas.window.low[1], 20])
    assert before > 101325.0
    gas._change(Window((0, 0, 0), SHAPE))
    assert float(gas.near.pressure[16, 16, 20]) == pytest.approx(before, rel=1e-9)
    assert float(gas.near.pressure[1, 1, 1]) == 101325.0


def test_windows_are_of_whole_blocks_with_their_margins() -> None:
    shape = (20, 30, 100)
    found = fitted([Window((9, 9, 9), (11, 12, 30))], 6, shape)
    assert (found.low, found.high) == ((0, 0, 0), (20, 24, 40))
    assert found.inner(shape) == (0, 0, 0, 1, 0, 1)
    assert found.sides(shape, ("closed",) * 6) == ("closed", "closed", "closed", "open", "closed", "open")
    assert fitted([Window((9, 9, 9), (11, 12, 30))], 6, shape, Window((0, 0, 0), (8, 30, 64))).high == (20, 30, 64)
    far = Window((0, 0, 0), (20, 24, 96))
    assert shrunk(far, Window((0, 0, 40), (20, 24, 80))) == Window((0, 0, 40), (20, 24, 96))
    assert bounds_of(np.zeros((3, 3, 3), bool)) is None


def test_coarse_openings_are_means_of_fine_ones() -> None:
    shape = (8, 6, 8)
    points = corners_of(shape, 1.0, np.zeros(3))
    fine = enclosed(shape, SIDES, cut(points[..., 2] - 2.5), widen=False)
    found = coarse(fine, shape)
    assert found.room.shape == (3, 3, 3)
    # 1.5 of 4 cells are open; of the last two along y only half exist.
    assert found.room[0, 0, 0] == pytest.approx(1.5 / MANY)
    assert found.room[0, 1, 0] == pytest.approx(0.75 / MANY)
    assert found.opening[1, 0, 0, 0] == pytest.approx(1.5 / MANY)
    assert found.opening[0, 0, 0, 2] == 0.0
    assert found.opening[0, 0, 2, 2] == pytest.approx(1.0)
    assert found.opening[0, 2, 1, 1] == pytest.approx(1.0)
