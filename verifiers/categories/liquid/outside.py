"""Cells around a solid with the distance of their middles, so that the many points of a liquid that lie outside its bed need no query."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ....geometry import Solid
from ....worlds.arrays import F64, I64

__all__ = ["MANY", "OutsideCells"]

MANY = 4096
"""Own choice: with fewer points a query of each costs less than looking up cells."""
CELLS = 1e6
"""Own choice: cells that the box of a solid is cut into; four bytes each."""
ROUNDING = 1e-4
"""Share of a solid's size that a distance in single precision may be off by, with room: it errs by some 1e-7 of it."""


class OutsideCells:
    """Distance outside a solid of the middles of its box's cells, worked out for a cell when a point first comes to lie in it.

    Args:
        solid: in its body's frame.
        depth: depth of points [m], negative outside, where it is the distance to the surface.
    """

    def __init__(self, solid: Solid, depth: Callable[[F64], F64]) -> None:
        span = np.maximum(solid.upper - solid.lower, 1e-9)
        self._depth, self._low = depth, np.asarray(solid.lower)
        self._edge = float((span.prod() / CELLS) ** (1 / 3))
        self._edge = max(self._edge, float(span.max()) / CELLS ** (1 / 2))
        self._counts = np.floor(span / self._edge).astype(np.int64) + 1
        self._distance = np.full(int(self._counts.prod()), np.nan, dtype=np.float32)
        self._room = ROUNDING * solid.size

    def near(self, points: F64) -> tuple[NDArray[np.intp], F64]:
        """Rows of the points of the box, shape (n, 3), that are not nearer to the middle of their cell than that is to the solid.

        All others lie outside. And by row: depth of that middle, negative outside, and how far it is away, with room for rounding
        [m], shape (rows, 2).
        """
        cells = np.minimum(((points - self._low) / self._edge).astype(np.int64), self._counts - 1)
        keys: I64 = (cells[:, 0] * self._counts[1] + cells[:, 1]) * self._counts[2] + cells[:, 2]
        new = np.unique(keys[np.isnan(self._distance[keys])])
        if len(new):
            z, rest = new % self._counts[2], new // self._counts[2]
            middle = np.column_stack([rest // self._counts[1], rest % self._counts[1], z]) + 0.5
            self._distance[new] = -self._depth(middle * self._edge + self._low)
        off = points - ((cells + 0.5) * self._edge + self._low)
        least = self._distance[keys] - self._room
        squared = np.einsum("ij,ij->i", off, off)
        rows = np.flatnonzero((least < 0.0) | (squared >= least * least))
        return rows, np.column_stack([-self._distance[keys[rows]], np.sqrt(squared[rows]) + self._room])
