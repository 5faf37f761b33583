"""Lays a liquid's surface onto the walls it touches, so that no air shows between water and glass."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...geometry.launch import launch, warp
from ...worlds.arrays import F64
from ...worlds.built import TriangleMesh

__all__ = ["fit_to_sides", "fit_to_walls"]

NEAR, FAR = 0.45, 0.85
"""Vertices up to NEAR spacings from a wall are laid onto it, from FAR on they stay; own choice: half a spacing and some."""
OVERLAP = 0.02
"""How far they reach into the wall, in spacings: light then never meets air between them."""
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
    walls = [w for w in walls if len(w.faces)]
    if not walls or not len(vertices):
        return vertices
    from .wall_kernels import nearest_wall

    wp = warp()
    starts = np.cumsum([0, *(len(w.vertices) for w in walls)])
    origin = vertices.mean(0)
    corners = np.concatenate([w.vertices for w in walls]) - origin
    faces = np.concatenate([w.faces + start for w, start in zip(walls, starts, strict=False)])
    low, high = vertices.min(0) - origin - FAR * spacing, vertices.max(0) - origin + FAR * spacing
    corner = corners[faces]
    faces = faces[((corner.max(1) >= low) & (corner.min(1) <= high)).all(1)]
    if not len(faces):
        return vertices
    mesh = wp.Mesh(
        wp.array(corners.astype(np.float32), dtype=wp.vec3f, device="cpu"),
        wp.array(faces.astype(np.int32).reshape(-1), dtype=wp.int32, device="cpu"),
    )
    count = len(vertices)
    points = wp.array((vertices - origin).astype(np.float32), dtype=wp.vec3f, device="cpu")
    place, outward = wp.zeros(count, dtype=wp.vec3f, device="cpu"), wp.zeros(count, dtype=wp.vec3f, device="cpu")
    sign = wp.zeros(count, dtype=wp.float32, device="cpu")
    launch(nearest_wall, count, [mesh.id, float(FAR * spacing), points, place, sign, outward], device="cpu")
    side = sign.numpy().astype(np.float64)
    gap = vertices - (place.numpy().astype(np.float64) + origin)
    length = np.linalg.norm(gap, axis=1)
    # On the wall itself the way to it has no direction: there the face has.
    near = length < 1e-3 * spacing
    away = np.where(near[:, None], outward.numpy().astype(np.float64), (side / np.maximum(length, 1e-12))[:, None] * gap)
    moved = _shifted(vertices, normals, side * length, away, spacing)
    return np.where((side != 0)[:, None], moved, vertices)
