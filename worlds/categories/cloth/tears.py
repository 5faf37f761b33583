"""Sheets that can tear: one vertex per corner of each triangle, and which corners are one as long as edges between them hold.

Triangle t has the corners 3 t, 3 t + 1, 3 t + 2. The side from a corner to the next has the number of that corner. A sheet hangs
together along sides that meet another triangle's and are not open: a point alone holds nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...arrays import F64, I32
from ...errors import InputError

__all__ = ["Flags", "Seams", "corners_of", "following", "seams_of", "welded"]

Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Seams:
    """Joins of the corners of a whole sheet."""

    kin: I32
    """Vertex of the whole sheet at each corner, shape (3 t,)."""
    mate: I32
    """The side of another triangle that lies along each side; -1 at a rim; shape (3 t,)."""


def corners_of(vertices: F64, faces: I32) -> tuple[F64, I32]:
    """The same surface with a vertex for every corner: vertices (3 t, 3), faces (t, 3)."""
    return vertices[faces.ravel()], np.arange(faces.size, dtype=np.int32).reshape(-1, 3)


def following(corner: I32) -> I32:
    """The next corner of the same triangle."""
    return np.asarray(corner - corner % 3 + (corner + 1) % 3, dtype=np.int32)


def seams_of(corners: F64) -> Seams:
    """Joins of corners (3 t, 3) [m] at rest: those at the same place are one.

    Raises:
        InputError: a side meets more than one other side, triangles face different ways, or meet in a point alone.
    """
    _, first, place_of = np.unique(corners, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(np.argsort(first, kind="stable"), kind="stable")
    kin: I32 = np.asarray(order[place_of.ravel()], dtype=np.int32)
    side = np.arange(len(corners), dtype=np.int32)
    start, end = kin.astype(np.int64), kin[following(side)].astype(np.int64)
    key, back = start * len(corners) + end, end * len(corners) + start
    if len(np.unique(key)) != len(key):
        raise InputError(
            "a sheet that can tear has an edge with three triangles, or triangles that face different ways; mend the mesh"
        )
    row = np.argsort(key, kind="stable")
    place = np.minimum(np.searchsorted(key, back, sorter=row), len(key) - 1)
    mate: I32 = np.asarray(np.where(key[row[place]] == back, row[place], -1), dtype=np.int32)
    seams = Seams(kin, mate)
    if int(welded(seams, np.zeros(len(corners), dtype=bool)).max()) != int(kin.max()):
        raise InputError("triangles of a sheet that can tear meet in a point alone; let them share an edge, or split the vertex")
    return seams


def welded(seams: Seams, opened: Flags) -> I32:
    """Vertex of every corner where some sides are open: numbers from 0 in the order of first appearance, shape (3 t,)."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    side = np.flatnonzero((seams.mate >= 0) & ~opened).astype(np.int32)
    mate, count = seams.mate[side], len(seams.kin)
    rows, columns = np.concatenate([side, following(side)]), np.concatenate([following(mate), mate])
    graph = coo_array((np.ones(len(rows), dtype=np.int8), (rows, columns)), shape=(count, count))
    label = connected_components(graph, directed=False)[1]
    _, first, number = np.unique(label, return_index=True, return_inverse=True)
    return np.asarray(np.argsort(np.argsort(first, kind="stable"), kind="stable")[number.ravel()], dtype=np.int32)
