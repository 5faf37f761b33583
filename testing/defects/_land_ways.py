"""Seeded defects of navigability over landscapes: too steep, too deep, overgrown, walled off, interrupted, and what only looks so."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ...verifiers.routes.bounds import WADING
from ...worlds.arrays import F64
from ...worlds.spec import BoxRegion, Connects, Entity
from ..worlds.small_worlds import box, make_candidate, world
from ._lands import NAME, axes, declared, keep
from .cases import Mechanism, World

__all__ = ["LAND_MECHANISMS"]

RNG = np.random.Generator
MARKER = "sign"


class _Country:
    """A square of land with a walker who wants from west to east."""

    def __init__(self, rng: RNG, side: int = 41) -> None:
        self.rng, self.side = rng, side
        self.cell = float(rng.choice([1.0, 2.0, 4.0]))
        self.x, self.y = axes(side, side, self.cell)
        self.half = 0.5 * (side - 1) * self.cell
        self.far = 0.6 * self.half
        self.limit = float(rng.uniform(0.4, 0.6))  # a walker's is 0.6
        self.width = float(rng.choice([0.6, 0.8, 1.2])) if self.cell > 1 else float(rng.uniform(0.6, 0.9))
        self.level = float(rng.uniform(-50, 400))
        gentle = math.tan(0.3 * self.limit)
        angle = rng.uniform(0, 2 * np.pi)
        self.height = self.level + gentle * (math.cos(angle) * self.x + math.sin(angle) * self.y)
        self.turned = bool(rng.random() < 0.5)

    def world(
        self,
        folder: Path,
        *culprits: str,
        water: F64 | None = None,
        plants: Sequence[tuple[float, float, float, str]] = (),
        things: dict[str, Entity] | None = None,
    ) -> World:
        """Finish; every second country is turned by a quarter."""
        terrain = declared(self.side, self.side, self.cell)
        height = self.height.T if self.turned else self.height
        water = water.T if water is not None and self.turned else water
        if self.turned:
            plants = [(y, x, z, shape) for x, y, z, shape in plants]
        keep(folder, terrain, height, water=water, plants=plants)
        regions = {}
        for name, at in (("a", -self.far), ("b", self.far)):
            x, y = (0.0, at) if self.turned else (at, 0.0)
            near = np.hypot(*(v - w for v, w in zip(axes(self.side, self.side, self.cell), (x, y), strict=True))) <= 3 * self.cell
            low, high = float(np.nanmin(height[near])), float(np.nanmax(height[near]))
            reach = 1.5 * self.cell
            regions[name] = BoxRegion(min=(x - reach, y - reach, low - 1), max=(x + reach, y + reach, high + 1))
        sign = box(0.5, 0.5, 0.5, at=(0, 0, self.level + 900))
        spec = world(
            {MARKER: sign, **(things or {})},
            regions=regions,
            relations={"way": Connects(a="a", b="b", width=self.width, max_slope=self.limit)},
            terrains={NAME: terrain},
        )
        return World(make_candidate(folder, spec), culprits)

    def ridge(self, slope: float, pass_at: float | None = None) -> None:
        """A ridge from side to side, `slope` [rad] steep, on level land; with a gentle pass where asked."""
        wide = 4 * self.cell
        bump = math.tan(slope) * np.maximum(wide - np.abs(self.x), 0.0)
        if pass_at is not None:
            bump = np.where(np.abs(self.y - pass_at) <= 2.5 * self.cell, 0.0, bump)
        self.height = self.level + bump

    def strip(self, count: int) -> np.ndarray:
        """Lattice points of a strip from side to side, `count` wide."""
        return np.abs(self.x) <= 0.5 * (count - 1) * self.cell + 1e-6

    def palisade(self, gap: float) -> list[tuple[float, float, float, str]]:
        """Columns from side to side with `gap` between them."""
        radius = 0.6
        rows = np.arange(-self.half, self.half + 2 * radius + gap, 2 * radius + gap)
        return [(float(self.rng.uniform(-0.02, 0.02)), float(y), radius / 0.06, "column") for y in rows]


def _too_steep(folder: Path, m: float, rng: RNG) -> World:
    land = _Country(rng)
    land.ridge(land.limit + m)
    return land.world(folder, "way")


def _deep_ford(folder: Path, m: float, rng: RNG) -> World:
    land = _Country(rng)
    water = np.where(land.strip(3), land.height + WADING["walker"] + m, np.nan)
    return land.world(folder, "way", water=water)


def _palisade(folder: Path, m: float, rng: RNG) -> World:
    land = _Country(rng)
    land.height = 0.0 * land.height + land.level
    return land.world(folder, "way", plants=land.palisade(land.width - m))


def _walled(folder: Path, m: float, rng: RNG) -> World:
    """A wall from side to side, m high; or a fence that hangs in the height of the walker."""
    land = _Country(rng, 13)
    land.height = 0.0 * land.height + land.level
    wide = 2.4 * land.half
    size = (wide, 0.4, m) if land.turned else (0.4, wide, m)
    wall = box(*size, at=(0, 0, land.level + m / 2 - 0.05))
    return land.world(folder, "wall", things={"wall": wall})


def _chasm(folder: Path, m: float, rng: RNG) -> World:
    land = _Country(rng)
    land.height = np.where(land.strip(max(1, round(m))), np.nan, land.height)
    return land.world(folder, "way")


def _hillside(folder: Path, m: float, rng: RNG) -> World:
    land = _Country(rng)
    land.ridge(land.limit - m)
    return land.world(folder)


def _ford(folder: Path, m: float, rng: RNG) -> World:
    land = _Country(rng)
    return land.world(folder, water=np.where(land.strip(5), land.height + WADING["walker"] - m, np.nan))


def _pass(folder: Path, m: float, rng: RNG) -> World:
    """A steep ridge with one gentle pass to the side."""
    land = _Country(rng)
    land.ridge(land.limit + m, float(rng.choice([-0.6, 0.6])) * land.half)
    return land.world(folder)


def _forest(folder: Path, m: float, rng: RNG) -> World:
    """Trees in an irregular grid that leaves ways more than twice as wide as needed."""
    land = _Country(rng)
    apart = 2.0 * (2.0 * land.width + 2 * land.cell + m)
    places = np.arange(-land.half + apart / 2, land.half, apart)
    plants = [
        (float(x + rng.uniform(-0.2, 0.2) * apart), float(y + rng.uniform(-0.2, 0.2) * apart), float(rng.uniform(4, 12)), "cone")
        for x in places
        for y in places
    ]
    return land.world(folder, plants=plants)


LAND_MECHANISMS = (
    Mechanism("steep hillside", "every way is too steep", True, _too_steep, 1e-3, 0.5, "rad", bound=0.0),
    Mechanism("deep ford", "every way leads through deep water", True, _deep_ford, 1e-3, 3.0, "m", bound=0.0),
    Mechanism("palisade", "trunks leave too little", True, _palisade, 0.02, 0.5, "m", bound=0.0),
    Mechanism("walled off", "a wall across the land", True, _walled, 1.0, 4.0, "m"),
    Mechanism("chasm", "no land in between", True, _chasm, 1.0, 5.0, "cells"),
    Mechanism("hillside", "at the limit of slope", False, _hillside, 1e-4, 0.3, "rad"),
    Mechanism("ford", "shallow enough", False, _ford, 1e-4, 0.4, "m"),
    Mechanism("mountain pass", "one gentle way round", False, _pass, 0.05, 0.5, "rad"),
    Mechanism("forest", "wide ways between trees", False, _forest, 0.1, 3.0, "m"),
)
"""Mechanisms of the suite `navigability` that need land."""
