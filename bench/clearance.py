"""Benchmark `clearance`: exactness against analytic cases, and answers and speed beside python-fcl, coal and trimesh."""

from __future__ import annotations

import math
import statistics
import time
from typing import Any

import numpy as np

from ..geometry import Solid, clearance_series, signed_clearance
from ..worlds.arrays import F64, I32, RigidPose, quaternion_product, rotation_matrix
from ..worlds.built import TriangleMesh
from .clearance_peers import compare

__all__ = ["box_mesh", "run"]

FRAMES = 240
ROUNDS = 15
DOMINO = (0.012, 0.036, 0.07)
"""Thickness, width, height [m]."""


def box_mesh(size: tuple[float, float, float]) -> tuple[F64, I32]:
    """Vertices and triangles of a box about the origin, edges `size` [m]."""
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]) * size
    faces = [
        *((0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)),
        *((2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)),
    ]
    return corners, np.array(faces, dtype=np.int32)


def _box(size: tuple[float, float, float]) -> Solid:
    return Solid.from_mesh(TriangleMesh(*box_mesh(size)), closed=True)


def _frame(inner: float, outer: float, height: float) -> Solid:
    """A square picture frame: not convex, with a hole."""
    ring = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    flat = np.concatenate([ring * outer, ring * inner])
    corners = np.concatenate([np.c_[flat, np.full(8, -height / 2)], np.c_[flat, np.full(8, height / 2)]])
    quads = []
    for k in range(4):
        n = (k + 1) % 4
        quads += [(k, n, n + 8, k + 8), (n + 4, k + 4, k + 12, n + 12), (k + 8, n + 8, n + 12, k + 12), (n, k, k + 4, n + 4)]
    faces = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return Solid.from_mesh(TriangleMesh(corners, np.array(faces, dtype=np.int32)), closed=True)


def _turns(rng: np.random.Generator, count: int) -> F64:
    q = rng.normal(size=(count, 4))
    return np.asarray(q / np.linalg.norm(q, axis=1)[:, None])


def _separated_error(rng: np.random.Generator) -> float:
    """Largest relative error over tilted boxes hung over a big one by a corner: the gap is known from the support."""
    table, worst = _box((9.0, 9.0, 1.0)), 0.0
    for q in _turns(rng, 200):
        size, gap = rng.uniform(0.05, 1.0, 3), 10.0 ** rng.uniform(-4, 0)
        reach = float(np.abs(rotation_matrix(q)[2]) @ size / 2)
        pose = RigidPose(np.array([*rng.uniform(-3, 3, 2), 0.5 + gap + reach]), q)
        found = signed_clearance(_box(tuple(size)), pose, table, RigidPose(np.zeros(3), np.array([1.0, 0, 0, 0])))
        worst = max(worst, abs(found.distance - gap) / gap)
    return worst


def _depth_error(rng: np.random.Generator) -> float:
    """Largest relative error over dips into a table, by a tilted box and by a frame that is not convex, and containment."""
    table, still = _box((9.0, 9.0, 4.0)), RigidPose(np.zeros(3), np.array([1.0, 0, 0, 0]))
    worst = 0.0
    for k, q in enumerate(_turns(rng, 60)):
        thing = _frame(0.3, 0.5, 0.2) if k % 3 == 0 else _box(tuple(rng.uniform(0.2, 1.0, 3)))
        reach = -float((thing.vertices @ rotation_matrix(q)[2]).min())
        depth = 10.0 ** rng.uniform(-4, -0.5)
        pose = RigidPose(np.array([*rng.uniform(-3, 3, 2), 2.0 + reach - depth]), q)
        found = signed_clearance(thing, pose, table, still).distance
        worst = max(worst, abs(found + depth) / depth)
        inside = RigidPose(np.array([0.0, 0.0, 0.5]), q)
        # The deepest point of a body wholly inside is its lowest: nearest to the middle, 2 m below the top.
        low = 0.5 - reach
        found = signed_clearance(thing, inside, table, still).distance
        heights = 2.0 - np.abs(np.clip(0.0, low, 0.5 + float((thing.vertices @ rotation_matrix(q)[2]).max())))
        if k % 3 != 0 and low <= 0.0:
            worst = max(worst, abs(found + heights) / heights)
    for thing in (_frame(0.3, 0.5, 0.2), _box((1.0, 1.0, 0.2))):
        worst = max(worst, _inclined_edge_error(thing))
    return worst


def _inclined_edge_error(thing: Solid) -> float:
    """Relative error where no vertex is the deepest point.

    The edge at y = -0.5, z = -0.1 of `thing`, turned lowest and inclined by `slope`, cuts a post of width w from depth d
    on one side. Along it the distance to the top, d + slope x, meets that to the far side, w - x: the depth there.
    """
    width, start, slope = 0.2, 0.05, 0.3
    turned, tilted = math.pi / 8, math.atan(slope) / 2
    about_x, about_y = np.array([math.cos(turned), math.sin(turned), 0, 0]), np.array([math.cos(tilted), 0, math.sin(tilted), 0])
    quaternion = quaternion_product(about_y, about_x)
    a, b = (rotation_matrix(quaternion) @ np.array([x, -0.5, -0.1]) for x in (-0.5, 0.5))
    middle = a + (b - a) * 0.4
    pose = RigidPose(np.array([0.0, 0.0, -start]) - middle, quaternion)
    post = RigidPose(np.array([width / 2, 0.0, -2.0]), np.array([1.0, 0, 0, 0]))
    expected = start + slope * (width - start) / (1.0 + slope)
    found = signed_clearance(thing, pose, _box((width, 4.0, 4.0)), post).distance
    return abs(found + expected) / expected


def _speed(rng: np.random.Generator) -> tuple[float, float, float]:
    """Medians [microseconds per pair] of ours and of fcl's distance of the same tumbling dominoes, and their difference [m]."""
    import fcl

    domino = _box(DOMINO)
    quaternions = _turns(rng, FRAMES)
    heading = rng.normal(size=(FRAMES, 3))
    heading /= np.linalg.norm(heading, axis=1)[:, None]
    positions = heading * rng.uniform(0.09, 0.12, (FRAMES, 1))
    still = np.zeros((FRAMES, 3)), np.tile([1.0, 0.0, 0.0, 0.0], (FRAMES, 1))
    first, second = fcl.CollisionObject(domino.bvh), fcl.CollisionObject(domino.bvh)
    request = fcl.DistanceRequest()
    ours, theirs = [], []
    mine, peer = np.empty(FRAMES), np.empty(FRAMES)
    for _ in range(ROUNDS):
        start = time.perf_counter()
        mine = clearance_series(domino, (positions, quaternions), domino, still, skip_above=math.inf)
        ours.append(time.perf_counter() - start)
        start = time.perf_counter()
        for k in range(FRAMES):
            first.setTransform(fcl.Transform(quaternions[k], positions[k]))
            peer[k] = fcl.distance(first, second, request, fcl.DistanceResult())
        theirs.append(time.perf_counter() - start)
    unit = 1e6 / FRAMES
    return statistics.median(ours) * unit, statistics.median(theirs) * unit, float(np.abs(mine - peer).max())


def run() -> dict[str, Any]:
    """Measure; prints nothing."""
    rng = np.random.default_rng(0)
    ours, theirs, difference = _speed(rng)
    return {
        "name": "clearance",
        "rel_error_separated": _separated_error(rng),
        "rel_error_depth": _depth_error(rng),
        "ratio_vs_fcl": ours / theirs,
        "us_per_pair": ours,
        "fcl_us_per_pair": theirs,
        "difference_from_fcl_m": difference,
        "peers": compare(rng),
    }
