"""Drainage of a landscape: filled surface, flow direction, order, accumulation and watersheds (R34, R36, R37).

The terrain itself is never changed: filling is the level that water would reach.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.errors import InputError
from .grid import Grid

__all__ = ["D8_CODES", "Drainage", "drain"]

D8_CODES = {(0, 1): 1, (-1, 1): 2, (-1, 0): 4, (-1, -1): 8, (0, -1): 16, (1, -1): 32, (1, 0): 64, (1, 1): 128, (0, 0): 0}
"""(row step, column step) -> code of the flow direction: powers of two clockwise from east, 0 at an outlet. Row 0 is
south, so that a step of -1 in rows leads south."""


@dataclass(frozen=True)
class Drainage:
    """Where water goes on one surface. Arrays of shape (rows, cols) unless said otherwise."""

    grid: Grid
    valid: np.ndarray
    """True where there is land (or sea floor) at all."""
    height: F64
    """The surface that was drained [m]."""
    filled: F64
    """Level of Priority-Flood [m]: "Surface Height"."""
    receiver: np.ndarray
    """Flat index of the cell that each cell drains to; its own at an outlet; -1 without land."""
    order: np.ndarray
    """Flat indices, each after its receiver, shape (number of valid cells,)."""

    @property
    def depth(self) -> F64:
        """Depth of the depressions [m]: "Basin Depth"."""
        return self.filled - self.height

    def accumulation(self, weight: F64 | None = None) -> F64:
        """Sum of `weight` (default: the area of a cell [m^2]) over each cell and all that drains through it."""
        return self._area if weight is None else self._gathered(weight)

    @cached_property
    def _area(self) -> F64:
        found = self._gathered(np.full(self.grid.shape, self.grid.cell_area))
        found.flags.writeable = False
        return found

    def _gathered(self, weight: F64) -> F64:
        from .flood_kernels import accumulate

        flat = np.where(self.valid, weight, 0.0).ravel().astype(np.float64, copy=False)
        return np.asarray(accumulate(flat, self.receiver.ravel(), self.order)).reshape(self.grid.shape)

    def basins(self) -> np.ndarray:
        """Number of the watershed of each cell, from 1; 0 without land."""
        from .flood_kernels import label_basins

        return np.asarray(label_basins(self.receiver.ravel(), self.order)).reshape(self.grid.shape)

    def divides(self) -> np.ndarray:
        """Cells beside which another watershed begins."""
        label = self.basins()
        found = np.zeros(self.grid.shape, dtype=bool)
        for a, b in ((np.s_[1:, :], np.s_[:-1, :]), (np.s_[:, 1:], np.s_[:, :-1])):
            differs = (label[a] != label[b]) & (label[a] > 0) & (label[b] > 0)
            found[a] |= differs
            found[b] |= differs
        return found

    def directions(self) -> np.ndarray:
        """Flow direction of each cell as a D8 code (`D8_CODES`); 247 without land."""
        here = np.arange(self.receiver.size).reshape(self.grid.shape)
        rows = self.receiver // self.grid.cols - here // self.grid.cols
        cols = self.receiver % self.grid.cols - here % self.grid.cols
        found = np.full(self.grid.shape, 247, dtype=np.uint8)
        for (row, col), code in D8_CODES.items():
            found[self.valid & (rows == row) & (cols == col)] = code
        return found


def drain(grid: Grid, height: F64, *, valid: Any = None) -> Drainage:
    """Fill and route a surface.

    Args:
        grid: where the heights lie.
        height: [m], shape (rows, cols).
        valid: where there is land; default everywhere that `height` is a number.

    Raises:
        InputError: the heights do not fit the grid, or there is no land.
    """
    from .flood_kernels import flood

    if height.shape != grid.shape:
        raise InputError(f"heights of shape {height.shape} do not fit the grid of {grid.shape}")
    known = np.isfinite(height) if valid is None else np.asarray(valid, dtype=bool) & np.isfinite(height)
    if not known.any():
        raise InputError("there is no cell with a height: the surface is all no-data")
    solid = np.where(known, height, 0.0).astype(np.float64, copy=False)
    filled = solid.ravel().copy()
    receiver, order, waiting = (np.empty(filled.size, dtype=np.int32) for _ in range(3))
    queue = np.empty((filled.size, 2), dtype=np.int32)
    count = flood(known.ravel(), grid.rows, grid.cols, filled, receiver, order, waiting, queue)
    return Drainage(
        grid=grid,
        valid=known,
        height=np.where(known, height, np.nan),
        filled=np.where(known, filled.reshape(grid.shape), np.nan),
        receiver=receiver.reshape(grid.shape),
        order=order[:count].copy() if count < order.size else order,
    )
