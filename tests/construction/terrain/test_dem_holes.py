"""Holes of a measured height file stay holes: no land, no plant, no ground to stand on, and every row of the landscape passes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import tifffile
from worldagent.construction.terrain.store import build_terrain_file, cut_patch
from worldagent.rendering.land.scenery import drawn_land
from worldagent.rendering.land.triangles import grid_faces
from worldagent.verifiers.land.landscapes import drainage_finding, fill_finding, ledger_finding, plant_finding, water_finding
from worldagent.worlds.errors import InputError
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.landscape import SavedLandscape
from worldagent.worlds.spec import WorldSpec

SIDE = 60
HOLE = (slice(15, 27), slice(22, 40))
"""Rows from the north, columns from the west."""


def _values() -> Any:
    rng = np.random.default_rng(0)
    return np.add.outer(np.linspace(20, 80, SIDE), np.linspace(0, 30, SIDE)) + rng.normal(size=(SIDE, SIDE))


def _build(folder: WorldFolder, file: str, **layer: Any) -> tuple[SavedLandscape, WorldSpec]:
    land = {
        "extent": [600, 600], "cell": 10, "erosion": {"years": 500, "steps": 1}, "vegetation": {"density": 0.2},
        "layers": {"m": {"kind": "dem", "file": file, "holes": "keep", **layer}},
    }  # fmt: skip
    spec = WorldSpec.model_validate({"title": "t", "prompt": "p", "terrains": {"land": land}, "simulation": {"frames": 2}})
    return build_terrain_file(folder, spec, "land")[0], spec


@pytest.fixture
def folder(tmp_path: Path) -> WorldFolder:
    made = WorldFolder(tmp_path)
    made.assets.mkdir(parents=True, exist_ok=True)
    return made


def test_a_kept_hole_is_no_land_and_all_rows_hold(folder: WorldFolder) -> None:
    values = _values()
    values[HOLE] = np.nan
    np.save(folder.assets / "a.npy", values)
    land, spec = _build(folder, "a.npy")
    gone = np.isnan(land.field("height"))
    assert gone.sum() == 12 * 18
    assert (np.flipud(gone)[HOLE]).all()
    for finding in (fill_finding(land), drainage_finding(land), ledger_finding(land)):
        assert finding.measured <= 1e-6, finding.text
    for found in (water_finding(land, spec.terrains["land"]), plant_finding(land, spec.terrains["land"], {})):
        assert found.measured == 0
    x, y, height = drawn_land(land)
    known = np.isfinite(height)
    keep = known[:-1, :-1] & known[1:, :-1] & known[:-1, 1:] & known[1:, 1:]
    assert not gone.ravel()[grid_faces(len(y), len(x), keep)].any(), "no triangle of the picture has a corner in the hole"
    feet = land.raw("plant_position")
    row, col = ((feet[:, k] / 10 + 29.5).round().astype(int) for k in (1, 0))
    assert not gone[row, col].any()
    with pytest.raises(InputError, match="without land"):
        cut_patch(folder, "land", land, center=(10.0, 90.0), size=(100.0, 100.0), cells=10)


def test_the_no_data_value_of_a_geotiff_is_a_hole(folder: WorldFolder) -> None:
    values = _values().astype(np.float32)
    values[HOLE] = -9999
    tifffile.imwrite(folder.assets / "a.tif", values, extratags=[(42113, "s", 0, "-9999", True)])
    land, _ = _build(folder, "a.tif")
    assert np.isnan(land.field("height")).sum() == 12 * 18
    filled, _ = _build(folder, "a.tif", holes="fill")
    assert np.isfinite(filled.field("height")).all()
    assert filled.field("height").min() > 0, "interpolated, not the no-data value"


def test_a_16_bit_png_is_scaled(folder: WorldFolder) -> None:
    values = np.round(_values() * 100).astype(np.uint16)
    cv2.imwrite(str(folder.assets / "a.png"), values)
    land, _ = _build(folder, "a.png", scale=0.01)
    start = np.flipud(land.field("start"))
    assert start == pytest.approx(_values(), abs=0.011)
