"""Cells of a gas at one frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64

__all__ = ["WHOLE", "Cells", "FireCells", "GasFrame", "Mask", "neighbours"]

WHOLE = 0.999
"""[1] Room of a cell that no body cuts; the rest is rounding of bodies whose sides are those of cells."""
Cells: TypeAlias = NDArray[np.float32]
Mask: TypeAlias = NDArray[np.bool_]


def neighbours(array: NDArray[Any], axis: int) -> tuple[NDArray[Any], NDArray[Any]]:
    """Views of all cells but the last one and of all but the first one along an axis: each pair of neighbours at one place."""
    lower: list[slice] = [slice(None)] * array.ndim
    upper = list(lower)
    lower[axis], upper[axis] = slice(0, -1), slice(1, None)
    return array[tuple(lower)], array[tuple(upper)]


@dataclass(frozen=True)
class FireCells:
    """Fire in all cells of one frame; arrays are (nx, ny, nz)."""

    fuel: Cells
    """[kg/m^3] Not burnt yet."""
    product: Cells
    """[kg/m^3]"""
    released: Cells
    """[W/m^3] In the last step before the frame."""
    radiated: Cells
    """[W/m^3] The same."""


@dataclass(frozen=True)
class GasFrame:
    """All cells of one frame; arrays are (nx, ny, nz)."""

    index: int
    cell: float
    """[m]"""
    corner: F64
    """Lower corner of the first cell [m], shape (3,)."""
    soot: Cells
    """[kg/m^3] Of the open part of a cell."""
    temperature: Cells
    """[K]"""
    velocity: Cells
    """At the middles of cells [m/s], shape (nx, ny, nz, 3)."""
    room: Cells
    """[1] Open share of a cell."""
    fire: FireCells | None = None
    """None of a gas without fuel."""
    part: NDArray[np.int32] | None = None
    """First cell and the one behind the last of the part that was solved, shape (2, 3); None where all was."""

    @property
    def active(self) -> tuple[slice, ...]:
        """The part that was solved: all cells, or what follows the gas."""
        return (slice(None),) * 3 if self.part is None else tuple(slice(int(a), int(b)) for a, b in self.part.T)

    @property
    def inner_sides(self) -> tuple[int, ...]:
        """Sides of that part that lie inside the box, of -x, +x, -y, +y, -z, +z."""
        if self.part is None:
            return ()
        low, high = self.part
        return tuple(s for s in range(6) if (high[s // 2] < self.room.shape[s // 2] if s % 2 else low[s // 2] > 0))

    @cached_property
    def open(self) -> Mask:
        """Cells that have room."""
        return self.room > 0.0

    @cached_property
    def speed(self) -> Cells:
        """[m/s]; 0 where a cell has no room."""
        return np.asarray(np.linalg.norm(self.velocity, axis=-1) * self.open, dtype=np.float32)

    @cached_property
    def centers(self) -> F64:
        """Middles of cells [m], shape (nx, ny, nz, 3)."""
        grid = np.stack(np.meshgrid(*(np.arange(n) + 0.5 for n in self.soot.shape), indexing="ij"), axis=-1)
        return np.asarray(self.corner + self.cell * grid)

    def place(self, cell: Sequence[Any]) -> list[float]:
        """Middle of a cell [m], to the millimetre."""
        return [round(float(c), 3) for c in self.corner + self.cell * (np.array(cell) + 0.5)]
