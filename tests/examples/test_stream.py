"""A stream of the landscape that carries leaves and a log: its reach, and that painted water does not count."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import ndimage
from worldagent.construction.build import build_entity
from worldagent.construction.terrain.grid import Grid
from worldagent.construction.terrain.store import build_terrain_file, cut_patch
from worldagent.examples.stream import PROMPT, Course, land_spec
from worldagent.simulation.liquid.scene import build_scene
from worldagent.tools.waters import water_operations
from worldagent.worlds.audit import audit
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.patch import apply_patch, parse_spec

SPACING = 0.8
SIZE = (230.0, 52.0)


def river_of(folder: WorldFolder) -> tuple[Any, Any, dict[str, Any]]:
    """Specification with the long reach, the landscape, and the figures of the reply."""
    spec = parse_spec({"prompt": PROMPT, **land_spec(20.0, 12)})
    land, _ = build_terrain_file(folder, spec, "valley")
    patch = cut_patch(folder, "valley", land, center=(0.0, 0.0), size=SIZE, cells=230)
    made, told = water_operations(
        folder, spec, land, file=patch.file, center=(0.0, 0.0), size=SIZE, liquid="river", spacing=SPACING
    )
    return apply_patch(spec, made), land, told


def test_the_long_reach_agrees_with_the_mask_of_hydrology_within_one_cell(tmp_path: Path) -> None:
    spec, land, told = river_of(WorldFolder.at(tmp_path))
    course = Course(spec.entities["river"].model_dump(mode="json"))
    assert course.length > 200
    assert told["currents"][0]["length_m"] == pytest.approx(course.length, abs=1)
    setup = build_scene(spec, {"river": build_entity(spec, "river", tmp_path)}, "river").setup
    grid = Grid(*land.shape, land.cell)
    have = np.zeros(grid.shape, dtype=bool)
    have[grid.indices(setup.position[:, 0], setup.position[:, 1])] = True
    east, north = grid.axes()
    low, high = setup.lower, setup.upper
    assert (high[:2] - low[:2] > np.array(SIZE) - 8 * SPACING).all()
    inside = ((east > low[0]) & (east < high[0]))[None] & ((north > low[1]) & (north < high[1]))[:, None]
    wet = land.raw("wet").astype(bool) & inside
    near = np.ones((3, 3), dtype=bool)
    assert wet.sum() > 1500
    assert not (have & ~ndimage.binary_dilation(wet, near)).any()
    assert not (wet & ~ndimage.binary_dilation(have, near)).any()
    speed = np.linalg.norm(setup.velocity, axis=1)
    assert (speed > 0.5).mean() > 0.995
    assert speed.max() < 2.5


def test_the_course_bends_smoothly(tmp_path: Path) -> None:
    """Between stations of a metre it turns by less than a sixth of a right angle, where links of cells turn by a half."""
    spec, _, _ = river_of(WorldFolder.at(tmp_path))
    line = Course(spec.entities["river"].model_dump(mode="json")).line[:, :2]
    way = np.unwrap(np.arctan2(*np.diff(line, axis=0).T[::-1]))
    assert np.abs(np.diff(way)).max() < np.pi / 12


def test_painted_water_carries_no_log() -> None:
    """The same beats, but the stream is a blue slab, or only the landscape's: nothing that flows, so no evidence."""
    world = land_spec(1.0, 12)
    box = {"shape": {"kind": "box", "size": [20, 6, 0.1]}}
    slab = {"role": "blue water of the stream", "motion": "static", "material": "water", "dimensions": {"size": [20, 6, 0.1]}, "parts": {"body": box}}  # fmt: skip
    log = {"shape": {"kind": "cylinder", "radius": 0.3, "height": 3}}
    world["entities"] = {
        "river": slab,
        "log": {"role": "log", "motion": "dynamic", "material": "wood", "dimensions": {"size": [0.6, 0.6, 3]}, "parts": {"body": log},
                "pose": {"position": [0, 0, 2]}},
    }  # fmt: skip
    world["simulation"]["solvers"] = {"bodies": {"engine": "mujoco", "members": ["river", "log"]}}
    beat = {"text": "the log is carried on", "owner": "bodies", "subject": "log", "frames": [0, 11],
            "predicate": {"kind": "displacement", "entity": "log", "min": 1.0}, "causes": []}  # fmt: skip
    world["story"] = {"semantics": "s", "beats": {"drifts": beat}}
    for shown in ("/entities/river", "/terrains/valley"):
        world["clauses"] = {"c1": {"met_by": [shown, "/entities/log", "/story/beats/drifts"]}}
        row = next(r for r in audit(parse_spec({"prompt": PROMPT, **world})).rows if r.id == "audit:clauses")
        assert row.status == "fail"
        assert "that nothing simulates" in " ".join(row.evidence["problems"])
