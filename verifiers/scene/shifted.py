"""Bounds of clearances at frame 0 after a small move, which settle most comparisons without a measurement.

Upper: points of two surfaces stay on them, so that the surfaces are no farther apart than these are after the move, and overlap where one of these
lies in the other body. Lower: whatever is apart comes nearer by no more than the move is long, and bodies whose boxes are apart are at least as far
apart. A bound decides where it is farther from what is compared than the two measurements of the clearance can be wrong together; all else is measured.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...geometry import contains
from ...worlds.arrays import F64

if TYPE_CHECKING:
    from .at_start import Gap
    from .parts import Pair, Parts

__all__ = ["Shifted", "Start", "shifted"]

WRONG = 4.0
"""[1] Own choice: so many query noises a bound must be from what is compared; two measurements and two places err by one each."""

Two = tuple[int, int]


class Start(NamedTuple):
    """Knowledge of frame 0 that bounds are taken from."""

    clearance: Mapping[Two, float]
    """Clearance of parts, the lower index first [m]; bounds of those beyond reach."""
    boxes: tuple[F64, F64]
    """Corners of boxes around all parts [m], shapes (parts, 3)."""
    gap: Callable[[str, str], Gap | None]
    """Gap of two entities as far as it was measured before."""


class Shifted(NamedTuple):
    """Comparisons that bounds settled, and what is left."""

    known: dict[Pair, float]
    """Bound of the clearance [m] of pairs that it settles, on the same side of what is compared as the clearance; infinite where that is larger."""
    open: dict[Pair, list[Two]]
    """Parts (above, below) of the other pairs that may decide."""


def shifted(
    surfaces: Parts, start: Start, parts: Mapping[Pair, Sequence[Two]], bound: Mapping[Pair, float], offset: F64
) -> Shifted:
    """Pairs (below, above) with `above` moved by a small offset at frame 0, as far as bounds settle on which side of `bound` they are.

    Args:
        surfaces: of the candidate.
        start: what is known of frame 0.
        parts: of each pair the parts (above, below) that come near each other.
        bound: what the clearance of each is compared with [m].
        offset: of the entity above [m], shape (3,).
    """
    margin = {pair: WRONG * surfaces.noise(*pair) for pair in parts}
    known = {pair: far for pair in parts if (far := _farthest(start, pair, offset)) < bound[pair] - margin[pair]}
    left = [pair for pair in parts if pair not in known]
    asked = [two for pair in left for two in parts[pair]]
    least = _least(start, asked, offset)
    compared = np.repeat([bound[pair] + margin[pair] for pair in left], [len(parts[pair]) for pair in left])
    near = iter((least <= compared).tolist())
    unsettled = {pair: [two for two in parts[pair] if next(near)] for pair in left}
    sunk = [
        pair for pair, some in unsettled.items() if bound[pair] > margin[pair] and _sinks(surfaces, start, pair, some, offset)
    ]
    known |= dict.fromkeys(sunk, 0.0)
    unsettled = {pair: some for pair, some in unsettled.items() if pair not in known}
    known |= {pair: np.inf for pair, some in unsettled.items() if not some}
    return Shifted(known, {pair: some for pair, some in unsettled.items() if some})


def _farthest(start: Start, pair: Pair, offset: F64) -> float:
    """Distance after the move of the two points at which a pair is nearest [m]; infinite where they are not known."""
    below, above = pair
    gap = start.gap(above, below)
    return np.inf if gap is None else float(np.linalg.norm(gap.point_a + offset - gap.point_b))


def _sinks(surfaces: Parts, start: Start, pair: Pair, some: Sequence[Two], offset: F64) -> bool:
    """True if a point at which a pair is nearest lies in the other body after the move; not asked of convex parts, whose overlap costs no more."""
    below, above = pair
    gap = start.gap(above, below)
    if gap is None or all(surfaces.parts[i].solid.convex and surfaces.parts[j].solid.convex for i, j in some):
        return False
    for entity, part, point in ((below, gap.part_b, gap.point_a + offset), (above, gap.part_a, gap.point_b - offset)):
        k = next(k for k in surfaces.parts_of[entity] if surfaces.parts[k].part == part)
        solid, pose = surfaces.shapes.solid(k, 0), surfaces.track_of(k).at(0)
        if contains(solid, pose.inverse().apply(point[None]))[0]:
            return True
    return False


def _least(start: Start, asked: Sequence[Two], offset: F64) -> F64:
    """Lower bounds of the clearances of parts after the first of each is moved [m], shape (n,); -inf where they may overlap."""
    if not asked:
        return np.empty(0)
    first, second = np.array(asked, dtype=np.intp).T
    before = np.array([start.clearance.get((min(two), max(two)), -np.inf) for two in asked])
    nearer = before - float(np.linalg.norm(offset))
    low, high = start.boxes
    apart = np.maximum(low[first] + offset - high[second], low[second] - high[first] - offset)
    between = np.linalg.norm(np.maximum(apart, 0.0), axis=1)
    least = np.maximum(nearer, between)
    return np.where(least > 0.0, least, -np.inf)
