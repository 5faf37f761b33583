"""The regular grid that all fields of a landscape share."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...worlds.arrays import F64

__all__ = ["Grid"]


@dataclass(frozen=True)
class Grid:
    """Square cells over a rectangle centred at the origin: x east, y north, row 0 south, column 0 west.

    A value belongs to the centre of its cell, so that areas and volumes are sums over cells.
    """

    rows: int
    cols: int
    cell: float
    """Side of a cell [m]."""

    @classmethod
    def over(cls, extent: tuple[float, float], cell: float) -> Grid:
        """The grid over an extent x, y [m]: as many whole cells as come closest to it, at least three each way."""
        return cls(rows=max(3, round(extent[1] / cell)), cols=max(3, round(extent[0] / cell)), cell=cell)

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, cols)."""
        return self.rows, self.cols

    @property
    def extent(self) -> tuple[float, float]:
        """Size x, y [m]."""
        return self.cols * self.cell, self.rows * self.cell

    @property
    def cell_area(self) -> float:
        """[m^2]"""
        return self.cell * self.cell

    def axes(self) -> tuple[F64, F64]:
        """Coordinates of the columns [m], shape (cols,), and of the rows [m], shape (rows,)."""
        x = (np.arange(self.cols) - 0.5 * (self.cols - 1)) * self.cell
        y = (np.arange(self.rows) - 0.5 * (self.rows - 1)) * self.cell
        return x.astype(np.float64), y.astype(np.float64)

    def points(self) -> tuple[F64, F64]:
        """Coordinates x and y of all cells [m], each of shape (rows, cols)."""
        x, y = self.axes()
        return np.broadcast_to(x, self.shape).astype(np.float64), np.broadcast_to(y[:, None], self.shape).astype(np.float64)

    def place(self, index: int) -> tuple[float, float]:
        """Coordinates x, y [m] of the cell with this flat index."""
        row, col = divmod(int(index), self.cols)
        return (col - 0.5 * (self.cols - 1)) * self.cell, (row - 0.5 * (self.rows - 1)) * self.cell

    def indices(self, x: F64, y: F64) -> tuple[np.ndarray, np.ndarray]:
        """Row and column of the cells that hold points [m]; points beyond the edge get the nearest cell."""
        col = np.clip(np.round(np.asarray(x) / self.cell + 0.5 * (self.cols - 1)), 0, self.cols - 1).astype(np.int64)
        row = np.clip(np.round(np.asarray(y) / self.cell + 0.5 * (self.rows - 1)), 0, self.rows - 1).astype(np.int64)
        return row, col

    def sample(self, field: F64, x: F64, y: F64) -> F64:
        """Bilinear interpolation of a field at points [m]; constant beyond the outermost cell centres."""
        u = np.clip(np.asarray(x) / self.cell + 0.5 * (self.cols - 1), 0.0, self.cols - 1.0)
        v = np.clip(np.asarray(y) / self.cell + 0.5 * (self.rows - 1), 0.0, self.rows - 1.0)
        col, row = np.minimum(u.astype(int), self.cols - 2), np.minimum(v.astype(int), self.rows - 2)
        s, t = u - col, v - row
        south = field[row, col] * (1 - s) + field[row, col + 1] * s
        north = field[row + 1, col] * (1 - s) + field[row + 1, col + 1] * s
        return np.asarray(south * (1 - t) + north * t, dtype=np.float64)
