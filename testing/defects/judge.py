"""Judge seeded worlds by one check and count detections and false alarms."""

from __future__ import annotations

import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...verifiers.checks import run_checks
from ...verifiers.story.robustness import clopper_pearson
from ...worlds.requirements import Row
from .cases import Mechanism, Suite, World, magnitudes

__all__ = ["Drawn", "Judged", "Outcome", "draw", "interval", "judge", "judge_one", "outcome", "smallest_detected", "survey"]

SEARCHES = 12
"""Bisections of the magnitude below `low`; leaves the smallest detected defect known within 1/4096 of the span."""


@dataclass(frozen=True)
class Judged:
    """Verdict of one check on one world."""

    detected: bool
    """Broken: found, and the culprit named. Clean: always False."""
    alarm: bool
    """Clean: some mandatory row does not pass. Broken: always False."""
    milliseconds: float
    rows: tuple[Row, ...]


@dataclass(frozen=True)
class Outcome:
    """One judged world of a survey."""

    mechanism: str
    broken: bool
    magnitude: float
    seed: int
    named: bool
    right: bool
    milliseconds: float


def judge(check: str, mechanism: Mechanism, world: World) -> Judged:
    """Run one check on one world: the mechanism's own where it has one."""
    start = time.perf_counter()
    rows = tuple(run_checks(world.candidate, only=[mechanism.check or check]))
    spent = 1e3 * (time.perf_counter() - start)
    open_rows = [r for r in rows if r.mandatory and r.status in ("fail", "unverified")]
    if not mechanism.broken:
        return Judged(False, bool(open_rows) or not rows, spent, rows)
    found = [r for r in open_rows if r.status in mechanism.finds and _names(r, world.culprits)]
    return Judged(bool(found), False, spent, rows)


def _names(row: Row, culprits: tuple[str, ...]) -> bool:
    named = {*row.entities, row.first_failing_entity, row.question, *row.subject}
    return bool(named & set(culprits))


def judge_one(check: str, mechanism: Mechanism, magnitude: float, seed: int) -> Judged:
    """Build one world in a temporary folder and judge it."""
    with tempfile.TemporaryDirectory(prefix="worldagent-defect-") as folder:
        return judge(check, mechanism, mechanism.build(Path(folder), magnitude, np.random.default_rng(seed)))


@dataclass(frozen=True)
class Drawn:
    """One world to build and judge."""

    mechanism: str
    magnitude: float
    seed: int
    named: bool
    """Picked by hand, not drawn."""


def draw(suite: Suite, *, variants: int, seed: int, named: bool = True) -> list[Drawn]:
    """The hand-picked worlds of a suite and at least `variants` generated ones of each kind."""
    rng = np.random.default_rng(seed)
    found = []
    for broken in (True, False):
        chosen = suite.of(broken=broken)
        each = -(-variants // len(chosen)) if chosen else 0
        for mechanism in chosen:
            picked = [(m, True) for m in mechanism.hand_picked] if named else []
            for magnitude, hand in [*picked, *((m, False) for m in magnitudes(mechanism, each, rng))]:
                found.append(Drawn(mechanism.name, magnitude, int(rng.integers(2**31)), hand))
    return found


def outcome(suite: Suite, drawn: Drawn) -> Outcome:
    """Build one drawn world and judge it."""
    (mechanism,) = (m for m in suite.mechanisms if m.name == drawn.mechanism)
    verdict = judge_one(suite.check, mechanism, drawn.magnitude, drawn.seed)
    right = verdict.detected if mechanism.broken else not verdict.alarm
    return Outcome(drawn.mechanism, mechanism.broken, drawn.magnitude, drawn.seed, drawn.named, right, verdict.milliseconds)


def survey(suite: Suite, *, variants: int, seed: int, named: bool = True) -> list[Outcome]:
    """Draw worlds and judge them, one after the other."""
    return [outcome(suite, d) for d in draw(suite, variants=variants, seed=seed, named=named)]


def smallest_detected(check: str, mechanism: Mechanism, seed: int) -> float | None:
    """Smallest magnitude that is still detected, by bisection below `low` (the world's other details stay as they are)."""
    if not judge_one(check, mechanism, mechanism.low, seed).detected:
        return None
    missed, found = 0.0, mechanism.low
    for _ in range(SEARCHES):
        middle = 0.5 * (missed + found)
        if judge_one(check, mechanism, middle, seed).detected:
            found = middle
        else:
            missed = middle
    return found


def interval(hits: int, count: int) -> tuple[float, float]:
    """Two-sided 95 % interval of a proportion. Source: Clopper and Pearson (1934), doi:10.1093/biomet/26.4.404."""
    return clopper_pearson(hits, count)
