"""Clearances at frame 0 for which a large world is asked pair by pair, all at once: where entities are nearest, and parts of one entity."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ...geometry import ConvexGaps, convex_gaps
from ...worlds.arrays import F64
from .bounds import ROUNDING

if TYPE_CHECKING:
    from .surfaces import Gap, Surfaces

__all__ = ["nearest_parts", "own_distances"]

Parts = tuple[int, int]


def nearest_parts(surfaces: Surfaces, near: dict[tuple[str, str], set[Parts]]) -> Iterator[tuple[tuple[str, str], Gap]]:
    """Pairs of entities with their clearance and its points at frame 0, as far as compiled loops know them.

    Args:
        surfaces: of the candidate.
        near: parts of pairs of entities that come within reach of each other.
    """
    from .surfaces import Gap

    soft = {surfaces.parts[i].entity for i in surfaces.shapes.soft}
    asked = {pair: _candidates(surfaces, pair, near[pair]) for pair in surfaces.first if pair in near and not soft & {*pair}}
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


def _candidates(surfaces: Surfaces, pair: tuple[str, str], near: set[Parts]) -> tuple[list[Parts], list[float]]:
    """Parts that may be the nearest ones, in order of the gaps between their boxes [m], and those."""
    known = {(i, j): surfaces.at_start[min(i, j), max(i, j)] for i, j in near}
    most = max(min(known.values()), 0.0) + ROUNDING
    some = sorted(parts for parts, value in known.items() if value <= most)
    if len(some) == 1:
        return some, [0.0]
    (low_a, high_a), (low_b, high_b) = (surfaces.tight_boxes(name, 0) for name in pair)
    one, two = (np.array([p[k] for p in some]) - surfaces.parts_of[pair[k]][0] for k in (0, 1))
    apart = np.maximum(np.maximum(low_a[one] - high_b[two], low_b[two] - high_a[one]), 0.0)
    bound = np.linalg.norm(apart, axis=1)
    order = np.argsort(bound, kind="stable")
    return [some[k] for k in order], bound[order].tolist()


def own_distances(surfaces: Surfaces) -> dict[Parts, float]:
    """Clearance of parts i < j of one entity at frame 0 whose boxes come within reach of each other [m], as far as compiled loops know it.

    Above `reach` a lower bound.
    """
    low, high = (box[:, 0] for box in surfaces.boxes(np.zeros(1, dtype=np.intp)))
    asked: list[Parts] = []
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


def _convex(surfaces: Surfaces, asked: list[Parts], skip_above: float) -> ConvexGaps | None:
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
