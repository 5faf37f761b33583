"""Ways in which the frames of a gas go wrong, each by a magnitude; and some that look wrong and are not."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.cache import Cache
from ._gas_scenes import CELL, SOOT

__all__ = ["Change"]

Change = Callable[[int, dict[str, Any], float, np.random.Generator, Cache], None]
"""Changes the channels and records of a frame; given are the frame, the magnitude, what draws details, and the cache as simulated."""
FIRST = 5
"""Frame from which on a defect stands."""
FIELDS = ("gas_soot", "gas_temperature", "gas_velocity")
VOLUME = CELL**3


def _mass(data: dict[str, Any]) -> float:
    return VOLUME * float(np.sum(data["gas_soot"] * data["gas_room"], dtype=np.float64))


def _tell(data: dict[str, Any]) -> None:
    """Make the record of soot that of the cells."""
    data["record/soot_mass"] = np.float64(_mass(data))


def _thickest(data: dict[str, Any]) -> tuple[int, ...]:
    return tuple(int(i) for i in np.unravel_index(int(np.argmax(data["gas_soot"])), data["gas_soot"].shape))


def _clear(data: dict[str, Any], rng: np.random.Generator) -> tuple[int, ...]:
    """A cell in open and clear air, away from sides, in the upper half of the box."""
    shape = data["gas_soot"].shape
    free = (data["gas_soot"] < 1e-6 * SOOT) & (data["gas_room"] > 0.999)
    free[:, :, : shape[2] // 2] = False
    inner = np.zeros_like(free)
    inner[3:-3, 3:-3, 2:-2] = True
    at = np.argwhere(free & inner)
    return tuple(int(i) for i in at[rng.integers(len(at))])


def fade(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """A share of the soot is lost, and the record with it."""
    if frame >= FIRST:
        data["gas_soot"] = (data["gas_soot"] * (1.0 - magnitude)).astype(np.float32)
        _tell(data)


def grow(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Soot comes from nowhere, and the record with it."""
    fade(frame, data, -magnitude, rng, cache)


def forge(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """The record of soot is too large."""
    if frame >= FIRST:
        data["record/soot_mass"] = data["record/soot_mass"] * (1.0 + magnitude)


def slip(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """A share of the soot is gone and told to have left through a side, which nothing passed."""
    if frame >= FIRST:
        before = _mass(data)
        fade(frame, data, magnitude, rng, cache)
        data["record/escaped_soot"] = data["record/escaped_soot"] + before - _mass(data)


def withhold(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """A share of the heat is gone, and the record with it."""
    if frame >= FIRST:
        old = data["gas_temperature"].astype(np.float64)
        light = (1.0 - 293.15 / old) * (1.0 - magnitude)
        data["gas_temperature"] = (293.15 / (1.0 - light)).astype(np.float32)
        data["record/heat"] = data["record/heat"] * (1.0 - magnitude)


def vent_heat(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """The same, told to have left through a side."""
    if frame >= FIRST:
        before = float(data["record/heat"])
        withhold(frame, data, magnitude, rng, cache)
        data["record/escaped_heat"] = data["record/escaped_heat"] + before - float(data["record/heat"])


def overfeed(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """The source lets out too much, and all books say so."""
    data["gas_soot"] = (data["gas_soot"] * (1.0 + magnitude)).astype(np.float32)
    for name in ("emitted_soot", "escaped_soot"):
        data[f"record/{name}"] = data[f"record/{name}"] * (1.0 + magnitude)
    _tell(data)


def misread(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """More gas is told to have come than the drivers let out."""
    data["record/volume_emitted"] = data["record/volume_emitted"] * (1.0 + magnitude)


def teleport(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Some soot is all at once in a cell that the gas has not come to."""
    if frame >= FIRST:
        soot, at = data["gas_soot"].astype(np.float64), _clear(cache.read(FIRST), rng)
        added = magnitude * SOOT
        total = float((soot * data["gas_room"]).sum())
        soot *= 1.0 - added * float(data["gas_room"][at]) / total
        soot[at] += added
        data["gas_soot"] = soot.astype(np.float32)


def stall(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """A frame is that before, a number of times; only its books go on."""
    if FIRST <= frame < FIRST + round(magnitude):
        old = cache.read(FIRST - 1)
        for name in FIELDS:
            data[name] = np.array(old[name])


def jump(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Soot and heat stand some cells aside."""
    if frame >= FIRST:
        for name in ("gas_soot", "gas_temperature"):
            data[name] = np.roll(data[name], round(magnitude), axis=0)


def haze(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Even smoke all over, with a hole that nothing makes."""
    data["gas_soot"] = np.full_like(data["gas_soot"], 0.5 * SOOT)
    if frame >= FIRST:
        data["gas_soot"][_clear(cache.read(FIRST), rng)] *= 1.0 - magnitude


def chill(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """A cell is colder than the air."""
    if frame >= FIRST:
        data["gas_temperature"][_clear(cache.read(FIRST), rng)] -= np.float32(magnitude)


def scorch(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """A cell is hotter than the source."""
    if frame >= FIRST:
        data["gas_temperature"][_thickest(data)] = np.float32(400.0 + magnitude)


def owe(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """A cell holds less than no soot."""
    if frame >= FIRST:
        data["gas_soot"][_clear(cache.read(FIRST), rng)] = np.float32(-magnitude * SOOT)


def clot(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """A cell is denser than the source."""
    if frame >= FIRST:
        data["gas_soot"][_thickest(data)] = np.float32((1.0 + magnitude) * SOOT)


def spout(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """The air of a cell goes up out of nothing."""
    if frame >= FIRST:
        data["gas_velocity"][(*_clear(cache.read(FIRST), rng), 2)] += np.float32(magnitude)


def press(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """All air runs apart from the middle of the box."""
    if frame >= FIRST:
        speed = data["gas_velocity"]
        for axis in range(3):
            n = speed.shape[axis]
            ramp = (np.arange(n) - 0.5 * (n - 1)) / n
            speed[..., axis] += np.float32(magnitude) * ramp.reshape([-1 if a == axis else 1 for a in range(3)]).astype(
                np.float32
            )


def hurry(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """All gas is faster than the source and buoyancy make it."""
    if frame >= FIRST:
        data["gas_velocity"] = (data["gas_velocity"] * (1.0 + magnitude)).astype(np.float32)
        data["record/max_speed"] = data["record/max_speed"] * (1.0 + magnitude)


def whirl(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """A wheel of air, free of divergence, turns out of nothing."""
    if frame >= FIRST:
        nx, ny = data["gas_velocity"].shape[:2]
        x, y = (np.arange(n) + 0.5 - 0.5 * n for n in (nx, ny))
        psi = np.exp(-(x[:, None] ** 2 + y[None, :] ** 2) / 9.0)
        data["gas_velocity"][..., 0] += (magnitude * psi * -y[None, :])[..., None].astype(np.float32)
        data["gas_velocity"][..., 1] += (magnitude * psi * x[:, None])[..., None].astype(np.float32)


def unsolved(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """The pressure was not solved."""
    if frame >= FIRST:
        data["record/divergence"] = np.float64(magnitude)


def capped(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """A share of all steps ended at the cap of iterations."""
    data["record/capped"] = np.float64(magnitude * float(data["record/steps"]))


def skip(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """A frame has too few steps for the longest allowed."""
    if frame == FIRST:
        data["record/steps"] = np.float64(round(magnitude))


def wall_up(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Cells in open air are closed."""
    for _ in range(round(magnitude)):
        data["gas_room"][_clear(cache.read(FIRST), rng)] = 0.0


def seep(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Soot is in a closed cell."""
    if frame >= FIRST:
        closed = np.argwhere(data["gas_room"] <= 0.0)
        data["gas_soot"][tuple(closed[rng.integers(len(closed))])] = np.float32(magnitude * SOOT)


def drift_off(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """The box stands elsewhere than its source."""
    data["gas_corner"] = data["gas_corner"] + np.array([magnitude, 0.0, 0.0])


def blank(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Numbers that are none."""
    if frame >= FIRST:
        flat = data["gas_velocity"].reshape(-1)
        flat[rng.permutation(len(flat))[: round(magnitude)]] = np.nan


def bolt(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """A cell of air is faster than anything may be."""
    if frame >= FIRST:
        data["gas_velocity"][(*_clear(cache.read(FIRST), rng), 0)] = np.float32(magnitude)


def rounded(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Fields off by what single precision leaves."""
    noise: F64 = 1.0 + magnitude * rng.uniform(-1.0, 1.0, data["gas_soot"].shape)
    data["gas_soot"] = (data["gas_soot"] * noise).astype(np.float32)
    data["gas_velocity"] = (data["gas_velocity"] * noise[..., None]).astype(np.float32)


def still(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """As simulated."""
