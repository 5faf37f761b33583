"""Strengths of methods from pairs (Bradley & Terry, Biometrika 39 (1952) 324) by maximum likelihood, with intervals over raters."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ....worlds.arrays import F64
from ..statistics import RESAMPLES

__all__ = ["Comparison", "Strength", "bradley_terry", "strengths"]

TOLERANCE, MOST_ROUNDS = 1e-10, 10_000
"""Largest change of a log strength in the last round; rounds of the iteration."""
MOST_ENDLESS = 0.01
"""Share of resamples without a finite maximum above which an interval at 95 % is not told."""


@dataclass(frozen=True)
class Comparison:
    """One answer about a pair."""

    rater: str
    first: str
    second: str
    choice: str
    """`first`, `second` or `equal`, which counts as half a win of both."""


@dataclass(frozen=True)
class Strength:
    """Log strength of a method [nat]; all of a study sum to zero. A difference of d is a win of 1 / (1 + exp(-d)) of all pairs."""

    value: float
    low: float | None
    high: float | None
    """None where too many resamples have no finite maximum."""


def bradley_terry(wins: F64) -> F64 | None:
    """Log strengths of the maximum likelihood by Hunter's MM iteration (Ann. Stat. 32 (2004) 384); None where there is none that is finite.

    It is finite where every group of methods has lost to, or tied with, one outside it (Ford, Am. Math. Mon. 64 (1957) 28).

    Args:
        wins: of the row's method over the column's, shape (n, n), ties as halves.
    """
    count = len(wins)
    reach = np.linalg.matrix_power((wins > 0).astype(np.float64) + np.eye(count), count) > 0
    if not bool(reach.all()):
        return None
    met, won = wins + wins.T, wins.sum(axis=1)
    log = np.zeros(count)
    for _ in range(MOST_ROUNDS):
        power = np.exp(log)
        new = np.log(won) - np.log((met / (power[:, None] + power[None, :])).sum(axis=1))
        new -= new.mean()
        done = float(np.abs(new - log).max()) < TOLERANCE
        log = new
        if done:
            break
    return log


def strengths(
    methods: Sequence[str], told: Sequence[Comparison], *, seed: int = 1, resamples: int = RESAMPLES // 10
) -> Mapping[str, Strength] | None:
    """Strengths with 95 % percentile intervals: raters are drawn, all of whose answers belong together.

    Args:
        methods: all of them.
        told: answers.
        seed: of the draws.
        resamples: number of draws.

    Returns:
        By method; None where the answers have no finite maximum: one method (or a group) won all, or lost all.
    """
    raters = sorted({c.rater for c in told})
    tables = np.zeros((len(raters), len(methods), len(methods)))
    for c in told:
        a, b, r = methods.index(c.first), methods.index(c.second), raters.index(c.rater)
        share = {"first": 1.0, "second": 0.0, "equal": 0.5}[c.choice]
        tables[r, a, b] += share
        tables[r, b, a] += 1.0 - share
    found = bradley_terry(tables.sum(axis=0))
    if found is None:
        return None
    random = np.random.default_rng(seed)
    drawn = [bradley_terry(tables[random.integers(len(raters), size=len(raters))].sum(axis=0)) for _ in range(resamples)]
    finite = [d for d in drawn if d is not None]
    if len(finite) < math.ceil((1.0 - MOST_ENDLESS) * resamples):
        return {m: Strength(float(v), None, None) for m, v in zip(methods, found, strict=True)}
    low, high = np.quantile(np.array(finite), [0.025, 0.975], axis=0)
    return {m: Strength(float(v), float(a), float(b)) for m, v, a, b in zip(methods, found, low, high, strict=True)}
