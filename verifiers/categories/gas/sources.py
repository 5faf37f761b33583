"""Sources of gas as the specification declares them: the shape of the entity's parts, what drivers let out of it when, what impacts raise and what boils."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....geometry import Solid
from ....worlds.arrays import F64
from .boils import boils_of
from .puffs import Puff, puffs_of

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from .cells import GasFrame, Mask

__all__ = ["Source", "sources_of"]

OUTLET = 0.25
"""[cells] How well points in a source tell where on the cells the middle of what it lets out is."""
SAMPLES = 6
"""Own choice: points along each side of a part's box."""


@dataclass(frozen=True, eq=False)
class Source:
    """The parts of one entity, and what lets its gas out."""

    entity: str
    parts: tuple[Solid, ...]
    """In the world."""
    drivers: tuple[Any, ...]
    """Drivers of kind `emission`."""
    puffs: tuple[Puff, ...] = ()
    """Dust of impacts, steam of contacts."""

    @property
    def lower(self) -> F64:
        """Least corner of its box [m]."""
        return np.asarray(np.min([p.lower for p in self.parts], axis=0), dtype=np.float64)

    @property
    def upper(self) -> F64:
        """Greatest corner of its box [m]."""
        return np.asarray(np.max([p.upper for p in self.parts], axis=0), dtype=np.float64)

    def outlet(self, corner: F64, cell: float, room: NDArray[np.float32]) -> F64:
        """Middle of what it lets out on cells, by the points of it that lie in each and the room there [m]."""
        index = np.floor((self.samples() - corner) / cell).astype(np.int64)
        index = index[((index >= 0) & (index < np.array(room.shape))).all(axis=1)]
        weight = room[tuple(index.T)].astype(np.float64)
        if not weight.sum() > 0.0:
            return 0.5 * (self.lower + self.upper)
        return np.asarray(corner + cell * (np.average(index, axis=0, weights=weight) + 0.5))

    def samples(self) -> F64:
        """Points all over its parts [m], shape (n, 3)."""
        return self._points

    @cached_property
    def _points(self) -> F64:
        found = []
        for part in self.parts:
            axes = [np.linspace(part.lower[a], part.upper[a], SAMPLES + 2)[1:-1] for a in range(3)]
            points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
            if part.convex:
                points = points[(points @ part.facets.normals.T <= part.facets.offsets).all(axis=1)]
            found.append(points)
        return np.concatenate(found)

    @property
    def width(self) -> F64:
        """Extent along each axis of where its gas first is [m], shape (3,): its box, or the balls about impacts."""
        if self.drivers or not self.puffs:
            return self.upper - self.lower
        return np.full(3, 2.0 * max(p.radius for p in self.puffs))

    def cells(self, frame: GasFrame, margin: float, duration: float) -> Mask:
        """Cells within a margin [m] of where its gas comes out over the time before a frame [s], (nx, ny, nz)."""
        found = np.zeros(frame.room.shape, dtype=bool)
        if self.drivers:
            at = frame.centers[:, 0, 0, 0], frame.centers[0, :, 0, 1], frame.centers[0, 0, :, 2]
            low, high = self.lower - margin, self.upper + margin
            x, y, z = ((at[a] >= low[a]) & (at[a] <= high[a]) for a in range(3))
            found |= x[:, None, None] & y[None, :, None] & z[None, None, :]
        end = duration * frame.index
        for puff in self._between(end - duration, end):
            found |= puff.cells(frame, margin)
        return found

    def _between(self, start: float, end: float) -> list[Puff]:
        """Puffs that come at some time between two."""
        return [p for p in self.puffs if p.begin <= end and start < p.end]

    def rate(self, time: float) -> float:
        """Gas that comes out at a time, at the temperature of the source [m^3/s]."""
        steady = sum(d.rate for d in self.drivers if d.start <= time and (d.end is None or time < d.end))
        return float(steady + sum(p.volume / (p.end - p.begin) for p in self.puffs if p.at(time)))

    def changes(self, start: float, end: float) -> bool:
        """True where its rate changes within [start, end) seconds."""
        ends = [(d.start, d.end) for d in self.drivers] + [(p.begin, p.end) for p in self.puffs if p.sudden]
        return any(start <= t < end for pair in ends for t in pair if t is not None)

    def emitted(self, time: float) -> float:
        """Gas that has come out since frame 0, at the temperature of the source [m^3]."""
        return self._flowed(time) + float(sum(p.emitted(time) for p in self.puffs))

    def _flowed(self, time: float) -> float:
        """Part of it that emissions let out [m^3]."""
        return float(sum(d.rate * max(0.0, min(time, time if d.end is None else d.end) - d.start) for d in self.drivers))

    def given(self, now: GasFrame, duration: float) -> list[tuple[float, F64, float]]:
        """Gas that came out over the time before a frame [m^3], its middle [m] and how far that may be off [m]; one of each place."""
        return now.fields.of(now, ("given", self, duration), lambda: self._given(now, duration))

    def _given(self, now: GasFrame, duration: float) -> list[tuple[float, F64, float]]:
        end = duration * now.index
        start = end - duration
        steady = self._flowed(end) - self._flowed(start)
        found = [(steady, self.outlet(now.corner, now.cell, now.room), OUTLET * now.cell)] if self.drivers else []
        return found + [(p.emitted(end) - p.emitted(start), p.point, p.reach(now) + now.cell) for p in self._between(start, end)]


def sources_of(candidate: Candidate, members: Sequence[str]) -> tuple[Source, ...]:
    """Sources of the members of an instance."""
    drivers = candidate.spec.simulation.drivers.values()
    return tuple(
        Source(
            name,
            _parts(candidate, name),
            tuple(d for d in drivers if d.kind == "emission" and d.entity == name),
            (*puffs_of(candidate, name), *_steam(candidate, name)),
        )
        for name in members
    )


def _steam(candidate: Candidate, name: str) -> tuple[Puff, ...]:
    """Puffs of steam of a gas."""
    held = (n for n, i in candidate.spec.simulation.gas.items() if name in i.members)
    return tuple(p for n in held if (found := boils_of(candidate, n)) is not None for p in found.puffs)


def _parts(candidate: Candidate, name: str) -> tuple[Solid, ...]:
    from ....worlds.built import TriangleMesh

    found = []
    for part in candidate.entity(name).parts:
        vertices = candidate.surface(name, part.part, 0)
        found.append(Solid.from_mesh(TriangleMesh(vertices, part.render.faces), closed=part.closed))
    return tuple(found)
