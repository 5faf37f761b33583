"""Dust that impacts raise: when, where and how much, by the contacts that the caches of rigid instances hold."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from ...physics.dust import impact_energy, reduced_mass
from ...worlds.categories.gas.facts import dusty_box
from .puffs import Puff

if TYPE_CHECKING:
    from ...worlds.cache import Cache
    from ...worlds.spec import DustDriver, Entity

__all__ = ["Dust"]

EVENTS = ("event/time", "event/pair", "event/point", "event/speed", "event/impulse")


class Dust:
    """Impacts of the frames about now, and the cells in which their dust comes.

    Args:
        drivers: that raise it.
        entity: the gas.
        masses: of all entities [kg]; infinite of those that do not give way.
        caches: of the rigid instances.
        fps: of the caches.
    """

    def __init__(
        self,
        drivers: Mapping[str, DustDriver],
        entity: Entity,
        masses: Mapping[str, float],
        caches: Mapping[str, Cache],
        fps: int,
    ) -> None:
        if entity.physics.category != "gas":
            raise ValueError("dust is of a gas")
        box = dusty_box(entity, entity.physics.resolution)
        if box is None:
            raise ValueError("the room in which dust lies has no box")
        self._drivers, self._masses, self._caches = drivers, masses, caches
        self._box, self._density = box, float(entity.physics.soot_density)
        self.span = 1.0 / fps
        self._kept: dict[int, list[Puff]] = {}

    def about(self, frame: int) -> list[Puff]:
        """Dust that comes between frame - 1 and `frame`: of impacts then and in the frame before."""
        return [p for k in (frame - 1, frame) if k > 0 for p in self._of_frame(k)]

    def _of_frame(self, frame: int) -> list[Puff]:
        if frame not in self._kept:
            self._kept = {k: v for k, v in self._kept.items() if k >= frame - 1}
            self._kept[frame] = [p for c in self._caches.values() for p in self._of_cache(c, frame)]
        return self._kept[frame]

    def _of_cache(self, cache: Cache, frame: int) -> list[Puff]:
        log = cache.read(frame, EVENTS)
        owners = [name.split("/", 1)[0] for name in cache.index.colliders]
        masses = np.array([self._masses[n] for n in owners])[log["event/pair"].reshape(-1, 2)]
        energy = impact_energy(log["event/impulse"], log["event/speed"], reduced_mass(*masses.T))
        low, high = self._box
        found = []
        for driver in self._drivers.values():
            end = np.inf if driver.end is None else driver.end
            for time, pair, point, joule in zip(log["event/time"], log["event/pair"], log["event/point"], energy, strict=True):
                struck = {owners[int(k)] for k in pair} & set(driver.bodies)
                here = bool((point >= low).all() and (point <= high).all())
                if struck and here and driver.start <= time < end and joule > 0.0:
                    volume = driver.per_energy * float(joule) / self._density
                    found.append(Puff(float(time), np.asarray(point, float), driver.radius, volume))
        return found
