"""Cells around a solid whose points all lie outside it, so that the many points of a liquid that are far from its bed need no query."""

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
"""Own choice: cells that the box of a solid is cut into; one byte each."""
ROUNDING = 1e-4
"""Share of a solid's size that a distance in single precision may be off by, with room: it errs by some 1e-7 of it."""
UNKNOWN, OUTSIDE, NEAR = np.uint8(0), np.uint8(1), np.uint8(2)


class OutsideCells:
    """Which cells of a solid's box lie wholly outside it, worked out for a cell when a point first comes to lie in it.

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
        self._state = np.zeros(int(self._counts.prod()), dtype=np.uint8)
        self._far = 0.5 * np.sqrt(3.0) * self._edge + ROUNDING * solid.size

    def near(self, points: F64) -> NDArray[np.bool_]:
        """Which points of the box, shape (n, 3), do not lie in a cell that is known to be outside, shape (n,)."""
        cells = np.minimum(((points - self._low) / self._edge).astype(np.int64), self._counts - 1)
        keys: I64 = (cells[:, 0] * self._counts[1] + cells[:, 1]) * self._counts[2] + cells[:, 2]
        new = np.unique(keys[self._state[keys] == UNKNOWN])
        if len(new):
            z, rest = new % self._counts[2], new // self._counts[2]
            middle = np.column_stack([rest // self._counts[1], rest % self._counts[1], z]) + 0.5
            outside = self._depth(middle * self._edge + self._low) < -self._far
            self._state[new] = np.where(outside, OUTSIDE, NEAR)
        return np.asarray(self._state[keys] == NEAR)
