"""Evaluators of events by which motion ends: stops."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..outcome import Outcome
from .bounds import HALF_SIZE, STOP_TIME
from .course import course_of
from .measures import happened, onset, run_sums, span_of

if TYPE_CHECKING:
    from ....worlds.predicates import BodyEvent
    from ..scope import Scope

__all__ = ["stops"]


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
