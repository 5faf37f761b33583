"""Steam where hot matter touches water, worked out anew from the caches of both (R60, R100).

Areas are summed over all pairs of particles, or of a solid's pieces and particles, that lie in each other's box; heat is that of the boiling law
from frame to frame, at most what the hot matter has.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ....geometry.patches import patches_of
from ....physics.boiling import BOILING, STEAM_DENSITY, boiling_flux, steam_heat
from ....physics.interfaces import facing_area, kernel, slope, wetted_share
from ....worlds.arrays import F64
from ....worlds.categories.gas.steam_facts import (
    HotMatter,
    contact_reach,
    hot_matter,
    instance_of,
    steams_of,
    water_temperature,
)
from ....worlds.errors import EvidenceError
from .puffs import Puff

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.spec import SteamDriver

__all__ = ["Boils", "Touched", "boils_of"]

PIECE = 0.2
"""Edge of the pieces of a solid's surface, as a share of the reach."""
UNDER = 0.9
"""Share of the water's particles in the squares about a ball that lie under its surface there."""
SUDDEN = 0.1
"""Own choice: share of the rate of all steam by which it may change from frame to frame, and of a ball's radius by which its middle may move, and
still push the air evenly."""
CHUNK = 2_000_000
"""Pairs that are looked at at once."""


class _Ball(NamedTuple):
    """Steam of one ball over the time before a frame."""

    point: F64
    """[m]"""
    radius: float
    """[m]"""
    volume: float
    """[m^3]"""
    hot: str
    water: tuple[str, ...]


@dataclass(frozen=True)
class Touched:
    """Contact of one hot entity with water at a frame."""

    point: F64
    """[m], shape (n, 3)."""
    area: F64
    """[m^2], shape (n,)."""
    mass: float
    """Mass of the hot entity [kg]."""
    water: F64
    """Places of the water's particles [m], shape (m, 3)."""


@dataclass(frozen=True)
class Boils:
    """Steam that the drivers of an instance make; rows are frames, columns hot entities."""

    hot: tuple[HotMatter, ...]
    area: F64
    """[m^2], shape (frames, hot)."""
    body: F64
    """Mass of the hot entities [kg], shape (frames, hot)."""
    temperature: F64
    """[K], shape (frames, hot)."""
    given: F64
    """Heat that made steam since frame 0 [J], shape (frames, hot)."""
    mass: F64
    """Steam since frame 0 [kg], shape (frames,)."""
    water: float
    """Water at frame 0 [kg]."""
    puffs: tuple[Puff, ...]


def boils_of(candidate: Candidate, solver: str) -> Boils | None:
    """Steam that the drivers of an instance make, worked out once per candidate; None where none makes steam.

    Raises:
        EvidenceError: a cache is missing.
    """
    drivers = steams_of(candidate.spec, solver) if solver in candidate.spec.simulation.gas else {}
    return candidate.memo(("gas boils", solver), lambda: _boils(candidate, drivers)) if drivers else None


def _boils(candidate: Candidate, drivers: dict[str, SteamDriver]) -> Boils:
    spec, hot = candidate.spec, hot_matter(candidate.spec, drivers)
    shape, step = (candidate.frame_count, len(hot)), 1.0 / spec.simulation.fps
    area, body, given = np.zeros(shape), np.zeros(shape), np.zeros(shape)
    temperature = np.tile([h.temperature for h in hot], (shape[0], 1)).astype(float)
    mass, puffs = np.zeros(shape[0]), list[Puff]()
    last_balls: list[_Ball] = []
    for frame in range(shape[0]):
        balls: list[_Ball] = []
        mass[frame] = mass[max(frame - 1, 0)]
        for k, own in enumerate(hot):
            driver = drivers[own.driver]
            touched = _touched(candidate, driver, own, frame)
            area[frame, k], body[frame, k] = touched.area.sum(), touched.mass
            if frame == 0:
                continue
            last = (frame - 1, k)
            seconds = np.clip(frame * step, driver.start, driver.end) - np.clip((frame - 1) * step, driver.start, driver.end)
            holds = touched.mass * own.heat_capacity
            left = max(0.0, holds * (own.temperature - BOILING) - given[last])
            heat = min(left, boiling_flux(float(temperature[last]) - BOILING) * area[frame, k] * float(seconds))
            given[frame, k] = given[last] + heat
            temperature[frame, k] = BOILING + (left - heat) / holds if holds > 0.0 else own.temperature
            made = heat / steam_heat(water_temperature(spec, driver))
            mass[frame] += made
            balls += [
                _Ball(p, driver.radius, v, own.entity, tuple(driver.water))
                for p, v in _balls(driver.radius, touched, made / STEAM_DENSITY)
            ]
        sudden = _sudden(last_balls, balls)
        puffs += [Puff((frame - 1) * step, frame * step, b.point, b.radius, b.volume, b.hot, b.water, sudden) for b in balls]
        last_balls = balls
    water = sum(_mass(candidate, n, 0) for n in sorted({w for d in drivers.values() for w in d.water}))
    return Boils(hot, area, body, temperature, given, mass, float(water), tuple(puffs))


def _sudden(before: list[_Ball], now: list[_Ball]) -> bool:
    """True where all steam comes at another rate than in the frame before, or elsewhere."""
    whole = [float(sum(b.volume for b in balls)) for balls in (before, now)]
    if min(whole) <= 0.0 or abs(whole[1] - whole[0]) > SUDDEN * max(whole):
        return max(whole) > 0.0
    middle = [np.sum([b.volume * b.point for b in balls], axis=0) / w for balls, w in zip((before, now), whole, strict=True)]
    return float(np.linalg.norm(middle[1] - middle[0])) > SUDDEN * min(b.radius for b in now)


def _touched(candidate: Candidate, driver: SteamDriver, hot: HotMatter, frame: int) -> Touched:
    """Contact of one entity with the water of its driver at a frame."""
    reach = contact_reach(candidate.spec, driver)
    found = [_particles(candidate, name, frame) for name in driver.water]
    water, size = np.concatenate([f[0] for f in found]), np.concatenate([f[1] for f in found])
    if hot.liquid:
        points, own = _particles(candidate, hot.entity, frame)
        mass = _mass(candidate, hot.entity, frame)
    else:
        points, own = _pieces(candidate, hot.entity, frame, water, reach)
        mass = float(sum(b.mass for b in candidate.entity(hot.entity).bodies))
    if not len(points) or not len(water):
        return Touched(np.zeros((0, 3)), np.zeros(0), mass, water)
    near = ((water >= points.min(axis=0) - reach) & (water <= points.max(axis=0) + reach)).all(axis=1)
    about = ((points >= water.min(axis=0) - reach) & (points <= water.max(axis=0) + reach)).all(axis=1)
    points, own, beside, sizes = points[about], own[about], water[near], size[near]
    colour, toward, back = np.zeros(len(points)), np.zeros((len(points), 3)), np.zeros((len(beside), 3))
    rows = max(1, CHUNK // max(1, len(beside)))
    for first in range(0, len(points), rows):
        part = slice(first, first + rows)
        way = points[part, None] - beside[None]
        far = np.linalg.norm(way, axis=2)
        if hot.liquid:
            pull = np.where(far < reach, slope(far, reach) / np.maximum(far, 1e-12), 0.0)
            toward[part] = np.einsum("ij,ijk->ik", pull * sizes, way)
            back -= np.einsum("ij,ijk->jk", pull * own[part, None], way)
        else:
            colour[part] = kernel(far, reach) @ sizes
    if hot.liquid:
        points, area = np.concatenate([points, beside]), np.concatenate([facing_area(own, toward), facing_area(sizes, back)])
    else:
        area = own * wetted_share(colour)
    kept = area > 0.0
    return Touched(points[kept], area[kept], mass, water)


def _particles(candidate: Candidate, name: str, frame: int) -> tuple[F64, F64]:
    """Places [m] and volumes [m^3] of the particles of a liquid."""
    solver = instance_of(candidate.spec, name)
    if solver not in candidate.caches or solver is None:
        raise EvidenceError(f"no cache holds {name!r}, which steam comes of; bake again")
    cache = candidate.caches[solver]
    held = cache.read(frame, ("origin", "particle/position", "particle/fluid", "particle/volume"))
    mine = np.flatnonzero(held["particle/fluid"] == cache.index.bodies.index(name))
    place = held["origin"] + held["particle/position"][mine].astype(np.float64)
    return np.asarray(place), held["particle/volume"][mine].astype(np.float64)


def _mass(candidate: Candidate, name: str, frame: int) -> float:
    """Mass of a liquid at a frame [kg]."""
    density = candidate.spec.materials[candidate.spec.entities[name].material].density
    return density * float(_particles(candidate, name, frame)[1].sum())


def _pieces(candidate: Candidate, name: str, frame: int, water: F64, reach: float) -> tuple[F64, F64]:
    """Middles [m] and areas [m^2] of pieces of a solid's surface near the water."""
    if not len(water):
        return np.zeros((0, 3)), np.zeros(0)
    low, high = water.min(axis=0) - reach, water.max(axis=0) + reach
    found = [
        patches_of(candidate.surface(name, p.part, frame), p.render.faces, PIECE * reach, low, high)
        for p in candidate.entity(name).parts
    ]
    return np.concatenate([f.point for f in found]), np.concatenate([f.area for f in found])


def _balls(radius: float, touched: Touched, volume: float) -> Sequence[tuple[F64, float]]:
    """Middles of the balls in which steam of a contact comes [m] and what comes in each [m^3]: one for each corner of the squares of their width
    about contact, which shares what is in the four squares beside it by its distance along x and y."""
    if volume <= 0.0:
        return ()
    wide, whole, found = 2.0 * radius, float(touched.area.sum()), []
    low, high = (f(touched.point[:, :2] / wide, axis=0) for f in (np.min, np.max))
    for x in range(int(np.floor(low[0])), int(np.floor(high[0])) + 2):
        for y in range(int(np.floor(low[1])), int(np.floor(high[1])) + 2):
            corner = np.array([x, y])
            share = touched.area * np.maximum(0.0, 1.0 - np.abs(touched.point[:, :2] / wide - corner)).prod(axis=1)
            if not share.sum() > 0.0:
                continue
            middle = share @ touched.point / share.sum()
            about = (np.abs(touched.water[:, :2] / wide - corner) < 1.0).all(axis=1)
            top = max(middle[2], np.quantile(touched.water[about, 2], UNDER) if about.any() else middle[2])
            found.append((np.array([middle[0], middle[1], top + radius]), volume * float(share.sum()) / whole))
    return found
