"""Verdict of one predicate over an interval, and how a measured series becomes one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from ..rows.questions import Comparison

__all__ = ["Comparison", "Outcome", "Series", "Truth", "Verdict", "band", "finite", "judge", "missing", "vector"]

Truth: TypeAlias = NDArray[np.bool_]
Verdict = Literal["pass", "fail", "unverified"]
When = Literal["eventually", "always", "end"]


@dataclass(frozen=True)
class Outcome:
    """Verdict of a predicate over the frames [first, last], with its measured value."""

    status: Verdict
    frames: tuple[int, int]
    unit: str
    explanation: str
    """One sentence with numbers."""
    value: float | None = None
    bound: float | None = None
    comparison: Comparison = ""
    truth: Truth | None = None
    """Truth at every frame of `frames`; None where only the interval as a whole has a truth value."""
    margin: float | None = None
    """Signed robustness in `unit`: by how much the predicate is satisfied, negative by how much it is missed."""
    first_true_frame: int | None = None
    first_failing_entity: str | None = None
    first_failing_frame: int | None = None
    failing: tuple[str, ...] = ()
    """Entities that miss the requirement, where it speaks of several."""
    details: Mapping[str, Any] = field(default_factory=dict)
    """Further measurements, JSON-able."""


def finite(value: float | None) -> float | None:
    """The number, or None where it is infinite or not a number (rows hold finite numbers only)."""
    return None if value is None or not np.isfinite(value) else float(value)


def vector(point: F64) -> str:
    """A point or offset in words, millimetre digits, no zero below zero: `(+0.080, +0.000, -0.020)`."""
    return "(" + ", ".join(f"{round(float(c), 3) + 0.0:+.3f}" for c in point) + ")"


def missing(frames: tuple[int, int], unit: str, reason: str) -> Outcome:
    """No evidence, no verdict."""
    return Outcome("unverified", frames, unit, reason)


@dataclass(frozen=True)
class Series:
    """A measured quantity at every frame of an interval, with its signed distance from failing.

    `side(i)` names bound and comparison that decide at index i, `tell(i)` describes index i in words and
    `detail(i)` in numbers. Where nothing is there to measure the value is NaN and the margin -inf: not true, and no number.
    """

    frames: tuple[int, int]
    value: F64
    margin: F64
    unit: str
    entity: str
    side: Callable[[int], tuple[float, Comparison]]
    tell: Callable[[int], str]
    detail: Callable[[int], Mapping[str, Any]] = lambda i: {}


def band(value: F64, low: float | None, high: float | None) -> tuple[F64, Callable[[int], tuple[float, Comparison]]]:
    """Margin of `low <= value <= high` and the bound that is nearer to failing at an index."""
    under = value - low if low is not None else np.full(len(value), np.inf)
    over = high - value if high is not None else np.full(len(value), np.inf)

    def side(i: int) -> tuple[float, Comparison]:
        if high is None or (low is not None and under[i] <= over[i]):
            assert low is not None
            return low, ">="
        return high, "<="

    return np.minimum(under, over), side


def judge(series: Series, when: When) -> Outcome:
    """One verdict over the interval: true at some frame, at every frame, or at the last one.

    A value that is not a number fails at the first frame that has it.
    """
    first, last = series.frames
    broken = ~np.isfinite(series.value) & ~np.isinf(series.margin) | np.isnan(series.margin)
    if broken.any():
        frame = first + int(np.argmax(broken))
        return Outcome(
            "fail",
            series.frames,
            series.unit,
            f"{series.entity} has coordinates that are not finite at frame {frame}",
            first_failing_entity=series.entity,
            first_failing_frame=frame,
            failing=(series.entity,),
            details={"non_finite": True},
        )
    truth = series.margin >= 0
    true_at = np.flatnonzero(truth)
    if when == "eventually":
        index, ok, fails_at = int(np.argmax(series.margin)), bool(truth.any()), last
    elif when == "always":
        index, ok, fails_at = int(np.argmin(series.margin)), bool(truth.all()), first + int(np.argmin(truth))
    else:
        index, ok, fails_at = len(truth) - 1, bool(truth[-1]), last
    bound, comparison = series.side(index)
    return Outcome(
        "pass" if ok else "fail",
        series.frames,
        series.unit,
        series.tell(index),
        value=finite(float(series.value[index])),
        bound=bound,
        comparison=comparison,
        truth=truth,
        margin=float(series.margin[index]),
        first_true_frame=first + int(true_at[0]) if len(true_at) else None,
        first_failing_entity=None if ok else series.entity,
        first_failing_frame=None if ok else fails_at,
        failing=() if ok else (series.entity,),
        details={"frame": first + index, **series.detail(index)},
    )
