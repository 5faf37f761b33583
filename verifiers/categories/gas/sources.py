"""Sources of gas as the specification declares them: the shape of the entity's parts, and what drivers let out of it when."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....geometry import Solid
from ....worlds.arrays import F64

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate

__all__ = ["Source", "sources_of"]

SAMPLES = 6
"""Own choice: points along each side of a part's box."""


@dataclass(frozen=True, eq=False)
class Source:
    """The parts of one entity, and the drivers that let its gas out."""

    entity: str
    parts: tuple[Solid, ...]
    """In the world."""
    drivers: tuple[Any, ...]
    """Of kind `emission`."""

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
        found = []
        for part in self.parts:
            axes = [np.linspace(part.lower[a], part.upper[a], SAMPLES + 2)[1:-1] for a in range(3)]
            points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
            if part.convex:
                points = points[(points @ part.facets.normals.T <= part.facets.offsets).all(axis=1)]
            found.append(points)
        return np.concatenate(found)

    def cells(self, centers: F64, cell: float) -> NDArray[np.bool_]:
        """Cells whose middles are within a cell of its box, shape as `centers` without the last axis."""
        return np.asarray(((centers >= self.lower - cell) & (centers <= self.upper + cell)).all(axis=-1))

    def rate(self, time: float) -> float:
        """Gas that comes out at a time, at the temperature of the source [m^3/s]."""
        return float(sum(d.rate for d in self.drivers if d.start <= time and (d.end is None or time < d.end)))

    def changes(self, start: float, end: float) -> bool:
        """True where its rate changes within [start, end) seconds."""
        return any(start <= t < end for d in self.drivers for t in (d.start, d.end) if t is not None)

    def emitted(self, time: float) -> float:
        """Gas that has come out since frame 0, at the temperature of the source [m^3]."""
        return float(sum(d.rate * max(0.0, min(time, time if d.end is None else d.end) - d.start) for d in self.drivers))


def sources_of(candidate: Candidate, members: Sequence[str]) -> tuple[Source, ...]:
    """Sources of the members of an instance."""
    drivers = candidate.spec.simulation.drivers.values()
    return tuple(
        Source(name, _parts(candidate, name), tuple(d for d in drivers if d.kind == "emission" and d.entity == name))
        for name in members
    )


def _parts(candidate: Candidate, name: str) -> tuple[Solid, ...]:
    from ....worlds.built import TriangleMesh

    found = []
    for part in candidate.entity(name).parts:
        vertices = candidate.surface(name, part.part, 0)
        found.append(Solid.from_mesh(TriangleMesh(vertices, part.render.faces), closed=part.closed))
    return tuple(found)
