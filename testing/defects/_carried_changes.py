"""Ways in which what a gas gives to what it carries goes wrong, each by a magnitude."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...worlds.cache import Cache

STREAM = 3.0
"""[m/s] Of the small worlds."""


def shove(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Bodies are told to get a share more than they got."""
    data["field/impulse"] = data["field/impulse"] * (1.0 + magnitude)


def sideways(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Bodies are told to get a share of it across the stream."""
    data["field/impulse"] = data["field/impulse"] + magnitude * np.roll(data["field/impulse"], 1, axis=1)


def unlift(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """A card in a stream along +x is told to get a share less of what lies across it, none (1) or the opposite (2)."""
    past = np.array([STREAM, 0.0, 0.0]) - data["velocity"]
    way = past / np.maximum(np.linalg.norm(past, axis=1), 1e-12)[:, None]
    given = data["field/impulse"]
    along = (given * way).sum(axis=1)[:, None] * way
    data["field/impulse"] = given - magnitude * (given - along)


def overlift(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """It is told to get a share more of it, twice as much (1)."""
    unlift(frame, data, -magnitude, rng, cache)


def puffing(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Sheets are told to get a share more than they got."""
    for axis in "xyz":
        data[f"record/air_impulse_{axis}"] = data[f"record/air_impulse_{axis}"] * (1.0 + magnitude)


def gale(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """The gas is told to be a share faster than it was."""
    data["gas_velocity"] = (data["gas_velocity"] * (1.0 + magnitude)).astype(np.float32)
