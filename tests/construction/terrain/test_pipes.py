"""Running water: lakes at rest, Manning's law, closed ledgers of water and matter, symmetry, gullies."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.construction.terrain.erosion import Ground
from worldagent.construction.terrain.grid import Grid
from worldagent.construction.terrain.landscape import build_landscape
from worldagent.construction.terrain.noise import fractal
from worldagent.construction.terrain.pipes import Rain, run_off
from worldagent.worlds.errors import InputError, LimitError
from worldagent.worlds.spec.terrain import Terrain

NO_WEAR = {"capacity": 0.0, "dissolving": 0.0}


def _hill(cells: int = 64, cell: float = 5.0, *, octaves: int = 3) -> tuple[Grid, np.ndarray]:
    """A rounded hill with little roughness, higher than all around."""
    grid = Grid(cells, cells, cell)
    x, y = grid.points()
    return grid, 40 * np.exp(-(x**2 + y**2) / (2 * 70.0**2)) + 2 * fractal(
        x, y, wavelength=80, octaves=octaves, gain=0.5, seed=1, cell=cell
    )


def test_a_lake_at_rest_stays_level_and_still() -> None:
    grid = Grid(40, 50, 2.0)
    x, y = grid.points()
    ground = 0.02 * (x**2 + y**2) + 1.5 * fractal(x, y, wavelength=20, octaves=4, gain=0.5, seed=3, cell=2.0)
    depth = np.maximum(8.0 - ground, 0.0)
    _, _, record = run_off(Ground.bare(grid, ground), Rain(rate=0.0, duration=60, **NO_WEAR), depth=depth)
    assert np.abs(record.depth - depth).max() < 1e-12
    assert record.speed.max() < 1e-9


def test_water_that_falls_dries_runs_off_or_stays() -> None:
    grid, height = _hill()
    rain = Rain(rate=1e-4, duration=200, evaporation=4e-5, **NO_WEAR)
    _, _, record = run_off(Ground.bare(grid, height), rain)
    assert record.rained == pytest.approx(1e-4 * 200 * 320.0**2, rel=1e-9)
    assert min(record.evaporated, record.left, record.stored) > 0
    assert record.water_residual <= 1e-12


def test_sheet_flow_down_a_plane_has_the_depth_of_mannings_law() -> None:
    """Steady rain r on a plane of slope S: q = r x = d^(5/3) S^(1/2) / n (kinematic wave)."""
    slope, roughness, rate = 0.1, 0.04, 1e-4
    grid = Grid(16, 100, 2.0)
    x, _ = grid.points()
    rain = Rain(rate=rate, duration=400, roughness=roughness, **NO_WEAR)
    _, _, record = run_off(Ground.bare(grid, -slope * x), rain)
    for col in (20, 60, 90):
        length = (col + 1) * grid.cell
        expected = (rate * length * roughness / np.sqrt(slope)) ** 0.6
        assert record.depth[8, col] == pytest.approx(expected, rel=0.01)
        assert record.flow[8, col] == pytest.approx(rate * length, rel=0.03)


@pytest.mark.parametrize("degrees", [0, 30, 45])
def test_water_runs_at_mannings_speed_whatever_its_direction_to_the_grid(degrees: float) -> None:
    """A uniform film in the middle of a plane: v = d^(2/3) S^(1/2) / n."""
    slope, roughness, depth = 0.1, 0.04, 0.02
    grid = Grid(60, 60, 2.0)
    x, y = grid.points()
    turn = np.radians(degrees)
    plane = Ground.bare(grid, -slope * (x * np.cos(turn) + y * np.sin(turn)))
    rain = Rain(rate=0.0, duration=20, roughness=roughness, **NO_WEAR)
    _, _, record = run_off(plane, rain, depth=np.full(grid.shape, depth))
    assert record.depth[40, 40] == pytest.approx(depth, rel=1e-3)
    assert record.speed[40, 40] == pytest.approx(depth ** (2 / 3) * np.sqrt(slope) / roughness, rel=0.03)


def test_what_the_storm_wears_is_laid_down_or_leaves() -> None:
    grid, height = _hill(octaves=5)
    before = Ground.bare(grid, height, soil=0.3)
    after, balance, record = run_off(before, Rain(rate=5e-5, duration=240, capacity=20, dissolving=0.05, settling=0.05))
    assert balance.worn > 100
    assert balance.exported > 0
    assert balance.residual <= 1e-9
    change = (after.height - before.height).sum() * grid.cell_area
    assert change == pytest.approx(-balance.exported, rel=1e-9)
    assert (after.deposit - after.wear).sum() * grid.cell_area == pytest.approx(change, rel=1e-9)
    assert after.height - before.height == pytest.approx(after.deposit - after.wear, abs=1e-9)
    assert (after.sediment >= 0).all()
    assert (after.bedrock <= before.bedrock).all()
    assert record.water_residual <= 1e-12


def test_the_sea_takes_water_and_load_and_keeps_its_bed() -> None:
    grid, height = _hill()
    height -= 10.0
    sea = height < 0
    before = Ground.bare(grid, height, soil=0.3)
    after, balance, record = run_off(before, Rain(rate=5e-5, duration=200, capacity=20), sea=sea, sea_level=0.0)
    assert np.array_equal(after.height[sea], before.height[sea])
    assert balance.exported > 0
    assert balance.residual <= 1e-9
    assert record.left > 0
    assert record.rained == pytest.approx(5e-5 * 200 * (~sea).sum() * 25.0, rel=1e-9)


def test_a_symmetric_hill_wears_symmetrically() -> None:
    grid = Grid(41, 41, 3.0)
    x, y = grid.points()
    hill = Ground.bare(grid, 20 * np.exp(-(x**2 + y**2) / 800), soil=0.2)
    after, _, _ = run_off(hill, Rain(rate=5e-5, duration=120, capacity=20, dissolving=0.05))
    worn = after.wear
    assert worn.max() > 0.01
    for other in (worn.T, worn[::-1], worn[:, ::-1]):
        assert other == pytest.approx(worn, rel=1e-6, abs=1e-9)


def test_a_storm_gives_the_same_bytes_twice_and_however_it_is_sliced(monkeypatch: pytest.MonkeyPatch) -> None:
    grid, height = _hill(40)
    ground, rain = Ground.bare(grid, height, soil=0.3), Rain(rate=5e-5, duration=60, capacity=20)
    one, _, _ = run_off(ground, rain)
    monkeypatch.setattr("worldagent.construction.terrain.pipes.SLICE", 333)
    two, _, _ = run_off(ground, rain)
    for name in ("bedrock", "sediment", "wear", "deposit"):
        assert getattr(one, name).tobytes() == getattr(two, name).tobytes(), name


def test_cliffs_and_holes_break_nothing() -> None:
    grid = Grid(30, 40, 1.0)
    x, _ = grid.points()
    cliff = np.where(x < 0, 60.0, 0.0)
    cliff[10, 5] = -40.0
    valid = np.ones(grid.shape, dtype=bool)
    valid[20:24, 20:30] = False
    after, balance, record = run_off(Ground.bare(grid, cliff, soil=1.0), Rain(rate=1e-4, duration=60, capacity=50), valid=valid)
    for values in (after.height, record.depth, record.speed, after.wear):
        assert np.isfinite(values).all()
    assert balance.residual <= 1e-9
    assert record.speed.max() < 50
    assert np.array_equal(after.height[~valid], cliff[~valid])


def test_gullies_appear_on_a_smooth_hill() -> None:
    """Drainage density by form: cells whose surface is hollow by more than 0.01 / m."""
    grid, height = _hill(80, 4.0, octaves=5)
    storm = Rain(rate=1e-4, duration=900, capacity=100, dissolving=0.1, settling=0.1)
    after, _, _ = run_off(Ground.bare(grid, height, soil=1.0), storm)

    def hollows(surface: np.ndarray) -> float:
        bend = sum(np.gradient(np.gradient(surface, grid.cell, axis=k), grid.cell, axis=k) for k in (0, 1))
        return float((bend[4:-4, 4:-4] > 0.01).mean())

    assert hollows(after.height) > 3 * hollows(height)
    assert hollows(after.height) > 0.1
    assert (after.deposit > 0.05).any()


def test_a_storm_that_a_cpu_cannot_do_in_minutes_is_refused_with_the_estimate() -> None:
    grid = Grid(2000, 2000, 1.0)
    with pytest.raises(LimitError, match="shorten the duration"):
        run_off(Ground.bare(grid, np.zeros(grid.shape)), Rain(duration=3600))
    with pytest.raises(InputError, match="roughness"):
        run_off(Ground.bare(Grid(4, 4, 1.0), np.zeros((4, 4))), Rain(roughness=0.0))


def test_a_landscape_with_a_storm_records_its_ledgers() -> None:
    land = {
        "extent": [480, 480], "cell": 8, "sea_level": -5,
        "layers": {"hill": {"kind": "cone", "radius": 220, "height": 70}, "rough": {"kind": "noise", "amplitude": 5, "wavelength": 90}},
        "erosion": {"years": 2000, "steps": 2, "hydraulic": {"duration": 200}},
    }  # fmt: skip
    built = build_landscape(Terrain.model_validate(land), Path())
    figures = built.figures["hydraulic_erosion"]
    assert figures["residual"] <= 1e-6
    assert figures["water_residual"] <= 1e-6
    assert figures["worn"] > 0
    fields = built.fields
    exported = (fields["wear"] - fields["deposit"]).sum() * built.grid.cell_area
    ledgers = [built.figures[k]["exported"] for k in ("river_erosion", "hydraulic_erosion")]
    assert exported == pytest.approx(sum(ledgers), rel=1e-9)
    change = fields["ground"] - fields["start"] - fields["uplift"] - fields["earthworks"]
    assert change == pytest.approx(fields["deposit"] - fields["wear"], abs=1e-9)
