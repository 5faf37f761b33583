"""Lays a liquid's surface onto the walls it touches, so that no air shows between water and glass."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...geometry.launch import launch, warp
from ...worlds.arrays import F64
from ...worlds.built import TriangleMesh

__all__ = ["fit_to_sides", "fit_to_walls", "off_sides", "off_walls"]

NEAR, FAR = 0.45, 0.85
"""Vertices up to NEAR spacings from a wall are laid onto it, from FAR on they stay; own choice: half a spacing and some."""
OVERLAP = 0.02
"""Length by which they reach into the wall, in spacings: light then never meets air between them."""
FACING = (-0.2, 0.3)
"""Cosine between the surface's outward normal and the way to the wall: from none to all of the shift."""


def _step(value: F64, low: float, high: float) -> F64:
    t = np.clip((value - low) / (high - low), 0.0, 1.0)
    return np.asarray(t * t * (3 - 2 * t))


def _shifted(vertices: F64, normals: F64, distance: F64, away: F64, spacing: float) -> F64:
    """Vertices moved along `away` (from the wall) to its surface, by how near and how much they face it."""
    facing = -(normals * away).sum(1)
    weight = _step(facing, *FACING) * (1 - _step(np.abs(distance) / spacing, NEAR, FAR))
    return np.asarray(vertices + (weight * (-OVERLAP * spacing - distance))[:, None] * away)


def fit_to_sides(vertices: F64, normals: F64, lower: F64, upper: F64, closed: Sequence[bool], spacing: float) -> F64:
    """Fit to the closed sides of a domain (order -x, +x, -y, +y, -z, +z); see `fit_to_walls`."""
    for k in range(6):
        if not closed[k]:
            continue
        away = np.zeros_like(vertices)
        axis, high = divmod(k, 2)
        away[:, axis] = -1.0 if high else 1.0
        distance = upper[axis] - vertices[:, axis] if high else vertices[:, axis] - lower[axis]
        vertices = _shifted(vertices, normals, distance, away, spacing)
    return vertices


def fit_to_walls(vertices: F64, normals: F64, walls: Sequence[TriangleMesh], spacing: float) -> F64:
    """Move vertices that face a wall within half a spacing onto it.

    Args:
        vertices: of the liquid's surface (v, 3) [m].
        normals: outward of the liquid (v, 3).
        walls: solids in the same frame, outward.
        spacing: distance of particles at rest [m].
    """
    distance, away = _from_walls(vertices, walls, FAR * spacing, 1e-3 * spacing)
    near = np.isfinite(distance)
    moved = _shifted(vertices[near], normals[near], distance[near], away[near], spacing)
    found = vertices.copy()
    found[near] = moved
    return found


def off_walls(points: F64, walls: Sequence[TriangleMesh], reach: float, deep: float) -> NDArray[np.bool_]:
    """Points (n, 3) farther than `reach` [m] outside every wall; none of them is more than `deep` [m] inside one."""
    return np.asarray(_from_walls(points, walls, max(reach, deep), 1e-9)[0] > reach)


def off_sides(points: F64, lower: F64, upper: F64, closed: Sequence[bool], reach: float) -> NDArray[np.bool_]:
    """Points (n, 3) farther than `reach` [m] from the closed sides of a domain."""
    found = np.ones(len(points), dtype=bool)
    for axis in range(3):
        found &= (not closed[2 * axis]) | (points[:, axis] - lower[axis] > reach)
        found &= (not closed[2 * axis + 1]) | (upper[axis] - points[:, axis] > reach)
    return found


def _from_walls(points: F64, walls: Sequence[TriangleMesh], reach: float, touching: float) -> tuple[F64, F64]:
    """Signed distance to the walls (inf beyond `reach`, negative inside) and unit vector away from them."""
    none = np.full(len(points), np.inf), np.zeros((len(points), 3))
    walls = [w for w in walls if len(w.faces)]
    if not walls or not len(points):
        return none
    from .filling_kernels import nearest_places

    wp = warp()
    starts = np.cumsum([0, *(len(w.vertices) for w in walls)])
    origin = points.mean(0)
    corners = np.concatenate([w.vertices for w in walls]) - origin
    faces = np.concatenate([w.faces + start for w, start in zip(walls, starts, strict=False)])
    low, high = points.min(0) - origin - reach, points.max(0) - origin + reach
    corner = corners[faces]
    faces = faces[((corner.max(1) >= low) & (corner.min(1) <= high)).all(1)]
    if not len(faces):
        return none
    mesh = wp.Mesh(
        wp.array(corners.astype(np.float32), dtype=wp.vec3f, device="cpu"),
        wp.array(faces.astype(np.int32).reshape(-1), dtype=wp.int32, device="cpu"),
    )
    count = len(points)
    asked = wp.array((points - origin).astype(np.float32), dtype=wp.vec3f, device="cpu")
    place, outward = (wp.zeros(count, dtype=wp.vec3f, device="cpu") for _ in range(2))
    face = wp.zeros(count, dtype=wp.int32, device="cpu")
    sign = wp.zeros(count, dtype=wp.float32, device="cpu")
    launch(nearest_places, count, [mesh.id, asked, float(reach), place, face, sign, outward], device="cpu")
    side = sign.numpy().astype(np.float64)
    gap = points - (place.numpy().astype(np.float64) + origin)
    length = np.linalg.norm(gap, axis=1)
    # On the wall itself the way to it has no direction: there the face has.
    near = length < touching
    away = np.where(near[:, None], outward.numpy().astype(np.float64), (side / np.maximum(length, 1e-12))[:, None] * gap)
    return np.where(side == 0, np.inf, side * length), away
