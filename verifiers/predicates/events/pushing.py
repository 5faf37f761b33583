"""Evaluators of events that one body does to another: hits, pushes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64
from ...ledgers import motion
from ...ledgers.origins import Origin
from ..outcome import Outcome
from .bounds import BLOW_HEIGHT, BLOW_IMPULSE, BLOW_LEAST, BLOW_OWN, PUSH_ALONG, PUSH_TIME, PUSH_WAY
from .course import Between, Course, between, course_of
from .measures import happened, onset, run_sums, span_of

if TYPE_CHECKING:
    from ....worlds.predicates import PairEvent
    from ..scope import Scope

__all__ = ["Blow", "blows_of", "hits", "pushes"]


class Blow(NamedTuple):
    """A contact that begins."""

    interval: int
    speed: float
    """Closing speed [m/s]."""
    impulse: float
    """Normal, from then to the end of the interval [N s]."""
    own: float
    """Share of the closing speed that is the motion of the first entity."""


def hits(scope: Scope, p: PairEvent) -> Outcome:
    """Measured: normal impulse of the blow [N s]."""
    one, two = course_of(scope.candidate, p.entity), course_of(scope.candidate, p.other)
    span = span_of(scope)
    slowest = max(BLOW_LEAST, float(np.sqrt(2.0 * one.strength * BLOW_HEIGHT * min(one.size, two.size))))
    reduced = _reduced(one, two)
    value, least = np.zeros(span.stop - span.start), np.full(span.stop - span.start, p.min or 0.0)
    told: dict[int, Blow] = {}
    nearest: Blow | None = None
    for blow in blows_of(one, two):
        i = blow.interval - span.start
        if not 0 <= i < len(value):
            continue
        nearest = max((nearest, blow), key=lambda b: b.speed if b else -1.0)
        if blow.speed >= slowest and blow.own >= BLOW_OWN and blow.impulse > value[i]:
            value[i], told[i] = blow.impulse, blow
            least[i] = max(BLOW_IMPULSE * reduced * blow.speed, p.min or 0.0)
    least = np.where(value > 0.0, least, max(p.min or 0.0, BLOW_IMPULSE * reduced * slowest, 1e-12))

    def tell(i: int) -> str:
        if i in told:
            blow = told[i]
            return (
                f"{p.entity} hits {p.other} at frame {blow.interval + 1}: closing at {blow.speed:.3g} m/s, {blow.own:.2g} of it its own, "
                f"{blow.impulse:.3g} N s (needed {least[i]:.3g})"
            )
        if nearest is None:
            return f"no contact of {p.entity} and {p.other} begins in frames {scope.frames[0]}..{scope.frames[1]}"
        return (
            f"{p.entity} does not hit {p.other}: their fastest new contact, at frame {nearest.interval + 1}, closes at {nearest.speed:.3g} m/s "
            f"(a blow: {slowest:.3g}), {nearest.own:.2g} of it the motion of {p.entity} (needed {BLOW_OWN:g})"
        )

    def detail(i: int) -> dict[str, Any]:
        blow = told.get(i, nearest)
        return {} if blow is None else {"speed": blow.speed, "own_share": blow.own, "other": p.other}

    return happened(scope, p.entity, value, least, "N s", tell, detail)


def _reduced(one: Course, two: Course) -> float:
    """Reduced mass of two bodies [kg]; what is held, static or on a path counts as infinitely heavy."""
    shares = [1.0 / c.mass for c in (one, two) if c.candidate.spec.entities[c.entity].motion == "dynamic"]
    return 1.0 / sum(shares) if shares else 0.0


def blows_of(one: Course, two: Course) -> list[Blow]:
    """Contacts of two entities that begin after an interval without any, in the order of time."""
    candidate, found = one.candidate, []
    met = between(candidate, one.entity, two.entity)
    for cache in motion.caches_with(candidate, one.entity, two.entity):
        names = cache.index.colliders
        pair = sorted((names.index(one.entity), names.index(two.entity)))
        log = cache.ragged("event/pair", "event/speed", "event/impulse", "event/point")
        for frame in range(1, candidate.frame_count):
            rows = np.flatnonzero((log[frame]["event/pair"] == pair).all(axis=1))
            if not len(rows) or (frame >= 2 and met.touched[frame - 2]):
                continue
            row = rows[int(np.argmax(log[frame]["event/speed"][rows]))]
            speed, impulse = float(log[frame]["event/speed"][row]), float(log[frame]["event/impulse"][rows].sum())
            point = np.asarray(log[frame]["event/point"][row], dtype=np.float64)
            found.append(Blow(frame - 1, speed, impulse, _own_share(one, two, met.impulse[frame - 1], point, frame - 1)))
    return found


def _own_share(one: Course, two: Course, impulse: F64, point: F64, frame: int) -> float:
    """Share of the closing speed along the impulse that is the first one's, from the motion at the frame before."""
    size = float(np.linalg.norm(impulse))
    if size == 0.0:
        return 0.0
    along = impulse / size
    mine, theirs = (float(_at_point(c, point, frame) @ along) for c in (one, two))
    closing = mine - theirs
    return float(np.clip(mine / closing, 0.0, 1.0)) if closing > 0.0 else 0.0


def _at_point(course: Course, point: F64, frame: int) -> F64:
    if course.candidate.spec.entities[course.entity].motion == "static":
        return np.zeros(3)
    result: F64 = course.velocities[frame] + np.cross(course.spins[frame], point - course.centers[frame])
    return result


class Knock(NamedTuple):
    """The longest stretch of pushing between two bodies that is too short for a push, and how the two go on."""

    onset: int
    """Frame at which it begins."""
    until: int
    """Frame by which they have parted."""
    lasted_s: float
    """[s]"""
    way: float
    """Way of the pushed one [m]."""
    given: float
    """Impulse in its first interval [N s]."""
    pusher_speed: float
    """At `until`, along that impulse [m/s]."""
    pushed_speed: float
    """The same of the pushed one [m/s]."""

    def told(self, one: str, two: str, least: float) -> str:
        """In words, with the way that a push needs [m]."""
        return (
            f"{one} touches {two} from frame {self.onset} to {self.until}, but pushes it for {self.lasted_s:.3g} s over {self.way:.3g} m only, "
            f"with {self.given:.3g} N s at first; by then {two} goes on at {self.pushed_speed:.3g} m/s and {one} at "
            f"{self.pusher_speed:.3g} m/s (needed {PUSH_TIME:g} s without a break, and {least:.3g} m)"
        )


def _knock(one: Course, two: Course, span: slice, met: Between, run: NDArray[np.bool_], pushed: F64, lasted: F64) -> Knock | None:
    """The longest push of two bodies that touch in these intervals, or their first touch; None where one does not push the other."""
    touched = met.touched[span] & (np.linalg.norm(met.impulse[span], axis=1) > 0.0)
    if not touched.any() or (_works(two, one, span) > _works(one, two, span)):
        return None
    last = int(np.argmax(lasted)) if run.any() else int(np.argmax(touched))
    first = onset(run, last)
    while last + 1 < len(touched) and touched[last + 1]:
        last += 1
    impulse = met.impulse[span.start + first]
    along = impulse / max(float(np.linalg.norm(impulse)), 1e-300)
    until = span.start + last + 1
    speeds = (float(c.velocities[until] @ along) for c in (one, two))
    return Knock(span.start + first, until, float(lasted.max()), float(pushed.max()), float(np.linalg.norm(impulse)), *speeds)


def pushes(scope: Scope, p: PairEvent) -> Outcome:
    """Measured: way of the other over which it is pushed without a break [m]: work by force."""
    one, two = course_of(scope.candidate, p.entity), course_of(scope.candidate, p.other)
    span = span_of(scope)
    met = between(scope.candidate, p.entity, p.other)
    given = two.origins.get(Origin("contact", p.entity), two.matter.get(p.entity))
    count = span.stop - span.start
    work = np.zeros(count) if given is None else given.work[span]
    moved = np.diff(two.centers[span.start : span.stop + 1], axis=0)
    impulse = met.impulse[span]
    size, way = np.linalg.norm(impulse, axis=1), np.linalg.norm(moved, axis=1)
    along = np.sum(impulse * moved, axis=1)
    free = scope.candidate.spec.entities[p.other].motion == "dynamic"
    run = met.touched[span] & free & (work > 0.0) & (along >= PUSH_ALONG * size * way) & (along > 0.0)
    pushed = run_sums(run, work * one.step / np.maximum(size, 1e-300))
    lasted = np.round(run_sums(run, np.full(count, one.step)), 9)
    done = run_sums(run, work)
    least = max(PUSH_WAY * two.size, p.min or 0.0)

    knock = _knock(one, two, span, met, run, pushed, lasted) if free and not (lasted >= PUSH_TIME).any() else None

    def tell(i: int) -> str:
        if knock is not None:
            return knock.told(p.entity, p.other, float(least))
        if pushed[i] <= 0.0:
            if not free:
                return f"{p.other} is {scope.candidate.spec.entities[p.other].motion}: nothing pushes it"
            back = two.entity if _works(two, one, span) > 0.0 else ""
            turned = f"; {back} works on it" if back else ""
            return f"{p.entity} does not work on {p.other} by contact in frames {scope.frames[0]}..{scope.frames[1]}{turned}"
        start = span.start + onset(run, i)
        return (
            f"{p.entity} pushes {p.other} over {pushed[i]:.3g} m from frame {start} to {span.start + i + 1} with {done[i]:.3g} J "
            f"(needed {least:.3g} m and {PUSH_TIME:g} s)"
        )

    def detail(i: int) -> dict[str, Any]:
        if knock is not None:
            return {**knock._asdict(), "other": p.other}
        told = {"onset": span.start + onset(run, i), "work": float(done[i]), "lasted_s": float(lasted[i]), "other": p.other}
        return told if met.touched[span].any() or not free else told | {"untouched": True}

    return happened(scope, p.entity, pushed, least, "m", tell, detail, holds=lasted >= PUSH_TIME)


def _works(by: Course, on: Course, span: slice) -> float:
    given = on.origins.get(Origin("contact", by.entity), on.matter.get(by.entity))
    return 0.0 if given is None else float(given.work[span].sum())
