"""Things that may shatter: their bodies are cut into pieces and bonds when they are built."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction.assets.documents import asset_documents
from worldagent.construction.assets.registry import GENERATORS
from worldagent.construction.build import build_entity
from worldagent.worlds.arrays import RigidPose
from worldagent.worlds.patch import parse_edit

BREAKABLE = ("glass", "wine_glass", "bottle", "jug", "vase", "jar", "flower_pot", "bowl", "plate", "mug")
STAND = RigidPose(np.array([0.0, 0.0, 0.1]), np.array([1.0, 0.0, 0.0, 0.0]))


def _document(name: str, parameters: dict[str, Any], seed: int) -> dict[str, Any]:
    record = {"generator": name, "parameters": parameters, "seed": seed}
    made = asset_documents(name, record, GENERATORS[name].make(parameters, seed), STAND, motion="dynamic")
    entities = {key: {k: v for k, v in entity.items() if k != "asset"} for key, entity in made.entities.items()}
    rigid = {"engine": "mujoco", "members": list(entities)}
    return {
        "title": name,
        "prompt": name,
        "spec_version": "2",
        "entities": entities,
        "simulation": {"frames": 2, "solvers": {"rigid": rigid}},
    }


@pytest.mark.parametrize("name", BREAKABLE)
def test_a_breakable_thing_is_built_of_bonded_pieces_of_the_mass_of_the_whole_one(name: str) -> None:
    spec = parse_edit(_document(name, {"breakable": True}, 3))
    cut = build_entity(spec, name, Path())
    assert len(cut.bodies) >= 6
    assert cut.bonds is not None
    assert len(cut.bonds) >= len(cut.bodies) - 1
    assert set(cut.bonds.pieces.ravel().tolist()) == set(range(len(cut.bodies)))
    document = _document(name, {"breakable": True}, 3)
    del document["entities"][name]["breakable"]
    whole = build_entity(parse_edit(document), name, Path())
    assert sum(b.mass for b in cut.bodies) == pytest.approx(sum(b.mass for b in whole.bodies), rel=1e-6)


@pytest.mark.parametrize("name", BREAKABLE)
def test_a_thing_does_not_break_unless_it_is_asked_for(name: str) -> None:
    assert {str(body.breakable) for body in GENERATORS[name].make({}, 3).bodies.values()} == {"None"}


@pytest.mark.parametrize("name", ["jug", "mug"])
def test_a_breakable_vessel_has_no_handle(name: str) -> None:
    parts = {
        key: set(GENERATORS[name].make({"breakable": broken}, 3).main.parts) for key, broken in (("whole", False), ("cut", True))
    }
    assert "handle" in parts["whole"]
    assert "handle" not in parts["cut"]
