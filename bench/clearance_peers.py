"""Clearances of the same pairs by other libraries: python-fcl, coal, and trimesh with its collision manager.

Each takes a mesh as a soup of triangles: exact where surfaces are apart, without an inside. Where one is not installed
its entry is None, with the reason.
"""

from __future__ import annotations

import importlib
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ..geometry import Forest, Solid, clearance_batch, clearance_series
from ..geometry import batch as batch_route
from ..worlds.arrays import F64, rotation_matrix
from ..worlds.built import TriangleMesh
from .contact_shapes import sphere, torus

__all__ = ["compare"]

SAME = 1e-6
"""Relative to the size: peers this close to the truth are right."""
Poses = tuple[F64, F64]
Peer = Callable[[Solid, Solid, Poses], F64]


class Case(NamedTuple):
    """One kind of pair: b stands at the origin, a at each of the poses."""

    a: Solid
    b: Solid
    poses: Poses


def _solid(mesh: tuple[F64, Any], *, closed: bool = True) -> Solid:
    return Solid.from_mesh(TriangleMesh(*mesh), closed=closed)


def cases(rng: np.random.Generator, count: int) -> dict[str, Case]:
    """Pairs apart, in touch range, overlapping, contained, nested and in an open shell."""

    def poses(offset: F64) -> Poses:
        q = rng.normal(size=(count, 4))
        way = rng.normal(size=(count, 3))
        return offset[:, None] * way / np.linalg.norm(way, axis=1)[:, None], q / np.linalg.norm(q, axis=1)[:, None]

    ball, ring = _solid(sphere(0.5)), _solid(torus(0.5, 0.15))
    vertices, faces = sphere(1.0)
    shell = _solid((vertices, faces))
    inner, back = sphere(0.7)
    hollow = _solid((np.concatenate([vertices, inner]), np.concatenate([faces, back[:, ::-1] + len(vertices)])))
    bowl = _solid((vertices, faces[vertices[faces].mean(axis=1)[:, 2] < 0.2]), closed=False)
    small = _solid(sphere(0.2))
    linked = (
        np.array([0.35, 0, 0]) + rng.uniform(-0.03, 0.03, (count, 3)),
        np.tile([np.sqrt(0.5), np.sqrt(0.5), 0, 0], (count, 1)),
    )
    return {
        "apart": Case(ball, ring, poses(rng.uniform(1.05, 1.5, count))),
        "in touch range": Case(ball, ball, poses(rng.uniform(1.0005, 1.005, count))),
        "linked, not touching": Case(ring, ring, linked),
        "overlapping": Case(ball, ball, poses(rng.uniform(0.7, 0.95, count))),
        "contained": Case(small, shell, poses(rng.uniform(0.0, 0.3, count))),
        "free in a cavity": Case(small, hollow, poses(rng.uniform(0.0, 0.3, count))),
        "in an open bowl": Case(small, bowl, poses(rng.uniform(0.0, 0.2, count))),
    }


def _single(a: Solid, b: Solid, poses: Poses) -> F64:
    return clearance_series(a, poses, b, _still(poses), skip_above=np.inf)


def _still(poses: Poses) -> Poses:
    return np.zeros_like(poses[0]), np.tile([1.0, 0.0, 0.0, 0.0], (len(poses[0]), 1))


def _batched(a: Solid, b: Solid, poses: Poses) -> F64:
    pairs = np.tile([[0, 1]], (len(poses[0]), 1))
    kept, batch_route.EFFORT = batch_route.EFFORT, 0.0
    try:
        return clearance_batch(Forest([a, b]), pairs, poses, _still(poses), skip_above=np.inf).distance
    finally:
        batch_route.EFFORT = kept


def _fcl(a: Solid, b: Solid, poses: Poses) -> F64:
    import fcl

    first, second = fcl.CollisionObject(a.bvh), fcl.CollisionObject(b.bvh)
    found = []
    for position, quaternion in zip(*poses, strict=True):
        first.setTransform(fcl.Transform(quaternion, position))
        value = fcl.distance(first, second, fcl.DistanceRequest(), fcl.DistanceResult())
        if value <= 0.0:
            result = fcl.CollisionResult()
            fcl.collide(first, second, fcl.CollisionRequest(num_max_contacts=10_000, enable_contact=True), result)
            value = -max((c.penetration_depth for c in result.contacts), default=0.0)
        found.append(value)
    return np.array(found)


def _coal(a: Solid, b: Solid, poses: Poses) -> F64:
    import coal

    def model(solid: Solid) -> Any:
        made = coal.BVHModelOBBRSS()
        made.beginModel(len(solid.faces), len(solid.vertices))
        points = coal.StdVec_Vec3s()
        for v in solid.vertices:
            points.append(v)
        triangles = coal.StdVec_Triangle()
        for f in solid.faces:
            triangles.append(coal.Triangle(*(int(i) for i in f)))
        made.addSubModel(points, triangles)
        made.endModel()
        return made

    one, two = model(a), model(b)
    there, here = coal.Transform3s(), coal.Transform3s.Identity()
    found = []
    for position, turn in zip(poses[0], rotation_matrix(poses[1]), strict=True):
        there.setRotation(turn)
        there.setTranslation(position)
        value = coal.distance(one, there, two, here, coal.DistanceRequest(), coal.DistanceResult())
        if value <= 0.0:
            request, result = coal.CollisionRequest(), coal.CollisionResult()
            request.num_max_contacts = 10_000
            coal.collide(one, there, two, here, request, result)
            value = -max((abs(c.penetration_depth) for c in result.getContacts()), default=0.0)
        found.append(value)
    return np.array(found)


def _trimesh(a: Solid, b: Solid, poses: Poses) -> F64:
    import trimesh

    one, two = (trimesh.collision.CollisionManager() for _ in range(2))
    one.add_object("a", trimesh.Trimesh(a.vertices, a.faces, process=False))
    two.add_object("b", trimesh.Trimesh(b.vertices, b.faces, process=False))
    found, place = [], np.eye(4)
    for position, turn in zip(poses[0], rotation_matrix(poses[1]), strict=True):
        place[:3, :3], place[:3, 3] = turn, position
        one.set_transform("a", place)
        value = one.min_distance_other(two)
        if value <= 0.0:
            _, contacts = one.in_collision_other(two, return_data=True)
            value = -max((c.depth for c in contacts), default=0.0)
        found.append(value)
    return np.array(found)


OURS: dict[str, Peer] = {"single": _single, "batched": _batched}
PEERS: dict[str, tuple[str, Peer]] = {"fcl": ("fcl", _fcl), "coal": ("coal", _coal), "trimesh": ("trimesh", _trimesh)}


def _verdict(found: F64, truth: F64, size: float) -> dict[str, Any]:
    """Comparison of the answers with the truth."""
    overlap = truth < 0.0
    wrong = np.abs(found - truth) > np.where(overlap, 0.01 * np.abs(truth), SAME * size)
    classes = {
        "right": ~wrong,
        "depth too small": wrong & overlap & (found < 0.0),
        "overlap reported as touching": wrong & overlap & (found == 0.0),
        "overlap reported as apart": wrong & overlap & (found > 0.0),
        "distance wrong": wrong & ~overlap,
    }
    return {
        "answers": {name: int(rows.sum()) for name, rows in classes.items() if rows.any()},
        "rel_error": float((np.abs(found - truth) / np.maximum(np.abs(truth), 1e-300)).max()),
    }


def _timed(ask: Peer, case: Case, rounds: int) -> tuple[F64, float]:
    """Answers and the least time per pair [us]."""
    spent, values = np.inf, ask(*case)
    for _ in range(rounds):
        start = time.perf_counter()
        values = ask(*case)
        spent = min(spent, time.perf_counter() - start)
    return values, 1e6 * spent / len(case.poses[0])


def compare(rng: np.random.Generator, *, count: int = 100, rounds: int = 1) -> dict[str, Any]:
    """Answers and times [us per pair] of both own routes and of every peer, per kind of pair."""
    missing: dict[str, str] = {}
    for name, (module, _) in PEERS.items():
        try:
            importlib.import_module(module)
        except ImportError as error:
            missing[name] = f"{error}; pip install 'worldagent[bench]'"
    table: dict[str, Any] = {}
    for kind, case in cases(rng, count).items():
        truth = _single(*case)
        row: dict[str, Any] = {}
        for name, ask in {**OURS, **{n: p for n, (_, p) in PEERS.items()}}.items():
            if name in missing:
                row[name] = None
                continue
            values, spent = _timed(ask, case, rounds)
            row[name] = {"us_per_pair": spent, **_verdict(values, truth, case.a.size + case.b.size)}
        table[kind] = row
    return {"pairs_per_kind": count, "kinds": table, "missing": missing}
