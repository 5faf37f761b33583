"""Evaluators of events of leaving what one touched: bounces, jumps."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ....worlds.arrays import F64
from ..outcome import Outcome
from .bounds import BLOW_HEIGHT, BLOW_LEAST, BOUNCE_BACK, BOUNCE_WAY, CARRIED, HALF_SIZE, JUMP_OUTSIDE, JUMP_REST
from .course import Course, between, course_of
from .measures import happened, span_of

if TYPE_CHECKING:
    from ....worlds.predicates import BodyEvent, TouchEvent
    from ..scope import Scope

__all__ = ["bounces", "jumps"]


class _Rebound(NamedTuple):
    other: str
    first: int
    """Interval in which the contact begins."""
    last: int
    """Interval in which it ends."""
    closing: float
    leaving: float
    off: F64
    """Distance that it has come off at the end of each later interval, until they touch again [m]."""


def bounces(scope: Scope, p: TouchEvent) -> Outcome:
    """Measured: how far it comes off what it bounced on [m]."""
    course, span = course_of(scope.candidate, p.entity), span_of(scope)
    count = span.stop - span.start
    value, told = np.zeros(count), dict[int, _Rebound]()
    slowest = max(BLOW_LEAST, float(np.sqrt(2.0 * course.strength * BLOW_HEIGHT * course.size)))
    for other in course.partners if p.other is None else (p.other,):
        for found in _rebounds(course, other, span):
            if found.closing < slowest or found.leaving < BOUNCE_BACK * found.closing:
                continue
            if not course.stirs[found.first : found.last + 1].any():
                continue  # It rests, and something bounces off it.
            for k, off in enumerate(found.off, found.last + 1 - span.start):
                if off > value[k]:
                    value[k], told[k] = off, found
    least = max(BOUNCE_WAY * course.size, p.min or 0.0)

    def tell(i: int) -> str:
        if i not in told:
            asked = f" off {p.other}" if p.other else ""
            return f"{p.entity} does not bounce{asked} in frames {scope.frames[0]}..{scope.frames[1]}"
        r = told[i]
        return (
            f"{p.entity} bounces off {r.other} at frame {r.last + 1}: it comes at {r.closing:.3g} m/s, leaves at {r.leaving:.3g} m/s and is "
            f"{value[i]:.3g} m off at frame {span.start + i + 1} (needed {least:.3g})"
        )

    def detail(i: int) -> dict[str, Any]:
        r = told.get(i)
        return {} if r is None else {"other": r.other, "closing": r.closing, "leaving": r.leaving, "onset": r.first}

    return happened(scope, p.entity, value, least, "m", tell, detail)


def _rebounds(course: Course, other: str, span: slice) -> list[_Rebound]:
    """Contacts with another entity that begin and end within a span, seen along their impulse."""
    met, partner = between(course.candidate, other, course.entity), course_of(course.candidate, other)
    still = course.candidate.spec.entities[other].motion == "static"
    relative = course.velocities - (0.0 if still else partner.velocities)
    place = course.centers - (0.0 if still else partner.centers)
    found, k = [], span.start
    while k < span.stop:
        if not met.touched[k]:
            k += 1
            continue
        end = k
        while end + 1 < span.stop and met.touched[end + 1]:
            end += 1
        given = met.impulse[k : end + 1].sum(axis=0)
        size = float(np.linalg.norm(given))
        if size > 0.0 and end + 1 < span.stop:
            along = given / size
            after = end + 1
            while after < span.stop and not met.touched[after]:
                after += 1
            off = np.maximum((place[end + 2 : after + 1] - place[end + 1]) @ along, 0.0)
            found.append(_Rebound(other, k, end, -float(relative[k] @ along), float(relative[end + 1] @ along), off))
        k = end + 1
    return found


def jumps(scope: Scope, p: BodyEvent) -> Outcome:
    """Measured: how far its centre rises above where it left the ground [m]."""
    course, span = course_of(scope.candidate, p.entity), span_of(scope)
    count = span.stop - span.start
    value, why = np.zeros(count), ["it never leaves the ground on its way up"] * count
    light, rising = course.carried < CARRIED, course.velocities @ course.up
    k = span.start
    while k < span.stop and course.strength > 0.0:
        if light[k] or not (k + 1 < span.stop and light[k + 1] and rising[k + 1] > 0.0):
            k += 1
            continue
        start = k
        while start > span.start and not light[start - 1] and rising[start] > 0.0:
            start -= 1
        reason = _outside(course, start, k)
        top = k + 1
        while top < span.stop and light[top] and course.heights[top + 1] > course.heights[top]:
            if not reason:
                value[top - span.start] = course.heights[top + 1] - course.heights[k + 1]
            top += 1
        if reason:
            why[k - span.start] = reason
        k = max(top, k + 1)
    least = max(HALF_SIZE * course.size, p.min or 0.0)

    def tell(i: int) -> str:
        if value[i] <= 0.0:
            said = next((w for w in why if not w.startswith("it never")), why[0] if why else "")
            return f"{p.entity} does not jump in frames {scope.frames[0]}..{scope.frames[1]}: {said}"
        return f"{p.entity} jumps {value[i]:.3g} m up to frame {span.start + i + 1} (needed {least:.3g})"

    return happened(scope, p.entity, value, least, "m", tell)


def _outside(course: Course, first: int, last: int) -> str:
    """Why leaving the ground in the intervals first..last was no jump; empty where nothing from outside brought it about."""
    leaves = float(course.velocities[last + 1] @ course.up)
    came = float(course.velocities[first] @ course.up)
    if came < -JUMP_REST * leaves:
        return f"it came down at {-came:.3g} m/s before: it bounces"
    if course.candidate.spec.entities[course.entity].motion == "kinematic":
        return "it follows a path"
    total = course.mass * (leaves - came)
    if total < (1.0 - JUMP_OUTSIDE) * course.mass * leaves:
        return f"it already rose at {came:.3g} m/s"
    for origin, given in course.origins.items():
        pushed = float((given.impulse[first : last + 1] @ course.up).sum())
        moving = origin.kind in ("driver", "fields", "matter") or (
            origin.kind == "contact" and _moving(course, origin.name, first, last)
        )
        if moving and pushed > JUMP_OUTSIDE * total:
            return f"{origin.kind} {origin.name} gives {pushed:.3g} of {total:.3g} N s"
    return ""


def _moving(course: Course, other: str, first: int, last: int) -> bool:
    """True if another entity moves over some intervals."""
    if course.candidate.spec.entities[other].motion == "static":
        return False
    partner = course_of(course.candidate, other)
    return bool(partner.judge.moving(course.candidate, other)[first : last + 2].any())
