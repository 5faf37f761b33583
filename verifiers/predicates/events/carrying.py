"""Evaluators of events in which one body moves another by contact, rope or joint: lifts, lowers, pulls, throws."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ....worlds.arrays import F64, rotation_matrix
from ..outcome import Outcome
from .bounds import (
    CARRIED,
    HALF_SIZE,
    LIFT_WORK,
    PULL_TOWARD,
    PUSH_ALONG,
    PUSH_TIME,
    PUSH_WAY,
    THROW_SPEED,
    THROW_WAY,
    THROW_WORK,
    WITH,
)
from .course import Course, course_of
from .deeds import Deed, deed_of
from .measures import happened, onset, run_sums, span_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ....worlds.predicates import PairEvent
    from ..scope import Scope

__all__ = ["lifts", "lowers", "pulls", "throws"]


def _moved(
    scope: Scope, p: PairEvent, way: F64, run: NDArray[np.bool_], holds: NDArray[np.bool_], least: float, verb: str
) -> Outcome:
    """Outcome of moving the other over a way [m] in runs of intervals."""
    span, deed = span_of(scope), deed_of(scope.candidate, p.entity, p.other)
    value, done = run_sums(run, way), run_sums(run, deed.work[span])
    by = ", ".join(deed.how) or "nothing"

    def tell(i: int) -> str:
        if value[i] <= 0.0:
            return f"{p.entity} does not {verb} {p.other} in frames {scope.frames[0]}..{scope.frames[1]}: it acts on it by {by}"
        start = span.start + onset(run, i)
        return (
            f"{p.other} comes {value[i]:.3g} m from frame {start} to {span.start + i + 1} while {p.entity} works {done[i]:.3g} J on it by {by} "
            f"(to {verb}: needed {least:.3g} m)"
        )

    def detail(i: int) -> dict[str, Any]:
        return {"onset": span.start + onset(run, i), "work": float(done[i]), "by": list(deed.how), "other": p.other}

    return happened(scope, p.entity, value, least, "m", tell, detail, holds=holds)


def _moves(course: Course) -> bool:
    return course.candidate.spec.entities[course.entity].motion != "static"


def _with(one: Course, two: Course, deed: Deed, rises: F64, span: slice) -> NDArray[np.bool_]:
    """Where it goes up or down with the other by at least `WITH` of that, as what carries by contact alone has to, per interval."""
    if deed.how != ("contact",):
        return np.ones(len(rises), dtype=bool)
    own = _rise_below(one, two, span)
    return np.asarray(own * np.sign(rises) >= WITH * np.abs(rises))


def _rise_below(one: Course, two: Course, span: slice) -> F64:
    """Rise of the carrier over each interval, of that of it which is below the other's centre: the end of a beam that turns rises, its centre does not.

    Of several bodies, and of what deforms, the rise of its centre.
    """
    at = slice(span.start, span.stop + 1)
    if one.entity in one.candidate.deforming or len(one.candidate.entity(one.entity).bodies) != 1:
        return np.diff(one.heights[at])
    positions, quaternions = (track[at] for track in one.candidate.track(one.entity))
    turns = rotation_matrix(quaternions)
    arms = np.einsum("fji,fj->fi", turns[:-1], two.centers[at][:-1] - positions[:-1])
    result: F64 = (positions[1:] + np.einsum("fij,fj->fi", turns[1:], arms) - two.centers[at][:-1]) @ one.up
    return result


def lifts(scope: Scope, p: PairEvent) -> Outcome:
    """Measured: how far the other rises without a break while the entity works on it [m]."""
    one, two, span, deed = _all(scope, p)
    gains = np.diff(two.heights[span.start : span.stop + 1])
    run = (gains > 0.0) & (deed.work[span] > 0.0) & _moves(one) & _with(one, two, deed, gains, span)
    weight = two.mass * two.strength
    enough = run_sums(run, deed.work[span]) >= LIFT_WORK * weight * run_sums(run, gains)
    return _moved(scope, p, gains, run, enough, max(HALF_SIZE * two.size, p.min or 0.0), "lift")


def lowers(scope: Scope, p: PairEvent) -> Outcome:
    """Measured: how far the other goes down without a break while the entity bears it and takes its energy [m]."""
    one, two, span, deed = _all(scope, p)
    drops = -np.diff(two.heights[span.start : span.stop + 1])
    weight = two.mass * two.strength
    borne = deed.impulse[span] @ two.up >= CARRIED * weight * two.step
    run = (drops > 0.0) & borne & (deed.work[span] < 0.0) & _moves(one) & _with(one, two, deed, -drops, span)
    enough = -run_sums(run, deed.work[span]) >= LIFT_WORK * weight * run_sums(run, drops)
    return _moved(scope, p, drops, run, enough, max(HALF_SIZE * two.size, p.min or 0.0), "lower")


def _all(scope: Scope, p: PairEvent) -> tuple[Course, Course, slice, Deed]:
    one, two = course_of(scope.candidate, p.entity), course_of(scope.candidate, p.other)
    return one, two, span_of(scope), deed_of(scope.candidate, p.entity, p.other)


def pulls(scope: Scope, p: PairEvent) -> Outcome:
    """Measured: way of the other over which it is pulled without a break [m]: work by force."""
    one, two, span, deed = _all(scope, p)
    moved = np.diff(two.centers[span.start : span.stop + 1], axis=0)
    impulse, work = deed.impulse[span], deed.work[span]
    size, way = np.linalg.norm(impulse, axis=1), np.linalg.norm(moved, axis=1)
    toward = (one.centers - two.centers)[span.start : span.stop]
    toward = toward / np.maximum(np.linalg.norm(toward, axis=1, keepdims=True), 1e-12)
    run = (work > 0.0) & (np.sum(impulse * moved, axis=1) >= PUSH_ALONG * size * way)
    run &= (np.sum(impulse * toward, axis=1) >= PULL_TOWARD * size) & (scope.candidate.spec.entities[p.other].motion == "dynamic")
    lasted = np.round(run_sums(run, np.full(len(run), one.step)), 9)
    pulled = work * one.step / np.maximum(size, 1e-300)
    return _moved(scope, p, pulled, run, lasted >= PUSH_TIME, max(PUSH_WAY * two.size, p.min or 0.0), "pull")


def throws(scope: Scope, p: PairEvent) -> Outcome:
    """Measured: way that the other flies uncarried after the entity has worked on it [m]."""
    _, two, span, deed = _all(scope, p)
    count = span.stop - span.start
    flown, done = np.zeros(count), np.zeros(count)
    speeds = np.linalg.norm(two.velocities, axis=1)
    moving = 0.5 * two.mass * speeds**2
    least_speed = float(np.sqrt(2.0 * two.strength * THROW_SPEED * two.size))
    light = (two.carried < CARRIED) & ~(np.linalg.norm(deed.impulse, axis=1) > 0.0)
    lasted = work = way = 0.0
    thrown = False
    for k in range(span.start, span.stop):
        if light[k]:
            if lasted >= PUSH_TIME - 1e-9 and not thrown:
                thrown = work >= THROW_WORK * moving[k] and speeds[k] >= least_speed
            way += float(np.linalg.norm(two.centers[k + 1] - two.centers[k]))
            flown[k - span.start], done[k - span.start] = (way if thrown else 0.0), work
        elif np.linalg.norm(deed.impulse[k]) > 0.0:
            if way > 0.0:
                lasted = work = way = 0.0
                thrown = False
            lasted, work = lasted + two.step, max(0.0, work + float(deed.work[k]))
        else:
            lasted = work = way = 0.0
            thrown = False
    least = max(THROW_WAY * two.size, p.min or 0.0)

    def tell(i: int) -> str:
        if flown[i] <= 0.0:
            return f"{p.other} does not fly off from work of {p.entity} in frames {scope.frames[0]}..{scope.frames[1]}"
        return f"{p.other} flies {flown[i]:.3g} m up to frame {span.start + i + 1} after {p.entity} has worked {done[i]:.3g} J on it (needed {least:.3g})"

    return happened(scope, p.entity, flown, least, "m", tell, lambda i: {"work": float(done[i]), "other": p.other})
