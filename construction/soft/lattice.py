"""The lattice of an elastic body: how many cells, and the tetrahedra of its blocks."""

from __future__ import annotations

import itertools
import math

import numpy as np

from ...worlds.arrays import F64, I32
from ...worlds.errors import LimitError
from ...worlds.simulation_mesh import volumes

__all__ = ["LATTICE_CELLS", "block_tets", "cells_of", "grid_points", "outer_faces"]

LATTICE_CELLS = 512
"""Most cells of one elastic body: 729 nodes per 64 cells and 30 ms per step there on one core (measured, MuJoCo 4.0.0)."""
SLENDER = 4.0
"""Own choice: a body this many times longer than thin bends as a beam or plate, and one cell across follows that."""


def cells_of(extent: F64, resolution: float | None) -> tuple[int, int, int]:
    """Cells along x, y, z of a body's box of these extents [m].

    Raises:
        LimitError: there would be more than `LATTICE_CELLS`.
    """
    least, most = float(extent.min()), float(extent.max())
    edge = resolution or (least if most > SLENDER * least else least / 2)
    cells = [max(1, math.ceil(float(e) / edge - 1e-6)) for e in extent]
    count = math.prod(cells)
    if count > LATTICE_CELLS:
        wanted = (float(np.prod(extent)) / LATTICE_CELLS) ** (1 / 3)
        raise LimitError(
            f"cells of {edge:g} m fill a body of {', '.join(f'{e:g}' for e in extent)} m with {count} cells, at most "
            f"{LATTICE_CELLS} are possible; raise physics.resolution to about {wanted:.3g} m"
        )
    return (cells[0], cells[1], cells[2])


def grid_points(low: F64, high: F64, counts: tuple[int, int, int]) -> F64:
    """Corners of a grid of `counts` blocks in a box, z fastest, shape (n, 3)."""
    axes = [np.linspace(a, b, c + 1) for a, b, c in zip(low, high, counts, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def block_tets(counts: tuple[int, int, int], points: F64) -> I32:
    """Six tetrahedra per block of a grid, the same way round in each (H. Freudenthal), of positive volume; shape (k, 4)."""
    index = np.arange(len(points)).reshape([c + 1 for c in counts])
    found = []
    for order in itertools.permutations(range(3)):
        at = [0, 0, 0]
        corners = [tuple(at)]
        for axis in order:
            at[axis] = 1
            corners.append(tuple(at))
        own = [index[tuple(slice(c, c + n) for c, n in zip(corner, counts, strict=True))].reshape(-1) for corner in corners]
        found.append(np.stack(own, axis=1))
    tets = np.stack(found, axis=1).reshape(-1, 4)
    wrong = volumes(points, tets.astype(np.int32)) < 0
    tets[wrong] = tets[wrong][:, [0, 1, 3, 2]]
    return tets.astype(np.int32)


def outer_faces(tets: I32) -> I32:
    """Faces of tetrahedra that no second one shares, outward, shape (m, 3)."""
    faces = np.concatenate([tets[:, [1, 2, 3]], tets[:, [0, 3, 2]], tets[:, [0, 1, 3]], tets[:, [0, 2, 1]]])
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    outer: I32 = faces[np.sort(first[count == 1])]
    return outer
