"""Values per task, macro averages and their intervals over repeats."""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import fmean, stdev
from typing import NamedTuple

from ..metrics.formulas import macro_average
from .runs import Run, SampleScores

__all__ = ["LEVEL", "Estimate", "macro", "per_task"]

LEVEL = 0.95
"""Level of confidence of intervals."""


class Estimate(NamedTuple):
    """A mean with its interval."""

    value: float | None
    """None as soon as one of the values behind it is missing."""
    low: float | None
    """Ends of the interval; None below two repeats."""
    high: float | None
    scored: int
    """Samples that have a score."""
    samples: int


def per_task(run: Run, metric: str) -> dict[str, Estimate]:
    """Mean over the repeats of every task."""
    return {task: _estimate([s.scores.get(metric) for s in run.of_task(task)]) for task in run.tasks}


def macro(run: Run, metric: str) -> Estimate:
    """Macro average over tasks (R140); its interval is that of the macro averages of the single repeats."""
    repeats: dict[int, list[SampleScores]] = {}
    for sample in run.samples:
        repeats.setdefault(sample.repeat, []).append(sample)
    tasks = set(run.tasks)
    whole = [macro_average({s.task: s.scores.get(metric) for s in found}) for found in repeats.values() if {s.task for s in found} == tasks]
    known = [s.scores.get(metric) for s in run.samples]
    value = macro_average({task: estimate.value for task, estimate in per_task(run, metric).items()})
    low, high = _interval([v for v in whole if v is not None]) if value is not None else (None, None)
    return Estimate(value, low, high, sum(k is not None for k in known), len(known))


def _estimate(values: Sequence[float | None]) -> Estimate:
    known = [v for v in values if v is not None]
    value = fmean(known) if known and len(known) == len(values) else None
    low, high = _interval(known) if value is not None else (None, None)
    return Estimate(value, low, high, len(known), len(values))


def _interval(values: Sequence[float]) -> tuple[float | None, float | None]:
    """Student's interval of a mean."""
    if len(values) < 2:
        return None, None
    from scipy.stats import t

    half = float(t.ppf(0.5 + LEVEL / 2, len(values) - 1)) * stdev(values) / math.sqrt(len(values))
    mean = fmean(values)
    return mean - half, mean + half
