"""Events of bodies that a liquid does, or that happen to one, by a definition of its own: it pushes, it comes to rest (R28, R131).

A liquid bears what it touches, too. What counts as a push is therefore level: the work that its level impulse does on the level way of the
body, beside all that drives the body along.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import F64
from ....worlds.errors import EvidenceError
from ...predicates.conditions import Condition, happens
from ...predicates.events.bounds import DRIFT_WORK, PUSH_ALONG, PUSH_TIME, PUSH_WAY
from ...predicates.events.course import course_of
from ...predicates.events.measures import onset, run_sums, span_of
from ..granules import mean_depth
from .bodies import Bodies, impulses
from .bounds import REST_FROM, REST_SECONDS, REST_SPEED
from .told import liquid_or_none, painted

if TYPE_CHECKING:
    from ....worlds.predicates import BodyEvent, PairEvent
    from ...predicates.outcome import Outcome
    from ...predicates.scope import Evaluator, Scope
    from .frames import Liquid

__all__ = ["EVENTS"]

TINY = 1e-300


def _given(liquid: Liquid, entity: str) -> F64:
    """Impulse of the liquid on a body, by its own record [N s], shape (F - 1, 3)."""
    bodies = Bodies(liquid)
    rows = [i for i, n in enumerate(bodies.entities) if n == entity]
    return np.asarray(impulses(liquid)[1:, rows, :3].sum(axis=1))


def pushes(scope: Scope, p: PairEvent) -> Outcome:
    """Measured: level way of the other over which the liquid pushes it without a break [m]: work by force."""
    found = liquid_or_none(scope.candidate, p.entity)
    if isinstance(found, str):
        return painted(scope, "m", p.entity, found)
    course, span = course_of(scope.candidate, p.other), span_of(scope)
    up, step = course.up, course.step

    def level(vectors: F64) -> F64:
        return vectors - (vectors @ up)[:, None] * up

    moved = level(np.diff(course.centers[span.start : span.stop + 1], axis=0))
    impulse = level(_given(found[0], p.other)[span])
    size, way, along = np.linalg.norm(impulse, axis=1), np.linalg.norm(moved, axis=1), np.sum(impulse * moved, axis=1)
    free = scope.candidate.spec.entities[p.other].motion == "dynamic"
    run = free & (along > 0.0) & (along >= PUSH_ALONG * size * way)
    driving = np.zeros(len(run))
    for origin, given in course.origins.items():
        # What this liquid gave stands in `along`, by its own record.
        if origin.kind != "matter":
            driving += np.maximum(np.sum(level(given.impulse[span]) * moved, axis=1), 0.0)
    pushed = run_sums(run, along / np.maximum(size, TINY))
    work, others = run_sums(run, along), run_sums(run, driving)
    pad = scope.length - len(run)

    def framed(values: F64) -> F64:
        """One value per frame of the interval; at frame 0 nothing has happened yet."""
        return np.concatenate([np.zeros(pad), values])

    conditions = (
        Condition(
            f"level way over which {p.entity} pushes {p.other}", framed(pushed), max(PUSH_WAY * course.size, p.min or 0.0), "m"
        ),
        Condition("time of that without a break", framed(np.round(run_sums(run, np.full(len(run), step)), 9)), PUSH_TIME, "s"),
        Condition("share of it in the work that drives that along", framed(work / np.maximum(work + others, TINY)), DRIFT_WORK),
    )

    def detail(i: int) -> dict[str, object]:
        k = max(i - pad, 0)
        return {"onset": span.start + onset(run, k), "work": float(work[k] / step), "other": p.other} if len(run) else {}

    return happens(scope, p.entity, conditions, detail)


def stops(scope: Scope, p: BodyEvent) -> Outcome:
    """Measured: how long it is at rest on end after it has moved [s].

    A wave of height a on water of depth h moves it with a sqrt(g / h) (Lamb, Hydrodynamics, 1932, 169): below `REST_SPEED` sqrt(g h) on the mean, what still
    runs to and fro is less than that share of the depth high. At its turning points a standing wave is slow, too, so it has to last.
    """
    found = liquid_or_none(scope.candidate, p.entity)
    if isinstance(found, str):
        return painted(scope, "s", p.entity, found)
    liquid, member = found
    if liquid.strength < 1e-6:
        raise EvidenceError("no liquid comes to rest where there is no gravity; give simulation.gravity or ask liquid_speed")
    first, last = scope.frames
    speed, bound = np.zeros(scope.length), np.zeros(scope.length)
    for i, index in enumerate(range(first, last + 1)):
        frame = liquid.read(index)
        own = frame.fluid == member
        mass = frame.mass[own]
        speed[i] = float(np.sqrt((frame.squared[own] @ mass) / max(float(mass.sum()), TINY)))
        bound[i] = REST_SPEED * float(
            np.sqrt(liquid.strength * mean_depth(frame.position[own], frame.volume[own], liquid.up, liquid.spacing))
        )
    still = (speed <= bound) & (bound > 0.0)
    lasted = np.round(run_sums(still, np.full(scope.length, liquid.duration)), 9)
    conditions = (
        Condition(f"time for which {p.entity} is at rest on end", lasted, max(REST_SECONDS, p.min or 0.0), "s"),
        Condition("its mean speed", speed, bound, "m/s", "<="),
        Condition("its largest mean speed before", np.maximum.accumulate(speed), REST_FROM * bound, "m/s"),
    )
    return happens(scope, p.entity, conditions, lambda i: {"speed": float(speed[i]), "bound": float(bound[i])})


EVENTS: Mapping[str, Evaluator] = {"pushes": pushes, "stops": stops}
"""By kind: what a liquid meets by definitions of its own."""
