"""Evaluators of predicates about fire: its power, that something burns, how much of it, that it goes out (R28, R100)."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import F64
from ....worlds.categories.gas.predicates import BurntShare, FireEvent, HeatRelease
from ...predicates.conditions import Condition, happens
from ...predicates.outcome import Outcome, Series, band, judge
from .bounds import FIRE_OUT, FIRE_POWER, FIRE_TIME
from .fire_of import SolidFire, fire_of
from .flame_life import with_life
from .predicates import banded, inside, no_gas

if TYPE_CHECKING:
    from ....worlds.spec import SpecModel
    from ...predicates.scope import Scope
    from .cells import GasFrame
    from .frames import GasBox

__all__ = ["burns", "burnt_share", "goes_out", "heat_release"]


def heat_release(scope: Scope, predicate: SpecModel) -> Outcome:
    """Measured: power of the flames in a region [W]."""
    assert isinstance(predicate, HeatRelease)
    p, candidate = predicate, scope.candidate

    def measure(box: GasBox, frame: GasFrame) -> float:
        if frame.fire is None:
            return 0.0
        there = inside(candidate, p.region, box, frame)
        return box.volume * float(np.sum((frame.fire.released * frame.room)[there], dtype=np.float64))

    found = banded(scope, p, "W", f"power of the flames of {p.entity}" + (f" in {p.region}" if p.region else ""), measure)
    fire = fire_of(candidate, p.entity) if found.status == "fail" else ""
    return found if isinstance(fire, str) else with_life(found, candidate, p.entity, fire)


def burnt_share(scope: Scope, predicate: SpecModel) -> Outcome:
    """Measured: share of the mass that can become gas which has."""
    assert isinstance(predicate, BurntShare)
    p = predicate
    fire = fire_of(scope.candidate, p.entity)
    if not isinstance(fire, SolidFire):
        text = fire if isinstance(fire, str) else f"{p.entity!r} is a gas, which is no body that burns away; ask for heat_release"
        return no_gas(scope, p.entity, "1", text)
    first, last = scope.frames
    value = fire.surfaces.share(p.entity)[first : last + 1]
    margin, side = band(value, p.min, p.max)

    def tell(i: int) -> str:
        return f"{value[i]:.2%} of what can burn of {p.entity} has by frame {first + i}, {value[-1]:.2%} by frame {last}"

    return judge(Series(scope.frames, value, margin, "1", p.entity, side, tell, lambda i: {}), p.when)


def burns(scope: Scope, p: FireEvent) -> Outcome:
    """Measured: least power of its flames over 0.2 s [W]."""
    fire = fire_of(scope.candidate, p.entity)
    if isinstance(fire, str):
        return no_gas(scope, p.entity, "W", fire)
    power = fire.power(scope.frames[0], scope.frames[1])
    kept = _kept(fire.box, power)
    condition = Condition("least power of its flames over 0.2 s", kept, max(FIRE_POWER, p.min or 0.0), "W")
    found = happens(scope, p.entity, (condition,))
    hottest = fire.hottest(scope.frames[1])
    if hottest and found.status == "fail":
        return replace(found, explanation=f"{found.explanation}; {hottest}")
    return with_life(found, scope.candidate, p.entity, fire)


def goes_out(scope: Scope, p: FireEvent) -> Outcome:
    """Measured: share of the power of its flames that is gone for good."""
    fire = fire_of(scope.candidate, p.entity)
    if isinstance(fire, str):
        return no_gas(scope, p.entity, "1", fire)
    first, last = scope.frames
    power = fire.power(first, fire.box.frames - 1)
    most = np.maximum.accumulate(power)
    # From each frame on to the end of the world.
    yet = np.maximum.accumulate(power[::-1])[::-1]
    count = last - first + 1
    burnt = np.maximum.accumulate(_kept(fire.box, power))[:count]
    gone = 1.0 - yet[:count] / np.maximum(most[:count], FIRE_POWER)
    conditions = (
        Condition("share of its power that is gone for good", gone, max(1.0 - FIRE_OUT, p.min or 0.0)),
        Condition("least power of its flames over 0.2 s before", burnt, FIRE_POWER, "W"),
    )
    return with_life(happens(scope, p.entity, conditions), scope.candidate, p.entity, fire)


def _kept(box: GasBox, power: F64) -> F64:
    """Least power of the frames of the time `FIRE_TIME` up to each; 0 before."""
    count = max(1, round(FIRE_TIME / box.duration)) + 1
    if len(power) < count:
        return np.zeros_like(power)
    least = np.lib.stride_tricks.sliding_window_view(power, count).min(axis=1)
    return np.concatenate([np.zeros(count - 1), least])
