"""Ways in which steam where hot matter meets water goes wrong, each by a magnitude."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...worlds.cache import Cache

TEMPERATURE = 1000.0
"""[K] Of the block of `quench`."""


def scald(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """More heat, and steam by it, is told than contacts give."""
    for name in ("steam_given", "record/steam_mass"):
        data[name] = data[name] * (1.0 + magnitude)
    data["steam_temperature"] = TEMPERATURE - (1.0 + magnitude) * (TEMPERATURE - data["steam_temperature"])


def sprawl(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """A larger area is told than hot matter and water share."""
    data["steam_area"] = data["steam_area"] * (1.0 + magnitude)


def perpetual(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Hot matter keeps a share of the heat that it gave."""
    data["steam_temperature"] = data["steam_temperature"] + magnitude * (TEMPERATURE - data["steam_temperature"])


def dilute(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Less steam is told than the heat makes."""
    data["record/steam_mass"] = data["record/steam_mass"] * (1.0 - magnitude)


def parch(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """A share of all water has become steam by the last frame."""
    data["record/steam_mass"] = np.float64(magnitude * 25.6 * frame / (cache.index.frames - 1))
