"""Onset of a cause: when and where it starts to act.

For a cause that is an instant (contact, reaching, crossing) it is one frame before its first true frame; for a process (toppling,
moving, turning) it is when the subject began to move, because a domino has struck its neighbour before it counts as toppled; for an
authored driver it is the moment at which the driver acts.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...worlds.drivers import acts_from
from ...worlds.predicates import Contact
from ..categories.registry import judge_of, logged, pressed
from ..ledgers import motion

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.spec import Beat

__all__ = ["Onset", "begins", "contact_time", "onset_of"]

INSTANTS = frozenset({"contact", "reaches", "crosses", "liquid_arrives", "gas_arrives", "hits"})
"""Kinds of predicates that come true in an instant."""


@dataclass(frozen=True)
class Onset:
    """When and where a cause starts to act."""

    sources: tuple[str, ...]
    start: float
    """[s] from which on contacts may carry its chain."""
    frame: float
    """At which it counts as having happened."""
    acting_until: int
    """Frame up to which its sources count as moving: its first true one."""
    text: str


def onset_of(candidate: Candidate, beat_id: str, first: int) -> Onset:
    """When and where a beat that came true at frame `first` started to act as a cause."""
    plan, beat = candidate.spec.simulation, candidate.spec.story.beats[beat_id]
    if beat.owner in plan.drivers:
        time, entities = acts_from(candidate.spec, beat.owner)
        sources = tuple(dict.fromkeys((*entities, beat.subject)))
        return Onset(sources, time, time * plan.fps, first, f"driver {beat.owner} acts at {time:.3f} s")
    onset = first - 1
    if beat.predicate.kind not in INSTANTS:
        active = judge_of(candidate.spec, beat.subject).moving(candidate, beat.subject)
        while onset > max(0, beat.frames[0] - 1) and active[onset]:
            onset -= 1
    # Interval frame k covers ((k-1)/fps, k/fps]: its contacts may have begun a frame earlier than k.
    start = onset / plan.fps
    if isinstance(beat.predicate, Contact):
        touched = begins(candidate, beat.predicate.a, beat.predicate.b, (beat.frames[0], first))
        start = start if touched is None else touched
    return Onset((beat.subject,), start, first, first, f"{beat_id} was first true at frame {first}")


def contact_time(candidate: Candidate, beat: Beat, first: int | None) -> float | None:
    """Event time of a beat that is a contact and came true with its first touch [s]; None for any other, and where no log tells its moment."""
    if first is None or not isinstance(beat.predicate, Contact):
        return None
    a, b = beat.predicate.a, beat.predicate.b
    if not logged(candidate.spec, a, b):
        return None
    time = begins(candidate, a, b, (beat.frames[0], first))
    return time if time is not None and time >= (first - 1) / candidate.spec.simulation.fps else None


def begins(candidate: Candidate, a: str, b: str, frames: tuple[int, int]) -> float | None:
    """Time [s] at which the first contact of the pair within the frames began; None without one.

    A pair that already touched before the interval began counts from the interval's first instant. Where no log of contacts tells, it
    is the beginning of the frame over which they first press each other: records tell no moment within it.
    """
    fps = candidate.spec.simulation.fps
    impulse = pressed(candidate, a, b)
    if impulse is not None:
        when = np.flatnonzero(impulse[frames[0] : frames[1] + 1])
        return max(0, frames[0] + int(when[0]) - 1) / fps if len(when) else None
    for cache in motion.caches_with(candidate, a, b):
        pair = sorted((cache.index.colliders.index(a), cache.index.colliders.index(b)))
        contacts, events = cache.ragged("contact/pair", "contact/impulse"), cache.ragged("event/time", "event/pair")
        for frame in range(frames[0], frames[1] + 1):
            log = events[frame]
            times = [float(t) for t, p in zip(log["event/time"], log["event/pair"].tolist(), strict=True) if p == pair]
            if pair in contacts[frame]["contact/pair"].tolist():
                return min(times, default=(frame - 1) / fps)
            if times:
                return min(times)
    return None
