"""Events as conditions that have to hold at one frame: the measure of the event first, then what sets it apart from what is like it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.arrays import F64
from .outcome import Comparison, Outcome, Truth, finite

if TYPE_CHECKING:
    from .scope import Scope

__all__ = ["Condition", "happens", "in_digits", "lasts"]

MOST_DIGITS = 9
"""Significant digits of numbers that hardly differ."""


def in_digits(value: float, bound: float) -> tuple[str, str]:
    """Both numbers with three significant digits, or as many more as tell them apart, so that no row says that 0.99 is less than 0.99."""
    told = (f"{value:.3g}", f"{bound:.3g}")
    for digits in range(4, MOST_DIGITS + 1):
        if value == bound or told[0] != told[1]:
            break
        told = (f"{value:.{digits}g}", f"{bound:.{digits}g}")
    return told


@dataclass(frozen=True)
class Condition:
    """A measured value that has to be at least, or at most, a bound. NaN: it cannot be measured there, and does not hold."""

    told: str
    """The value in words."""
    value: F64
    """Per frame of the interval."""
    bound: F64 | float
    unit: str = "1"
    comparison: Comparison = ">="

    @property
    def over(self) -> F64:
        """By how much it holds, negative by how much it is missed; NaN as the value."""
        sign = 1.0 if self.comparison == ">=" else -1.0
        return np.asarray(sign * (self.value - self.bound))

    @property
    def holds(self) -> Truth:
        """Where it does."""
        return np.asarray(self.over >= 0.0)

    def bound_at(self, i: int) -> float:
        """The bound at a frame of the interval."""
        return float(np.broadcast_to(self.bound, self.value.shape)[i])

    def text(self, i: int) -> str:
        """Value and bound in words."""
        if not np.isfinite(self.value[i]):
            return f"{self.told} cannot be measured"
        unit = "" if self.unit == "1" else f" {self.unit}"
        most = "at least" if self.comparison == ">=" else "at most"
        value, bound = in_digits(float(self.value[i]), self.bound_at(i))
        return f"{self.told} is {value}{unit}, {most} {bound}{unit} is asked"


def happens(
    scope: Scope,
    entity: str,
    conditions: Sequence[Condition],
    detail: Callable[[int], Mapping[str, Any]] = lambda i: {},
) -> Outcome:
    """Judge whether all conditions hold together at some frame of the interval.

    Where they do, the first one's value stands there, at the frame at which it is largest; else that of the first one that is missed,
    at the frame at which most hold.

    Args:
        scope: the interval.
        entity: to whom it happens.
        conditions: the event's own measure first.
        detail: further measurements at a frame of the interval.
    """
    held = np.stack([c.holds for c in conditions])
    truth: Truth = np.asarray(held.all(axis=0))
    measure = np.nan_to_num(conditions[0].over, nan=-np.inf)
    found = bool(truth.any())
    best = np.where(truth, measure, -np.inf) if found else held.sum(axis=0) + 1e-6 * _ranked(measure)
    i = int(np.argmax(best))
    return _judged(scope, entity, conditions, truth, (found, i, scope.frames[1]), detail)


def lasts(
    scope: Scope,
    entity: str,
    conditions: Sequence[Condition],
    begin: int,
    detail: Callable[[int], Mapping[str, Any]] = lambda i: {},
) -> Outcome:
    """True if all conditions hold at every frame of the interval from one of its frames on.

    Where they do, the first one's value stands there, at the frame at which it is nearest to its bound; else that of the first one that
    is missed, at the first frame at which one is.

    Args:
        scope: the interval.
        entity: to whom it happens.
        conditions: the state's own measure first.
        begin: place in the interval of the first frame at which they can be measured; before it counts what is true there.
        detail: further measurements at a frame of the interval.
    """
    held = np.stack([c.holds for c in conditions])
    truth: Truth = np.asarray(held.all(axis=0))
    truth[:begin] = truth[begin]
    ok = bool(truth.all())
    i = begin + int(np.argmin(conditions[0].over[begin:] if ok else truth[begin:]))
    return _judged(scope, entity, conditions, truth, (ok, i, scope.frames[0] + i), detail)


def _judged(
    scope: Scope,
    entity: str,
    conditions: Sequence[Condition],
    truth: Truth,
    found: tuple[bool, int, int],
    detail: Callable[[int], Mapping[str, Any]],
) -> Outcome:
    """The outcome, shown at one place of the interval.

    Args:
        scope: the interval.
        entity: to whom it happens.
        conditions: the own measure first.
        truth: of all together at every frame.
        found: verdict, the place that is shown, and the frame at which it fails where it does.
        detail: further measurements at a place.
    """
    ok, i, fails_at = found
    shown = conditions[0] if ok else next(c for c in conditions if not c.holds[i])
    first = scope.frames[0]
    return Outcome(
        "pass" if ok else "fail",
        scope.frames,
        shown.unit,
        f"{entity} at frame {first + i}: " + "; ".join(c.text(i) for c in (conditions if ok else [shown])),
        value=finite(float(shown.value[i])),
        bound=shown.bound_at(i),
        comparison=shown.comparison,
        truth=truth,
        margin=finite(float(shown.over[i])),
        first_true_frame=first + int(np.argmax(truth)) if truth.any() else None,
        first_failing_entity=None if ok else entity,
        first_failing_frame=None if ok else fails_at,
        failing=() if ok else (entity,),
        details={"frame": first + i, **_numbers(conditions, i), **detail(i)},
    )


def _ranked(values: F64) -> F64:
    """Values by their order, the largest last; equal ones alike, so that of these the first frame is shown."""
    return np.asarray(np.searchsorted(np.sort(values), values), dtype=np.float64)


def _numbers(conditions: Sequence[Condition], i: int) -> dict[str, Any]:
    """Every condition at a frame, in its own words, with its unit."""
    return {
        "conditions": {
            c.told: {"measured": finite(float(c.value[i])), c.comparison: c.bound_at(i), "unit": c.unit} for c in conditions
        }
    }
