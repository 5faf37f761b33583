"""Dust that impacts raise, worked out anew from the contacts that rigid caches record (R60, R100)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ....physics.dust import impact_energy, reduced_mass
from ....worlds.arrays import F64
from ....worlds.categories.gas.facts import dusty_box, yielding_mass
from .cells import squares

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.spec import DustDriver
    from .cells import GasFrame, Mask

__all__ = ["Puff", "puffs_of"]

LEEWAY = 3.0
"""[cells] Own choice: beyond the ball that has room for the dust of an impact: no gas is made in cells whose room changes."""
ROOMY = 2.0
"""Own choice: times the volume of the dust, that the open cells of that ball have."""


@dataclass(frozen=True, eq=False)
class Puff:
    """Dust of one impact, which comes from `begin` to `end` [s], evenly."""

    begin: float
    end: float
    point: F64
    """[m]"""
    radius: float
    """[m]"""
    volume: float
    """[m^3] With its air."""
    body: str
    """That struck, or is hot."""
    water: tuple[str, ...] = ()
    """Liquids that it comes of, too."""
    sudden: bool = True
    """True where it pushes the air from one moment to the next."""

    def emitted(self, time: float) -> float:
        """Part of it that has come by a time [m^3]."""
        return self.volume * float(np.clip((time - self.begin) / (self.end - self.begin), 0.0, 1.0))

    def at(self, time: float) -> bool:
        """True while it comes."""
        return self.begin <= time < self.end

    def reach(self, frame: GasFrame) -> float:
        """Distance from the impact within which its dust comes [m]: its ball, or the one whose cells have room for it at a frame."""
        return frame.fields.of(frame, ("reach", self), lambda: self._reach(frame))

    def _away(self, frame: GasFrame) -> F64:
        """Distance of the middles of cells from the impact [m], (nx, ny, nz)."""
        key = ("away", self.point.tobytes())
        return frame.fields.of(frame, key, lambda: np.sqrt(squares(frame.centers - self.point)))

    def _reach(self, frame: GasFrame) -> float:
        away = self._away(frame)
        if float(frame.room[away <= self.radius].sum(dtype=np.float64)) * frame.cell**3 >= ROOMY * self.volume:
            return self.radius + LEEWAY * frame.cell
        far = away.ravel()
        order = np.argsort(far)
        held = np.cumsum(frame.room.ravel()[order].astype(np.float64)) * frame.cell**3
        enough = far[order[min(int(np.searchsorted(held, ROOMY * self.volume)), len(order) - 1)]]
        return max(self.radius, float(enough)) + LEEWAY * frame.cell

    def cells(self, frame: GasFrame, margin: float) -> Mask:
        """Cells whose middles are within its reach and a margin [m], (nx, ny, nz)."""
        return np.asarray(self._away(frame) <= self.reach(frame) + margin)


def puffs_of(candidate: Candidate, entity: str) -> tuple[Puff, ...]:
    """Dust of all impacts that drivers let raise a gas, in order of their frames."""
    physics = candidate.spec.entities[entity].physics
    if physics.category != "gas":
        return ()
    box = dusty_box(candidate.spec.entities[entity], physics.resolution)
    drivers = [d for d in candidate.spec.simulation.drivers.values() if d.kind == "dust" and d.entity == entity]
    if box is None:
        return ()
    return tuple(p for d in drivers for p in _raised(candidate, d, box, physics.soot_density))


def _raised(candidate: Candidate, driver: DustDriver, box: tuple[F64, F64], density: float) -> Iterator[Puff]:
    span, last = 1.0 / candidate.spec.simulation.fps, np.inf if driver.end is None else driver.end
    for cache in candidate.rigid_caches.values():
        names = [c.split("/", 1)[0] for c in cache.index.colliders]
        masses = np.array(
            [yielding_mass(candidate.spec.entities[n], (b.mass for b in candidate.entity(n).bodies)) for n in names]
        )
        logs = cache.ragged("event/time", "event/pair", "event/point", "event/speed", "event/impulse")
        for log in logs[1 : candidate.frame_count]:
            pairs, times, points = log["event/pair"].reshape(-1, 2), log["event/time"], log["event/point"].reshape(-1, 3)
            energy = impact_energy(log["event/impulse"], log["event/speed"], reduced_mass(*masses[pairs].T))
            inside = (
                ((points >= box[0]) & (points <= box[1])).all(axis=1) & (times >= driver.start) & (times < last) & (energy > 0.0)
            )
            for k in np.flatnonzero(inside).tolist():
                struck = [names[i] for i in pairs[k].tolist() if names[i] in driver.bodies]
                if struck:
                    volume = driver.per_energy * float(energy[k]) / density
                    yield Puff(
                        float(times[k]), float(times[k]) + span, points[k].astype(np.float64), driver.radius, volume, struck[0]
                    )
