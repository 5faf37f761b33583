"""Pieces of surface on the parts that carry them: where they are on these at frame 0, they stay (R100).

Bodies and cloth alike: a piece keeps its place on its triangle of the visible surface, wherever that is at a frame.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....geometry.inside import nearest_faces
from ....geometry.solids import Solid
from ....worlds.arrays import F64
from ....worlds.built import TriangleMesh

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from .kindled import KindledSurfaces

__all__ = ["Carried"]


class _Bound(NamedTuple):
    """Pieces of one part on its triangles."""

    rows: NDArray[np.intp]
    corner: NDArray[np.int64]
    """Visible vertices of the triangle of each, shape (k, 3)."""
    weight: F64
    """Their shares, shape (k, 3)."""


class Carried:
    """Places at which pieces have to be.

    Args:
        candidate: whose bodies and cloth carry them.
        surfaces: the pieces.
    """

    def __init__(self, candidate: Candidate, surfaces: KindledSurfaces) -> None:
        self.candidate, self.surfaces = candidate, surfaces
        self.off = np.zeros(len(surfaces.area))
        """Distance of each piece from the surface of its part at frame 0 [m], shape (n,)."""
        self._bound = [self._bind(k) for k in range(len(surfaces.parts))]

    def _bind(self, number: int) -> _Bound:
        part = self.surfaces.parts[number]
        own = next(p for p in self.candidate.entity(part.entity).parts if p.part == part.part)
        place = self.candidate.surface(part.entity, part.part, 0)
        rows = np.flatnonzero(self.surfaces.part == number)
        if not len(rows):
            return _Bound(rows, np.zeros((0, 3), dtype=np.int64), np.zeros((0, 3)))
        corner = np.asarray(own.render.faces, dtype=np.int64)
        corner = corner[_areas(place[corner]) > 0.0]  # A solid leaves out the others.
        solid = Solid.from_mesh(TriangleMesh(place, corner.astype(np.int32)), closed=own.closed)
        self.off[rows], point, face = nearest_faces(solid, self.surfaces.state[0].point[rows])
        return _Bound(rows, corner[face], _shares(place[corner[face]], point))

    def astray(self, frame: int) -> F64:
        """Distance of each piece from its place on its part at a frame [m], shape (n,)."""
        if frame == 0:
            return self.off
        found = np.zeros(len(self.off))
        for bound, part in zip(self._bound, self.surfaces.parts, strict=True):
            place = self.candidate.surface(part.entity, part.part, frame)
            wanted = np.einsum("nk,nkx->nx", bound.weight, place[bound.corner])
            found[bound.rows] = np.linalg.norm(self.surfaces.state[frame].point[bound.rows] - wanted, axis=1)
        return found


def _areas(triangles: F64) -> F64:
    """Areas of triangles [m^2], (m, 3, 3) -> (m,)."""
    across = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return 0.5 * np.asarray(np.sqrt(np.einsum("ij,ij->i", across, across)))


def _shares(triangles: F64, points: F64) -> F64:
    """Barycentric coordinates of points (n, 3) in their triangles (n, 3, 3)."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    across = np.cross(b - a, c - a)
    square = np.maximum(np.einsum("ij,ij->i", across, across), 1e-300)
    second = np.einsum("ij,ij->i", np.cross(points - a, c - a), across) / square
    third = np.einsum("ij,ij->i", np.cross(b - a, points - a), across) / square
    return np.stack([1.0 - second - third, second, third], axis=1)
