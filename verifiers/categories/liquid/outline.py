"""Shape of a liquid without a surface mesh, as pictures see it: the cells that its particles fill."""

from __future__ import annotations

import numpy as np

from ....worlds.arrays import F64
from ....worlds.built import TriangleMesh

__all__ = ["filled_cells"]

FACES = (
    *(((-1, 0, 0), ((0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0))), ((1, 0, 0), ((1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)))),
    *(((0, -1, 0), ((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1))), ((0, 1, 0), ((0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0)))),
    *(((0, 0, -1), ((0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0))), ((0, 0, 1), ((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)))),
)
"""Neighbour across each face of a unit cube, and the face's corners, counter-clockwise from outside."""


def filled_cells(points: F64, size: float) -> TriangleMesh:
    """Outer faces of the cubes of a grid that hold a point.

    Args:
        points: shape (n, 3) [m].
        size: edge of a cube [m].
    """
    if not len(points):
        return TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int32))
    low = np.floor(points.min(axis=0) / size).astype(np.int64) - 1
    shape = np.floor(points.max(axis=0) / size).astype(np.int64) - low + 2
    cells = np.unique(np.floor(points / size).astype(np.int64) - low, axis=0)
    weight = np.array([shape[1] * shape[2], shape[2], 1])
    keys = cells @ weight
    corners = []
    for step, square in FACES:
        other = keys + np.array(step) @ weight
        place = np.minimum(np.searchsorted(keys, other), len(keys) - 1)
        open_cells = cells[keys[place] != other]
        corners.append(open_cells[:, None] + np.array(square))
    quads = (np.concatenate(corners) + low) * size
    first = 4 * np.arange(len(quads))[:, None]
    faces = np.concatenate([first + np.array([0, 1, 2]), first + np.array([0, 2, 3])]).astype(np.int32)
    return TriangleMesh(quads.reshape(-1, 3), faces)
