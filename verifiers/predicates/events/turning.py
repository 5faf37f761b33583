"""Evaluators of events in which a body turns or slips on what it touches: rolls, slides, tips, spins."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64
from ...ledgers.origins import Origin
from ..outcome import Outcome
from .asked_of import AskedOf, conditions_told
from .bounds import (
    BEARS,
    BECOMES_MOTION,
    HALF_SIZE,
    LAST_TURN,
    LEVEL,
    MOST_SLIP,
    ON_FACE,
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
    asked: tuple[AskedOf, ...] = ()
    """Its conditions, and first the measure itself as far as it goes without the others."""


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
    best = max(found, key=_reached, default=none)
    asked = f" on {p.other}" if p.other else ""
    lacks = bool(best.asked) and not (np.where(best.holds, best.value, 0.0) >= least).any()
    why, broken = _conditions(best, span, scope.frames[1]) if lacks else ("", {})

    def tell(i: int) -> str:
        if best.value[i] <= 0.0 or (why and not best.holds[i]):
            reached = f"; on {best.other} {why}" if why else ""
            return f"{p.entity} {verb} nowhere{asked} in frames {scope.frames[0]}..{scope.frames[1]}{reached}"
        start, end = span.start + onset(best.run, i), span.start + i + 1
        text = f"{p.entity} {verb} on {best.other} by {best.value[i]:.3g} {unit} from frame {start} to {end} (needed {least:.3g})"
        return f"{text}; {why}" if why else text

    def detail(i: int) -> dict[str, Any]:
        return {"other": best.other or None, "onset": span.start + onset(best.run, i), **broken}

    return happened(scope, p.entity, best.value, least, unit, tell, detail, holds=best.holds)


def _reached(one: _Best) -> tuple[float, float]:
    """Most that is reached with all conditions, then without them."""
    raw = one.asked[0].value if one.asked else one.value
    return float(np.where(one.holds, one.value, 0.0).max(initial=0.0)), float(raw.max(initial=0.0))


def _conditions(best: _Best, span: slice, last: int) -> tuple[str, dict[str, Any]]:
    """Sentence and data about the conditions where the measure came furthest without the others; nothing where it came nowhere."""
    raw = best.asked[0].value
    if not len(raw) or not np.isfinite(raw).all() or raw.max() <= 0.0:
        return "", {}
    i = min(int(np.argmax(raw)), last)
    return conditions_told(best.asked, onset(raw > 0.0, i), i, span.start + 1)


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
    slips, ways = run_sums(run, _norms(met.slip)), run_sums(run, _norms(met.way))
    slipped = slips <= ROLL_SLIP * ways
    own = _norms(met.turned)
    free, turning, pace = run_sums(met.touching, own), across / np.maximum(own, 1e-300), _norms(met.way)
    slip = _norms(met.slip) / np.maximum(pace, 1e-300)
    asked_of = (
        AskedOf("turned while it touches", free, TURN_TO_ROLL, ">=", "rad", free >= TURN_TO_ROLL),
        AskedOf("share of the turn about an axis across its way", turning, LEVEL, ">=", "1", turning >= LEVEL),
        AskedOf("slip of the contact over the way between two frames", slip, MOST_SLIP, "<=", "1", slip <= MOST_SLIP),
        AskedOf("slip over the way since it rolls", slips / np.maximum(ways, 1e-300), ROLL_SLIP, "<=", "1", slipped),
        AskedOf(
            "turn that the contact runs around it, of the whole",
            around / np.maximum(full, 1e-300),
            ROLL_ROUND,
            ">=",
            "1",
            around >= ROLL_ROUND * full,
        ),
    )
    return _Best(other, angle, run, slipped & (around >= ROLL_ROUND * full), asked_of)


def slides(scope: Scope, p: TouchEvent) -> Outcome:
    """Measured: way that the point of contact slips without a break [m]."""
    course, span = course_of(scope.candidate, p.entity), span_of(scope)
    found = []
    for other in _partners(course, p.other):
        met = meeting_of(course.candidate, course.entity, other, span)
        run = met.touching & course.stirs[span] & (_norms(met.slip) >= SLIDE_SLIP * _norms(met.way)) & (_norms(met.slip) > 0.0)
        borne = _bears(course, other, p.other, span)
        run &= borne
        free, least = run_sums(met.touching, _norms(met.slip) * course.step), max(HALF_SIZE * course.size, p.min or 0.0)
        share = _norms(met.slip) / np.maximum(_norms(met.way), 1e-300)
        asked_of = (
            AskedOf("slip of the contact while they touch", free, least, ">=", "m", free >= least),
            AskedOf("slip over the way of its centre", share, SLIDE_SLIP, ">=", "1", share >= SLIDE_SLIP),
            AskedOf("borne by it", borne.astype(float), 1.0, ">=", "1", borne),
        )
        found.append(_Best(other, run_sums(run, _norms(met.slip) * course.step), run, run, asked_of))
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
    became: F64
    """Share of the energy that it lost since the highest place which became motion [1]."""
    ran: F64
    """Way of the point of contact around the body over what it turned through [1]."""


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
    edge, ran = _stays(met, run, same, angle)
    became = gained / np.maximum(lost, 1e-300)
    return Tip(other, run, angle, drop, climbed, gained >= BECOMES_MOTION * lost, edge, became, ran)


def _stays(met: Meeting, run: NDArray[np.bool_], same: NDArray[np.bool_], angle: F64) -> tuple[NDArray[np.bool_], F64]:
    """True where the point of contact stays on the body over the last radian of its turning, or since it left the face that it stood on.

    Up to then the point goes from the middle of that face to an edge of it. Also its way over what the body turned through.
    """
    result, ran, start = np.zeros(len(run), dtype=bool), np.ones(len(run)), 0
    for i in map(int, np.flatnonzero(run)):
        if i == 0 or not run[i - 1] or not same[i]:
            start = i
        since = start + int(np.searchsorted(angle[start : i + 1], max(ON_FACE, angle[i] - LAST_TURN)))
        if since >= i:
            continue
        axis, moved = met.axes[i], met.middles[i + 1] - met.middles[since + 1]
        way = float(np.linalg.norm(moved - (moved @ axis) * axis))
        turned = float(np.linalg.norm(met.lever[i])) * (angle[i] - angle[since])
        result[i], ran[i] = way < ROLL_ROUND * turned, way / max(turned, 1e-300)
    return result, ran


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
        passed = (tip.climbed >= least) | tip.freely
        over = tip.edge & (tip.drop >= least) & passed
        turn = max(TIP_TURN, p.min or 0.0)
        balance = np.minimum(np.maximum(tip.climbed / least, tip.became / BECOMES_MOTION), 1e3)
        asked_of = (
            AskedOf("turned over one edge", tip.angle, turn, ">=", "rad", tip.angle >= turn),
            AskedOf("way of that edge around it over its turn", tip.ran, ROLL_ROUND, "<=", "1", tip.edge),
            AskedOf("centre below its highest place", tip.drop, least, ">=", "m", tip.drop >= least),
            AskedOf(
                f"rise before that over {least:.2g} m, or share of the lost height that became motion over {BECOMES_MOTION:g}",
                balance,
                1.0,
                ">=",
                "1",
                passed,
            ),
        )
        found.append(_Best(other, tip.angle, tip.run, over, asked_of))
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
