"""Evaluators of `floats`, `bobs` and `sinks`: what carries a body in a liquid, from the impulses on it by origin (R28, R131)."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import F64
from ....worlds.categories.liquid.events import FloatEvent, SinkEvent
from ....worlds.errors import EvidenceError
from ...ledgers.motion import centers, entity_mass
from ...predicates.conditions import Condition, happens, lasts
from ...predicates.turns import turning_points
from ..registry import judge_of
from .bodies import Bodies, impulses
from .bounds import (
    BOB_CARRIED,
    BOB_LEAST,
    BOB_SWING,
    BOB_TURNS,
    FLOAT_CARRIED,
    FLOAT_FREE,
    FLOAT_GOES_DOWN,
    FLOAT_OTHERS,
    FLOAT_PRESSED,
    FLOAT_SECONDS,
    FLOAT_THROUGHOUT,
    SINK_HEAVIER,
    SINK_LANDED,
    SINK_OTHERS,
    SINK_TO_BOTTOM,
    SINK_WAY,
    UNDER,
)
from .submerged import Submerged
from .told import liquid_or_none, painted

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ...predicates.outcome import Outcome
    from ...predicates.scope import Scope
    from .frames import Liquid

__all__ = ["bobs", "floats", "sinks"]


class _Carried:
    """Upward impulses on a body over each interval between frames, by who gave them."""

    def __init__(self, candidate: Candidate, entity: str, liquid: Liquid) -> None:
        if liquid.strength < 1e-6:
            raise EvidenceError("nothing floats or sinks where there is no gravity; give simulation.gravity or ask reaches")
        self.liquid = liquid
        self.frames = candidate.frame_count
        self.duration = liquid.duration
        self.weight = entity_mass(candidate, entity) * liquid.strength
        """[N]"""
        self.volume = float(sum(b.volume for b in candidate.entity(entity).bodies))
        given = judge_of(candidate.spec, entity).origins(candidate, entity)
        if not given:
            raise EvidenceError(f"no cache tells what acts on {entity!r}; make it dynamic and a member of a solver")
        self.up = {origin: one.impulse @ liquid.up for origin, one in given.items()}
        self.height = float(np.ptp(candidate.vertices(entity, 0) @ liquid.up))
        """Height of its box along up at frame 0 [m]."""
        self.place = centers(candidate, entity) @ liquid.up
        self._entity = entity

    @cached_property
    def pushed(self) -> F64:
        """Upward impulse of this liquid, by its own record and no more than the body received of matter [N s], shape (F - 1,)."""
        bodies = Bodies(self.liquid)
        rows = [i for i, n in enumerate(bodies.entities) if n == self._entity]
        record: F64 = impulses(self.liquid)[: self.frames, rows, :3].sum(axis=1)
        received = sum((v for o, v in self.up.items() if o.kind == "matter"), np.zeros(self.frames - 1))
        return np.minimum(record[1:] @ self.liquid.up, received)

    @cached_property
    def gravity(self) -> F64:
        """Weight that acted, downward [N s], shape (F - 1,)."""
        return -sum((v for o, v in self.up.items() if o.kind == "gravity"), np.zeros(self.frames - 1))

    @cached_property
    def others(self) -> dict[str, F64]:
        """By all but gravity and this liquid, by name [N s], each shape (F - 1,)."""
        found: dict[str, F64] = {}
        for origin, value in self.up.items():
            if origin.kind == "matter":
                found["other matter"] = value - self.pushed
            elif origin.kind != "gravity":
                found[origin.name or origin.kind] = found.get(origin.name or origin.kind, np.zeros_like(value)) + value
        return found

    @cached_property
    def borne(self) -> F64:
        """By contacts with solids [N s], shape (F - 1,)."""
        return sum((v for o, v in self.up.items() if o.kind == "contact"), np.zeros(self.frames - 1))

    @cached_property
    def span(self) -> int:
        """Frames in half a second."""
        return max(2, round(FLOAT_SECONDS / self.duration))

    def mean(self, impulses: F64, frames: tuple[int, int]) -> F64:
        """Share of its weight over the half second that ends at each frame from one to another; NaN where it would begin before frame 0."""
        wanted, span = self.weight * self.span * self.duration, self.span
        return np.array([impulses[f - span : f].sum() / wanted if f >= span else np.nan for f in range(frames[0], frames[1] + 1)])

    def density(self, member: int) -> float:
        """The body's over that of the liquid."""
        return self.weight / self.liquid.strength / (self.volume * float(self.liquid.rest_density[member]))


def floats(scope: Scope, p: FloatEvent) -> Outcome:
    """Measured: share of the body's weight that the liquid carried over the last half second; the least of all where it is to last.

    Raises:
        EvidenceError: it is to last over an interval of no more than half a second.
    """
    found = liquid_or_none(scope.candidate, p.other)
    if isinstance(found, str):
        return painted(scope, "1", p.other, found)
    liquid, member = found
    own = _Carried(scope.candidate, p.entity, liquid)
    span, bearing = own.span, own.weight * own.duration
    pressed: F64 = np.where(own.pushed >= FLOAT_PRESSED * bearing, bearing, 0.0)
    by = {name: own.mean(value, scope.frames) for name, value in own.others.items()}
    shares = [
        Condition(f"share of its weight that {p.other} carries", own.mean(own.pushed, scope.frames), max(FLOAT_CARRIED, p.min or 0.0)),
        Condition("share of the last half second in which the liquid bears it", own.mean(pressed, scope.frames), FLOAT_THROUGHOUT),
        Condition("share of the last half second in which it is free", own.mean(own.gravity, scope.frames), FLOAT_FREE),
        Condition("share of its weight that others carry", sum((np.maximum(v, 0.0) for v in by.values()), np.zeros(scope.length)), FLOAT_OTHERS, "1", "<="),
    ]  # fmt: skip
    borne = np.all([c.holds for c in shares], axis=0)
    under, down = Submerged(scope.candidate, p.entity, liquid, member), np.full(scope.length, np.nan)
    for i in np.flatnonzero(borne):
        f = scope.frames[0] + int(i)
        fell = (own.place[f - span] - own.place[f]) / own.height
        down[i] = max(fell, 0.0) if under.share(f) > UNDER else 0.0
    shares.append(Condition("way down while wholly under, over its height,", down, FLOAT_GOES_DOWN, "1", "<="))

    def detail(i: int) -> dict[str, object]:
        f = scope.frames[0] + i
        return {"span": [max(0, f - span), f], "liquid": p.other, "others": {n: float(v[i]) for n, v in by.items() if f >= span}}

    if p.when == "always":
        if scope.length <= span:
            raise EvidenceError(
                f"whether it floats always takes an interval of more than {FLOAT_SECONDS:g} s, {span} frames; give it more"
            )
        return lasts(scope, p.entity, shares, span, detail)
    return happens(scope, p.entity, shares, detail)


def bobs(scope: Scope, p: SinkEvent) -> Outcome:
    """Measured: turning points of its height so far, while the liquid and nothing else carries it."""
    found = liquid_or_none(scope.candidate, p.other)
    if isinstance(found, str):
        return painted(scope, "1", p.other, found)
    own = _Carried(scope.candidate, p.entity, found[0])
    swing = max(BOB_SWING * own.height, BOB_LEAST)
    turns = turning_points(own.place[scope.frames[0] : scope.frames[1] + 1], swing)
    others = sum((np.maximum(own.mean(v, scope.frames), 0.0) for v in own.others.values()), np.zeros(scope.length))
    conditions = (
        Condition("turning points of its height", turns, max(BOB_TURNS, p.min or 0.0)),
        Condition(
            f"share of its weight that {p.other} carries over half a second", own.mean(own.pushed, scope.frames), BOB_CARRIED
        ),
        Condition("share of the last half second in which it is free", own.mean(own.gravity, scope.frames), FLOAT_FREE),
        Condition("share of its weight that others carry", others, FLOAT_OTHERS, "1", "<="),
    )
    return happens(scope, p.entity, conditions, lambda i: {"liquid": p.other, "least_swing_m": swing})


def sinks(scope: Scope, p: SinkEvent) -> Outcome:
    """Measured: way down in the liquid in own heights, by the share of the body that is under the surface, since the interval began."""
    found = liquid_or_none(scope.candidate, p.other)
    if isinstance(found, str):
        return painted(scope, "1", p.other, found)
    liquid, member = found
    own = _Carried(scope.candidate, p.entity, liquid)
    under = Submerged(scope.candidate, p.entity, liquid, member)
    buoyancy = own.weight / max(own.density(member), 1e-9)
    bottom = SINK_LANDED * max(own.weight - buoyancy, 0.0) * own.duration
    others = sum(own.others.values(), np.zeros(own.frames - 1))
    way, helped, landed = np.zeros(scope.length), np.zeros(scope.length), np.zeros(scope.length, dtype=bool)
    pulled = weighed = 0.0
    shares = np.array([under.share(f) for f in range(scope.frames[0], scope.frames[1] + 1)])
    for i, f in enumerate(range(scope.frames[0] + 1, scope.frames[1] + 1), start=1):
        landed[i] = landed[i - 1] or (bottom > 0.0 and own.borne[f - 1] > bottom)
        wet = 0.0 if landed[i - 1] else 0.5 * float(shares[i - 1] + shares[i])
        way[i] = way[i - 1] + wet * (own.place[f - 1] - own.place[f]) / own.height
        if wet > 0.0 and not landed[i]:
            pulled, weighed = pulled + float(others[f - 1]), weighed + own.weight * own.duration
        helped[i] = abs(pulled) / weighed if weighed else 0.0
    least = np.maximum(np.where(landed, SINK_TO_BOTTOM, SINK_WAY), p.min or 0.0)
    conditions = (
        Condition("way down in it, by the share that is under, over its height,", way, least),
        Condition("share of it that is under the surface", shares, UNDER),
        Condition(f"density over that of {p.other}", np.full(scope.length, own.density(member)), SINK_HEAVIER),
        Condition("share of its weight by which others help or hinder", helped, SINK_OTHERS, "1", "<="),
    )
    return happens(scope, p.entity, conditions, lambda i: {"liquid": p.other, "at_the_bottom": bool(landed[i])})
