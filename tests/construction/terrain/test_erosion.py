"""Erosion: closed mass balances, the graded profile of the stream power law, angles of repose."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.construction.terrain.erosion import AREA_EXPONENT, Ground, Rivers, erode_rivers, relax_slopes
from worldagent.construction.terrain.flood import drain
from worldagent.construction.terrain.grid import Grid
from worldagent.construction.terrain.noise import fractal
from worldagent.tests.construction.terrain.lands import rough_land
from worldagent.worlds.errors import InputError


@pytest.mark.parametrize("seed", [1, 2])
def test_what_wears_away_is_deposited_or_leaves(seed: int) -> None:
    grid, height = rough_land(seed=seed)
    before = Ground.bare(grid, height, soil=0.5)
    after, balance = erode_rivers(before, Rivers(years=5e4, steps=8, erodibility=2e-5, uplift=1e-4))
    assert balance.worn > 0
    assert balance.residual <= 1e-12
    change = (after.height - before.height).sum() * grid.cell_area
    assert change == pytest.approx(balance.uplifted - balance.worn + balance.deposited, rel=1e-9)
    assert after.height == pytest.approx(after.bedrock + after.sediment)
    assert (after.sediment >= 0).all()


def test_lakes_take_sediment_and_never_rise_above_their_level() -> None:
    grid, height = rough_land(seed=4)
    level = drain(grid, height).filled
    after, balance = erode_rivers(Ground.bare(grid, height), Rivers(years=2e4, steps=1, erodibility=2e-5))
    assert balance.deposited > 0
    assert (after.height <= level + 1e-9).all()


def test_a_graded_river_has_the_slope_of_the_stream_power_law() -> None:
    """Steady state: U = K A^m S, so that log S falls with log A by m (Whipple & Tucker 1999); published 0.4 to 0.6."""
    uplift, erodibility = 5e-4, 2e-5
    grid = Grid(64, 96, 100.0)
    rng = np.random.default_rng(0)
    ground = Ground.bare(grid, rng.uniform(0, 1, grid.shape))
    edge = np.ones(grid.shape, dtype=bool)
    edge[1:-1, 1:-1] = False
    for _ in range(3):
        ground, _ = erode_rivers(ground, Rivers(years=2e6, steps=80, erodibility=erodibility, uplift=uplift), base=edge)
    drainage = drain(grid, ground.height)
    receiver = drainage.receiver.ravel()
    here = np.arange(receiver.size)
    inner = ~edge.ravel() & (drainage.depth.ravel() == 0)
    length = np.hypot(receiver // grid.cols - here // grid.cols, receiver % grid.cols - here % grid.cols) * grid.cell
    slope = (ground.height.ravel() - ground.height.ravel()[receiver])[inner] / length[inner]
    area = drainage.accumulation().ravel()[inner]
    exponent = np.polyfit(np.log(area), np.log(slope), 1)[0]
    assert -exponent == pytest.approx(AREA_EXPONENT, abs=0.02)
    expected = uplift / (erodibility * area**AREA_EXPONENT)
    assert np.median(slope / expected) == pytest.approx(1.0, abs=0.01)


def test_slopes_creep_by_diffusion_and_their_mass_balance_closes() -> None:
    """A wave of number k fades by 1 / (1 + D k^2 dt) in each implicit step (up to the error of the grid)."""
    grid, creep, wavelength = Grid(40, 160, 5.0), 0.01, 200.0
    x, _ = grid.points()
    wave = 3.0 * np.cos(2 * np.pi * x / wavelength)
    flat, _ = erode_rivers(Ground.bare(grid, wave), Rivers(years=2e4, steps=10, erodibility=1e-30, creep=creep))
    expected = (1 + creep * (2 * np.pi / wavelength) ** 2 * 2e3) ** -10
    middle = np.s_[:, 60:100]
    assert np.ptp(flat.height[middle]) / np.ptp(wave[middle]) == pytest.approx(expected, rel=0.01)
    assert np.ptp(flat.height, axis=0).max() < 1e-9
    grid, height = rough_land()
    base = height < np.percentile(height, 20)
    before = Ground.bare(grid, height, soil=0.5)
    after, balance = erode_rivers(before, Rivers(years=2e4, steps=5, erodibility=2e-5, creep=creep), base=base)
    assert balance.residual <= 1e-12
    assert balance.exported > 0
    assert np.array_equal(after.height[base], before.height[base])
    change = (after.height - before.height).sum() * grid.cell_area
    assert change == pytest.approx(balance.deposited - balance.worn, rel=1e-9)
    assert (after.deposit - after.wear).sum() * grid.cell_area == pytest.approx(change, rel=1e-9)


def test_valleys_keep_their_size_on_a_finer_grid() -> None:
    """Without creep valleys are as narrow as the cells, and the land twice as rough on a grid twice as fine."""
    sizes = {}
    for creep in (0.0, 0.02):
        for cell in (10.0, 5.0):
            grid = Grid(round(640 / cell), round(960 / cell), cell)
            x, y = grid.points()
            plane = 0.2 * x + 8 * fractal(x, y, wavelength=200, octaves=5, gain=0.5, seed=2, cell=cell)
            worn, _ = erode_rivers(Ground.bare(grid, plane), Rivers(years=5e4, steps=8, erodibility=3e-5, creep=creep))
            hollow = np.gradient(np.gradient(worn.height, cell, axis=0), cell, axis=0)
            sizes[creep, cell] = float(np.sqrt(np.mean(hollow**2)))
    assert sizes[0.0, 5.0] > 1.6 * sizes[0.0, 10.0]
    # Known: creep from both sides fills a bed of one cell faster the narrower it is, so that the finest valleys fade a little.
    assert 0.5 < sizes[0.02, 5.0] / sizes[0.02, 10.0] < 1.1


def test_a_pile_slides_to_its_angle_of_repose_and_keeps_its_mass() -> None:
    grid = Grid(81, 81, 1.0)
    x, y = grid.points()
    pile = np.where(np.hypot(x, y) < 8, 20.0, 0.0)
    talus = float(np.tan(np.radians(33.0)))
    before = Ground.bare(grid, pile, soil=pile)
    after, excess, passes = relax_slopes(before, talus=talus, talus_rock=1.7)
    assert excess <= 1e-3
    assert passes > 20
    assert after.height.sum() == pytest.approx(pile.sum(), rel=1e-12)
    north, east = np.gradient(after.height)
    flank = (after.height > 1.0) & (np.hypot(x, y) > 3)
    angle = np.degrees(np.arctan(np.hypot(north, east)[flank]))
    assert np.median(angle) == pytest.approx(33.0, abs=2.0)
    peak = np.unravel_index(after.height.argmax(), grid.shape)
    assert peak == (40, 40), "no direction is preferred"


def test_rock_stands_steeper_than_scree() -> None:
    grid = Grid(20, 60, 1.0)
    x, _ = grid.points()
    cliff = np.where(x < 0, 30.0, 0.0) + 0.0 * x
    after, excess, _ = relax_slopes(Ground.bare(grid, cliff), talus=0.65, talus_rock=1.7)
    assert excess <= 1e-3
    middle = after.height[10]
    falls = -np.diff(middle)
    assert falls.max() == pytest.approx(1.7, abs=0.05)
    assert after.sediment.sum() > 0


def test_impossible_parameters_are_refused() -> None:
    grid, height = rough_land()
    with pytest.raises(InputError, match="years"):
        erode_rivers(Ground.bare(grid, height), Rivers(years=0, steps=5, erodibility=1e-5))
    with pytest.raises(InputError, match="talus"):
        relax_slopes(Ground.bare(grid, height), talus=2.0, talus_rock=1.0)
