"""Rooms hold a hundredweight beside a few grams: how exactly the rigid instance that is made for them searches for forces."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
from worldagent.construction import build_world
from worldagent.construction.assets.documents import asset_documents
from worldagent.construction.assets.registry import make
from worldagent.construction.interiors.build import build_interior
from worldagent.simulation.schedule import run_frames
from worldagent.workflow.creation import create
from worldagent.workflow.interiors import TOLERANCE, interior_operations
from worldagent.worlds.arrays import RigidPose, euler_to_quaternion
from worldagent.worlds.patch import apply_patch, parse_edit
from worldagent.worlds.spec import Interior, WorldSpec

FRAMES = 49
"""The initial state and 2 s."""


def _jar_among_blocks(tolerance: float) -> dict[str, Any]:
    """A jar whose lid of cork weighs a few grams, between blocks of oak of 700 kg, on a floor."""
    asked = {"generator": "jar", "parameters": {"lid": "cork"}, "seed": 487226690}
    here = RigidPose(np.array([0.0, 0.0, 0.001]), euler_to_quaternion((0.0, 0.0, 0.3)))
    jar = asset_documents("jar", asked, make("jar", {"lid": "cork"}, 487226690), here, motion="dynamic")
    slab = {"shape": {"kind": "box", "size": [9.0, 9.0, 0.2]}, "pose": {"position": [0.0, 0.0, -0.1]}}
    entities: dict[str, Any] = {
        "floor": {
            "role": "floor",
            "motion": "static",
            "material": "oak",
            "dimensions": {"size": [9.0, 9.0, 0.2]},
            "parts": {"slab": slab},
        }
    }
    for k in range(3):
        block = {"shape": {"kind": "box", "size": [1.0, 1.0, 1.0]}, "pose": {"position": [0.0, 0.0, 0.5]}}
        where = {"position": [2.0 * k - 2.0, 2.0, 0.001]}
        entities[f"block{k}"] = {
            "role": "block",
            "motion": "dynamic",
            "material": "oak",
            "dimensions": {"size": [1.0, 1.0, 1.0]},
            "pose": where,
            "parts": {"all": block},
        }
    members = [*entities, *jar.entities]
    rigid = {"engine": "mujoco", "members": members, "settings": {"tolerance": tolerance}}
    simulation = {"frames": FRAMES, "joints": jar.joints, "solvers": {"rigid": rigid}}
    return {"spec_version": "2", "title": "t", "prompt": "a jar", "entities": entities | jar.entities, "simulation": simulation}


def _turned(tmp_path: Path, tolerance: float) -> float:
    """Largest angle [degrees] by which the lid is turned at any frame."""
    session, _ = create(tmp_path, f"w{tolerance:g}", "a jar", {"simulation": {"frames": FRAMES}})
    spec: WorldSpec = parse_edit(_jar_among_blocks(tolerance))
    built, _ = build_world(session.folder, spec)
    cached = run_frames(spec, built, session.folder.root / "run", frames=FRAMES)["rigid"]
    row = list(cached.index.bodies).index("jar_lid/body")
    start = cached.pose(row, 0).quaternion
    turns = [2.0 * math.acos(min(1.0, abs(float(start @ cached.pose(row, f).quaternion)))) for f in range(FRAMES)]
    return math.degrees(max(turns))


def test_a_light_lid_stays_where_it_lies_among_heavy_things(tmp_path: Path) -> None:
    """Law: nothing turns a lid that lies on its jar; the engine's own tolerance, taken from the heavy ones, leaves forces that do."""
    assert _turned(tmp_path, TOLERANCE) < 0.02
    assert _turned(tmp_path, 1e-8) > 0.03


def test_the_instance_that_is_made_for_a_room_searches_that_exactly_and_an_own_one_stays_as_it_is(tmp_path: Path) -> None:
    """Choice: settings that a client gave are not changed by what is built into its world."""
    asked = Interior.model_validate({"rooms": {"store": {"kind": "store", "area": 6.0, "doors": ["outside"]}}, "seed": 1})
    made = build_interior("flat", asked, gap=1e-3)
    for name, given in (("bare", None), ("own", {"tolerance": 1e-9})):
        session, _ = create(tmp_path, name, "a room", {"simulation": {"frames": 2}})
        spec = session.spec
        if given is not None:
            document = _jar_among_blocks(given["tolerance"]) | {"prompt": spec.prompt}
            spec = parse_edit(document)
        after = apply_patch(spec, interior_operations(spec, "flat", asked, made))
        settings = after.simulation.rigid["rigid"].settings
        assert settings.tolerance == (TOLERANCE if given is None else given["tolerance"])
