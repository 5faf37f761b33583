"""Dust that impacts raise: when, where and how much, by the contacts that the caches of rigid instances hold."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...physics.dust import impact_energy, reduced_mass
from ...worlds.arrays import F64
from ...worlds.categories.gas.facts import dusty_box

if TYPE_CHECKING:
    from ...worlds.cache import Cache
    from ...worlds.categories.gas.facts import Grid
    from ...worlds.spec import DustDriver, Entity

__all__ = ["Dust", "Puff"]

WIDER = 1.25
"""Steps in which a ball widens that has too little room."""
EVENTS = ("event/time", "event/pair", "event/point", "event/speed", "event/impulse")


class Puff(NamedTuple):
    """Dust of one impact."""

    begin: float
    """[s] Of the impact; the dust comes within a frame from then on."""
    point: F64
    """[m]"""
    radius: float
    """[m] Of the ball in which it comes."""
    volume: float
    """[m^3] With the air that it comes in."""

    def made(self, start: float, end: float, span: float) -> float:
        """Volume that comes between two times [m^3], of all that comes within `span` [s]."""
        return self.volume * max(0.0, min(end, self.begin + span) - max(start, self.begin)) / span


class Dust:
    """Impacts of the frames about now, and the cells in which their dust comes.

    Args:
        drivers: that raise it.
        entity: the gas.
        masses: of all entities [kg]; infinite of those that do not give way.
        caches: of the rigid instances.
        grid: of the gas.
        fps: of the caches.
    """

    def __init__(
        self, drivers: Mapping[str, DustDriver], entity: Entity, masses: Mapping[str, float], caches: Mapping[str, Cache],
        grid: Grid, fps: int,
    ) -> None:  # fmt: skip
        if entity.physics.category != "gas":
            raise ValueError("dust is of a gas")
        box = dusty_box(entity, entity.physics.resolution)
        if box is None:
            raise ValueError("the room in which dust lies has no box")
        self._drivers, self._masses, self._caches, self._grid = drivers, masses, caches, grid
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

    def shares(self, puff: Puff, room: NDArray[np.float32]) -> tuple[tuple[slice, ...], F64]:
        """Gas per volume and second in the cells about an impact for 1 m^3/s of its dust: where they are on the grid, and the values there.

        The ball widens until its cells have room for the dust, as under a body that lies flat.

        Args:
            puff: dust of an impact.
            room: open share of each cell in which gas can be made, else 0; (nx, ny, nz).
        """
        size, radius = self._grid.cell**3, puff.radius
        while True:
            at, whole = self._window(puff.point, radius)
            within = self._far(puff.point, at) <= radius
            open_to = room[at].astype(np.float64) * within
            total = float(open_to.sum()) * size
            if total >= puff.volume or (whole and within.all()):
                break
            radius *= WIDER
        return at, np.where(open_to > 0.0, 1.0 / total if total > 0.0 else 0.0, 0.0)

    def _window(self, point: F64, radius: float) -> tuple[tuple[slice, ...], bool]:
        """Cells of the box around a ball, and whether they are all cells."""
        grid = self._grid
        low, high = ((point + s * radius - grid.corner) / grid.cell for s in (-1.0, 1.0))
        first = np.clip(np.floor(low).astype(int), 0, np.array(grid.shape) - 1)
        last = np.clip(np.ceil(high).astype(int), first + 1, grid.shape)
        at = tuple(slice(int(a), int(b)) for a, b in zip(first, last, strict=True))
        return at, bool((first == 0).all() and (last == grid.shape).all())

    def _far(self, point: F64, at: tuple[slice, ...]) -> F64:
        """Distance of the middles of cells from a place [m]."""
        grid = self._grid
        axes = [grid.corner[k] + grid.cell * (np.arange(s.start, s.stop) + 0.5) - point[k] for k, s in enumerate(at)]
        x, y, z = np.meshgrid(*axes, indexing="ij", sparse=True)
        return np.asarray(np.sqrt(x * x + y * y + z * z))
