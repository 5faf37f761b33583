"""Intervals over repeats, and the paired bootstrap of two runs over their prompts: functions over plain numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean, variance

import numpy as np

__all__ = ["RESAMPLES", "Interval", "PairedDifference", "paired_bootstrap", "repeat_interval", "share_interval"]

LEVEL = 0.95
"""Of every interval."""
RESAMPLES = 10_000
"""Of every bootstrap: the ends of an interval move by less than a hundredth of its length from seed to seed."""


@dataclass(frozen=True)
class Interval:
    """Bounds of a figure at `LEVEL`."""

    low: float
    high: float


def repeat_interval(repeats: Sequence[Sequence[float]]) -> Interval | None:
    """Interval of the mean of means, each over its own repeats; None where one of them has fewer than two.

    The groups are fixed (a benchmark has these prompts and no others) and the repeats are the sample: the variance is
    sum(s_i^2 / n_i) / N^2, its degrees of freedom are Welch's and Satterthwaite's (Biometrika 34 (1947) 28).

    Args:
        repeats: values of each group.
    """
    if not repeats or any(len(group) < 2 for group in repeats):
        return None
    from scipy.stats import t

    parts = [variance(group) / len(group) for group in repeats]
    centre, total = fmean(fmean(group) for group in repeats), sum(parts)
    if total == 0.0:
        return Interval(centre, centre)
    freedom = total**2 / sum(part**2 / (len(group) - 1) for part, group in zip(parts, repeats, strict=True))
    reach = float(t.ppf((1.0 + LEVEL) / 2.0, freedom)) * math.sqrt(total) / len(repeats)
    return Interval(centre - reach, centre + reach)


def share_interval(count: int, of: int) -> Interval:
    """Wilson's interval of a share (J. Am. Stat. Assoc. 22 (1927) 209), which is not empty where all tries came out the same.

    Args:
        count: tries that came true.
        of: all of them, at least one.
    """
    z = 1.959963984540054  # of the normal distribution at `LEVEL`
    share, reach = count / of, z * z / of
    centre = (share + reach / 2.0) / (1.0 + reach)
    half = z / (1.0 + reach) * math.sqrt(share * (1.0 - share) / of + reach / (4.0 * of))
    return Interval(max(0.0, centre - half), min(1.0, centre + half))


@dataclass(frozen=True)
class PairedDifference:
    """Difference of the means of two runs over the same prompts, second less first."""

    first: float
    second: float
    difference: float
    low: float
    high: float
    same_sign: float | None
    """Share of resamples whose difference has the sign of `difference`; None where that is zero."""
    prompts: int
    resamples: int
    seed: int

    @property
    def moved(self) -> bool:
        """True where the interval leaves zero out."""
        return self.low > 0.0 or self.high < 0.0


def paired_bootstrap(
    first: Mapping[str, float], second: Mapping[str, float], *, seed: int = 1, resamples: int = RESAMPLES
) -> PairedDifference:
    """Percentile bootstrap of the mean difference (Efron & Tibshirani 1993, section 13.3): prompts are drawn, both values of one together.

    Args:
        first: value by prompt.
        second: value by the same prompts.
        seed: of the draws.
        resamples: number of draws.

    Raises:
        ValueError: the prompts differ, or there are none.
    """
    if first.keys() != second.keys() or not first:
        raise ValueError(f"both sides need the same prompts, and at least one; {len(first)} and {len(second)} are given")
    names = sorted(first)
    paired = np.array([second[n] - first[n] for n in names])
    drawn = np.random.default_rng(seed).integers(len(names), size=(resamples, len(names)))
    means = paired[drawn].mean(axis=1)
    mean = float(paired.mean())
    low, high = (float(v) for v in np.quantile(means, [(1.0 - LEVEL) / 2.0, (1.0 + LEVEL) / 2.0]))
    same = None if mean == 0.0 else float(np.mean(np.sign(means) == np.sign(mean)))
    return PairedDifference(
        fmean(first[n] for n in names), fmean(second[n] for n in names), mean, low, high, same, len(names), resamples, seed
    )
