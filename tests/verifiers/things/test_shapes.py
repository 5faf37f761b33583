"""Collision, simulation and visible shapes of parts of generated things are measured against each other."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from worldagent.construction.build import build_entity
from worldagent.construction.primitives import build_shape
from worldagent.testing.defects._rooms import GAP, room
from worldagent.verifiers.things import shapes
from worldagent.worlds.arrays import RigidPose
from worldagent.worlds.built import BuiltPart, Convex
from worldagent.worlds.simulation_mesh import SimulationMesh
from worldagent.worlds.spec import Box, Capsule, Cylinder, Hull, Revolution, Shape, Sphere, Sweep

HERE = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
NONE = np.empty((0, 3))
CUP = Revolution(profile=[(0, 0), (0.04, 0), (0.04, 0.1), (0.035, 0.1), (0.035, 0.005), (0, 0.005)], segments=24)


def _part(shape: Shape, collision: tuple[Convex, ...] | None = None) -> BuiltPart:
    made = build_shape(shape, Path())
    pieces = made.collision if collision is None else collision
    return BuiltPart("p", "body", "wood", made.render, pieces, True, (0.0, 0.0), False)


SHAPES = [
    Box(size=(0.3, 0.2, 0.1)),
    Sphere(radius=0.1),
    Cylinder(radius=0.05, height=0.3),
    Capsule(radius=0.05, length=0.3),
    Hull(points=[(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0.3, 0.3, 0.3)]),
    CUP,
    Sweep(path=[(0, 0, 0), (0.1, 0, 0.1), (0.2, 0, 0.1)], profile=[(-0.01, -0.01), (0.01, -0.01), (0.01, 0.01), (-0.01, 0.01)]),
]


@pytest.mark.parametrize("shape", SHAPES, ids=lambda s: s.kind)
def test_shapes_as_they_are_constructed_agree(shape: Shape) -> None:
    part = _part(shape)
    assert shapes.difference(part).distance < 0.01 * float(np.linalg.norm(np.ptp(part.render.vertices, axis=0)))


@pytest.mark.parametrize("grown", [0.01, -0.01])
@pytest.mark.parametrize(("shape", "kind", "params"), [
    (Box(size=(0.3, 0.2, 0.1)), "box", (0.15, 0.1, 0.05)), (Sphere(radius=0.1), "sphere", (0.1, 0.0)),
    (Cylinder(radius=0.1, height=0.4), "cylinder", (0.1, 0.2)), (Capsule(radius=0.1, length=0.4), "capsule", (0.1, 0.2)),
])  # fmt: skip
def test_a_piece_that_is_larger_or_smaller_is_as_far_off(
    shape: Shape, kind: str, params: tuple[float, ...], grown: float
) -> None:
    piece = Convex(kind, (params[0] + grown, *params[1:]), HERE, NONE)
    found = shapes.difference(_part(shape, (piece,)))
    assert found.distance == pytest.approx(abs(grown), rel=0.15)
    assert found.how == (shapes.STANDS_OUT if grown > 0 else shapes.IS_BARE)


def test_one_hull_of_a_cup_fills_it() -> None:
    part = _part(CUP)
    hull = Convex("hull", (), HERE, part.render.vertices)
    found = shapes.difference(replace(part, collision=(hull,)))
    assert found.how == shapes.STANDS_OUT
    assert found.distance > 0.009


def test_a_piece_that_is_missing_leaves_it_bare() -> None:
    part = _part(CUP)
    found = shapes.difference(replace(part, collision=part.collision[: len(part.collision) // 2]))
    assert found.how == shapes.IS_BARE
    assert found.distance > 0.02


def test_bound_vertices_are_compared_with_what_is_drawn() -> None:
    part = _part(Box(size=(0.2, 0.2, 0.2)))
    count = len(part.render.vertices)
    rows = np.tile(np.arange(count, dtype=np.int32)[:, None], (1, 4))
    weights = np.tile([1.0, 0.0, 0.0, 0.0], (count, 1))
    mesh = SimulationMesh(
        part.render.vertices + np.array([0.0, 0.0, 0.003]), part.render.faces, np.empty((0, 4), dtype=np.int32), rows, weights
    )
    found = shapes.difference(replace(part, simulation=mesh))
    assert found.distance == pytest.approx(0.003)


def test_a_row_stands_for_a_thing_with_all_its_bodies(tmp_path: Path) -> None:
    found = room(np.random.default_rng(0))
    found.put("chest", "chest_of_drawers", (1.3, 0.0, GAP))
    candidate = found.world(tmp_path).candidate
    rows = {r.subject[0]: r for r in shapes.check(candidate)}
    assert set(rows) == {"door", "chest"}
    assert {r.status for r in rows.values()} == {"pass"}
    built = build_entity(candidate.spec, "chest_drawer_2", tmp_path)
    odd = max(built.parts, key=lambda p: float(np.ptp(p.render.vertices, axis=0).max()))
    moved = tuple(
        replace(c, pose=RigidPose(c.pose.position + np.array([0.0, 0.0, 0.05]), c.pose.quaternion)) for c in odd.collision
    )
    if moved[0].points.size:
        moved = tuple(replace(c, points=c.points + np.array([0.0, 0.0, 0.05])) for c in odd.collision)
    bad = found.world(tmp_path, parts={"chest_drawer_2": replace(odd, collision=moved)}).candidate
    row = next(r for r in shapes.check(bad) if r.subject == ("chest",))
    assert row.status == "fail"
    assert row.first_failing_entity == "chest_drawer_2"
    assert row.measured == pytest.approx(0.05, rel=0.05)
    assert row.corrections


def test_things_that_no_generator_made_are_not_asked(tmp_path: Path) -> None:
    assert [r.subject for r in shapes.check(room(np.random.default_rng(0)).world(tmp_path).candidate)] == [("door",)]
