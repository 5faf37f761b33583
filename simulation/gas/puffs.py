"""Gas that comes at places which other instances' records tell: balls of it, each over some time."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64

if TYPE_CHECKING:
    from ...worlds.categories.gas.facts import Grid

__all__ = ["Puff", "spread"]

WIDER = 1.25
"""Steps in which a ball widens that has too little room."""


class Puff(NamedTuple):
    """Gas of one place."""

    begin: float
    """[s] The gas comes within a frame from then on."""
    point: F64
    """[m]"""
    radius: float
    """[m] Of the ball in which it comes."""
    volume: float
    """[m^3] With the air that it comes in."""

    def made(self, start: float, end: float, span: float) -> float:
        """Volume that comes between two times [m^3], of all that comes within `span` [s]."""
        return self.volume * max(0.0, min(end, self.begin + span) - max(start, self.begin)) / span


def spread(grid: Grid, puff: Puff, room: NDArray[np.float32]) -> tuple[tuple[slice, ...], F64]:
    """Gas per volume and second in the cells about a place for 1 m^3/s of its puff: where they are on the grid, and the values there.

    The ball widens until its cells have room for the gas, as under a body that lies flat.

    Args:
        grid: of the gas.
        puff: of which place.
        room: open share of each cell in which gas can be made, else 0; (nx, ny, nz).
    """
    size, radius = grid.cell**3, puff.radius
    while True:
        at, whole = _window(grid, puff.point, radius)
        within = _far(grid, puff.point, at) <= radius
        open_to = room[at].astype(np.float64) * within
        total = float(open_to.sum()) * size
        if total >= puff.volume or (whole and within.all()):
            break
        radius *= WIDER
    return at, np.where(open_to > 0.0, 1.0 / total if total > 0.0 else 0.0, 0.0)


def _window(grid: Grid, point: F64, radius: float) -> tuple[tuple[slice, ...], bool]:
    """Cells of the box around a ball, and whether they are all cells."""
    low, high = ((point + s * radius - grid.corner) / grid.cell for s in (-1.0, 1.0))
    first = np.clip(np.floor(low).astype(int), 0, np.array(grid.shape) - 1)
    last = np.clip(np.ceil(high).astype(int), first + 1, grid.shape)
    at = tuple(slice(int(a), int(b)) for a, b in zip(first, last, strict=True))
    return at, bool((first == 0).all() and (last == grid.shape).all())


def _far(grid: Grid, point: F64, at: tuple[slice, ...]) -> F64:
    """Distance of the middles of cells from a place [m]."""
    axes = [grid.corner[k] + grid.cell * (np.arange(s.start, s.stop) + 0.5) - point[k] for k, s in enumerate(at)]
    x, y, z = np.meshgrid(*axes, indexing="ij", sparse=True)
    return np.asarray(np.sqrt(x * x + y * y + z * z))
