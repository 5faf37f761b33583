"""Evaluators of `pours`, `fills`, `overflows` and `leaks`: of liquids and grains in vessels."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...worlds.arrays import F64
from ...worlds.categories.event import VesselEvent
from ..predicates.conditions import Condition, happens
from .bounds import BRIMFUL, FILL_RISE, FILL_SHARE, LEAK_SHARE, OVERFLOW_SHARE, POUR_SHARE, UPRIGHT
from .granules import matter_of
from .liquid.told import painted
from .passage import Passage, passage
from .vessel import Vessel, vessel_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..predicates.outcome import Outcome
    from ..predicates.scope import Scope

__all__ = ["fills", "leaks", "overflows", "pours"]


def _judged(scope: Scope, p: VesselEvent, ask: Callable[[Passage, Vessel], list[Condition]]) -> Outcome:
    """Outcome of conditions on what goes in and out of the vessel."""
    matter = matter_of(scope.candidate, p.entity)
    if isinstance(matter, str):
        return painted(scope, "1", p.entity, matter)
    vessel = vessel_of(scope.candidate, p.other, matter.up)
    found = passage(matter, vessel, scope.frames)

    def detail(i: int) -> dict[str, object]:
        volumes = {n: float(getattr(found, n)[i]) for n in ("content", "poured", "overflowed", "spilled", "leaked")}
        return {"vessel": p.other, "capacity_m3": vessel.capacity, "tilt_rad": float(found.tilt[i]), "volumes_m3": volumes}

    return happens(scope, p.entity, ask(found, vessel), detail)


def _most(found: Passage) -> F64:
    """Most that was in the vessel so far [m^3]; never 0."""
    return np.asarray(np.maximum(np.maximum.accumulate(found.content), 1e-12))


def pours(scope: Scope, p: VesselEvent) -> Outcome:
    """Measured: share of the most that was in the vessel that left over its rim while it leaned, and fell."""

    def ask(found: Passage, vessel: Vessel) -> list[Condition]:
        del vessel
        leant = np.maximum.accumulate(found.tilt)
        return [
            Condition(f"share that left {p.other} over its rim as it leaned, and fell,", found.poured / _most(found), max(POUR_SHARE, p.min or 0.0)),
            Condition(f"most that {p.other} leaned", leant, UPRIGHT, "rad"),
        ]  # fmt: skip

    return _judged(scope, p, ask)


def fills(scope: Scope, p: VesselEvent) -> Outcome:
    """Measured: share of the vessel's volume that is full."""

    def ask(found: Passage, vessel: Vessel) -> list[Condition]:
        share = found.content / vessel.capacity
        return [
            Condition(f"share of {p.other} that it takes up", share, max(FILL_SHARE, p.min or 0.0)),
            Condition("rise of that share since it was least", share - np.minimum.accumulate(share), FILL_RISE),
        ]

    return _judged(scope, p, ask)


def overflows(scope: Scope, p: VesselEvent) -> Outcome:
    """Measured: what left over the rim of the full and upright vessel, over the vessel's volume."""

    def ask(found: Passage, vessel: Vessel) -> list[Condition]:
        return [
            Condition(f"what left over the rim of {p.other}, full and upright, over its volume,", found.overflowed / vessel.capacity, max(OVERFLOW_SHARE, p.min or 0.0)),
            Condition(f"highest that it stood in {p.other}, of its inside,", np.maximum.accumulate(found.level), BRIMFUL),
        ]  # fmt: skip

    return _judged(scope, p, ask)


def leaks(scope: Scope, p: VesselEvent) -> Outcome:
    """Measured: share of the most that was in the vessel that left lower than rim and surface, by a way that meets no wall."""

    def ask(found: Passage, vessel: Vessel) -> list[Condition]:
        del vessel
        share = found.leaked / _most(found)
        return [Condition(f"share that left {p.other} by an opening below the surface", share, max(LEAK_SHARE, p.min or 0.0))]

    return _judged(scope, p, ask)
