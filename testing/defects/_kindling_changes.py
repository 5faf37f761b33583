"""Ways in which the surfaces of solids that burn go wrong, each by a magnitude."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...worlds.cache import Cache
from ._gas_changes import FIRST


def _given(data: dict[str, Any], cache: Cache) -> Any:
    """Mass that each piece has given since frame 0 [kg/m^2]."""
    return cache.read(0, ("burning_left",))["burning_left"] - data["burning_left"]


def pilfer(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Surfaces lose more than they give, and their books of heat follow."""
    if frame >= FIRST:
        more = magnitude * _given(data, cache)
        data["burning_left"] = data["burning_left"] - more
        cost = magnitude * data["record/gasification_heat"]
        for name in ("gasification_heat", "taken_light"):
            data[f"record/{name}"] = data[f"record/{name}"] + cost


def regrow(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """At the last frame a share of what was given is there again."""
    if frame == cache.index.frames - 1:
        data["burning_left"] = data["burning_left"] + magnitude * _given(data, cache)


def smoulder(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """A share of what was given off came from the coldest piece of those that are large enough to have it."""
    given = magnitude * _given(data, cache)
    heat = cache.read(cache.index.frames - 1, ("burning_temperature",))["burning_temperature"]
    cold = int(np.argmin(np.where(data["burning_area"] >= np.median(data["burning_area"]), heat, np.inf)))
    lost = float(np.sum(given * data["burning_area"]))
    data["burning_left"] = data["burning_left"] + given
    data["burning_left"][cold] -= lost / data["burning_area"][cold]


def blister(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Surfaces far from the fire get a share of all heat more, and say that it was light."""
    if frame >= FIRST:
        heat = data["burning_heat"] * data["burning_area"]
        far = np.argsort(heat)[: len(heat) // 4]
        more = magnitude * float(heat.sum()) * (frame - FIRST + 1)
        data["burning_heat"][far] += more / float(data["burning_area"][far].sum())
        for name in ("surface_heat", "taken_light"):
            data[f"record/{name}"] = data[f"record/{name}"] + more


def freeze(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """A share of the heat in surfaces is gone."""
    if frame >= FIRST:
        data["burning_heat"] = data["burning_heat"] * (1.0 - magnitude)


def gift(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Surfaces took more heat than is in them and in their gas."""
    if frame >= FIRST:
        data["record/taken_light"] = data["record/taken_light"] * (1.0 + magnitude)


def hollow(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Less can burn of a part than it has."""
    data["burning_left"] = data["burning_left"] - magnitude * cache.read(0, ("burning_left",))["burning_left"]


def shrink(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Pieces do not cover their part."""
    data["burning_area"] = data["burning_area"] * (1.0 - magnitude)


def lag(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """Pieces stay behind their part by a share of its way."""
    first = cache.read(0, ("burning_point",))["burning_point"]
    data["burning_point"] = data["burning_point"] + magnitude * (first - data["burning_point"])


def shuffle(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """From a frame on pieces stand aside by so many metres."""
    if frame >= FIRST:
        data["burning_point"] = data["burning_point"] + magnitude * np.array([0.6, 0.0, 0.8])


def sear(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator, cache: Cache) -> None:
    """At the last frame pieces that were consumed take a share of all heat more, and say that it was light."""
    if frame == cache.index.frames - 1:
        gone = cache.read(frame - 1, ("burning_left",))["burning_left"] <= 0.0
        more = magnitude * float((data["burning_heat"] * data["burning_area"]).sum())
        data["burning_heat"][gone] += more / float(data["burning_area"][gone].sum())
        for name in ("surface_heat", "taken_light"):
            data[f"record/{name}"] = data[f"record/{name}"] + more
