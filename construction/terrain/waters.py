"""Water of a landscape as a liquid: the volume between its level and the ground (R38, R57)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from ...worlds.built import TriangleMesh
from ...worlds.errors import InputError
from ...worlds.landscape import SavedLandscape
from .grid import Grid

__all__ = ["WaterBody", "water_body"]

REACH = 1.5
"""The level goes on so many cells of the landscape beyond its wet ones, so that the shore lies where level and ground meet."""
LEAST_DEPTH = 1e-6
"""[m] Shallower places are dry."""
MOST = (20_000, 40_000)
"""Vertices and faces that a specification takes inline."""


@dataclass(frozen=True)
class WaterBody:
    """Water inside a rectangle of a landscape."""

    mesh: TriangleMesh
    """Closed, in world coordinates."""
    volume: float
    """[m^3]"""
    x: F64
    y: F64
    ground: F64
    """Heights of the cut (rows, cols) [m]."""
    level: F64
    """Level of the water, NaN where there is none near (rows, cols) [m]."""


def water_body(land: SavedLandscape, x: F64, y: F64, ground: F64) -> WaterBody:
    """The water over a ground that was cut from a landscape.

    Each cell of the ground is cut along its diagonal from south-west to north-east, as the ground is; triangles end at the shore.

    Args:
        land: the landscape.
        x: of the ground's columns [m].
        y: of its rows [m].
        ground: its heights, shape (rows, cols) [m].

    Raises:
        InputError: there is no water, or its surface has too many corners.
    """
    from scipy import ndimage

    grid = Grid(*land.shape, land.cell)
    there = land.field("water_level")
    wet = land.raw("wet").astype(bool) & np.isfinite(there)
    if not wet.any():
        raise InputError(
            "this landscape holds no water; ask for it under /terrains/<id>/hydrology/required, or choose another place"
        )
    far, nearest = ndimage.distance_transform_edt(~wet, return_indices=True)
    full = there[nearest[0], nearest[1]]
    east, north = grid.axes()
    at = np.stack(np.meshgrid((y - north[0]) / grid.cell, (x - east[0]) / grid.cell, indexing="ij"))
    level = ndimage.map_coordinates(full, at, order=1, mode="nearest")
    near = ndimage.map_coordinates(far, at, order=1, mode="nearest") <= REACH
    mesh = _between(x, y, ground, level, near)
    corner = mesh.vertices[mesh.faces]
    volume = float(np.einsum("ij,ij->i", corner[:, 0], np.cross(corner[:, 1], corner[:, 2])).sum()) / 6
    return WaterBody(mesh, volume, x, y, ground, np.where(near, level, np.nan))


def _between(x: F64, y: F64, ground: F64, level: F64, near: NDArray[np.bool_]) -> TriangleMesh:
    rows, cols = ground.shape
    depth = (level - ground).ravel()
    depth = np.where(np.abs(depth) < LEAST_DEPTH, -LEAST_DEPTH, depth)
    flat_x, flat_y = (a.ravel() for a in np.meshgrid(x, y))
    index = np.arange(rows * cols).reshape(rows, cols)
    a, b, d, e = (index[r, c].ravel() for r in (np.s_[:-1], np.s_[1:]) for c in (np.s_[:-1], np.s_[1:]))
    triangles = np.stack([a, b, e, a, e, d], axis=1).reshape(-1, 3)
    triangles = triangles[near.ravel()[triangles].all(axis=1) & (depth[triangles] > 0).any(axis=1)]
    names: dict[tuple[int, int], int] = {}
    place: list[tuple[float, float, float, float]] = []

    def corner(i: int, j: int) -> int:
        """Vertex at a node (i == j), or where the shore crosses the edge between two."""
        key = (min(i, j), max(i, j))
        if key not in names:
            i, j = key
            share = 0.0 if i == j else depth[i] / (depth[i] - depth[j])
            at = [(1 - share) * v[i] + share * v[j] for v in (flat_x, flat_y, ground.ravel())]
            names[key] = len(place)
            place.append((float(at[0]), float(at[1]), float(at[2]), float(at[2] + (depth[i] if i == j else 0.0))))
        return names[key]

    top: list[tuple[int, int, int]] = []
    for nodes in triangles.tolist():
        loop: list[int] = []
        for i, j in zip(nodes, [*nodes[1:], nodes[0]], strict=True):
            if depth[i] > 0:
                loop.append(corner(i, i))
            if (depth[i] > 0) != (depth[j] > 0):
                loop.append(corner(i, j))
        top += [(loop[0], loop[k], loop[k + 1]) for k in range(1, len(loop) - 1)]
    if not top:
        raise InputError("the ground that was cut holds no water; move its center or enlarge it")
    return _closed(np.array(top), np.array(place))


def _closed(top: NDArray[np.int64], place: F64) -> TriangleMesh:
    """Top, bottom and the walls between them where the water ends at no shore."""
    count = len(place)
    shore = place[:, 3] <= place[:, 2]
    below = np.where(shore, np.arange(count), count + np.arange(count))
    edges = top[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    forth, back = edges[:, 0] * count + edges[:, 1], edges[:, 1] * count + edges[:, 0]
    rim = edges[~np.isin(forth, back)]
    walls = np.concatenate([
        np.stack([rim[:, 0], below[rim[:, 0]], below[rim[:, 1]]], axis=1),
        np.stack([rim[:, 0], below[rim[:, 1]], rim[:, 1]], axis=1),
    ])  # fmt: skip
    faces = np.concatenate([top, below[top][:, ::-1], walls])
    real = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    vertices = np.concatenate([place[:, [0, 1, 3]], place[:, :3]])
    used, number = np.unique(faces[real], return_inverse=True)
    if len(used) > MOST[0] or int(real.sum()) > MOST[1]:
        raise InputError(
            f"the water's surface has {len(used)} corners, at most {MOST[0]} can be held; cut a smaller ground or fewer cells"
        )
    return TriangleMesh(vertices[used], number.reshape(-1, 3).astype(np.int32))
