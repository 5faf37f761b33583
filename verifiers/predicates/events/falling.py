"""Evaluators of events of going up and down: falls, rises, lands."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64
from ..outcome import Outcome
from .bounds import CARRIED, HALF_SIZE, LAND_SPEED, LAND_TIME, UPHILL_SLOPE, UPHILL_STILL
from .course import Course, between, course_of
from .measures import happened, onset, run_sums, span_of
from .turning import tips_of

if TYPE_CHECKING:
    from ....worlds.predicates import BodyEvent, TouchEvent
    from ...ledgers.origins import Origin
    from ..scope import Scope

__all__ = ["falls", "goes_uphill", "lands", "rises"]

NOTHING = 1e-12
"""[N s] Keeps a bound above zero where there is no gravity."""


def falls(scope: Scope, p: BodyEvent) -> Outcome:
    """Measured: how far its centre goes down uncarried, or over an edge, without a break [m]."""
    course, span = course_of(scope.candidate, p.entity), span_of(scope)
    free, run = _uncarried(course, span)
    edge, over = _over_edge(course, span)
    value = np.maximum(free, edge)
    least = max(HALF_SIZE * course.size, p.min or 0.0)

    def tell(i: int) -> str:
        end = span.start + i + 1
        if value[i] <= 0.0:
            return f"{p.entity} does not fall in frames {scope.frames[0]}..{scope.frames[1]}{_why_not(course, span)}"
        how = f"over an edge on {over}" if edge[i] > free[i] else f"carried by {_share(course, span, run, i):.2g} of its weight"
        return f"{p.entity} falls {value[i]:.3g} m up to frame {end}, {how} (needed {least:.3g})"

    def detail(i: int) -> dict[str, Any]:
        return {"onset": span.start + onset(run, i), "over_edge": bool(edge[i] > free[i]), "other": over}

    return happened(scope, p.entity, value, least, "m", tell, detail)


def _share(course: Course, span: slice, run: NDArray[np.bool_], i: int) -> float:
    """Mean share of its weight that carried it in the run that holds interval i, but for the meeting that ends it."""
    shares = course.carried[span][onset(run, i) : i + 1]
    return max(float(shares[shares < CARRIED].mean()), 0.0)


def _drops(course: Course, span: slice) -> F64:
    result: F64 = -np.diff(course.heights[span.start : span.stop + 1])
    return result


def _uncarried(course: Course, span: slice) -> tuple[F64, NDArray[np.bool_]]:
    """Way that it has gone down uncarried since that began [m], and where it does; the interval in which it meets something counts to it."""
    drops, light = _drops(course, span), course.carried[span] < CARRIED
    run = light & (drops > 0.0)
    meets = np.concatenate([[False], run[:-1]])[: len(run)] & ~run & (drops > 0.0)
    run |= meets
    if course.strength == 0.0:
        return np.zeros(len(drops)), np.zeros(len(drops), dtype=bool)
    return run_sums(run, drops), run


def _over_edge(course: Course, span: slice) -> tuple[F64, str | None]:
    """Way that it has gone down while it turned over an edge, where that became motion [m]; and on whom."""
    best, on = np.zeros(span.stop - span.start), None
    if course.books is None or len(course.candidate.entity(course.entity).bodies) != 1 or course.strength == 0.0:
        return best, on
    for other in course.partners:
        tip = tips_of(course, other, span)
        value = np.where(tip.edge & tip.freely, tip.drop, 0.0)
        if value.max(initial=0.0) > best.max(initial=0.0):
            best, on = value, other
    return best, on


def _why_not(course: Course, span: slice) -> str:
    """Words on who carries it while it goes down; empty where it never does."""
    drops = _drops(course, span)
    down = drops > 0.0
    if not drops[down].sum() > HALF_SIZE * course.size:
        return ""
    share = float(np.average(course.carried[span][down], weights=drops[down]))
    return f": on its way down it is carried by {share:.2g} of its weight{_bearers(course, span, down)}"


def _bearers(course: Course, span: slice, where: NDArray[np.bool_]) -> str:
    """Who bears it most over some intervals, in words."""
    borne = {o: float((g.impulse[span] @ course.up)[where].sum()) for o, g in course.origins.items() if o.kind != "gravity"}
    most = max(borne, key=lambda o: borne[o], default=None)
    return "" if most is None or borne[most] <= 0.0 else f", most by {_named(course, most)}"


def _named(course: Course, origin: Origin) -> str:
    if origin.kind == "unlisted":
        kinematic = course.candidate.spec.entities[course.entity].motion == "kinematic"
        return "its path" if kinematic else "joints or what no record tells of"
    return origin.name if origin.kind == "contact" else f"{origin.kind} {origin.name}".strip()


def rises(scope: Scope, p: BodyEvent) -> Outcome:
    """Measured: how far its centre goes up without a break [m]; told by whose work."""
    course, span = course_of(scope.candidate, p.entity), span_of(scope)
    gains = -_drops(course, span)
    run = gains > 0.0
    height = run_sums(run, gains)
    least = max(HALF_SIZE * course.size, p.min or 0.0)

    def by(i: int) -> dict[str, float]:
        return _raised_by(course, span.start + onset(run, i), span.start + i + 1)

    def tell(i: int) -> str:
        if height[i] <= 0.0:
            return f"{p.entity} does not rise in frames {scope.frames[0]}..{scope.frames[1]}"
        works = by(i)
        most = max(works, key=lambda n: works[n], default="")
        who = f", most by {most} ({works[most]:.3g} J)" if most else ""
        start = span.start + onset(run, i)
        return f"{p.entity} rises {height[i]:.3g} m from frame {start} to {span.start + i + 1}{who} (needed {least:.3g})"

    def detail(i: int) -> dict[str, Any]:
        return {"onset": span.start + onset(run, i), "by": by(i)}

    return happened(scope, p.entity, height, least, "m", tell, detail)


def goes_uphill(scope: Scope, p: TouchEvent) -> Outcome:
    """Measured: how far its centre goes up without a break while something that does not rise with it carries it along [m]."""
    course, span = course_of(scope.candidate, p.entity), span_of(scope)
    gains = -_drops(course, span)
    level = np.diff(course.centers[span.start : span.stop + 1], axis=0)
    level = np.linalg.norm(level - (level @ course.up)[:, None] * course.up, axis=1)
    best, on, run, holds = np.zeros(len(gains)), "", np.zeros(len(gains), dtype=bool), np.zeros(len(gains), dtype=bool)
    for other in course.partners if p.other is None else (p.other,):
        borne = between(scope.candidate, other, p.entity).impulse[span] @ course.up
        partner = course_of(scope.candidate, other)
        still = scope.candidate.spec.entities[other].motion == "static"
        rise = np.zeros(len(gains)) if still else np.diff(partner.heights[span.start : span.stop + 1])
        up = (gains > 0.0) & (borne > 0.0) & (rise <= UPHILL_STILL * gains)
        height = run_sums(up, gains)
        if height.max(initial=0.0) > best.max(initial=0.0):
            best, on, run, holds = height, other, up, run_sums(up, level) >= UPHILL_SLOPE * height
    least = max(HALF_SIZE * course.size, p.min or 0.0)

    def tell(i: int) -> str:
        if best[i] <= 0.0:
            return f"{p.entity} does not go uphill in frames {scope.frames[0]}..{scope.frames[1]}"
        start = span.start + onset(run, i)
        return f"{p.entity} goes {best[i]:.3g} m up on {on} from frame {start} to {span.start + i + 1} (needed {least:.3g})"

    def detail(i: int) -> dict[str, Any]:
        start = span.start + onset(run, i)
        return {"onset": start, "other": on or None, "by": _raised_by(course, start, span.start + i + 1)}

    return happened(scope, p.entity, best, least, "m", tell, detail, holds=holds)


def _raised_by(course: Course, first: int, last: int) -> dict[str, float]:
    """Works against gravity between two frames by who did them [J], greatest first; what its own motion gave stands as `its own motion`."""
    found = {_named(course, o): float(g.work[first:last].sum()) for o, g in course.origins.items() if o.kind != "gravity"}
    speeds = course.velocities[[first, last]]
    found["its own motion"] = 0.5 * course.mass * float(np.sum(speeds[0] ** 2) - np.sum(speeds[1] ** 2))
    least = 0.01 * course.mass * course.strength * float(course.heights[last] - course.heights[first])
    return {n: w for n, w in sorted(found.items(), key=lambda item: -item[1]) if w > max(least, 0.0)}


def lands(scope: Scope, p: TouchEvent) -> Outcome:
    """Measured: impulse against gravity by which contact takes its fall [N s], once it is carried."""
    course, span = course_of(scope.candidate, p.entity), span_of(scope)
    value, who = _landings(course, span, p.other)
    floor = course.mass * np.sqrt(2.0 * course.strength * LAND_SPEED * course.size)
    least = max(float(floor), p.min or 0.0, NOTHING)

    def tell(i: int) -> str:
        if value[i] <= 0.0:
            on = f" on {p.other}" if p.other else ""
            return f"{p.entity} does not land{on} in frames {scope.frames[0]}..{scope.frames[1]}"
        return f"{p.entity} lands on {who[i]}: {value[i]:.3g} N s take its fall, carried at frame {span.start + i + 1} (needed {least:.3g})"

    return happened(scope, p.entity, value, least, "N s", tell, lambda i: {"other": who[i] or None})


def _landings(course: Course, span: slice, asked: str | None) -> tuple[F64, list[str]]:
    """Momentum along gravity that contact took from a fall after which it is carried [N s], from the frame on at which it is; and by whom."""
    count = span.stop - span.start
    value, who = np.zeros(count), [""] * count
    if course.strength == 0.0:
        return value, who
    hold = max(1, round(LAND_TIME / course.step))
    light, drops = course.carried < CARRIED, -np.diff(course.heights)
    sinking = -(course.velocities @ course.up)
    pushed = {n: between(course.candidate, n, course.entity).impulse @ course.up for n in course.partners if asked in (None, n)}
    pushed |= {n: given.impulse @ course.up for n, given in course.matter.items() if asked in (None, n)}
    fallen, since, landed = 0.0, -1, False
    for k in range(span.start, span.stop):
        if light[k] and drops[k] > 0.0:
            # Small bounces belong to the fall that they follow.
            fallen, since = (0.0, k + 1) if landed or since < 0 else (fallen, since)
            fallen, landed = max(fallen, float(sinking[k + 1]) * course.mass), False
        if since < 0 or k - since < hold - 1:
            continue
        stays = slice(k + 1 - hold, k + 1)
        still = np.ptp(course.heights[k + 1 - hold : k + 2]) < HALF_SIZE * course.size
        if still and course.carried[stays].mean() >= CARRIED and not light[stays].all():
            taken = {n: float(j[since : k + 1].sum()) for n, j in pushed.items()}
            below = max(taken, key=lambda n: taken[n], default=None)
            if below is not None and taken[below] > 0.0:
                value[k - span.start], who[k - span.start], landed = fallen, below, True
    return value, who
