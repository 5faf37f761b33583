"""Evaluators of events by which motion ends: stops, slows, rests_against, jams."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..outcome import Outcome
from .bounds import HALF_SIZE, JAM_DRIVE, JAM_HOLD, REST_TIME, SLOW_BLOW, SLOW_SHARE, SLOW_TIME, STOP_TIME
from .course import Course, between, course_of
from .leaning import held_by
from .measures import happened, onset, run_sums, span_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ....worlds.arrays import F64
    from ....worlds.predicates import BodyEvent, PairEvent
    from ..scope import Scope

__all__ = ["jams", "rests_against", "slows", "stops"]

MOTION_NOISE = 0.02
"""[m/s] Slower motion has no speed to lose; as the floor of `speed` above noise."""


def stops(scope: Scope, p: BodyEvent) -> Outcome:
    """Measured: how long it is still on end after it has come at least its half-size [s]."""
    course, span = course_of(scope.candidate, p.entity), span_of(scope)
    moving = course.judge.moving(scope.candidate, p.entity)[span.start : span.stop + 1]
    steps = np.linalg.norm(np.diff(course.centers[span.start : span.stop + 1], axis=0), axis=1)
    turns = np.linalg.norm(course.spins[span.start : span.stop], axis=1) * course.step * course.gyration
    way = np.cumsum(steps + turns)
    still = ~moving[:-1] & ~moving[1:]
    lasted = np.round(run_sums(still, np.full(len(still), course.step)), 9)
    least = max(STOP_TIME, p.min or 0.0)

    def tell(i: int) -> str:
        if lasted[i] <= 0.0 or way[i] < HALF_SIZE * course.size:
            ends = f"{way[-1]:.3g} m in all, at {np.linalg.norm(course.velocities[span.stop]):.3g} m/s at frame {span.stop}"
            return f"{p.entity} does not come to rest after a way of {HALF_SIZE * course.size:.3g} m in these frames ({ends})"
        start = span.start + onset(still, i)
        return (
            f"{p.entity} is still from frame {start} for {lasted[i]:.3g} s after a way of {way[i]:.3g} m (needed {least:.3g} s)"
        )

    def detail(i: int) -> dict[str, Any]:
        return {"onset": span.start + onset(still, i), "way": float(way[i])}

    return happened(scope, p.entity, lasted, least, "s", tell, detail, holds=way >= HALF_SIZE * course.size)


def slows(scope: Scope, p: BodyEvent) -> Outcome:
    """Measured: share of its speed that it loses without a break [1]."""
    course, span = course_of(scope.candidate, p.entity), span_of(scope)
    speeds = np.linalg.norm(course.velocities[span.start : span.stop + 1], axis=1)
    losses = -np.diff(speeds)
    run = losses > 0.0
    lost, share, from_speed = run_sums(run, losses), np.zeros(len(losses)), np.zeros(len(losses))
    most, start = 0.0, 0
    for i in range(len(losses)):
        if not run[i]:
            most, start = 0.0, i + 1
            continue
        most = max(most, float(losses[i]))
        gradual = (i + 1 - start) * course.step >= SLOW_TIME - 1e-9 and most <= SLOW_BLOW * lost[i]
        from_speed[i] = speeds[start]
        share[i] = lost[i] / speeds[start] if gradual and speeds[start] >= MOTION_NOISE else 0.0
    least = max(SLOW_SHARE, p.min or 0.0)

    def tell(i: int) -> str:
        if share[i] <= 0.0:
            return f"{p.entity} does not lose speed over {SLOW_TIME:g} s in frames {scope.frames[0]}..{scope.frames[1]}, or at one blow"
        first = span.start + onset(run, i)
        return f"{p.entity} loses {share[i]:.2g} of {from_speed[i]:.3g} m/s from frame {first} to {span.start + i + 1} (needed {least:.2g})"

    return happened(scope, p.entity, share, least, "1", tell, lambda i: {"onset": span.start + onset(run, i)})


def _still(course: Course, span: slice) -> NDArray[np.bool_]:
    """True where it is still at both ends of each interval."""
    moving = course.judge.moving(course.candidate, course.entity)[span.start : span.stop + 1]
    return np.asarray(~moving[:-1] & ~moving[1:])


def rests_against(scope: Scope, p: PairEvent) -> Outcome:
    """Measured: how long it is still on end, touching the other, without which it would not stay or by which it stopped [s]."""
    course, span = course_of(scope.candidate, p.entity), span_of(scope)
    course_of(scope.candidate, p.other)
    still = _still(course, span)
    lasted = np.round(run_sums(still, np.full(len(still), course.step)), 9)
    least = max(REST_TIME, p.min or 0.0)
    held, why = np.zeros(len(still), dtype=bool), f"{p.entity} is not still for {least:g} s"
    for i in np.flatnonzero(lasted >= least):
        if i == 0 or lasted[i - 1] < least:
            answer = held_by(course, p.other, span.start + onset(still, int(i)), span.start + int(i) + 1)
            why = why if answer is None else answer
        held[i] = answer is None

    def tell(i: int) -> str:
        if not held[i]:
            return f"{p.entity} does not rest against {p.other}: {why}"
        return f"{p.entity} rests against {p.other} for {lasted[i]:.3g} s up to frame {span.start + i + 1} (needed {least:.3g})"

    return happened(
        scope, p.entity, lasted, least, "s", tell, lambda i: {"onset": span.start + onset(still, i), "other": p.other}, holds=held
    )


def jams(scope: Scope, p: PairEvent) -> Outcome:
    """Measured: how long the other holds it still on end while something still drives it [s]."""
    course, span = course_of(scope.candidate, p.entity), span_of(scope)
    still = _still(course, span)
    drive, by = _drive(course, span)
    size = np.linalg.norm(drive, axis=1)
    given = between(scope.candidate, p.other, p.entity).impulse[span]
    against = -np.sum(given * drive, axis=1) / np.maximum(size, 1e-300)
    weight = course.mass * course.strength * course.step
    run = still & (size > 0.0) & (size >= JAM_DRIVE * weight) & (against >= JAM_HOLD * size)
    lasted = np.round(run_sums(run, np.full(len(run), course.step)), 9)
    least = max(REST_TIME, p.min or 0.0)

    def tell(i: int) -> str:
        if lasted[i] <= 0.0:
            driven = f"{by} drives it" if by else "nothing drives it"
            return f"{p.other} does not hold {p.entity} still against a drive in frames {scope.frames[0]}..{scope.frames[1]}: {driven}"
        return f"{p.other} holds {p.entity} still for {lasted[i]:.3g} s up to frame {span.start + i + 1} against {by} (needed {least:.3g})"

    return happened(
        scope, p.entity, lasted, least, "s", tell, lambda i: {"onset": span.start + onset(run, i), "other": p.other, "drive": by}
    )


def _drive(course: Course, span: slice) -> tuple[F64, str]:
    """Impulse of all that drives a body, per interval [N s], and its names: drivers, fields, springs, bodies on paths."""
    total, names = np.zeros((span.stop - span.start, 3)), []
    for origin, given in course.origins.items():
        path = origin.kind == "contact" and course.candidate.spec.entities[origin.name].motion == "kinematic"
        if (origin.kind in ("driver", "fields", "spring") or path) and given.impulse[span].any():
            total += given.impulse[span]
            names.append(f"{origin.kind} {origin.name}")
    return total, ", ".join(names)
