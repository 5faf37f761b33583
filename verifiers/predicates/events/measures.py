"""Shared by the evaluators of events: the span that an interval of frames covers, sums over runs, and the outcome of a measure."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64
from ..outcome import Comparison, Outcome, Series, judge

if TYPE_CHECKING:
    from ..scope import Scope

__all__ = ["happened", "onset", "run_sums", "span_of"]


def span_of(scope: Scope) -> slice:
    """Intervals between frames that end within the scope's frames; the first may begin one frame before."""
    return slice(max(0, scope.frames[0] - 1), scope.frames[1])


def run_sums(flags: NDArray[np.bool_], gains: F64) -> F64:
    """Sum of the gains since the run of true flags began, 0 where the flag is false, shape (n,)."""
    total = np.cumsum(np.where(flags, gains, 0.0))
    before = np.maximum.accumulate(np.where(flags, -1, np.arange(len(flags))))
    base = np.where(before >= 0, total[np.maximum(before, 0)], 0.0)
    return np.where(flags, total - base, 0.0)


def onset(flags: NDArray[np.bool_], index: int) -> int:
    """First index of the run of true flags that holds `index`; `index` itself where its flag is false."""
    while index > 0 and flags[index] and flags[index - 1]:
        index -= 1
    return index


def happened(
    scope: Scope,
    entity: str,
    value: F64,
    least: float | F64,
    unit: str,
    tell: Callable[[int], str],
    detail: Callable[[int], Mapping[str, Any]] = lambda i: {},
    *,
    holds: NDArray[np.bool_] | None = None,
) -> Outcome:
    """Outcome of an event whose measure over the intervals of `span_of` has to reach a bound.

    Args:
        scope: the evaluation.
        entity: to whom it happens.
        value: the measure at the end of each interval.
        least: what it has to reach, a number or one per interval.
        unit: of the measure.
        tell: describes interval i in words.
        detail: the same in numbers.
        holds: where the event's other conditions hold; elsewhere the measure counts as none.
    """
    bound = np.broadcast_to(np.asarray(least, dtype=np.float64), value.shape)
    value = value if holds is None else np.where(holds, value, 0.0)
    bad = ~np.isfinite(value)
    pad = scope.length - len(value)
    margin = np.where(bad, np.nan, value - bound)
    lead = np.zeros(pad)
    first = float(bound[0]) if len(bound) else float(np.asarray(least).reshape(-1)[0]) if np.size(least) else 1.0
    margins, values = np.concatenate([lead - first, margin]), np.concatenate([lead, value])

    def side(i: int) -> tuple[float, Comparison]:
        return (float(bound[i - pad]) if i >= pad else first), ">="

    def told(i: int) -> str:
        return tell(max(i - pad, 0)) if len(value) else f"nothing can happen to {entity} within one frame"

    def more(i: int) -> Mapping[str, Any]:
        return detail(max(i - pad, 0)) if len(value) else {}

    return judge(Series(scope.frames, values, margins, unit, entity, side, told, more), "eventually")
