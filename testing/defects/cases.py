"""Seeded defects: a way to break a world, or to make a sound one look suspicious, with a magnitude."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ...worlds.candidate import Candidate

__all__ = ["Mechanism", "Suite", "World", "magnitudes"]


@dataclass(frozen=True)
class World:
    """One world to judge."""

    candidate: Candidate
    culprits: tuple[str, ...] = ()
    """Broken worlds: a detection must name one of these in its row (entity, region, beat, shot or solver), or its question; empty for clean ones."""


@dataclass(frozen=True)
class Mechanism:
    """One distinct way in which worlds of a check are broken, or look broken and are not.

    `build(folder, magnitude, rng)` makes a world whose other details (sizes, places, directions, frames) come from `rng`.
    Equal arguments give equal worlds.
    """

    name: str
    text: str
    """Fault in plain words; or why it looks wrong and is not."""
    broken: bool
    build: Callable[[Path, float, np.random.Generator], World]
    low: float
    """Least magnitude: for broken worlds just over the documented bound, so that all from here on must be detected."""
    high: float
    unit: str
    bound: float | None = None
    """The check's documented bound in `unit`; below it a world is sound. Where given, the smallest detected magnitude is searched."""
    named: tuple[float, ...] = field(default=())
    """Hand-picked magnitudes; default the least, the greatest and their geometric mean."""
    finds: tuple[str, ...] = ("fail",)
    """Statuses that count as detected. `unverified` only where the defect is missing evidence."""
    check: str = ""
    """Which check is to find it, where that is another than the suite's."""

    @property
    def hand_picked(self) -> tuple[float, ...]:
        """Magnitudes of the hand-picked worlds."""
        return self.named or (self.low, float(np.sqrt(self.low * self.high)), self.high)


@dataclass(frozen=True)
class Suite:
    """All mechanisms of one check."""

    check: str
    """Name of the check as in rows (`worlds/requirements.py`)."""
    mechanisms: tuple[Mechanism, ...]

    def __post_init__(self) -> None:
        names = [m.name for m in self.mechanisms]
        if len(set(names)) != len(names):
            raise ValueError(f"suite {self.check!r} has mechanisms of equal name")

    def of(self, *, broken: bool) -> tuple[Mechanism, ...]:
        """Mechanisms of one kind."""
        return tuple(m for m in self.mechanisms if m.broken == broken)


def magnitudes(mechanism: Mechanism, count: int, rng: np.random.Generator) -> list[float]:
    """Log-uniform magnitudes between `low` and `high`."""
    return [float(m) for m in np.exp(rng.uniform(np.log(mechanism.low), np.log(mechanism.high), count))]
