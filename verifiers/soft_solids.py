"""Points in deforming bodies at a frame, by winding number and exact distance in double precision (R66, R101)."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..geometry import Solid, contains, distance_to_surface
from ..geometry.inside import nearest_faces
from ..worlds.arrays import F64
from ..worlds.built import TriangleMesh
from ..worlds.errors import EvidenceError
from ..worlds.instances import soft_met

if TYPE_CHECKING:
    from ..worlds.candidate import Candidate
    from ..worlds.deforming import Deforming
    from .liquid_frames import Rows

__all__ = ["SoftDepth", "passed_through", "soft_boxes", "soft_depths", "soft_gaps", "soft_walls"]

NEAR = 4.0
"""[largest radii] Grains farther from a sheet than that at a frame are told by their nearest triangle no more."""
CROSSED = 0.2
"""Of the radius: own choice; a middle so far on the other side has gone through."""


class SoftDepth(NamedTuple):
    """Points inside one part."""

    entity: str
    part: str
    rows: Rows
    value: F64
    """How deep [m]."""


def soft_walls(candidate: Candidate, solver: str) -> dict[str, Deforming]:
    """Deforming entities that an instance meets, by name.

    Raises:
        EvidenceError: one has no cache of how it deforms.
    """
    found = {}
    for name in soft_met(candidate.spec, solver):
        if name not in candidate.deforming:
            raise EvidenceError(f"no cache holds how {name!r} deforms; probe or bake its instance")
        found[name] = candidate.deforming[name]
    return found


def soft_depths(candidate: Candidate, solver: str, points: F64, frame: int) -> list[SoftDepth]:
    """Points inside the closed deforming bodies that an instance meets, per part."""
    found = []
    for name in soft_walls(candidate, solver):
        for part in candidate.entity(name).parts:
            place = candidate.surface(name, part.part, frame)
            if not part.closed or not len(points) or not np.isfinite(place).all():
                continue
            near = np.flatnonzero(((points >= place.min(axis=0)) & (points <= place.max(axis=0))).all(axis=1))
            if not len(near):
                continue
            solid = Solid.from_mesh(TriangleMesh(place, part.render.faces), closed=True)
            rows = near[contains(solid, points[near])]
            if len(rows):
                found.append(SoftDepth(name, part.part, rows, distance_to_surface(solid, points[rows]).distance))
    return found


def soft_boxes(candidate: Candidate, solver: str, frame: int) -> list[tuple[F64, F64]]:
    """Least and greatest corners of the deforming parts that an instance meets, at a frame and the one before [m]."""
    found = []
    for name in soft_walls(candidate, solver):
        for part in candidate.entity(name).parts:
            both = [candidate.surface(name, part.part, k) for k in (max(frame - 1, 0), frame)]
            found.append((np.min([p.min(axis=0) for p in both], axis=0), np.max([p.max(axis=0) for p in both], axis=0)))
    return found


def soft_gaps(candidate: Candidate, solver: str, points: F64, frame: int, reach: float) -> F64:
    """Distance of points from the deforming surfaces that an instance meets [m], shape (n,); infinite beyond `reach`."""
    found = np.full(len(points), np.inf)
    for name in soft_walls(candidate, solver):
        for part in candidate.entity(name).parts:
            place = candidate.surface(name, part.part, frame)
            low, high = place.min(axis=0) - reach, place.max(axis=0) + reach
            near = np.flatnonzero(((points >= low) & (points <= high)).all(axis=1))
            if len(near):
                solid = Solid.from_mesh(TriangleMesh(place, part.render.faces), closed=part.closed)
                found[near] = np.minimum(found[near], distance_to_surface(solid, points[near]).distance)
    return np.where(found <= reach, found, np.inf)


def passed_through(
    candidate: Candidate, solver: str, before: tuple[F64, int], now: tuple[F64, int], radius: F64
) -> list[SoftDepth]:
    """Particles that were on one side of a sheet at a frame and are on the other side of the same triangle at the next.

    Args:
        candidate: what is judged.
        solver: the instance of the particles.
        before: their places (n, 3) [m], and the frame.
        now: the same at a later frame, in the same order.
        radius: theirs (n,) [m].
    """
    found = []
    for name in soft_walls(candidate, solver):
        for part in candidate.entity(name).parts:
            if part.closed or not len(radius):
                continue
            first, last = (candidate.surface(name, part.part, k) for _, k in (before, now))
            sheet = Solid.from_mesh(TriangleMesh(first, part.render.faces), closed=False)
            gap, point, face = nearest_faces(sheet, before[0])
            rows = np.flatnonzero(gap < NEAR * radius.max())
            corners = part.render.faces[face[rows]]
            one, two = first[corners], last[corners]
            weight = _weights(one, point[rows])
            there = np.einsum("nk,nkd->nd", weight, two)
            side = [
                np.einsum("nd,nd->n", p[rows] - q, _normals(c))
                for p, q, c in ((before[0], point[rows], one), (now[0], there, two))
            ]
            along = np.linalg.norm(now[0][rows] - there, axis=1)
            least = CROSSED * radius[rows]
            gone = (side[0] * side[1] < 0) & (np.abs(side[0]) > least) & (np.abs(side[1]) > least) & (along < NEAR * radius.max())
            if gone.any():
                found.append(SoftDepth(name, part.part, rows[gone], np.abs(side[1])[gone]))
    return found


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
