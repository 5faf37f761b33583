"""Layers of height: what each promises, at every resolution."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction.terrain.grid import Grid
from worldagent.construction.terrain.layers import shape_land
from worldagent.construction.terrain.zones import zone_distance
from worldagent.worlds.errors import InputError
from worldagent.worlds.spec.terrain import Terrain, Zone


def _land(layers: dict[str, Any], *, cell: float = 10.0, assets: Path = Path(), **more: Any) -> tuple[Grid, np.ndarray]:
    terrain = Terrain.model_validate({"extent": [1000, 800], "cell": cell, "layers": layers, **more})
    grid = Grid.over(terrain.extent, terrain.cell)
    early = shape_land(grid, terrain, assets)
    return grid, shape_land(grid, terrain, assets, after=early)


EVERY_LAYER: dict[str, dict[str, Any]] = {
    "fbm": {"kind": "noise", "style": "fbm", "amplitude": 40, "wavelength": 300},
    "ridged": {"kind": "noise", "style": "ridged", "amplitude": 40, "wavelength": 300, "warp": 20},
    "billow": {"kind": "noise", "style": "billow", "amplitude": 40, "wavelength": 300},
    "ramp": {"kind": "ramp", "rise": 50, "direction_deg": 30},
    "cone": {"kind": "cone", "radius": 300, "height": 200},
    "crater": {"kind": "crater", "radius": 150, "depth": 60, "rim": 10},
    "mesa": {"kind": "mesa", "zone": "top", "height": 60},
    "dunes": {"kind": "dunes", "height": 8, "spacing": 90},
    "ridge": {"kind": "ridge", "line": [[-300, 0], [300, 100]], "height": 70, "width": 200},
    "valley": {"kind": "valley", "line": [[-400, 0], [400, 50]], "width": 200, "depth": 40, "fall": 20},
    "canyon": {"kind": "valley", "line": [[-400, 0], [400, 50]], "width": 200, "depth": 80, "walls": "canyon"},
    "coast": {"kind": "coast", "line": [[100, -400], [100, 400]], "shelf": 150, "depth": 20},
    "flatten": {"kind": "flatten", "zone": "top", "falloff": 40},
    "road": {"kind": "road", "line": [[-450, -300], [450, 300]], "width": 8, "grade": 0.08},
}
ZONES = {"top": {"center": [50, 40], "radius": 120}}


@pytest.mark.parametrize("name", EVERY_LAYER)
def test_a_layer_keeps_its_character_on_a_finer_grid(name: str) -> None:
    base = {"hills": {"kind": "noise", "amplitude": 20, "wavelength": 500, "octaves": 3}}
    layers = {**base, "it": {**EVERY_LAYER[name], "order": 5}}
    coarse, low = _land(layers, cell=10.0, zones=ZONES, sea_level=0)
    fine, high = _land(layers, cell=2.5, zones=ZONES, sea_level=0)
    assert np.isfinite(low).all()
    x, y = coarse.points()
    resampled = fine.sample(high, x.ravel(), y.ravel()).reshape(coarse.shape)
    spread = np.ptp(low)
    assert spread > 1
    assert np.sqrt(np.mean((resampled - low) ** 2)) < 0.05 * spread
    assert np.ptp(high) == pytest.approx(spread, rel=0.15)


def test_a_crater_has_the_declared_depth_below_its_rim() -> None:
    grid, height = _land({"bowl": EVERY_LAYER["crater"]})
    x, y = grid.points()
    away = np.hypot(x, y)
    assert height[away < 40].mean() == pytest.approx(10 - 60, abs=0.5)
    assert height[np.abs(away - 150) < 8].max() == pytest.approx(10, abs=1.5)


def test_a_road_keeps_its_grade_and_is_level_across() -> None:
    layers = {
        "hills": {"kind": "noise", "amplitude": 15, "wavelength": 400, "octaves": 3},
        "way": {**EVERY_LAYER["road"], "order": 9},
    }
    grid, height = _land(layers, cell=2.0)
    share = np.linspace(0.02, 0.98, 300)
    x, y = -450 + 900 * share, -300 + 600 * share
    along = grid.sample(height, x, y)
    step = np.hypot(x[1] - x[0], y[1] - y[0])
    assert np.abs(np.diff(along)).max() / step <= 0.08 * 1.25
    across = np.array([-600, 900]) / np.hypot(600, 900)
    left, right = (
        grid.sample(height, x + 2 * across[0], y + 2 * across[1]),
        grid.sample(height, x - 2 * across[0], y - 2 * across[1]),
    )
    assert np.abs(left - right).max() < 0.15


def test_a_flattened_zone_is_level_and_fades_outside() -> None:
    layers = {
        "hills": {"kind": "noise", "amplitude": 30, "wavelength": 300},
        "site": {**EVERY_LAYER["flatten"], "order": 9, "height": 12.5},
    }
    grid, height = _land(layers, zones=ZONES)
    distance = zone_distance(grid, Zone.model_validate(ZONES["top"]))
    assert np.abs(height[distance <= 0] - 12.5).max() < 1e-9
    _, untouched = _land({"hills": layers["hills"]})
    assert np.array_equal(height[distance > 40], untouched[distance > 40])


def test_dunes_lee_side_rests_near_its_angle() -> None:
    grid, height = _land({"sea": {"kind": "dunes", "height": 10, "spacing": 100, "wind_deg": 0}}, cell=1.0)
    east = np.gradient(height, grid.cell, axis=1)
    lee, windward = np.degrees(np.arctan(-east.min())), np.degrees(np.arctan(east.max()))
    assert 20 <= lee <= 36
    assert windward < lee


def test_zones_measure_signed_distances() -> None:
    grid = Grid(41, 41, 1.0)
    square = zone_distance(grid, Zone.model_validate({"polygon": [[-5, -5], [5, -5], [5, 5], [-5, 5]]}))
    assert square[20, 20] == pytest.approx(-5)
    assert square[20, 30] == pytest.approx(5)
    disc = zone_distance(grid, Zone.model_validate({"center": [0, 0], "radius": 4}))
    assert disc[20, 20] == pytest.approx(-4)
    strip = zone_distance(grid, Zone.model_validate({"line": [[-20, 0], [20, 0]], "width": 6}))
    assert strip[20, 20] == pytest.approx(-3)
    with pytest.raises(ValueError, match="polygon"):
        Zone.model_validate({"center": [0, 0]})


@pytest.mark.parametrize(
    ("layers", "more", "words"),
    [
        ({"m": {"kind": "mesa", "height": 5}}, {}, "zone"),
        ({"m": {"kind": "noise", "amplitude": 5, "wavelength": 50, "zone": "nowhere"}}, {}, "nowhere"),
        ({"m": {"kind": "coast", "line": [[0, 0], [1, 1]]}}, {}, "sea_level"),
        ({"m": {"kind": "flatten", "zone": "far"}}, {"zones": {"far": {"center": [9000, 0], "radius": 5}}}, "holds no cell"),
        ({"m": {"kind": "dem", "file": "none.npy"}}, {}, "no file"),
    ],
)
def test_layers_that_cannot_be_made_say_why(layers: dict[str, Any], more: dict[str, Any], words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=words):
        _land(layers, assets=tmp_path, **more)


@pytest.mark.parametrize("suffix", ["npy", "png", "tif"])
def test_a_file_of_heights_lands_north_up_at_its_scale(suffix: str, tmp_path: Path) -> None:
    import cv2

    rows = np.arange(80)[:, None]
    stored = (np.broadcast_to(1000 - 10 * rows, (80, 100)) + np.arange(100)[None]).astype(np.uint16)  # first row is north
    path = tmp_path / f"land.{suffix}"
    if suffix == "npy":
        np.save(path, stored)
    else:
        cv2.imwrite(str(path), stored)
    grid, height = _land({"m": {"kind": "dem", "file": path.name, "scale": 0.1}}, assets=tmp_path)
    assert height[-1].mean() == pytest.approx((1000 + 49.5) * 0.1, abs=1.5)
    assert height[-1].mean() > height[0].mean()
    assert height[:, -1].mean() > height[:, 0].mean()
    assert grid.shape == (80, 100)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        (np.full((10, 10), np.nan), "no finite height"),
        (np.full((10, 10), 7.0), "flat"),
        (np.where(np.eye(10) > 0, np.nan, np.arange(100.0).reshape(10, 10)), "without data"),
        (np.zeros((10, 10, 3)), "one band"),
        (np.zeros((1, 1)), "2 x 2"),
    ],
)
def test_files_that_are_no_land_are_refused(values: np.ndarray, words: str, tmp_path: Path) -> None:
    np.save(tmp_path / "land.npy", values)
    with pytest.raises(InputError, match=words):
        _land({"m": {"kind": "dem", "file": "land.npy"}}, assets=tmp_path)


def test_holes_are_filled_or_kept_as_asked(tmp_path: Path) -> None:
    values = np.arange(100.0).reshape(10, 10)
    values[4:6, 4:6] = np.nan
    np.save(tmp_path / "land.npy", values)
    _, filled = _land({"m": {"kind": "dem", "file": "land.npy", "holes": "fill"}}, assets=tmp_path)
    _, kept = _land({"m": {"kind": "dem", "file": "land.npy", "holes": "keep"}}, assets=tmp_path)
    assert np.isfinite(filled).all()
    assert 0 < np.isnan(kept).sum() < kept.size / 10


def test_a_file_that_holds_code_is_not_unpickled(tmp_path: Path) -> None:
    np.save(tmp_path / "land.npy", np.array([{"a": 1}], dtype=object), allow_pickle=True)
    with pytest.raises(InputError, match="cannot be loaded"):
        _land({"m": {"kind": "dem", "file": "land.npy"}}, assets=tmp_path)
