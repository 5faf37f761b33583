"""Bodies of one entity against each other: a rope through itself, pieces of one object (R90, R108).

Neighbours along a rope overlap by construction and are left out, as the engine leaves them out. Parts of one body may
overlap: they are one body's surface.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry import aabb_of, candidate_pairs, clearance_series, signed_clearance
from ...worlds.arrays import F64
from ...worlds.spec import Rope
from .surfaces import NOWHERE, Gap

if TYPE_CHECKING:
    from .surfaces import Surfaces

__all__ = ["OwnPair", "joined", "own_gap", "own_pairs"]


class OwnPair(NamedTuple):
    """Two bodies of one entity that come close."""

    first: int
    """Index of the part in `Surfaces.parts`."""
    second: int
    series: F64
    """Clearance at the inspected frames [m]; a lower bound where they are farther apart than the reach."""


def joined(surfaces: Surfaces, entity: str) -> int:
    """Number of bodies, in their order, over which neighbours touch by construction; 0 where none do.

    Segments of a rope share their round ends: those nearer along it than its thickness and the skins touch or overlap.
    """
    rope = surfaces.candidate.spec.entities[entity].generator
    if not isinstance(rope, Rope):
        return 0
    points = np.array(rope.points, dtype=np.float64)
    length = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum()) / rope.segments
    return 1 + math.ceil((2.0 * rope.radius + surfaces.skins(entity, entity)) / max(length, 1e-9))


def own_pairs(surfaces: Surfaces, frames: NDArray[np.intp]) -> dict[str, list[OwnPair]]:
    """Pairs of bodies of one entity that come within reach at some of the frames, per entity."""
    found: dict[str, list[OwnPair]] = {}
    for entity in surfaces.entities:
        bodies = [b.name for b in surfaces.candidate.entity(entity).bodies]
        if len(bodies) < 2:
            continue
        place = {name: k for k, name in enumerate(bodies)}
        rows = surfaces.parts_of[entity]
        low, high = _boxes(surfaces, rows, frames)
        near = joined(surfaces, entity)
        for i, j in candidate_pairs(low, high, surfaces.reach):
            one, two = surfaces.parts[rows[i]], surfaces.parts[rows[j]]
            apart = abs(place[one.body] - place[two.body])
            if apart == 0 or apart <= near:
                continue
            at = np.flatnonzero((np.maximum(low[i] - high[j], low[j] - high[i]) <= surfaces.reach).all(axis=1))
            tracks = [surfaces.track(entity, p.body).take(frames[at]) for p in (one, two)]
            series = np.full(len(frames), np.inf)
            series[at] = clearance_series(one.solid, tracks[0], two.solid, tracks[1], skip_above=surfaces.reach)
            if series.min() <= surfaces.reach:
                found.setdefault(entity, []).append(OwnPair(rows[i], rows[j], series))
    return found


def _boxes(surfaces: Surfaces, rows: tuple[int, ...], frames: NDArray[np.intp]) -> tuple[F64, F64]:
    """World boxes of some parts [m], shapes (parts, frames, 3); empty from the first broken pose on."""
    low, high = np.empty((2, len(rows), len(frames), 3))
    for k, i in enumerate(rows):
        part = surfaces.parts[i]
        good = np.flatnonzero(frames < surfaces.broken.get(part.entity, surfaces.frames))
        low[k], high[k] = NOWHERE, -NOWHERE
        low[k, good], high[k, good] = aabb_of(part.solid.vertices, *surfaces.track(part.entity, part.body).take(frames[good]))
    return low, high


def own_gap(surfaces: Surfaces, pair: OwnPair, frame: int) -> Gap:
    """Exact clearance of two bodies of one entity at a frame, with its points."""
    one, two = surfaces.parts[pair.first], surfaces.parts[pair.second]
    poses = [surfaces.track(p.entity, p.body).at(frame) for p in (one, two)]
    found = signed_clearance(one.solid, poses[0], two.solid, poses[1])
    return Gap(found.distance, found.point_a, found.point_b, one.part, two.part)
