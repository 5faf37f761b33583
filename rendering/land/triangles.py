"""Triangles of landscapes."""

from __future__ import annotations

import numpy as np

from ...worlds.arrays import F64
from ...worlds.landscape import SavedLandscape

__all__ = ["grid_faces", "grid_uv", "top_of"]


def grid_faces(rows: int, cols: int, keep: np.ndarray) -> np.ndarray:
    """Two triangles for every cell of corners that `keep`, shape (rows - 1, cols - 1), lets stand."""
    index = np.arange(rows * cols).reshape(rows, cols)
    a, b, c, d = (x[keep] for x in (index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]))
    return np.concatenate([np.stack([a, b, d], 1), np.stack([a, d, c], 1)])


def grid_uv(land: SavedLandscape, vertices: F64) -> F64:
    """Texture coordinates in a picture of the whole landscape, shape (n, 2)."""
    extent = np.array([land.shape[1], land.shape[0]]) * land.cell
    return np.asarray(vertices[:, :2] / extent + 0.5)


def top_of(vertices: F64, faces: np.ndarray) -> tuple[F64, np.ndarray]:
    """The upper surface of a solid ground: corners and triangles that face upwards."""
    a, b, c = (vertices[faces[:, k], :2] for k in range(3))
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    upward = faces[area > 1e-9 * np.abs(area).max()]
    used, numbers = np.unique(upward, return_inverse=True)
    return vertices[used], numbers.reshape(-1, 3)
