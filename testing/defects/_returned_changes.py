"""Ways in which what a gas takes of what it carries goes wrong, each by a magnitude."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...worlds.cache import Cache

TAKEN = ("gas_returned", "gas_gained")


def _times(data: dict[str, Any], factor: float) -> None:
    for name in TAKEN:
        data[name] = (data[name] * factor).astype(data[name].dtype)


def forget(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """The gas lost a share less than what it carries got."""
    _times(data, 1.0 - magnitude)


def redouble(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """It lost a share more."""
    _times(data, 1.0 + magnitude)


def invert(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """It got what it should have lost, or a share of that."""
    _times(data, -magnitude)


def displace(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """It lost it some cells away from what it carries."""
    data["gas_returned"] = np.roll(data["gas_returned"], round(magnitude), axis=0)


def miscount(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Its cells lost a share more than all of it."""
    data["gas_returned"] = (data["gas_returned"] * (1.0 + magnitude)).astype(np.float32)
