"""Two runs on the same prompts: differences task by task, and a paired bootstrap over tasks (Efron and Tibshirani 1993, chapter 16)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from ....worlds.errors import InputError
from .averages import LEVEL, per_task
from .runs import METRICS, Metric, Run

__all__ = ["RESAMPLES", "Comparison", "compare"]

RESAMPLES = 10_000


@dataclass(frozen=True)
class Comparison:
    """One metric of two runs."""

    metric: str
    tasks: tuple[str, ...]
    """That both runs scored."""
    left_out: tuple[str, ...]
    """That one of them did not score, or does not have."""
    first: float | None
    """Mean of the first over those tasks; None where there are none."""
    second: float | None
    difference: float | None
    """Second less first."""
    low: float | None
    """Ends of the interval of the difference; None below two tasks."""
    high: float | None
    better: str
    """`first`, `second`, or `neither` where the interval holds 0 or is unknown."""
    by_task: dict[str, float]
    """Difference of each task."""

    def as_json(self) -> dict[str, Any]:
        """Plain data."""
        return asdict(self)


def compare(first: Run, second: Run, *, metrics: Sequence[Metric] = METRICS, seed: int = 0, resamples: int = RESAMPLES) -> dict[str, Comparison]:
    """Compare two runs metric by metric, over the tasks that both scored.

    Args:
        first: one run.
        second: the other.
        metrics: to compare.
        seed: of the resampling.
        resamples: of the tasks, with replacement.

    Raises:
        InputError: the runs are of different prompts.
    """
    if first.prompts != second.prompts:
        raise InputError(f"the runs are of different prompts ({dict(first.prompts)} and {dict(second.prompts)}): their scores do not compare")
    return {m.name: _compared(first, second, m, np.random.default_rng(seed), resamples) for m in metrics}


def _compared(first: Run, second: Run, metric: Metric, rng: np.random.Generator, resamples: int) -> Comparison:
    one, two = ({task: e.value for task, e in per_task(run, metric.name).items()} for run in (first, second))
    every = tuple(dict.fromkeys([*one, *two]))
    pairs = {task: (a, b) for task in every if (a := one.get(task)) is not None and (b := two.get(task)) is not None}
    left_out = tuple(task for task in every if task not in pairs)
    if not pairs:
        return Comparison(metric.name, (), left_out, None, None, None, None, None, "neither", {})
    values = np.array(list(pairs.values()))
    change = values[:, 1] - values[:, 0]
    low = high = None
    if len(change) > 1:
        means = change[rng.integers(0, len(change), (resamples, len(change)))].mean(axis=1)
        low, high = (float(q) for q in np.quantile(means, (0.5 - LEVEL / 2, 0.5 + LEVEL / 2)))
    up, down = low is not None and low > 0.0, high is not None and high < 0.0
    better = "neither" if not (up or down) else "second" if up == metric.higher else "first"
    return Comparison(
        metric.name, tuple(pairs), left_out, float(values[:, 0].mean()), float(values[:, 1].mean()), float(change.mean()),
        low, high, better, {task: float(d) for task, d in zip(pairs, change, strict=True)},
    )  # fmt: skip
