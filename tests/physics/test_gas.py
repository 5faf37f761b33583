"""The gas engine against exact flows, sums that must stay, and a published cavity; resolutions stand beside the numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest
from worldagent.bench.gas import CAVITY, CLOSED, WIND, WINDY, ball, cavity, residuals, smoke_box, vortices
from worldagent.simulation.gas.engine import SOOT, Gas
from worldagent.simulation.gas.settings import GasSettings
from worldagent.simulation.gas.solids import cut, open_share


def test_reflection_keeps_vortices_at_second_order() -> None:
    coarse, fine = vortices(16, "reflection"), vortices(32, "reflection")
    assert math.log2(coarse["error"] / fine["error"]) > 1.8
    assert fine["energy"] > 0.96
    assert max(coarse["divergence"], fine["divergence"]) < 1e-5


def test_vortices_that_a_wind_takes_along_are_where_it_takes_them_at_second_order() -> None:
    """Steps of two cells: what carries velocities is the flow halfway through the time that it does, or the error falls by half instead."""
    coarse, fine = (vortices(n, "reflection", courant=WINDY, wind=WIND) for n in (16, 32))
    assert math.log2(coarse["error"] / fine["error"]) > 1.8
    assert fine["error"] < 0.08
    assert fine["energy"] > 0.96


def test_reflection_keeps_more_energy_than_maccormack_alone() -> None:
    assert vortices(16, "reflection")["energy"] > vortices(16, "maccormack")["energy"] + 0.3


def test_viscosity_damps_vortices_at_their_rate() -> None:
    """exp(-8 pi^2 nu t) at 32 x 32, nu = 0.002 m^2/s."""
    assert vortices(32, "reflection", 0.002)["error"] < 0.02


@pytest.mark.slow
def test_vortices_at_64_cells_are_within_one_percent() -> None:
    assert vortices(64, "reflection")["error"] < 0.01
    assert vortices(64, "reflection", 0.002)["error"] < 0.01


def test_heat_goes_through_a_weakly_heated_cavity() -> None:
    """Rayleigh number 1,000 at 16 x 16, after 0.2 times: within 2 %, and what comes in goes out."""
    warm, cold = cavity(1e3, 16, 0.2)
    assert warm == pytest.approx(CAVITY[1e3], rel=0.02)
    assert cold == pytest.approx(warm, rel=0.005)


@pytest.mark.slow
@pytest.mark.parametrize(("rayleigh", "cells"), [(1e4, 48), (1e5, 64)])
def test_heat_goes_through_a_heated_cavity(rayleigh: float, cells: int) -> None:
    warm, cold = cavity(rayleigh, cells, 0.3)
    assert warm == pytest.approx(CAVITY[rayleigh], rel=0.02)
    assert cold == pytest.approx(warm, rel=0.005)


@pytest.mark.parametrize("expands", [False, True])
def test_smoke_that_rises_around_a_ball_in_a_closed_box_is_kept(expands: bool) -> None:
    """20^3 cells for half a second: soot to 1e-6, none below zero, nothing inside the ball."""
    cells = 20
    solids = cut(ball(cells))
    gas = Gas((cells,) * 3, 1.0 / cells, CLOSED, GasSettings(expands=expands), solids=solids)
    state = np.zeros((cells, cells, cells, 4), np.float32)
    state[6:14, 6:14, 2:7, :2] = (0.5 if expands else 0.1, 0.01)
    gas.state = state
    before = gas.totals()
    reports = gas.advance(0.5)
    after = gas.totals()
    assert after[SOOT] == pytest.approx(before[SOOT], rel=1e-6)
    assert after[0] == pytest.approx(before[0], rel=1e-5)
    assert max(r.divergence for r in reports) < 1e-5
    assert not any(r.capped for r in reports)
    found = gas.state
    assert found.min() > -1e-4
    assert np.abs(found[solids.room[:-1, :-1, :-1] == 0.0]).max() == 0.0
    assert np.abs(gas.velocity).max() > 0.1
    assert found[:, :, 8:, SOOT].sum() > 0.01  # all was below


def test_tails_of_smoke_end_before_numbers_that_processors_are_slow_with() -> None:
    """Smoke thins out cell by cell; none of it is below the least normal number, and there are tails."""
    gas = smoke_box(20, "reflection")
    gas.advance(0.5)
    held = np.abs(gas.state[..., SOOT])
    least = float(np.finfo(np.float32).tiny)
    assert ((held > 0.0) & (held < 1e-12)).any()
    assert not ((held > 0.0) & (held < least)).any()


def test_a_uniform_concentration_stays_uniform_in_any_flow() -> None:
    """Stirred for a second in a closed box with a ball."""
    cells = 16
    gas = Gas((cells,) * 3, 1.0 / cells, CLOSED, GasSettings(expands=False), gravity=(0.0, 0.0, 0.0), solids=cut(ball(cells)))
    state = np.zeros((cells, cells, cells, 4), np.float32)
    state[..., SOOT] = 1.0
    gas.state = state
    gas.velocity = np.random.default_rng(3).normal(size=(cells + 1, cells + 1, cells + 1, 3)).astype(np.float32)
    gas.advance(0.3)
    inside = cut(ball(cells)).room[:-1, :-1, :-1] > 0.0
    assert gas.state[..., SOOT][inside] == pytest.approx(1.0, abs=1e-3)


def test_heat_makes_volume_and_leaves_by_the_open_side() -> None:
    """A cube is heated at 0.2 volumes per second: what flows out of its top is that, and its air becomes lighter by as much."""
    cells = 8
    gas = Gas((cells,) * 3, 1.0 / cells, (*CLOSED[:5], "open"), GasSettings(expands=True), gravity=(0.0, 0.0, 0.0))
    gas.heat(np.full((cells,) * 3, 0.2))
    gas.step(0.1)
    top = gas.velocity[:cells, :cells, cells, 2]
    assert top == pytest.approx(0.2, rel=1e-3)
    assert gas.totals()[0] / cells**3 == pytest.approx(1.0 - math.exp(-0.02), rel=0.02)


def test_a_box_that_is_open_all_around_comes_to_rest() -> None:
    """12^3 cells, air that comes in along x and leaves along y at 2 m/s: what comes in brings no energy, so the flow dies down."""
    cells = 12
    gas = Gas((cells,) * 3, 1.0 / cells, ("open",) * 6, GasSettings(expands=False), gravity=(0.0, 0.0, 0.0))
    speed = 0.2 * np.random.default_rng(0).normal(size=(cells + 1, cells + 1, cells + 1, 3)).astype(np.float32)
    out = 4.0 * (np.arange(cells + 1) / cells - 0.5)
    speed[..., 0] -= out[:, None, None]
    speed[..., 1] += out[None, :, None]
    gas.velocity = speed
    gas.advance(0.25)
    early = np.abs(gas.velocity).max()
    gas.advance(1.75)
    assert np.abs(gas.velocity).max() < 0.5 * early


def test_residuals_fall_by_a_decade_per_two_iterations_around_obstacles() -> None:
    """32^3 with a ball, from noise: iterations 2, 4, 6."""
    first, second, third = residuals(32, ball(32))
    assert first / second > 10.0
    assert second / third > 10.0


def test_a_refreshed_hierarchy_is_that_of_the_new_couplings() -> None:
    cells = 16
    gas = Gas((cells,) * 3, 1.0 / cells, (*CLOSED[:5], "open"), GasSettings(expands=True))
    gas.step(0.01)
    light = np.zeros((cells, cells, cells, 4), np.float32)
    light[:, :, :8, 0] = 0.7
    gas.state = light
    gas.step(1e-6)
    projection = gas.projection
    fine, coarse = projection.levels[:2]
    inner = (slice(0, cells // 2),) * 3
    sums = np.zeros((cells // 2,) * 3)
    for axis, weights in enumerate(fine.weights):
        faces = np.moveaxis(weights.numpy().reshape((cells + 1,) * 3), axis, 0)[::2, :cells, :cells].astype(np.float64)
        blocks = 0.5 * faces.reshape(cells // 2 + 1, cells // 2, 2, cells // 2, 2).sum(axis=(2, 4))
        sums += np.moveaxis(blocks[1:] + blocks[:-1], 0, axis)
    have = 1.0 / coarse.inverse.numpy().reshape((cells // 2 + 1,) * 3)[inner]
    assert have == pytest.approx(sums, rel=1e-5)
    assert have.max() > 2.0 * np.median(have)


@pytest.mark.parametrize(
    ("corners", "share"),
    [((1, 1, 1, 1), 1.0), ((-1, -1, -1, -1), 0.0), ((1, 1, -1, -1), 0.5), ((3, 1, -1, 1), 0.875), ((-3, -1, 1, -1), 0.125)],
)
def test_open_shares_of_squares(corners: tuple[float, ...], share: float) -> None:
    found = open_share(*(np.array([float(c)]) for c in corners))
    assert found == pytest.approx(share)
