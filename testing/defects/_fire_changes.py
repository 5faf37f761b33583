"""Ways in which the frames of a fire go wrong, each by a magnitude."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...physics.combustion import greatest_power
from ...worlds.cache import Cache
from ._gas_changes import FIRST, VOLUME
from ._gas_scenes import CELL

AMBIENT = 293.15
"""[K]"""


def _told(data: dict[str, Any]) -> None:
    """Make the record of fuel that of the cells."""
    data["record/fuel_mass"] = np.float64(VOLUME * np.sum(data["gas_fuel"] * data["gas_room"], dtype=np.float64))


def _hot(data: dict[str, Any]) -> tuple[int, ...]:
    """The cell that burns most, or the hottest."""
    field = data["gas_released"] if data["gas_released"].any() else data["gas_temperature"]
    return tuple(int(i) for i in np.unravel_index(int(np.argmax(field)), field.shape))


def _cold(data: dict[str, Any], rng: np.random.Generator) -> tuple[int, ...]:
    """A cell of clear ambient air in a corner of the upper half of the box, far from all fire."""
    nx, ny, nz = data["gas_released"].shape
    return int(rng.choice([1, nx - 2])), int(rng.choice([1, ny - 2])), int(rng.integers(nz // 2, nz - 1))


def embezzle(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """A share of the fuel is lost, burnt or not, and the record with it."""
    if frame >= FIRST:
        for name in ("gas_fuel", "gas_product"):
            data[name] = (data[name] * (1.0 - magnitude)).astype(np.float32)
        _told(data)


def flatter(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """More heat is told to have been released than fuel has burnt."""
    if frame >= FIRST:
        more = magnitude * data["record/released_heat"]
        data["record/released_heat"] = data["record/released_heat"] + more
        data["record/lost_heat"] = data["record/lost_heat"] + more


def smother(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Soot is told to have been made that the fuel does not make."""
    if frame >= FIRST:
        data["record/made_soot"] = data["record/made_soot"] + magnitude * data["record/burnt_fuel"]


def dim(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """The flames of the frames give less than is recorded."""
    for name in ("gas_released", "gas_radiated"):
        data[name] = (data[name] * (1.0 - magnitude)).astype(np.float32)


def ghost(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """A share of the flames burns in a corner, in cold air without fuel."""
    if frame >= FIRST:
        moved = magnitude * data["gas_released"]
        data["gas_released"] = (data["gas_released"] - moved).astype(np.float32)
        data["gas_released"][_cold(data, rng)] += np.float32(moved.sum(dtype=np.float64))


def blast(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """A cell gives more heat than a flame does."""
    if frame >= FIRST:
        data["gas_released"][_hot(data)] = np.float32((1.0 + magnitude) * greatest_power(CELL))


def leap(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """From a frame on a share of the fire burns in a corner that no hot gas has come to, with fuel and heat there."""
    if frame >= FIRST:
        at, burning = _cold(data, rng), _hot(data)
        moved = magnitude * data["gas_released"]
        data["gas_released"] = (data["gas_released"] - moved).astype(np.float32)
        data["gas_released"][at] = np.float32(min(greatest_power(CELL), moved.sum(dtype=np.float64)))
        for name in ("gas_fuel", "gas_product", "gas_temperature"):
            data[name][at] = data[name][burning]


def stuff(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """A cell has more products than it has gas."""
    if frame >= FIRST:
        at = _hot(data)
        density = 1.2041 * AMBIENT / float(data["gas_temperature"][at])
        data["gas_product"][at] = np.float32((1.0 + magnitude) * density)


def gloom(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Flames keep what they radiate."""
    if frame >= FIRST:
        data["gas_radiated"] = (data["gas_radiated"] * (1.0 - magnitude)).astype(np.float32)


def glare(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Clear cold air radiates as much as a share of the brightest cell."""
    if frame >= FIRST:
        data["gas_radiated"][_cold(data, rng)] = np.float32(magnitude * data["gas_radiated"].max())


def forge(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Gas hotter than the hottest flame."""
    if frame >= FIRST:
        data["gas_temperature"][_hot(data)] = np.float32(3500.0 + magnitude)
