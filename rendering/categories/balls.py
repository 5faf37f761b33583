"""Meshes of many small balls."""

from __future__ import annotations

import numpy as np

from ...worlds.arrays import F64, I32

__all__ = ["fine_balls", "joined_balls"]


def joined_balls(center: F64, radius: F64) -> tuple[F64, I32]:
    """One mesh of small icosahedra: vertices (12 n, 3), faces (20 n, 3)."""
    corner, faces = _icosahedron()
    vertices = center[:, None] + corner[None] * np.broadcast_to(radius, len(center))[:, None, None]
    number = faces[None] + 12 * np.arange(len(center), dtype=np.int32)[:, None, None]
    return vertices.reshape(-1, 3), number.reshape(-1, 3).astype(np.int32)


def fine_balls(center: F64, radius: F64) -> tuple[F64, F64, I32]:
    """Balls of 42 vertices each: positions, normals, faces."""
    corner, faces = joined_balls(np.zeros((1, 3)), np.ones(1))
    edges: dict[tuple[int, int], int] = {}
    points, finer = [*corner], []

    def middle(a: int, b: int) -> int:
        key = (min(a, b), max(a, b))
        if key not in edges:
            point = points[a] + points[b]
            edges[key] = len(points)
            points.append(point / np.linalg.norm(point))
        return edges[key]

    for a, b, c in faces.tolist():
        ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
        finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
    unit, triangles = np.array(points), np.array(finer, dtype=np.int32)
    vertices = center[:, None] + unit[None] * radius[:, None, None]
    number = triangles[None] + len(unit) * np.arange(len(center), dtype=np.int32)[:, None, None]
    return vertices.reshape(-1, 3), np.tile(unit, (len(center), 1)), number.reshape(-1, 3).astype(np.int32)


def _icosahedron() -> tuple[F64, I32]:
    g = (1 + 5**0.5) / 2
    corner = np.array([[-1, g, 0], [1, g, 0], [-1, -g, 0], [1, -g, 0], [0, -1, g], [0, 1, g],
                       [0, -1, -g], [0, 1, -g], [g, 0, -1], [g, 0, 1], [-g, 0, -1], [-g, 0, 1]], dtype=np.float64)  # fmt: skip
    faces = [[0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6], [7, 1, 8],
             [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1]]  # fmt: skip
    return corner / np.linalg.norm(corner[0]), np.array(faces, dtype=np.int32)
