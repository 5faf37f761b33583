"""Clearances at frame 0 for which a large world is asked pair by pair, all at once: where entities are nearest, and parts of one entity."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...geometry import ConvexGaps, convex_gaps, signed_clearances
from ...worlds.arrays import F64, RigidPose
from .bounds import ROUNDING

if TYPE_CHECKING:
    from ...geometry import Clearance
    from .parts import Pair, Parts

__all__ = ["Gap", "measured_together", "nearest_parts", "own_distances"]

Two = tuple[int, int]
Boxes = tuple[F64, F64]


class Gap(NamedTuple):
    """Signed clearance of two entities at one frame."""

    distance: float
    """[m]"""
    point_a: F64
    """World [m], shape (3,)."""
    point_b: F64
    part_a: str
    part_b: str

    def turned(self) -> Gap:
        """The same with the other entity first."""
        return Gap(self.distance, self.point_b, self.point_a, self.part_b, self.part_a)


def nearest_parts(
    surfaces: Parts, near: Mapping[Pair, set[Two]], clearance: Mapping[Two, float], boxes: Callable[[str], Boxes]
) -> Iterator[tuple[Pair, Gap]]:
    """Pairs of entities with their clearance and its points at frame 0, as far as compiled loops know them.

    Args:
        surfaces: of the candidate.
        near: parts of pairs of entities of which some come within reach of each other.
        clearance: of those, the lower index first [m]; above `reach` a bound.
        boxes: around the vertices of the parts of an entity [m], shapes (parts, 3).
    """
    soft = {surfaces.parts[i].entity for i in surfaces.shapes.soft}
    known = {pair: {p: clearance[min(p), max(p)] for p in some} for pair, some in near.items() if not soft & {*pair}}
    known = {pair: some for pair, some in known.items() if min(some.values()) <= surfaces.reach}
    asked = {pair: _candidates(surfaces, pair, some, boxes) for pair, some in known.items()}
    found = _convex(surfaces, [parts for some, _ in asked.values() for parts in some], math.inf)
    if found is None:
        return
    start = 0
    for pair, (some, bound) in asked.items():
        rows = slice(start, start + len(some))
        start += len(some)
        if not found.answered[rows].all():
            continue
        distance, best = found.distance[rows], 0
        for k in range(1, len(some)):
            if bound[k] > max(distance[best], 0.0):
                break
            best = k if distance[k] < distance[best] else best
        names = (surfaces.parts[i].part for i in some[best])
        yield pair, Gap(float(distance[best]), found.point_a[rows][best], found.point_b[rows][best], *names)


def _candidates(
    surfaces: Parts, pair: Pair, known: Mapping[Two, float], boxes: Callable[[str], Boxes]
) -> tuple[list[Two], list[float]]:
    """Parts that may be the nearest ones, in order of the gaps between their boxes [m], and those."""
    most = max(min(known.values()), 0.0) + ROUNDING
    some = sorted(parts for parts, value in known.items() if value <= most)
    if len(some) == 1:
        return some, [0.0]
    (low_a, high_a), (low_b, high_b) = (boxes(name) for name in pair)
    one, two = (np.array([p[k] for p in some]) - surfaces.parts_of[pair[k]][0] for k in (0, 1))
    apart = np.maximum(np.maximum(low_a[one] - high_b[two], low_b[two] - high_a[one]), 0.0)
    bound = np.linalg.norm(apart, axis=1)
    order = np.argsort(bound, kind="stable")
    return [some[k] for k in order], bound[order].tolist()


def measured_together(surfaces: Parts, near: Sequence[set[Two]], clearance: Mapping[Two, float]) -> dict[Two, Clearance]:
    """Clearances at frame 0, with their points, of parts that may be the nearest ones of two entities.

    Args:
        surfaces: of the candidate.
        near: parts of pairs of entities whose clearance is known.
        clearance: of those, the lower index first [m]; above `reach` a bound.
    """
    asked: list[Two] = []
    for some in near:
        known = {two: clearance[min(two), max(two)] for two in some}
        most = max(min(known.values()), 0.0) + ROUNDING
        asked += [two for two, value in known.items() if value <= most]
    tracks = {i: surfaces.track_of(i) for two in asked for i in two}
    poses = {i: RigidPose(t.position[0] + 0.0, t.quaternion[0]) for i, t in tracks.items()}  # no -0, as after a move by nothing
    solid = surfaces.shapes.solid
    return dict(zip(asked, signed_clearances([(solid(i, 0), poses[i], solid(j, 0), poses[j]) for i, j in asked]), strict=True))


def own_distances(surfaces: Parts, boxes: Boxes) -> dict[Two, float]:
    """Clearance of parts i < j of one entity at frame 0 whose boxes come within reach of each other [m], as far as compiled loops know it.

    Above `reach` a lower bound. `boxes` hold the parts [m], shapes (parts, 3).
    """
    low, high = boxes
    asked: list[Two] = []
    for rows in surfaces.parts_of.values():
        if surfaces.shapes.soft & {*rows}:
            continue
        own = np.array(rows, dtype=np.intp)
        gap = np.maximum(low[own][:, None] - high[own], low[own] - high[own][:, None]).max(axis=2, initial=-np.inf)
        asked += [(int(own[a]), int(own[b])) for a, b in np.argwhere(gap <= surfaces.reach).tolist() if a < b]
    found = _convex(surfaces, asked, surfaces.reach)
    if found is None:
        return {}
    return {parts: value for parts, value, ok in zip(asked, found.distance.tolist(), found.answered, strict=True) if ok}


def _convex(surfaces: Parts, asked: list[Two], skip_above: float) -> ConvexGaps | None:
    first = np.zeros(1, dtype=np.intp)
    sides = [[(parts[k], first) for parts in asked] for k in (0, 1)]
    if not asked:
        return None
    forest, places = surfaces.shapes.forest([*sides[0], *sides[1]])
    poses: list[tuple[F64, F64]] = []
    for side in sides:
        tracks = [surfaces.track_of(part) for part, _ in side]
        poses.append((np.array([t.position[0] for t in tracks]), np.array([t.quaternion[0] for t in tracks])))
    return convex_gaps(forest, places.reshape(2, -1).T, *poses, skip_above=skip_above)
