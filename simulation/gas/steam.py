"""Steam where hot matter touches water: when, where and how much, by the caches of both; and how the hot matter cools."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...physics.boiling import BOILING, STEAM_DENSITY, boiling_flux, steam_heat
from ...worlds.arrays import F64
from ...worlds.categories.gas.steam_facts import hot_matter, water_temperature
from .puffs import Puff

if TYPE_CHECKING:
    from ...worlds.spec import SteamDriver, WorldSpec
    from .contacts import Contact, Contacts

__all__ = ["Steam", "SteamFrame"]

TOP = 0.9
"""Own choice: share of the water's particles in the squares about a ball that lie under its surface there; single drops above are none."""


@dataclass(frozen=True)
class SteamFrame:
    """Contacts at a frame, and what they have given since frame 0; rows as `hot_matter`."""

    area: F64
    """[m^2]"""
    temperature: F64
    """[K]"""
    given: F64
    """[J]"""
    mass: float
    """Steam since frame 0 [kg]."""
    puffs: tuple[Puff, ...]
    """That come over the time before the frame."""


class Steam:
    """Steam of all drivers of a gas.

    Args:
        spec: the specification.
        drivers: that make it.
        contacts: of what is hot.
        without: drivers that are taken away: their rows stay as they were.
    """

    def __init__(
        self, spec: WorldSpec, drivers: Mapping[str, SteamDriver], contacts: Contacts, without: frozenset[str] = frozenset()
    ) -> None:
        self._drivers, self._contacts, self._without = dict(drivers), contacts, without
        self._hot = hot_matter(spec, self._drivers)
        self._cost = {k: steam_heat(water_temperature(spec, d)) for k, d in self._drivers.items()}
        self.span = 1.0 / spec.simulation.fps
        self._frames: list[SteamFrame] = []

    def at(self, frame: int) -> SteamFrame:
        """Contacts of a frame, and what came of them and those before."""
        while len(self._frames) <= frame:
            self._frames.append(self._next(len(self._frames)))
        return self._frames[frame]

    def about(self, frame: int) -> tuple[Puff, ...]:
        """Steam that comes between frame - 1 and `frame`."""
        return self.at(frame).puffs if frame > 0 else ()

    def _next(self, frame: int) -> SteamFrame:
        met = [self._contacts.of(self._drivers[h.driver], h, frame) for h in self._hot]
        area = np.array([float(m.area.sum()) for m in met])
        if frame == 0:
            first = np.array([h.temperature for h in self._hot])
            return SteamFrame(area, first, np.zeros(len(met)), 0.0, ())
        before = self._frames[-1]
        temperature, given, mass = before.temperature.copy(), before.given.copy(), before.mass
        puffs: list[Puff] = []
        for k, (hot, touched) in enumerate(zip(self._hot, met, strict=True)):
            driver = self._drivers[hot.driver]
            capacity = touched.mass * hot.heat_capacity
            left = max(0.0, capacity * (hot.temperature - BOILING) - given[k])
            heat = min(boiling_flux(temperature[k] - BOILING) * area[k] * self._within(hot.driver, frame), left)
            given[k] += heat
            temperature[k] = BOILING + (left - heat) / capacity if capacity > 0.0 else hot.temperature
            made = heat / self._cost[hot.driver]
            mass += made
            puffs += self._gathered(driver.radius, touched, frame, made / STEAM_DENSITY)
        return SteamFrame(area, temperature, given, mass, tuple(puffs))

    def _within(self, name: str, frame: int) -> float:
        """Time before a frame in which a driver acts [s]."""
        driver, start, end = self._drivers[name], (frame - 1) * self.span, frame * self.span
        if name in self._without:
            return 0.0
        return max(0.0, min(end, np.inf if driver.end is None else driver.end) - max(start, driver.start))

    def _gathered(self, radius: float, touched: Contact, frame: int, volume: float) -> list[Puff]:
        """Steam of one contact in balls on the water: one for each corner of the squares of their width that hold contact, seen from above.

        Each piece of contact is shared by the four corners of its square, by how near they are: what moves on hands over evenly.
        """
        if volume <= 0.0:
            return []
        wide = 2.0 * radius
        first = np.floor(touched.point[:, :2] / wide).astype(int)
        near = touched.point[:, :2] / wide - first
        sides = np.array([[0, 0], [0, 1], [1, 0], [1, 1]])
        shares = np.prod(np.where(sides[:, None] == 1, near, 1.0 - near), axis=2) * touched.area
        corner, member = np.unique((first + sides[:, None]).reshape(-1, 2), axis=0, return_inverse=True)
        member, places = member.reshape(-1), np.tile(touched.point, (4, 1))
        weight = np.bincount(member, shares.ravel())
        found = []
        for k in np.flatnonzero(weight > 0.0).tolist():
            middle = shares.ravel()[member == k] @ places[member == k] / weight[k]
            over = touched.water[(np.abs(touched.water[:, :2] / wide - corner[k]) < 1.0).all(axis=1), 2]
            top = max(float(middle[2]), float(np.quantile(over, TOP)) if len(over) else -np.inf)
            point = np.array([middle[0], middle[1], top + radius])
            found.append(Puff((frame - 1) * self.span, point, radius, volume * float(weight[k] / weight.sum())))
        return found
