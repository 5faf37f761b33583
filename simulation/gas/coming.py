"""Gas that comes where other instances' records tell: dust of impacts, steam of contacts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from ...worlds.categories.gas.facts import dusts_of, gas_of, yielding_mass
from ...worlds.categories.gas.steam_facts import steams_of
from .contacts import Contacts
from .dust import Dust
from .puffs import Puff, spread
from .steam import Steam

if TYPE_CHECKING:
    from ...worlds.built import BuiltEntity
    from ...worlds.cache import Cache
    from ...worlds.categories.gas.facts import Grid
    from ...worlds.spec import WorldSpec

__all__ = ["Coming"]


class Coming:
    """Puffs of all drivers of a gas that raise dust or make steam.

    Args:
        spec: the specification.
        name: the instance.
        built: geometry.
        caches: of the instances that it reads.
        grid: of the gas.
        without: drivers that are taken away.
    """

    def __init__(
        self, spec: WorldSpec, name: str, built: Mapping[str, BuiltEntity], caches: Mapping[str, Cache], grid: Grid, without: frozenset[str]
    ) -> None:  # fmt: skip
        self._grid, self._span = grid, 1.0 / spec.simulation.fps
        found, dusts, steams = gas_of(spec, name), dusts_of(spec, name), steams_of(spec, name)
        self.drivers = tuple(k for k in (*dusts, *steams) if k not in without)
        self._dust: Dust | None = None
        self._steam: Steam | None = None
        raising = {k: d for k, d in dusts.items() if k not in without}
        if found is not None and raising:
            masses = {n: yielding_mass(spec.entities[n], (k.mass for k in b.bodies)) for n, b in built.items()}
            bodies = {n: c for n, c in caches.items() if n in spec.simulation.rigid}
            self._dust = Dust(raising, found[1], masses, bodies, spec.simulation.fps)
        if steams:
            self._steam = Steam(spec, steams, Contacts(spec, built, caches), without)

    def strongest(self, frame: int, room: NDArray[np.float32]) -> float:
        """Bound of the gas per volume and second that comes in a cell between frame - 1 and `frame` [1/s]; `room` as of `add`."""
        most = 0.0
        if self._dust is not None:
            most += sum(p.volume / self._span * float(spread(self._grid, p, room)[1].max()) for p in self._dust.about(frame))
        if self._steam is not None:
            rate = np.zeros(self._grid.shape)
            for puff in self._steam.about(frame):
                at, share = spread(self._grid, puff, room)
                rate[at] += share * (puff.volume / self._span)
            most += float(rate.max())
        return most

    def add(self, rate: F64, frame: int, times: tuple[float, float], room: NDArray[np.float32]) -> float:
        """Add what comes between two times [s] before a frame to a rate per volume [1/s], (nx, ny, nz); the volume of it [m^3].

        Args:
            rate: that is added to.
            frame: the next.
            times: start and end of a step.
            room: open share of each cell in which gas can be made, else 0.
        """
        volume = 0.0
        for puff in self._about(frame):
            given = puff.made(*times, self._span)
            if given > 0.0:
                at, share = spread(self._grid, puff, room)
                rate[at] += share * (given / (times[1] - times[0]))
                volume += given
        return volume

    def _about(self, frame: int) -> Iterator[Puff]:
        if self._dust is not None:
            yield from self._dust.about(frame)
        if self._steam is not None:
            yield from self._steam.about(frame)

    def measured(self, frame: int) -> dict[str, Any]:
        """Channels and records of what makes steam, at a frame."""
        if self._steam is None:
            return {}
        now = self._steam.at(frame)
        return {
            "steam_area": now.area,
            "steam_temperature": now.temperature,
            "steam_given": now.given,
            "record/steam_mass": np.float64(now.mass),
        }
