"""Evaluator of drifting: slow motion that air, water or a field brings about."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..outcome import Outcome
from .bounds import DRIFT_SPEED, DRIFT_WORK, HALF_SIZE
from .course import course_of
from .measures import happened, onset, run_sums, span_of

if TYPE_CHECKING:
    from ....worlds.predicates import BodyEvent
    from ..scope import Scope

__all__ = ["drifts"]

MEDIA = frozenset({"fields", "matter"})


def drifts(scope: Scope, p: BodyEvent) -> Outcome:
    """Measured: level way without a break, slowly, that mostly the medium or a field drives [m]."""
    course, span = course_of(scope.candidate, p.entity), span_of(scope)
    moved = np.diff(course.centers[span.start : span.stop + 1], axis=0)
    moved = moved - (moved @ course.up)[:, None] * course.up
    way = np.linalg.norm(moved, axis=1)
    carrying, driving = np.zeros((2, len(way)))
    for origin, given in course.origins.items():
        impulse = given.impulse[span]
        # Level work: what bears it up or pulls it down is no drift.
        work = np.maximum(np.sum((impulse - (impulse @ course.up)[:, None] * course.up) * moved, axis=1) / course.step, 0.0)
        driving += work
        carrying += work if origin.kind in MEDIA else 0.0
    run = (way > 0.0) & (way <= DRIFT_SPEED * course.size * course.step)
    total, good, value = run_sums(run, driving), run_sums(run, carrying), run_sums(run, way)
    holds = (good > 0.0) & (good >= DRIFT_WORK * total)
    least = max(HALF_SIZE * course.size, p.min or 0.0)

    def tell(i: int) -> str:
        if value[i] <= 0.0 or not holds[i]:
            return f"{p.entity} does not drift in frames {scope.frames[0]}..{scope.frames[1]}: no medium or field drives a slow level way of it"
        start = span.start + onset(run, i)
        share = good[i] / total[i]
        return f"{p.entity} drifts {value[i]:.3g} m from frame {start} to {span.start + i + 1}, {share:.2g} of the work by medium or fields (needed {least:.3g})"

    return happened(scope, p.entity, value, least, "m", tell, lambda i: {"onset": span.start + onset(run, i)}, holds=holds)
