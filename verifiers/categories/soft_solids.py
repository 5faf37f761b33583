"""Points in deforming bodies at a frame, by winding number and exact distance in double precision (R66, R101)."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...geometry import Solid, contains, distance_to_surface
from ...worlds.arrays import F64
from ...worlds.built import TriangleMesh
from ...worlds.errors import EvidenceError
from ...worlds.instances import soft_met

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.categories.deforming import Deforming
    from .liquid.frames import Rows

__all__ = ["SoftDepth", "soft_boxes", "soft_depths", "soft_gaps", "soft_walls"]


class SoftDepth(NamedTuple):
    """Points inside one part."""

    entity: str
    part: str
    rows: Rows
    value: F64
    """Depths of the points [m]."""


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
