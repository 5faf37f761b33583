"""Tetrahedra of a grid, cut along the surface of a solid.

Isosurface stuffing (F. Labelle and J. R. Shewchuk, *Isosurface stuffing*, SIGGRAPH 2007) on a Freudenthal grid: grid corners near
the surface move onto it, what lies outside is cut off, so that no sliver stays. Faces of neighbours meet because every
quadrilateral is split at its corner of the lowest number.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.inside import contains, distance_to_surface
from ...geometry.solids import Solid
from ...worlds.arrays import F64, I32
from ...worlds.built import BuiltPart, TriangleMesh
from ...worlds.errors import InputError
from ...worlds.simulation_mesh import SimulationMesh, volumes
from .lattice import outer_faces

__all__ = ["clipped_mesh", "clipped_tets"]

SNAP = 0.3
"""Own choice: grid corners nearer to the surface than this share of the shortest block edge move onto it."""
HALVINGS = 16
"""Halvings of an edge to find where it leaves the solid: to 1e-5 of it. Distances mislead in plates, where they are those to a face."""
SLIVER = 1e-4
"""Tetrahedra of less than this share of a block's volume are left out: what they would hold is below the cut's own error."""
VOLUME_ERROR = 0.1
"""Own choice: a mesh that misses more of the solid's volume does not resolve it."""


def clipped_mesh(part: BuiltPart, points: F64, tets: I32, cells: I32) -> BuiltPart:
    """A part whose surface is that of the tetrahedra cut out of a grid.

    Raises:
        InputError: the grid does not resolve the solid.
    """
    solid = Solid.from_mesh(part.render, closed=True)
    kept, inner = clipped_tets(solid, points, tets)
    volume = float(volumes(kept, inner).sum()) if len(inner) else 0.0
    if abs(volume - solid.volume) > VOLUME_ERROR * solid.volume:
        edge = float((points.max(0) - points.min(0)).max() / max(1, int(cells.max())))
        raise InputError(
            f"part {part.part!r} has {solid.volume:.4g} m^3 and its simulation mesh {volume:.4g} m^3: cells of {edge:.3g} m do not "
            f"resolve it; set physics.resolution to {edge / 2:.3g} m or less"
        )
    faces = outer_faces(inner)
    used, place = np.unique(faces, return_inverse=True)
    surface = TriangleMesh(kept[used], place.reshape(-1, 3).astype(np.int32))
    indices = np.repeat(used[:, None], 4, axis=1).astype(np.int32)
    weights = np.repeat([[1.0, 0.0, 0.0, 0.0]], len(used), axis=0)
    mesh = SimulationMesh(kept, faces, inner, indices, weights, cells)
    return replace(part, render=surface, simulation=mesh, deviation=(0.0, 0.0))


def clipped_tets(solid: Solid, points: F64, tets: I32) -> tuple[F64, I32]:
    """Vertices and tetrahedra of a grid's part inside a solid."""
    points = points.copy()
    edges = np.linalg.norm(points[tets[:, 1]] - points[tets[:, 0]], axis=1)
    depth, near = _signed(solid, points)
    close = np.abs(depth) < SNAP * float(edges.min())
    points[close], depth[close] = near[close], 0.0
    inside = depth[tets] <= 0.0
    whole = tets[inside.all(axis=1)]
    cut = tets[inside.any(axis=1) & ~inside.all(axis=1)]
    vertices, crossing = _crossings(solid, points, depth, cut)
    found = [whole, *(_cut(cut[inside_of(depth, cut) == k], depth, crossing, k) for k in (1, 2, 3))]
    every = np.concatenate(found)
    size = np.abs(volumes(vertices, every))
    distinct = (np.diff(np.sort(every, axis=1), axis=1) > 0).all(axis=1)
    every = every[distinct & (size > SLIVER * float(np.median(size[: len(whole)] if len(whole) else size)))]
    wrong = volumes(vertices, every) < 0
    every[wrong] = every[wrong][:, [0, 1, 3, 2]]
    # A tetrahedron all of whose corners lie on the surface may bridge a notch.
    middle = vertices[every].mean(axis=1)
    on = (np.append(depth, np.zeros(len(vertices) - len(depth)))[every] == 0.0).all(axis=1)
    on[on] = ~contains(solid, middle[on])
    every = every[~on]
    used, place = np.unique(every, return_inverse=True)
    return vertices[used], place.reshape(-1, 4).astype(np.int32)


def inside_of(depth: F64, tets: I32) -> NDArray[np.intp]:
    """Number of corners of each tetrahedron inside or on the surface."""
    return np.asarray((depth[tets] <= 0.0).sum(axis=1), dtype=np.intp)


def _signed(solid: Solid, points: F64) -> tuple[F64, F64]:
    """Distance to the surface, negative inside [m], and the nearest points of it."""
    distance, near = distance_to_surface(solid, points)
    return np.where(contains(solid, points), -distance, distance), near


class _Crossing:
    """Vertex in which the edge from an inner to an outer corner leaves the solid."""

    def __init__(self, keys: NDArray[np.int64], first: int, count: int, depth: F64) -> None:
        self.keys, self.first, self.count, self.depth = keys, first, count, depth

    def of(self, inner: I32, outer: I32) -> I32:
        key = inner.astype(np.int64) * self.count + outer
        place = np.minimum(np.searchsorted(self.keys, key), max(len(self.keys) - 1, 0))
        made = self.first + place
        return np.where(self.depth[inner] == 0.0, inner, made).astype(np.int32)


def _crossings(solid: Solid, points: F64, depth: F64, cut: I32) -> tuple[F64, _Crossing]:
    pairs = np.concatenate([cut[:, [a, b]] for a in range(4) for b in range(4) if a != b])
    pairs = np.unique(pairs[(depth[pairs[:, 0]] < 0.0) & (depth[pairs[:, 1]] > 0.0)], axis=0).astype(np.int64)
    low, high = np.zeros(len(pairs)), np.ones(len(pairs))
    start, along = points[pairs[:, 0]], points[pairs[:, 1]] - points[pairs[:, 0]]
    for _ in range(HALVINGS if len(pairs) else 0):
        middle = 0.5 * (low + high)
        inner = contains(solid, start + middle[:, None] * along)
        low, high = np.where(inner, middle, low), np.where(inner, high, middle)
    share = 0.5 * (low + high)
    keys = pairs[:, 0] * len(points) + pairs[:, 1]
    return np.concatenate([points, start + share[:, None] * along]), _Crossing(keys, len(points), len(points), depth)


def _cut(tets: I32, depth: F64, crossing: _Crossing, count: int) -> I32:
    """Tetrahedra that fill the inner part of each one with `count` corners inside, shape (n, 4)."""
    if not len(tets):
        return np.empty((0, 4), dtype=np.int32)
    order = np.argsort(depth[tets] > 0.0, axis=1, kind="stable")
    a, b, c, d = np.take_along_axis(tets, order, axis=1).T
    if count == 1:
        return np.stack([a, crossing.of(a, b), crossing.of(a, c), crossing.of(a, d)], axis=1)
    if count == 2:
        return _prisms(a, crossing.of(a, c), crossing.of(a, d), b, crossing.of(b, c), crossing.of(b, d))
    return _prisms(a, b, c, crossing.of(a, d), crossing.of(b, d), crossing.of(c, d))


_TURNS = np.array(
    [[0, 1, 2, 3, 4, 5], [1, 2, 0, 4, 5, 3], [2, 0, 1, 5, 3, 4], [3, 5, 4, 0, 2, 1], [4, 3, 5, 1, 0, 2], [5, 4, 3, 2, 1, 0]]
)
"""Orders of a prism's corners: one that begins with each corner and keeps which are joined, shape (6, 6)."""


def _prisms(*corners: I32) -> I32:
    """Three tetrahedra per prism; every side is split at its corner of the lowest number.

    J. Dompierre et al., *How to subdivide pyramids, prisms and hexahedra into tetrahedra*, 8th Meshing Roundtable, 1999.
    """
    prism = np.stack(corners, axis=1)
    prism = np.take_along_axis(prism, _TURNS[prism.argmin(axis=1)], axis=1)
    v = [prism[:, k] for k in range(6)]
    first = np.minimum(v[1], v[5]) < np.minimum(v[2], v[4])
    one = [[v[0], v[1], v[2], v[5]], [v[0], v[1], v[5], v[4]], [v[0], v[4], v[5], v[3]]]
    two = [[v[0], v[1], v[2], v[4]], [v[0], v[4], v[2], v[5]], [v[0], v[4], v[5], v[3]]]
    found = [np.where(first[:, None], np.stack(x, axis=1), np.stack(y, axis=1)) for x, y in zip(one, two, strict=True)]
    return np.concatenate(found).astype(np.int32)
