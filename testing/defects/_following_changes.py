"""Ways in which frames of a gas that a part of its box follows go wrong, each by a magnitude."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...worlds.cache import Cache
from ._gas_changes import FIRST
from ._gas_scenes import SOOT

__all__ = ["arrive", "leave_behind", "ooze", "stir"]


def _some(low: Any, high: Any, rng: np.random.Generator) -> tuple[int, int]:
    """A place within the active part along x and y, away from its sides."""
    return int(rng.integers(low[0] + 3, high[0] - 3)), int(rng.integers(low[1] + 3, high[1] - 3))


def arrive(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Smoke lies along the upper side of the active part, inside the box."""
    if frame >= FIRST:
        low, high = data["gas_active"]
        data["gas_soot"][(*_some(low, high, rng), high[2] - 1)] = magnitude * SOOT


def ooze(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """A share of the soot left through sides of the active part inside the box."""
    if frame >= FIRST:
        data["record/slipped_soot"] = np.float64(magnitude * data["record/emitted_soot"])


def stir(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Air moves outside the active part."""
    if frame >= FIRST:
        low, high = data["gas_active"]
        data["gas_velocity"][(*_some(low, high, rng), high[2] + 1, 2)] = magnitude


def leave_behind(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """The active part begins some cells above the floor, and the source lies below it."""
    if frame >= FIRST:
        data["gas_active"][0, 2] = max(1, round(magnitude))
