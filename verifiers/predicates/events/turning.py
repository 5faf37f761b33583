"""Evaluators of events in which a body turns or slips on what it touches: rolls, slides, tips, spins."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64
from ...ledgers.origins import Origin
from ..outcome import Outcome
from .bounds import (
    BEARS,
    BECOMES_MOTION,
    HALF_SIZE,
    LAST_TURN,
    LEVEL,
    MOST_SLIP,
    PAST_BALANCE,
    ROLL_HOP,
    ROLL_ROUND,
    ROLL_SLIP,
    SLIDE_SLIP,
    SPIN_OWN,
    SPIN_TURN,
    TIP_TURN,
    TURN_TO_ROLL,
)
from .contact_points import Meeting, meeting_of, single
from .course import Course, between, course_of
from .measures import happened, onset, run_sums, span_of

if TYPE_CHECKING:
    from ....worlds.predicates import BodyEvent, TouchEvent
    from ..scope import Scope

__all__ = ["Tip", "rolls", "slides", "spins", "tips", "tips_of"]


class _Best(NamedTuple):
    """The measure against one other body."""

    other: str
    value: F64
    run: NDArray[np.bool_]
    holds: NDArray[np.bool_]


def _partners(course: Course, asked: str | None) -> tuple[str, ...]:
    single(course)
    return course.partners if asked is None else (asked,)


def _bears(course: Course, other: str, asked: str | None, span: slice) -> NDArray[np.bool_]:
    """Where another body counts: everywhere where it is asked about, else where no other gives more than `1 - BEARS` of what contacts bear it with."""
    if asked is not None or course.strength == 0.0:
        return np.ones(span.stop - span.start, dtype=bool)
    up = {n: between(course.candidate, n, course.entity).impulse[span] @ course.up for n in course.partners}
    borne = np.sum([np.maximum(v, 0.0) for v in up.values()], axis=0)
    return np.asarray((up[other] >= BEARS * borne) & ((up[other] > 0.0) | (borne == 0.0)))


def _outcome(scope: Scope, p: TouchEvent, found: list[_Best], least: float, unit: str, verb: str) -> Outcome:
    """The outcome against the body with which most is reached."""
    span = span_of(scope)
    count = span.stop - span.start
    none = _Best("", np.zeros(count), np.zeros(count, dtype=bool), np.zeros(count, dtype=bool))
    best = max(found, key=lambda b: float(np.where(b.holds, b.value, 0.0).max(initial=0.0)), default=none)
    asked = f" on {p.other}" if p.other else ""

    def tell(i: int) -> str:
        if best.value[i] <= 0.0:
            return f"{p.entity} {verb} nowhere{asked} in frames {scope.frames[0]}..{scope.frames[1]}"
        start, end = span.start + onset(best.run, i), span.start + i + 1
        return f"{p.entity} {verb} on {best.other} by {best.value[i]:.3g} {unit} from frame {start} to {end} (needed {least:.3g})"

    def detail(i: int) -> dict[str, Any]:
        return {"other": best.other or None, "onset": span.start + onset(best.run, i)}

    return happened(scope, p.entity, best.value, least, unit, tell, detail, holds=best.holds)


def _norms(values: F64) -> F64:
    result: F64 = np.linalg.norm(values, axis=1)
    return result


def rolls(scope: Scope, p: TouchEvent) -> Outcome:
    """Measured: angle turned through while rolling without a break [rad]."""
    course, span = course_of(scope.candidate, p.entity), span_of(scope)
    found = [_rolling(course, other, p.other, span) for other in _partners(course, p.other)]
    return _outcome(scope, p, found, max(TURN_TO_ROLL, p.min or 0.0), "rad", "rolls")


def _rolling(course: Course, other: str, asked: str | None, span: slice) -> _Best:
    met = meeting_of(course.candidate, course.entity, other, span, ROLL_HOP * course.size)
    along = met.way / np.maximum(_norms(met.way), 1e-12)[:, None]
    across = _norms(met.turned - np.sum(met.turned * along, axis=1, keepdims=True) * along)
    run = (
        met.touching & (across >= LEVEL * _norms(met.turned)) & (_norms(met.slip) <= MOST_SLIP * _norms(met.way)) & (across > 0.0)
    )
    run &= _bears(course, other, asked, span)
    angle = run_sums(run, across)
    around, full = run_sums(run, met.around), run_sums(run, across * _norms(met.lever))
    slipped = run_sums(run, _norms(met.slip)) <= ROLL_SLIP * run_sums(run, _norms(met.way))
    return _Best(other, angle, run, slipped & (around >= ROLL_ROUND * full))


def slides(scope: Scope, p: TouchEvent) -> Outcome:
    """Measured: way that the point of contact slips without a break [m]."""
    course, span = course_of(scope.candidate, p.entity), span_of(scope)
    found = []
    for other in _partners(course, p.other):
        met = meeting_of(course.candidate, course.entity, other, span)
        run = met.touching & course.stirs[span] & (_norms(met.slip) >= SLIDE_SLIP * _norms(met.way)) & (_norms(met.slip) > 0.0)
        run &= _bears(course, other, p.other, span)
        found.append(_Best(other, run_sums(run, _norms(met.slip) * course.step), run, run))
    return _outcome(scope, p, found, max(HALF_SIZE * course.size, p.min or 0.0), "m", "slides")


class Tip(NamedTuple):
    """Turning over an edge on one other body, per interval of a span."""

    other: str
    run: NDArray[np.bool_]
    angle: F64
    """Turned through since the run began [rad]."""
    drop: F64
    """Height that the centre has come down from its highest place in the run [m]."""
    climbed: F64
    """Height that the centre went up before that [m]."""
    freely: NDArray[np.bool_]
    """True where the energy that it lost since the highest place became motion."""
    edge: NDArray[np.bool_]
    """True where the point of contact stayed on the body since the run began."""


def tips_of(course: Course, other: str, span: slice) -> Tip:
    """Turning of a body over an edge on another entity."""
    met: Meeting = meeting_of(course.candidate, course.entity, other, span)
    level = _norms(met.turned - (met.turned @ course.up)[:, None] * course.up)
    run = met.touching & (level >= LEVEL * _norms(met.turned)) & (level > 0.0)
    # A body that rocks turns back: each sense is a run of its own.
    same = np.concatenate([[True], np.sum(met.turned[1:] * met.turned[:-1], axis=1) >= 0.0])[: len(run)]
    angle = _sums(run, same, level)
    heights, kinetic = (v[span.start : span.stop + 1] for v in (course.heights, course.kinetic))
    given = _passed_on(course, other, span)
    drop, climbed, gained = np.zeros((3, len(run)))
    start = top = 0
    for i in map(int, np.flatnonzero(run)):
        if i == 0 or not run[i - 1] or not same[i]:
            start = top = i
        if heights[i + 1] > heights[top]:
            top = i + 1
        drop[i], climbed[i] = heights[top] - heights[i + 1], heights[top] - heights[start]
        if top <= i:
            here = kinetic[i + 1] - kinetic[top] + given[top : i + 1].sum()
            gained[i] = max(gained[i - 1] if i > top else 0.0, here)
    lost = course.mass * course.strength * drop
    return Tip(other, run, angle, drop, climbed, gained >= BECOMES_MOTION * lost, _stays(met, run, same, angle))


def _stays(met: Meeting, run: NDArray[np.bool_], same: NDArray[np.bool_], angle: F64) -> NDArray[np.bool_]:
    """True where the point of contact stays on the body over the last radian of its turning, or since the interval in which that began.

    In that first interval it goes from the middle of a face to an edge of it.
    """
    result, start = np.zeros(len(run), dtype=bool), 0
    for i in map(int, np.flatnonzero(run)):
        if i == 0 or not run[i - 1] or not same[i]:
            start = i
        since = start + int(np.searchsorted(angle[start : i + 1], angle[i] - LAST_TURN))
        if since >= i:
            continue
        axis, moved = met.axes[i], met.middles[i + 1] - met.middles[since + 1]
        way = float(np.linalg.norm(moved - (moved @ axis) * axis))
        result[i] = way < ROLL_ROUND * float(np.linalg.norm(met.lever[i])) * (angle[i] - angle[since])
    return result


def _passed_on(course: Course, pivot: str, span: slice) -> F64:
    """Work that it does by contact on free bodies but for the one it turns on [J], per interval."""
    total = np.zeros(span.stop - span.start)
    for other in course.partners:
        if other == pivot or course.candidate.spec.entities[other].motion != "dynamic":
            continue
        given = course_of(course.candidate, other).origins.get(Origin("contact", course.entity))
        if given is not None:
            total += np.maximum(given.work[span], 0.0)
    return total


def _sums(run: NDArray[np.bool_], same: NDArray[np.bool_], gains: F64) -> F64:
    """Sums over runs that also end where `same` is false."""
    result, total = np.zeros(len(run)), 0.0
    for i in range(len(run)):
        total = (total if same[i] else 0.0) + float(gains[i]) if run[i] else 0.0
        result[i] = total
    return result


def tips(scope: Scope, p: TouchEvent) -> Outcome:
    """Measured: angle turned over an edge [rad], once the balance is passed."""
    course, span = course_of(scope.candidate, p.entity), span_of(scope)
    found = []
    for other in _partners(course, p.other):
        tip = tips_of(course, other, span)
        if p.other is None and not _bears(course, other, None, span)[tip.run].any():
            continue
        least = PAST_BALANCE * course.size
        over = tip.edge & (tip.drop >= least) & ((tip.climbed >= least) | tip.freely)
        found.append(_Best(other, tip.angle, tip.run, over))
    return _outcome(scope, p, found, max(TIP_TURN, p.min or 0.0), "rad", "tips")


def spins(scope: Scope, p: BodyEvent) -> Outcome:
    """Measured: angle turned about its own centre in one sense without a break [rad]."""
    course, span = course_of(scope.candidate, p.entity), span_of(scope)
    at = slice(span.start, span.stop + 1)
    rates, speeds = course.spins[at], _norms(course.velocities[at])
    turned = 0.5 * (rates[:-1] + rates[1:]) * course.step
    own = speeds <= SPIN_OWN * course.gyration * _norms(rates)
    free = (
        ~np.any([between(course.candidate, other, p.entity).touched[span] for other in course.partners], axis=0)
        if course.partners
        else np.ones(len(turned), dtype=bool)
    )
    slipping = np.zeros(len(turned), dtype=bool)
    for other in course.partners:
        if len(scope.candidate.entity(p.entity).bodies) == 1:
            met = meeting_of(course.candidate, p.entity, other, span)
            slipping |= met.touching & (_norms(met.slip) >= SLIDE_SLIP * _norms(met.way))
    run = (_norms(turned) > 0.0) & (free | slipping | (own[:-1] & own[1:]))
    same = np.concatenate([[True], np.sum(turned[1:] * turned[:-1], axis=1) >= 0.0])[: len(run)]
    angle = _sums(run, same, _norms(turned))
    least = max(SPIN_TURN, p.min or 0.0)

    def tell(i: int) -> str:
        return f"{p.entity} turns about its own centre by {angle[i]:.3g} rad in one sense up to frame {span.start + i + 1} (needed {least:.3g})"

    return happened(scope, p.entity, angle, least, "rad", tell, lambda i: {"onset": span.start + onset(run, i)})
