"""A landscape's water becomes a liquid entity whose particles cover the hydrology's mask within one cell (R38, R57)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy import ndimage
from worldagent.construction.build import build_entity
from worldagent.construction.terrain.grid import Grid
from worldagent.construction.terrain.rivers import BED_ROUGHNESS
from worldagent.simulation.liquid.scene import build_scene
from worldagent.tests.construction.terrain.test_waters import CELL, COLS, DEEP, FALL, HALF, ROWS, Land
from worldagent.workflow.waters import water_operations
from worldagent.worlds import shapes
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.errors import LimitError
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.patch import apply_patch, parse_spec
from worldagent.worlds.spec import WorldSpec

SPACING = 0.4
CENTER, SIZE = (2.0, 0.0), (60.0, 24.0)


def base() -> WorldSpec:
    return parse_spec({
        "spec_version": "2", "title": "t", "prompt": "A river.", "simulation": {"frames": 24},
        "materials": {"stone": {"density": 2600, "substance": "stone"}},
    })  # fmt: skip


def operations(folder: WorldFolder, spec: WorldSpec, spacing: float = SPACING) -> tuple[WorldSpec, dict[str, object]]:
    """The river and the ground under it, as build_terrain adds them."""
    x = CENTER[0] + np.linspace(-SIZE[0] / 2, SIZE[0] / 2, 61)
    y = CENTER[1] + np.linspace(-SIZE[1] / 2, SIZE[1] / 2, 25)
    ground = -FALL * x[None] - DEEP * np.clip(1 - np.abs(y[:, None]) / HALF, 0, None)
    folder.assets.mkdir(parents=True, exist_ok=True)
    np.save(folder.assets / "g.npy", ground)
    made, told = water_operations(folder, spec, Land(), file="g.npy", center=CENTER, size=SIZE, liquid="river", spacing=spacing)
    shape = {"kind": "heightfield", "size": list(SIZE), "heights": ground.tolist(), "base": 1.0}
    land = {
        "role": "ground", "motion": "static", "material": "stone", "dimensions": {"size": [60, 24, 3.6]},
        "pose": {"position": [*CENTER, 0]}, "parts": {"land": {"shape": shape}},
    }  # fmt: skip
    made += [
        {"op": "add", "path": "/entities/ground", "value": land},
        {"op": "add", "path": "/simulation/solvers/rigid", "value": {"engine": "mujoco", "members": ["ground"]}},
    ]
    return apply_patch(spec, made), told


def test_the_river_passes_the_audit_and_brings_its_discharge(tmp_path: Path) -> None:
    spec, told = operations(WorldFolder.at(tmp_path), base(), spacing=0.2)
    open_rows = {r.id for r in audit(spec).rows if r.status != "pass"}
    assert open_rows <= {"audit:claims", "audit:story"}
    (inflow,) = [d for d in spec.simulation.drivers.values() if d.kind == "inflow"]
    assert 5 * 3.0 < (inflow.rate or 0.0) < 5 * 5.0, "bankfull"
    (outflow,) = [d for d in spec.simulation.drivers.values() if d.kind == "outflow"]
    assert outflow.pose.position[0] > CENTER[0] + 0.45 * SIZE[0]
    river = spec.simulation.liquid["river"]
    assert river.engine == "flip"
    assert river.settings.domain.sides[:2] == ("closed", "open")
    assert getattr(river.settings, "roughness", 0.0) == round(BED_ROUGHNESS, 4)
    assert spec.materials["water"].density == 1000
    assert told["volume_m3"] == round(float(str(told["volume_m3"])), 3) > 300


def test_a_river_too_shallow_for_the_spacing_says_so_and_has_no_inflow(tmp_path: Path) -> None:
    spec, told = operations(WorldFolder.at(tmp_path), base(), spacing=1.0)
    assert not [d for d in spec.simulation.drivers.values() if d.kind == "inflow"]
    assert told["too_small_for_the_spacing"]


def test_making_it_again_replaces_it(tmp_path: Path) -> None:
    folder = WorldFolder.at(tmp_path)
    once, _ = operations(folder, base(), spacing=0.2)
    twice, _ = operations(folder, once, spacing=0.2)
    assert twice == once


def test_particles_and_the_mask_of_hydrology_agree_within_one_cell(tmp_path: Path) -> None:
    spec, _ = operations(WorldFolder.at(tmp_path), base())
    built = {n: build_entity(spec, n, tmp_path) for n in spec.entities}
    setup = build_scene(spec, built, "river").setup
    assert abs(setup.volume.sum() / built["river"].bodies[0].volume - 1) < 0.01
    grid = Grid(ROWS, COLS, CELL)
    east, north = grid.axes()
    have = np.zeros(grid.shape, dtype=bool)
    have[
        np.round((setup.position[:, 1] - north[0]) / CELL).astype(int),
        np.round((setup.position[:, 0] - east[0]) / CELL).astype(int),
    ] = True
    inside = (np.abs(east - CENTER[0]) < SIZE[0] / 2)[None] & (np.abs(north - CENTER[1]) < SIZE[1] / 2)[:, None]
    wet = Land().raw("wet").astype(bool) & inside
    near = np.ones((3, 3), dtype=bool)
    assert wet.sum() > 50
    assert not (have & ~ndimage.binary_dilation(wet, near)).any()
    assert not (wet & ~ndimage.binary_dilation(have, near)).any()


def test_a_surface_with_more_corners_than_a_specification_holds_is_refused_with_both_counts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    spec, _ = operations(WorldFolder.at(tmp_path), base(), spacing=0.2)
    shape = spec.entities["river"].parts["body"].shape
    assert shape.kind == "mesh"
    corners, faces = len(shape.vertices or ()), len(shape.faces or ())
    monkeypatch.setattr(shapes, "MESH_VERTICES", corners)
    monkeypatch.setattr(shapes, "MESH_FACES", faces)
    assert operations(WorldFolder.at(tmp_path), base(), spacing=0.2)[0] == spec
    monkeypatch.setattr(shapes, "MESH_VERTICES", corners - 1)
    with pytest.raises(
        LimitError,
        match=rf"has {corners:,} corners and {faces:,} triangles, caps {corners - 1:,} and {faces:,}\. Knob: about \d+ cells",
    ):
        operations(WorldFolder.at(tmp_path), base(), spacing=0.2)


def test_the_caps_are_those_of_the_fields() -> None:
    """The schema refuses one more of either."""
    mesh = shapes.Mesh.model_json_schema()["properties"]
    assert [next(k["maxItems"] for k in mesh[f]["anyOf"] if "maxItems" in k) for f in ("vertices", "faces")] == [
        shapes.MESH_VERTICES,
        shapes.MESH_FACES,
    ]
