"""The gas engine against exact flows, sums that must stay, and a published cavity; resolutions stand beside the numbers."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
import pytest
from worldagent.simulation.gas.engine import SOOT, Gas
from worldagent.simulation.gas.settings import GasSettings, Side
from worldagent.simulation.gas.solids import corners_of, cut, open_share
from worldagent.simulation.grids import multigrid
from worldagent.worlds.arrays import F64

CLOSED: tuple[Side, ...] = ("closed",) * 6
CAVITY = {1e3: 1.118, 1e4: 2.243, 1e5: 4.519, 1e6: 8.800}
"""Mean Nusselt numbers of the heated square cavity at Pr 0.71 (de Vahl Davis 1983, doi:10.1002/fld.1650030305), by Rayleigh number."""


def vortices(cells: int, scheme: Literal["maccormack", "reflection"], viscosity: float = 0.0) -> tuple[float, float]:
    """Taylor-Green vortices on a periodic square of 1 m after 1 s: error of the speeds over their size, and the share of energy left."""
    size, k = 1.0 / cells, 2.0 * np.pi
    settings = GasSettings(scheme=scheme, viscosity=viscosity, courant=1.0, expands=False)
    gas = Gas((cells, cells, 2), size, ("periodic",) * 6, settings, gravity=(0.0, 0.0, 0.0))
    faces = np.arange(cells + 1) * size
    middle = faces + 0.5 * size
    speed = np.zeros((cells + 1, cells + 1, 3, 3), np.float32)
    speed[..., 0] = (np.sin(k * faces)[:, None] * np.cos(k * middle)[None, :])[:, :, None]
    speed[..., 1] = (-np.cos(k * middle)[:, None] * np.sin(k * faces)[None, :])[:, :, None]
    gas.velocity = speed
    reports = gas.advance(1.0)
    assert max(r.divergence for r in reports) < 1e-5
    left = math.exp(-2.0 * k * k * viscosity)
    start, end = speed[:cells, :cells, 0, :2], gas.velocity[:cells, :cells, 0, :2]
    error = np.sqrt(np.square(end - left * start).mean() / np.square(left * start).mean())
    return float(error), float(np.square(end).sum() / np.square(start).sum())


def test_reflection_keeps_vortices_at_second_order() -> None:
    coarse, fine = vortices(16, "reflection"), vortices(32, "reflection")
    assert math.log2(coarse[0] / fine[0]) > 1.8
    assert fine[1] > 0.96


def test_reflection_keeps_more_energy_than_maccormack_alone() -> None:
    assert vortices(16, "reflection")[1] > vortices(16, "maccormack")[1] + 0.3


def test_viscosity_damps_vortices_at_their_rate() -> None:
    """exp(-8 pi^2 nu t) at 32 x 32, nu = 0.002 m^2/s."""
    assert vortices(32, "reflection", 0.002)[0] < 0.02


@pytest.mark.slow
def test_vortices_at_64_cells_are_within_one_percent() -> None:
    assert vortices(64, "reflection")[0] < 0.01
    assert vortices(64, "reflection", 0.002)[0] < 0.01


def cavity(rayleigh: float, cells: int, seconds: float) -> tuple[float, float]:
    """Mean Nusselt numbers at the warm and the cold wall; lengths in sides, times in side^2 / diffusivity."""
    settings = GasSettings(scheme="maccormack", expands=False, viscosity=0.71, diffusivity=1.0, courant=1.0)
    sides: tuple[Side, ...] = ("closed", "closed", "periodic", "periodic", "closed", "closed")
    gas = Gas((cells, 2, cells), 1.0 / cells, sides, settings, gravity=(0.0, 0.0, -0.71 * rayleigh))
    gas.warm([0.5, -0.5, None, None, None, None])
    across = (np.arange(cells) + 0.5) / cells
    state = np.zeros((cells, 2, cells, 4), np.float32)
    state[..., 0] = (0.5 - across)[:, None, None]
    gas.state = state
    gas.advance(seconds)
    warm, cold = 0.5 - gas.state[0, 0, :, 0], gas.state[-1, 0, :, 0] + 0.5
    return float(2 * cells * warm.mean()), float(2 * cells * cold.mean())


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


def ball(cells: int) -> F64:
    """Signed distance to a ball, at the corners of a cube of 1 m."""
    corners = corners_of((cells, cells, cells), 1.0 / cells, np.zeros(3))
    return np.asarray(np.linalg.norm(corners - [0.5, 0.5, 0.6], axis=-1) - 0.15)


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


def test_residuals_fall_by_a_decade_per_two_iterations_around_obstacles() -> None:
    """32^3 with a ball, from noise: iterations 2, 4, 6."""
    cells = 32
    gas = Gas((cells,) * 3, 1.0 / cells, (*CLOSED[:5], "open"), GasSettings(expands=False), solids=cut(ball(cells)))
    noise = np.random.default_rng(1).normal(size=(cells + 1, cells + 1, cells + 1, 3)).astype(np.float32)
    residuals = []
    for cap in (2, 4, 6):
        gas.velocity = noise
        residuals.append(gas.solve(1e-12, cap).residual)
    assert residuals[0] / residuals[1] > 10.0
    assert residuals[1] / residuals[2] > 10.0


def test_a_refreshed_hierarchy_is_that_of_the_new_couplings() -> None:
    cells = 16
    gas = Gas((cells,) * 3, 1.0 / cells, (*CLOSED[:5], "open"), GasSettings(expands=True))
    gas.step(0.01)
    light = np.zeros((cells, cells, cells, 4), np.float32)
    light[:, :, :8, 0] = 0.7
    gas.state = light
    gas.step(1e-6)
    projection = gas.projection
    levels = projection.levels
    have = gas.run.read(levels[1].diagonal, levels[1].rows)
    made = gas.run.read(multigrid.hierarchy(gas.run, levels[0])[1].diagonal, levels[1].rows)
    assert have == pytest.approx(made)
    assert have.max() > 2.0 * np.median(have[have > 0])


@pytest.mark.parametrize(
    ("corners", "share"),
    [((1, 1, 1, 1), 1.0), ((-1, -1, -1, -1), 0.0), ((1, 1, -1, -1), 0.5), ((3, 1, -1, 1), 0.875), ((-3, -1, 1, -1), 0.125)],
)
def test_open_shares_of_squares(corners: tuple[float, ...], share: float) -> None:
    found = open_share(*(np.array([float(c)]) for c in corners))
    assert found == pytest.approx(share)
