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
    from collections.abc import Sequence

    from ....worlds.candidate import Candidate

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
        parts: entity and part that each number stands for.
        part: number of the part of each piece, shape (n,).
        points: where they are at each frame [m], each (n, 3).
    """

    def __init__(
        self, candidate: Candidate, parts: Sequence[tuple[str, str]], part: NDArray[np.int64], points: Sequence[F64]
    ) -> None:
        self.candidate, self.parts, self.part, self.points = candidate, parts, part, points
        self.off = np.zeros(len(part))
        """Distance of each piece from the surface of its part at frame 0 [m], shape (n,)."""
        self._bound = [self._bind(k) for k in range(len(parts))]

    def _bind(self, number: int) -> _Bound:
        entity, part = self.parts[number]
        own = next(p for p in self.candidate.entity(entity).parts if p.part == part)
        place, rows = self.candidate.surface(entity, part, 0), np.flatnonzero(self.part == number)
        if not len(rows):
            return _Bound(rows, np.zeros((0, 3), dtype=np.int64), np.zeros((0, 3)))
        corner = np.asarray(own.render.faces, dtype=np.int64)
        corner = corner[_areas(place[corner]) > 0.0]  # A solid leaves out the others.
        solid = Solid.from_mesh(TriangleMesh(place, corner.astype(np.int32)), closed=own.closed)
        self.off[rows], point, face = nearest_faces(solid, self.points[0][rows])
        return _Bound(rows, corner[face], _shares(place[corner[face]], point))

    def astray(self, frame: int) -> F64:
        """Distance of each piece from its place on its part at a frame [m], shape (n,)."""
        if frame == 0:
            return self.off
        found = np.zeros(len(self.off))
        for bound, (entity, part) in zip(self._bound, self.parts, strict=True):
            wanted = np.einsum("nk,nkx->nx", bound.weight, self.candidate.surface(entity, part, frame)[bound.corner])
            found[bound.rows] = np.linalg.norm(self.points[frame][bound.rows] - wanted, axis=1)
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
