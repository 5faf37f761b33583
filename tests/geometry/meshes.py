"""Meshes with known answers and an independent brute force, shared by the geometry tests."""

from __future__ import annotations

import math

import numpy as np
import trimesh
from worldagent.geometry import Solid
from worldagent.worlds.arrays import RigidPose
from worldagent.worlds.built import TriangleMesh


def mesh_of(shape: trimesh.Trimesh) -> TriangleMesh:
    return TriangleMesh(np.asarray(shape.vertices, dtype=np.float64), np.asarray(shape.faces, dtype=np.int32))


def solid_of(shape: trimesh.Trimesh, *, closed: bool = True) -> Solid:
    return Solid.from_mesh(mesh_of(shape), closed=closed)


def box(x: float, y: float, z: float) -> Solid:
    return solid_of(trimesh.creation.box((x, y, z)))


def ball(radius: float, detail: int = 2) -> Solid:
    return solid_of(trimesh.creation.icosphere(subdivisions=detail, radius=radius))


def ring(inner: float = 0.3, outer: float = 0.6, height: float = 0.3) -> Solid:
    return solid_of(trimesh.creation.annulus(inner, outer, height, sections=10))


def hull(rng: np.random.Generator) -> Solid:
    return solid_of(trimesh.convex.convex_hull(rng.normal(size=(10, 3)) * 0.4))


def at(x: float = 0.0, y: float = 0.0, z: float = 0.0, *, quaternion: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0)) -> RigidPose:
    q = np.array(quaternion)
    return RigidPose(np.array([x, y, z]), q / np.linalg.norm(q))


def random_pose(rng: np.random.Generator, spread: float) -> RigidPose:
    q = rng.normal(size=4)
    return RigidPose(rng.normal(size=3) * spread, q / np.linalg.norm(q))


def _point_triangle(p: np.ndarray, t: np.ndarray) -> float:
    """Region by region after Ericson, Real-Time Collision Detection (2005), 5.1.5: another route than the code."""
    a, b, c = t
    ab, ac, ap = b - a, c - a, p - a
    d1, d2 = ab @ ap, ac @ ap
    if d1 <= 0 and d2 <= 0:
        return math.dist(p, a)
    d3, d4 = ab @ (p - b), ac @ (p - b)
    if d3 >= 0 and d4 <= d3:
        return math.dist(p, b)
    vc = d1 * d4 - d3 * d2
    if vc <= 0 and d1 >= 0 and d3 <= 0:
        return math.dist(p, a + d1 / (d1 - d3) * ab)
    d5, d6 = ab @ (p - c), ac @ (p - c)
    if d6 >= 0 and d5 <= d6:
        return math.dist(p, c)
    vb = d5 * d2 - d1 * d6
    if vb <= 0 and d2 >= 0 and d6 <= 0:
        return math.dist(p, a + d2 / (d2 - d6) * ac)
    va = d3 * d6 - d5 * d4
    if va <= 0 and d4 - d3 >= 0 and d5 - d6 >= 0:
        return math.dist(p, b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b))
    n = np.cross(ab, ac)
    return abs(ap @ n) / float(np.linalg.norm(n))


def _segments(p: np.ndarray, p2: np.ndarray, q: np.ndarray, q2: np.ndarray) -> float:
    """Least of the interior solution of the 2 x 2 normal equations and the four end points."""
    u, v, r = p2 - p, q2 - q, p - q
    best = math.inf
    matrix = np.array([[u @ u, -(u @ v)], [-(u @ v), v @ v]])
    if np.linalg.det(matrix) > 1e-12 * matrix[0, 0] * matrix[1, 1]:
        s, t = np.linalg.solve(matrix, [-(u @ r), v @ r])
        if 0 <= s <= 1 and 0 <= t <= 1:
            best = math.dist(p + s * u, q + t * v)
    for x, a, d in ((p, q, v), (p2, q, v), (q, p, u), (q2, p, u)):
        k = min(1.0, max(0.0, (x - a) @ d / (d @ d)))
        best = min(best, math.dist(x, a + k * d))
    return best


def brute_distance(a: Solid, pose_a: RigidPose, b: Solid, pose_b: RigidPose) -> float:
    """Distance of two surfaces that do not cross, by all features in plain loops."""
    va, vb = pose_a.apply(a.vertices), pose_b.apply(b.vertices)
    best = min(_point_triangle(p, vb[f]) for p in va for f in b.faces)
    best = min(best, *(_point_triangle(p, va[f]) for p in vb for f in a.faces))
    return min(best, *(_segments(*va[e], *vb[g]) for e in a.edges for g in b.edges))


def brute_depth(a: Solid, pose_a: RigidPose, b: Solid, pose_b: RigidPose, density: int) -> float:
    """Lower bound of the depth: dense samples, inside by ray parity, distance by projection on sampled planes."""
    best = 0.0
    i, j = np.meshgrid(np.arange(density + 1), np.arange(density + 1))
    u, v = (x[i + j <= density] / density for x in (i, j))
    for one, pose_one, two, pose_two in ((a, pose_a, b, pose_b), (b, pose_b, a, pose_a)):
        back = pose_two.inverse()
        t = back.apply(pose_one.apply(one.vertices))[one.faces]
        points = (
            t[:, None, 0] + u[None, :, None] * (t[:, 1] - t[:, 0])[:, None] + v[None, :, None] * (t[:, 2] - t[:, 0])[:, None]
        ).reshape(-1, 3)
        points = points[((points > two.lower) & (points < two.upper)).all(axis=1)]
        points = points[_parity(two, points)]
        for p in points[:: max(1, len(points) // 60)]:
            best = max(best, min(_point_triangle(p, x) for x in two.triangles))
    return best


def _parity(solid: Solid, points: np.ndarray) -> np.ndarray:
    ray = np.array([0.3127, 0.7411, 0.5936])
    t = solid.triangles
    e1, e2 = t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]
    h = np.cross(ray, e2)
    det = np.einsum("ij,ij->i", e1, h)
    s = points[:, None] - t[None, :, 0]
    u = np.einsum("pfi,fi->pf", s, h) / det
    q = np.cross(s, e1[None])
    v = q @ ray / det
    w = np.einsum("pfi,fi->pf", q, e2) / det
    return ((u >= 0) & (v >= 0) & (u + v <= 1) & (w > 0)).sum(axis=1) % 2 == 1
