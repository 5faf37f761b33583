"""Lakes, rivers and streams follow from the land."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.construction.terrain.channels import carve
from worldagent.construction.terrain.flood import Drainage, drain
from worldagent.construction.terrain.water import WaterBodies, WaterLimits, find_lakes, find_sea, find_water
from worldagent.tests.construction.terrain.lands import pit_land, rough_land


def _water(
    drainage: Drainage, *, river: float = 2e-3, stream: float = 2e-3, sea: float | None = None, seed: int = 0
) -> WaterBodies:
    return find_water(
        drainage,
        WaterLimits(sea_level=sea, river_density=river, stream_density=stream, least_lake_area=500.0, least_lake_depth=0.5),
        runoff=np.full(drainage.grid.shape, 0.5),
        rng=np.random.default_rng(seed),
    )


def test_a_pit_becomes_a_lake_of_its_own_volume() -> None:
    depth, radius = 10.0, 40.0
    grid, height = pit_land(depth, radius)
    number, lakes = find_lakes(drain(grid, height), np.zeros(grid.shape, dtype=bool), least_area=10, least_depth=0.1)
    assert len(lakes) == 1
    lake = lakes[0]
    cone = np.pi * radius**2 * depth / 3
    assert lake.volume == pytest.approx(cone, rel=2e-3)
    assert lake.area == pytest.approx(np.pi * radius**2, rel=0.01)
    assert lake.depth == pytest.approx(depth, abs=1e-3)
    assert lake.contributing_area >= lake.area
    assert number.flat[lake.outlet] == 0
    assert (number > 0).sum() * grid.cell_area == pytest.approx(lake.area)


def test_depth_times_area_is_the_volume_of_every_lake() -> None:
    grid, height = rough_land(seed=8)
    drainage = drain(grid, height)
    number, lakes = find_lakes(drainage, np.zeros(grid.shape, dtype=bool), least_area=300, least_depth=0.2)
    assert len(lakes) >= 2
    for lake in lakes:
        inside = number == lake.number
        assert np.ptp(drainage.filled[inside]) == 0, "a lake has one level"
        assert lake.volume == pytest.approx((lake.level - height[inside]).sum() * grid.cell_area)
        assert lake.contributing_area >= lake.area


def test_only_low_land_joined_to_the_edge_is_sea() -> None:
    height = np.ones((9, 9))
    height[4, 4] = -1
    height[0:2, 3] = -1
    sea = find_sea(height, 0.0, np.ones((9, 9), dtype=bool))
    assert sea.sum() == 2
    assert not sea[4, 4]


@pytest.mark.parametrize("seed", [1, 9])
def test_reaches_go_down_and_end_in_water_or_at_the_edge(seed: int) -> None:
    grid, height = rough_land(seed=seed, tilt=0.08)
    drainage = drain(grid, height)
    water = _water(drainage)
    filled = drainage.filled.ravel()
    channel = water.channels()
    assert any(r.kind == "river" for r in water.rivers)
    assert any(r.kind == "stream" for r in water.rivers)
    for reach in water.rivers:
        level = filled[reach.cells]
        assert (np.diff(level) <= 0).all()
        assert (drainage.receiver.ravel()[reach.cells[:-1]] == reach.cells[1:]).all()
        assert (np.diff(reach.discharge) >= -1e-12).all()
        end = reach.cells[-1]
        row, col = divmod(int(end), grid.cols)
        at_edge = row in (0, grid.rows - 1) or col in (0, grid.cols - 1)
        assert {"lake": water.lake.flat[end] > 0, "sea": water.sea.flat[end], "river": channel.flat[end], "edge": at_edge}[
            reach.ends_in
        ]
        if reach.kind == "stream":
            assert reach.ends_in in ("river", "lake", "sea"), "a stream reaches water (R40)"


def test_streams_rise_near_divides() -> None:
    grid, height = rough_land(160, 160, seed=12, tilt=0.1)
    drainage = drain(grid, height)
    water = _water(drainage, stream=4e-3)
    area = drainage.accumulation().ravel()
    heads = [r.cells[0] for r in water.rivers if r.kind == "stream"]
    assert len(heads) >= 3
    assert area[heads].max() <= 2e5


def test_the_density_sets_the_length_of_rivers_and_more_is_longer() -> None:
    grid, height = rough_land(160, 160, seed=12, tilt=0.1)
    drainage = drain(grid, height)
    lengths = []
    for density in (1e-3, 2e-3, 4e-3):
        water = _water(drainage, river=density, stream=0.0)
        land = (~water.standing).sum() * grid.cell_area
        cells = water.channels("river")
        step = np.hypot(
            np.abs(drainage.receiver.ravel() // grid.cols - np.arange(cells.size) // grid.cols),
            np.abs(drainage.receiver.ravel() % grid.cols - np.arange(cells.size) % grid.cols),
        )
        lengths.append(float(step[cells.ravel()].sum() * grid.cell / land))
        assert lengths[-1] == pytest.approx(density, rel=0.1)
    assert lengths == sorted(lengths)


def test_the_same_seed_gives_the_same_streams() -> None:
    grid, height = rough_land(seed=2, tilt=0.1)
    drainage = drain(grid, height)
    one, two = _water(drainage, seed=4), _water(drainage, seed=4)
    assert [r.cells.tolist() for r in one.rivers] == [r.cells.tolist() for r in two.rivers]


def test_beds_fall_all_the_way_and_finding_water_leaves_the_land_alone() -> None:
    grid, height = rough_land(seed=9, tilt=0.08)
    before = height.copy()
    drainage = drain(grid, height)
    water = _water(drainage)
    channels = carve(drainage, water)
    assert np.array_equal(height, before)
    assert (channels.cut >= 0).all()
    assert channels.wet.any()
    wet = channels.wet
    ground = height - channels.cut
    assert (channels.level[wet] > ground[wet]).mean() > 0.95
    assert not (channels.bed & water.standing).any()
    big = max((r for r in water.rivers if r.kind == "river"), key=lambda r: len(r.cells))
    along = channels.level.ravel()[big.cells[1:-1]]
    along = along[np.isfinite(along)]
    assert along.size > 3
    assert np.diff(along).max() < 0.5


def test_rivers_are_the_cells_that_gather_most() -> None:
    """R39: no cell of dry land outside the rivers carries as much as any cell in them, by a count of the cells above each."""
    grid, height = rough_land(seed=9, tilt=0.08)
    drainage = drain(grid, height)
    water = _water(drainage)
    receiver, gathered = drainage.receiver.ravel(), np.zeros(grid.rows * grid.cols)
    for start in range(gathered.size):  # every cell walks down by itself
        here = start
        while True:
            gathered[here] += 1
            if receiver[here] in (here, -1):
                break
            here = receiver[here]
    river, land = water.channels("river").ravel(), ~water.standing.ravel()
    assert river.sum() > 30
    assert gathered[river].min() > gathered[land & ~river].max()


def test_streams_rise_beside_crests_and_divides_and_nowhere_else() -> None:
    """R40: within a quarter of the root of the largest area of a source from ground that nothing drains onto, or that parts watersheds."""
    grid, height = rough_land(160, 160, seed=12, tilt=0.1)
    drainage = drain(grid, height)
    heads = [int(r.cells[0]) for r in _water(drainage, stream=4e-3).rivers if r.kind == "stream"]
    assert len(heads) >= 3
    fed = np.zeros(grid.rows * grid.cols, dtype=bool)
    receiver = drainage.receiver.ravel()
    fed[receiver[receiver != np.arange(receiver.size)]] = True
    edge = np.flatnonzero(~fed | drainage.divides().ravel())
    rows, cols = np.divmod(edge, grid.cols)
    for head in heads:
        away = np.hypot(rows - head // grid.cols, cols - head % grid.cols).min() * grid.cell
        assert away <= 0.25 * np.sqrt(2e5)


def test_no_stream_leads_to_water_that_is_not_there() -> None:
    """R40: a plane that drains over its edge has neither lake nor river for a stream to reach."""
    grid, height = rough_land(seed=9, tilt=0.08)
    drainage = drain(grid, height)
    everywhere = find_water(
        drainage, WaterLimits(sea_level=None, river_density=0.0, stream_density=2e-3, least_lake_area=1e12, least_lake_depth=0.5), runoff=np.full(grid.shape, 0.5), rng=np.random.default_rng(0),
    )  # fmt: skip
    assert not everywhere.lakes
    assert everywhere.rivers == ()
    assert any(r.kind == "stream" for r in _water(drainage).rivers), "with rivers and lakes there are streams"
