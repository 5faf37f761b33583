"""Particles that go from one side of a sheet to the other, followed from frame to frame (R66, R101).

Between two frames particle and sheet move straight, in stretches in which no particle moves by more than its radius against the
sheet. It changes sides in a stretch where it ends on the other side of the triangle that was nearest, and of the one that is
nearest then. Nothing changes sides beside the rim: there it goes around. It has passed once it is `CROSSED` of a radius away
again, however many frames that takes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ....geometry import Solid
from ....geometry.inside import nearest_faces
from ....worlds.arrays import F64, I32
from ....worlds.built import TriangleMesh
from ....worlds.errors import EvidenceError
from ..soft_solids import SoftDepth, soft_walls
from .bounds import CROSSED, NEAR, NOISE, RIM, STRETCHES

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate

__all__ = ["PassedSheets", "SheetSides"]

Rows: TypeAlias = NDArray[np.intp]


class _Foot(NamedTuple):
    """Nearest points of a sheet."""

    gap: F64
    """[m], shape (n,)."""
    corners: NDArray[np.intp]
    """Vertices of the nearest triangle, shape (n, 3)."""
    weight: F64
    """Weights of these vertices, shape (n, 3)."""
    rim: NDArray[np.bool_]
    """True where the point lies on the rim, shape (n,)."""
    side: F64
    """Distance along the triangle's normal [m], shape (n,)."""

    def of(self, rows: Rows) -> _Foot:
        """Those of some points."""
        return _Foot(self.gap[rows], self.corners[rows], self.weight[rows], self.rim[rows], self.side[rows])


class SheetSides:
    """One sheet, and on which side of it particles are."""

    def __init__(self, faces: I32) -> None:
        self.faces, self.rim = faces, _rim(faces)
        self.between: dict[int, bool] = {}
        """Particles that were on a side for certain and are on neither now: whether they have changed it since."""

    def see(self, identity: NDArray[np.integer], sheet: tuple[F64, F64], place: tuple[F64, F64], radius: F64) -> tuple[Rows, F64]:
        """Rows of the particles that have passed, and how far they are beyond the sheet [m].

        Args:
            identity: of the particles, shape (n,).
            sheet: its vertices at a frame and at the next [m], each (v, 3).
            place: where the particles are at both [m], each (n, 3).
            radius: theirs (n,) [m].
        """
        rows = _near(*sheet, self.faces, *place, radius)
        if not len(rows):
            self.between = {}
            return rows, np.zeros(0)
        odd, start, end = self._follow(sheet[0], sheet[1], place[0][rows], place[1][rows], float(radius[rows].min()))
        ids, least = identity[rows].tolist(), CROSSED * radius[rows]
        sure = start.gap > least
        known = sure | np.array([i in self.between for i in ids])
        changed = np.where(sure, odd, odd ^ np.array([self.between.get(i, False) for i in ids]))
        away = end.gap > least
        self.between = {ids[k]: bool(changed[k]) for k in np.flatnonzero(known & ~away & ~end.rim)}
        passed = known & changed & away & ~end.rim
        return rows[passed], end.gap[passed]

    def _follow(self, first: F64, last: F64, before: F64, now: F64, radius: float) -> tuple[NDArray[np.bool_], _Foot, _Foot]:
        """Flags of particles that end on the other side, and the nearest points of the sheet at both frames."""
        start, end = self._foot(first, before), self._foot(last, now)
        along = _at(first, start) - before - (_at(last, start) - now)
        count = np.ceil(np.linalg.norm(along, axis=1) / radius)
        odd = _changes(start, end, last, now)
        rows = np.flatnonzero(count > 1)
        if len(rows):
            steps = int(min(count.max(), STRETCHES))
            foot = start.of(rows)
            odd[rows] = False
            for k in range(1, steps + 1):
                surface = first + k / steps * (last - first)
                place = before[rows] + k / steps * (now[rows] - before[rows])
                after = self._foot(surface, place)
                odd[rows] ^= _changes(foot, after, surface, place)
                foot = after
        return odd, start, end

    def _foot(self, surface: F64, place: F64) -> _Foot:
        sheet = Solid.from_mesh(TriangleMesh(surface, self.faces), closed=False)
        gap, point, face = nearest_faces(sheet, place)
        own = _own(sheet, surface, self.faces)[face]
        corners = surface[self.faces[own]]
        weight = _weights(corners, point)
        side = np.einsum("nd,nd->n", place - point, _normals(corners))
        return _Foot(gap, self.faces[own].astype(np.intp), weight, np.asarray(((weight < RIM) & self.rim[own]).any(axis=1)), side)


class PassedSheets:
    """Particles of an instance against all sheets that it meets."""

    def __init__(self, candidate: Candidate, solver: str) -> None:
        self.candidate = candidate
        self.sheets = [
            (name, part.part, SheetSides(part.render.faces))
            for name in soft_walls(candidate, solver)
            for part in candidate.entity(name).parts
            if not part.closed
        ]

    def see(self, identity: NDArray[np.integer], before: tuple[F64, int], now: tuple[F64, int], radius: F64) -> list[SoftDepth]:
        """Particles that have passed, per sheet; places (n, 3) [m] of a frame, and of the next one in the same order.

        Raises:
            EvidenceError: a sheet is not finite.
        """
        found = []
        for name, part, sides in self.sheets:
            first, last = (self.candidate.surface(name, part, k) for _, k in (before, now))
            if not (np.isfinite(first).all() and np.isfinite(last).all()):
                raise EvidenceError(f"{name!r} is not finite at frame {now[1]}; see its own rows")
            rows, gap = sides.see(identity, (first, last), (before[0], now[0]), radius)
            if len(rows):
                found.append(SoftDepth(name, part, rows, gap))
        return found


def _near(first: F64, last: F64, faces: I32, before: F64, now: F64, radius: F64) -> Rows:
    """Rows of the particles that may have met a sheet between two frames."""
    from scipy.spatial import cKDTree

    if not len(radius):
        return np.zeros(0, dtype=np.intp)
    edge = float(np.linalg.norm(first[faces] - np.roll(first[faces], 1, axis=1), axis=2).max())
    moved = float(np.linalg.norm(last - first, axis=1).max()) + np.linalg.norm(now - before, axis=1)
    reach = NEAR * float(radius.max()) + moved
    gap = cKDTree(first).query(before, distance_upper_bound=float(reach.max()) + edge)[0]
    return np.flatnonzero(gap < reach + edge)


def _changes(one: _Foot, two: _Foot, surface: F64, place: F64) -> NDArray[np.bool_]:
    """True where particles change sides from one place to the next; `surface` and `place` are those of the latter."""
    corners = surface[one.corners]
    across = np.einsum("nd,nd->n", place - np.einsum("nk,nkd->nd", one.weight, corners), _normals(corners))
    front = one.side >= 0.0
    return np.asarray((front != (two.side >= 0.0)) & (np.where(front, across, -across) < NOISE) & ~one.rim & ~two.rim)


def _own(sheet: Solid, surface: F64, faces: I32) -> NDArray[np.intp]:
    """Rows of `faces` that a sheet has kept: those without area are dropped there."""
    if len(sheet.faces) == len(faces):
        return np.arange(len(faces))
    corner = surface[faces]
    area = np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1)
    return np.flatnonzero(area > 0.0)


def _at(surface: F64, foot: _Foot) -> F64:
    return np.asarray(np.einsum("nk,nkd->nd", foot.weight, surface[foot.corners]))


def _rim(faces: I32) -> NDArray[np.bool_]:
    """True where the edge opposite of every corner has no other triangle, shape (m, 3)."""
    edges = np.sort(faces[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2), axis=1)
    _, which, count = np.unique(edges, axis=0, return_inverse=True, return_counts=True)
    return np.asarray((count[which.reshape(-1)] == 1).reshape(-1, 3))


def _normals(corners: F64) -> F64:
    """Unit normals of triangles (n, 3, 3)."""
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.asarray(cross / np.maximum(np.linalg.norm(cross, axis=1, keepdims=True), 1e-300))


def _weights(corners: F64, points: F64) -> F64:
    """Barycentric weights of points of triangles, (n, 3)."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    normal = np.cross(b - a, c - a)
    double = np.maximum((normal**2).sum(axis=1), 1e-300)
    v = (np.cross(points - a, c - a) * normal).sum(axis=1) / double
    w = (np.cross(b - a, points - a) * normal).sum(axis=1) / double
    return np.stack([1.0 - v - w, v, w], axis=1)
