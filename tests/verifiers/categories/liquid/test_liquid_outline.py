"""Liquids in pictures: the mesh that views see, at rest, in flight, and where all of it is gone."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from worldagent.construction.build import build_entity
from worldagent.testing.worlds.small_liquids import tank_spec
from worldagent.verifiers.categories.liquid.outline import filled_cells
from worldagent.verifiers.categories.registry import JUDGES
from worldagent.verifiers.register.assemble import approximations
from worldagent.verifiers.shots.sight import Sight
from worldagent.verifiers.support.check import check as check_support
from worldagent.worlds.arrays import F64
from worldagent.worlds.cache import Cache, CacheIndex, write_container
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.errors import EvidenceError
from worldagent.worlds.groups import GROUPS
from worldagent.worlds.spec import WorldSpec

SPACING = 0.025
EYE = {"k": {"frame": 0, "position": [0.01, -0.5, 2.6], "target": [0, 0, 0.1]}}


def block(low: F64, high: F64) -> F64:
    axes = [np.arange(a + SPACING / 2, b, SPACING) for a, b in zip(low, high, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def tank(tmp_path: Path, frames: list[F64], **changes: Any) -> Candidate:
    """A tank without crate, whose particles are at given places."""
    shots = {"wide": {"frames": [0, len(frames) - 1], "covers": [], "subjects": ["water"], "keys": EYE}}
    spec = WorldSpec.model_validate({"prompt": "p", **tank_spec(crate_at=None, frames=len(frames), shots=shots), **changes})
    built = {n: build_entity(spec, n, tmp_path) for n in spec.entities}
    cache = Cache(tmp_path / "water")
    cache.folder.mkdir()
    cache.write_index(CacheIndex("water", "dfsph", spec.simulation.fps, len(frames), ("water",), (), (), (), "", {}))
    cache.begin_digests([])
    for k, points in enumerate(frames):
        data = {
            "origin": np.array([0.0, 0.0, 0.1]),
            "particle/position": (points - np.array([0.0, 0.0, 0.1])).astype(np.float32),
            "particle/velocity": np.zeros((len(points), 3), dtype=np.float32),
            "particle/fluid": np.zeros(len(points), dtype=np.int32),
            "particle/volume": np.full(len(points), SPACING**3, dtype=np.float32),
        }
        cache.add_digest(write_container(cache.path(k), data))
    return Candidate(tmp_path, spec, built, "full", {"water": cache})


POOL = block(np.array([-0.2, -0.2, 0.0]), np.array([0.2, 0.2, 0.2]))


def test_filled_cells_are_closed_and_hold_their_volume() -> None:
    points = np.random.default_rng(3).uniform(-0.4, 0.4, (400, 3))
    mesh = filled_cells(points, 0.1)
    filled = len(np.unique(np.floor(points / 0.1), axis=0))
    assert trimesh.Trimesh(mesh.vertices, mesh.faces).volume == pytest.approx(filled * 1e-3, rel=1e-9)
    block_mesh = filled_cells(POOL, 2 * SPACING)
    assert trimesh.Trimesh(block_mesh.vertices, block_mesh.faces).is_watertight
    assert len(filled_cells(np.zeros((0, 3)), 0.1).faces) == 0


def test_the_outline_is_where_the_particles_are(tmp_path: Path) -> None:
    candidate = tank(tmp_path, [POOL, POOL + np.array([0, 0, 1.0])])
    for frame, lift in ((0, 0.0), (1, 1.0)):
        mesh = JUDGES["liquid"].outline(candidate, "water", frame)
        assert mesh.vertices.min(axis=0) == pytest.approx([-0.2, -0.2, lift], abs=1.6 * SPACING)
        assert mesh.vertices.max(axis=0) == pytest.approx([0.2, 0.2, 0.2 + lift], abs=1.6 * SPACING)
    declared = JUDGES["liquid"].outline(dataclasses.replace(candidate, stage="static", caches={}), "water", 0)
    assert declared.vertices.max(axis=0) == pytest.approx([0.2, 0.2, 0.2])


def test_a_liquid_without_a_cache_has_no_shape(tmp_path: Path) -> None:
    candidate = dataclasses.replace(tank(tmp_path, [POOL, POOL]), caches={})
    with pytest.raises(EvidenceError, match="no cache holds 'water'"):
        JUDGES["liquid"].outline(candidate, "water", 0)


def test_a_view_follows_the_liquid_and_says_when_it_is_gone(tmp_path: Path) -> None:
    gone = np.zeros((0, 3))
    below = POOL - np.array([0, 0, 0.6])
    candidate = tank(tmp_path, [POOL, below, gone])
    sight = Sight(candidate)
    full, hidden, none = (sight.seen("water", "wide", k) for k in range(3))
    assert full.in_picture
    assert full.unoccluded > 0.5
    assert hidden.unoccluded < 0.3
    assert hidden.hidden_by == "tank"
    assert not none.in_picture


def test_water_hides_nothing_and_paint_does(tmp_path: Path) -> None:
    marble = {
        "role": "marble on the floor", "motion": "static", "material": "stone", "dimensions": {"size": [0.1, 0.1, 0.1]},
        "pose": {"position": [0, 0, 0.05]}, "parts": {"body": {"shape": {"kind": "sphere", "radius": 0.05}}},
    }  # fmt: skip
    seen = {}
    for name, clear in (("water", 1.0), ("paint", 0.0)):
        (tmp_path / name).mkdir()
        base = json.loads(json.dumps(tank_spec(crate_at=None, frames=2)))
        base["entities"]["marble"] = marble
        base["materials"]["water"]["appearance"]["transmission"] = clear
        candidate = tank(tmp_path / name, [POOL, POOL], entities=base["entities"], materials=base["materials"])
        seen[name] = Sight(candidate).seen("marble", "wide", 0)
    assert seen["water"].unoccluded == pytest.approx(1.0)
    assert seen["paint"].unoccluded < 0.05
    assert seen["paint"].hidden_by == "water"


@pytest.mark.parametrize("engine", ["dfsph", "flip"])
def test_what_an_engine_leaves_out_stands_in_the_register(tmp_path: Path, engine: str) -> None:
    candidate = tank(tmp_path, [POOL, POOL])
    spec = WorldSpec.model_validate({"prompt": "p", **tank_spec(crate_at=None, engine=engine)})
    told = [a["what"] for a in approximations(dataclasses.replace(candidate, spec=spec))]
    assert any(t.startswith("surface tension of") and "not simulated" in t for t in told), told
    assert not any("viscosity" in t for t in told), told


def test_surface_tension_is_told_of_where_it_is_felt(tmp_path: Path) -> None:
    """At 5 mm water feels it, at the tank's spacing gravity leaves nothing to it."""
    candidate = tank(tmp_path, [POOL, POOL])
    told = {}
    for spacing in (None, 0.005):
        data = tank_spec(crate_at=None)
        if spacing is not None:
            data["entities"]["water"]["physics"]["resolution"] = spacing
        spec = WorldSpec.model_validate({"prompt": "p", **data})
        lines = [a["what"] for a in approximations(dataclasses.replace(candidate, spec=spec))]
        (told[spacing],) = (t for t in lines if "surface tension" in t)
    assert "not simulated" in told[None]
    assert "attractions" in told[0.005]


def test_a_liquid_that_is_not_coupled_carries_nothing_and_the_row_says_what_to_do(tmp_path: Path) -> None:
    relation = {"kind": "supports", "a": "water", "b": "crate"}
    data = tank_spec(coupled=False, graph={"relations": {"afloat": relation}})
    spec = WorldSpec.model_validate({"prompt": "p", **data})
    built = {n: build_entity(spec, n, tmp_path) for n in spec.entities}
    rows = {r.id: r for r in check_support(Candidate(tmp_path, spec, built, "static", {}))}
    row = rows["support:afloat:crate"]
    assert row.status == "fail"
    assert {c.group for c in row.corrections} <= set(GROUPS)
