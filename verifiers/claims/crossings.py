"""Crossing of the thing that an event's words name: from one side of its extent to the other, over it (R131, R155).

Along the way of the beat's plane, or along a level axis of the thing where the beat has none, the centre of the subject comes from before the thing to
behind it, and half way it is between the ends of its width. What starts or ends upon it, as a cart on a bridge, may be within a
tenth of its extent, or half of its own size and no more than a quarter of that. A thing that moves is followed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...worlds.categories.registry import shape_of
from ...worlds.claims import reading_of
from ...worlds.crossings import crossed_by
from ...worlds.predicates import Crosses, atoms_of
from ..categories.registry import judge_of
from .bounds import CROSS_BODY, CROSS_ENDS

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from ...worlds.arrays import F64
    from ...worlds.candidate import Candidate

__all__ = ["uncrossed"]


def uncrossed(candidate: Candidate, name: str, beats: Sequence[str]) -> str | None:
    """Why no beat of an event crosses what its words name, in words; None where one does, or the words name nothing."""
    spec = candidate.spec
    reading = reading_of(spec)
    bodies = [n for n in sorted(crossed_by(spec, reading.spans, name, reading.language)) if n in candidate.solids]
    rigid = [b for b in beats if shape_of(spec.entities[spec.story.beats[b].subject]) == "solid"] if bodies else []
    why = [found for b in rigid if spec.story.beats[b].subject not in bodies for found in (_why(candidate, b, bodies),)]
    return None if not why or None in why else why[0]


def _why(candidate: Candidate, beat: str, bodies: Sequence[str]) -> str | None:
    subject, last = candidate.spec.story.beats[beat].subject, candidate.last_frame
    way = judge_of(candidate.spec, subject).centers(candidate, subject)[: last + 1]
    shift = np.array(
        [np.mean([candidate.center(n, k) - candidate.center(n, 0) for n in bodies], axis=0) for k in range(last + 1)]
    )
    thing, half, most = _corners(candidate, bodies), 0.5 * min(candidate.spec.entities[subject].dimensions.size), 0.0
    for along, across in _ways(candidate, beat, bodies):
        ends, sides = thing @ along, thing @ across
        low, high = float(ends.min()), float(ends.max())
        width = float(sides.min()) - half, float(sides.max()) + half
        slack = max(CROSS_ENDS * (high - low), min(half, CROSS_BODY * (high - low)))
        s, side = (way - shift) @ along, (way - shift) @ across
        if any(_goes(sign * s, side, sorted((sign * low, sign * high)), slack, width) for sign in (1.0, -1.0)):
            return None
        most = max(most, float(np.ptp(np.clip((s - low) / max(high - low, 1e-12), 0.0, 1.0))))
    said = f"its centre comes over {most:.0%} of its extent" if most < 1.0 - 2.0 * CROSS_ENDS else "it passes beside it"
    return f"{subject!r} does not go from one side of {', '.join(bodies)} to the other, over it: {said}"


def _goes(path: F64, side: F64, ends: Sequence[float], slack: float, width: tuple[float, float]) -> bool:
    """True where a way leads from before an extent to behind it, and over its width between.

    Args:
        path: place along the way at each frame [m].
        side: place across it [m].
        ends: of the extent [m].
        slack: how far within the extent it may begin and end [m].
        width: least and greatest place across [m].
    """
    before = path <= ends[0] + slack
    for end in np.flatnonzero(path >= ends[1] - slack):
        if before[:end].any() and _over(
            path, side, int(np.flatnonzero(before[:end])[-1]), int(end), 0.5 * (ends[0] + ends[1]), width
        ):
            return True
    return False


def _over(path: F64, side: F64, start: int, end: int, middle: float, width: tuple[float, float]) -> bool:
    """True where what goes from one side to the other between two frames is within the thing's width half way."""
    steps = range(start, end)
    at = next((k for k in steps if path[k] <= middle <= path[k + 1]), start)
    share = (middle - path[at]) / max(path[at + 1] - path[at], 1e-12)
    return bool(width[0] <= side[at] + share * (side[at + 1] - side[at]) <= width[1])


def _ways(candidate: Candidate, beat: str, bodies: Sequence[str]) -> Iterator[tuple[F64, F64]]:
    """Level ways along which the thing may be crossed, each with that across it; unit vectors."""
    gravity = np.array(candidate.spec.simulation.gravity, dtype=np.float64)
    strength = float(np.linalg.norm(gravity))
    up = -gravity / strength if strength > 0.0 else np.array([0.0, 0.0, 1.0])
    plane = _plane(candidate, beat)
    ways = [np.array(plane.normal, dtype=np.float64)] if plane is not None else []
    if not ways:
        body = candidate.entity(bodies[0]).bodies[0].name
        pose = candidate.pose(bodies[0], 0, body)
        ends = pose.apply(np.concatenate([np.zeros((1, 3)), np.eye(3)]))
        ways = list(ends[1:] - ends[0])
    for way in ways:
        level = way - (way @ up) * up
        length = float(np.linalg.norm(level))
        if length > 0.5 * float(np.linalg.norm(way)):
            along = level / length
            yield along, np.cross(up, along)


def _plane(candidate: Candidate, beat: str) -> Crosses | None:
    return next((a for a in atoms_of(candidate.spec.story.beats[beat].predicate) if isinstance(a, Crosses)), None)


def _corners(candidate: Candidate, bodies: Sequence[str]) -> F64:
    """Points of the surfaces of bodies at frame 0 [m], shape (n, 3)."""
    return np.concatenate([candidate.surface(n, p.part, 0) for n in bodies for p in candidate.entity(n).parts])
