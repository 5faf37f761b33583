"""Priority-Flood and D8 against independent truths: greyscale reconstruction and pyflwdir."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.construction.terrain.flood import drain
from worldagent.construction.terrain.flood_kernels import order_streams
from worldagent.construction.terrain.grid import Grid
from worldagent.tests.construction.terrain.lands import pit_land, rough_land
from worldagent.worlds.errors import InputError


def _reconstructed(height: np.ndarray) -> np.ndarray:
    """Fill by morphological reconstruction (Soille & Gratin 1994): exact, and shares no code."""
    from skimage.morphology import reconstruction

    seed = height.copy()
    seed[1:-1, 1:-1] = height.max()
    return np.asarray(reconstruction(seed, height, method="erosion", footprint=np.ones((3, 3))))


def _lands() -> list[tuple[str, Grid, np.ndarray]]:
    lands = [(f"fractal {seed}", *rough_land(seed=seed)) for seed in (1, 2, 3)]
    terraces = np.floor(rough_land(seed=4)[1] / 15) * 15
    lands.append(("terraces", rough_land()[0], terraces))
    lands.append(("flat", Grid(20, 30, 1.0), np.zeros((20, 30))))
    lands.append(("pit", *pit_land()))
    return lands


@pytest.mark.parametrize(("name", "grid", "height"), _lands(), ids=lambda v: v if isinstance(v, str) else "")
def test_the_filled_surface_is_the_morphological_reconstruction(name: str, grid: Grid, height: np.ndarray) -> None:
    assert np.array_equal(drain(grid, height).filled, _reconstructed(height))


@pytest.mark.parametrize(("name", "grid", "height"), _lands(), ids=lambda v: v if isinstance(v, str) else "")
def test_every_cell_drains_down_its_steepest_way_and_out(name: str, grid: Grid, height: np.ndarray) -> None:
    found = drain(grid, height)
    filled, receiver = found.filled, found.receiver.ravel()
    here = np.arange(receiver.size)
    steepest = np.zeros(grid.shape)
    padded = np.pad(filled, 1, constant_values=np.inf)
    for dr, dc in ((a, b) for a in (-1, 0, 1) for b in (-1, 0, 1) if (a, b) != (0, 0)):
        there = padded[1 + dr : 1 + dr + grid.rows, 1 + dc : 1 + dc + grid.cols]
        steepest = np.maximum(steepest, (filled - there) / np.hypot(dr, dc))
    rows, cols = np.abs(receiver // grid.cols - here // grid.cols), np.abs(receiver % grid.cols - here % grid.cols)
    assert rows.max() <= 1
    assert cols.max() <= 1
    own = (filled.ravel() - filled.ravel()[receiver]) / np.maximum(np.hypot(rows, cols), 1)
    falls = steepest.ravel() > 0
    assert own[falls] == pytest.approx(steepest.ravel()[falls], rel=0, abs=0)
    assert (own >= 0).all()
    place = np.empty(receiver.size, dtype=int)
    place[found.order] = here
    assert ((place[receiver] < place) | (receiver == here)).all(), "a cell comes after its receiver: there is no cycle"


def test_the_area_that_leaves_the_grid_is_the_area_of_the_grid() -> None:
    grid, height = rough_land()
    found = drain(grid, height)
    outlets = found.receiver.ravel() == np.arange(found.receiver.size)
    assert found.accumulation().ravel()[outlets].sum() == pytest.approx(grid.rows * grid.cols * grid.cell_area, rel=1e-12)


def test_accumulation_and_stream_order_agree_with_pyflwdir() -> None:
    pyflwdir = pytest.importorskip("pyflwdir")
    grid, height = rough_land(seed=5)
    found = drain(grid, height)
    raster = pyflwdir.from_array(np.flipud(found.directions()), ftype="d8", check_ftype=True)
    area = found.accumulation() / grid.cell_area
    assert np.array_equal(np.flipud(raster.upstream_area("cell")), area)
    channel = area >= 40
    strahler = order_streams(channel.ravel(), found.receiver.ravel(), found.order).reshape(grid.shape)
    theirs = np.flipud(raster.stream_order(mask=np.flipud(channel)))
    assert np.array_equal(strahler[channel], theirs[channel])
    assert strahler.max() >= 3


def test_a_real_elevation_model_is_filled_and_routed() -> None:
    matplotlib = pytest.importorskip("matplotlib")
    path = Path(matplotlib.get_data_path()) / "sample_data" / "jacksboro_fault_dem.npz"
    height = np.load(path)["elevation"].astype(float)
    rows, cols = height.shape
    grid = Grid(rows, cols, 30.0)
    found = drain(grid, height)
    assert np.array_equal(found.filled, _reconstructed(height))
    outlets = found.receiver.ravel() == np.arange(height.size)
    assert found.accumulation().ravel()[outlets].sum() == pytest.approx(height.size * 900.0)


def test_water_leaves_over_the_edge_of_missing_data() -> None:
    grid, height = pit_land()
    height[70, 80] = np.nan
    found = drain(grid, height)
    assert np.nanmax(found.depth) < 1e-9
    assert found.receiver[70, 80] == -1
    assert np.isnan(found.filled[70, 80])


def test_a_surface_without_data_is_refused() -> None:
    with pytest.raises(InputError, match="all no-data"):
        drain(Grid(4, 4, 1.0), np.full((4, 4), np.nan))
    with pytest.raises(InputError, match="do not fit"):
        drain(Grid(4, 4, 1.0), np.zeros((4, 5)))


def test_every_watershed_drains_to_one_outlet_and_divides_part_them() -> None:
    grid, height = rough_land(seed=6)
    found = drain(grid, height)
    label, receiver = found.basins(), found.receiver
    assert (label > 0).all()
    assert np.array_equal(label.ravel(), label.ravel()[receiver.ravel()])
    divides = found.divides()
    beside = label[1:, :] != label[:-1, :]
    assert np.array_equal(divides[1:, :] & divides[:-1, :] & beside, beside)
