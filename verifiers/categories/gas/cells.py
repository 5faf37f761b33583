"""Cells of a gas at one frame."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64

__all__ = ["WHOLE", "Cells", "Fields", "FireCells", "GasFrame", "Grid", "Mask", "layer", "most_near", "neighbours", "squares"]

WHOLE = 0.999
"""[1] Room of a cell that no body cuts; the rest is rounding of bodies whose sides are those of cells."""
Cells: TypeAlias = NDArray[np.float32]
Mask: TypeAlias = NDArray[np.bool_]
T = TypeVar("T")


def neighbours(array: NDArray[Any], axis: int) -> tuple[NDArray[Any], NDArray[Any]]:
    """Views of all cells but the last one and of all but the first one along an axis: each pair of neighbours at one place."""
    lower: list[slice] = [slice(None)] * array.ndim
    upper = list(lower)
    lower[axis], upper[axis] = slice(0, -1), slice(1, None)
    return array[tuple(lower)], array[tuple(upper)]


def layer(array: Any, side: int, depth: int = 0) -> F64:
    """Cells of an array along a side; `depth` cells inward."""
    at: list[slice | int] = [slice(None)] * array.ndim
    at[side // 2] = -1 - depth if side % 2 else depth
    return np.array(array[tuple(at)], dtype=np.float64, order="C")


def most_near(values: NDArray[Any], reach: int) -> NDArray[Any]:
    """Greatest value within so many cells along each axis, of every cell; beyond the sides nothing is."""
    from .near_kernels import most_near as found

    if values.dtype == np.bool_:
        return np.asarray(found(np.ascontiguousarray(values).view(np.uint8), reach)).view(np.bool_)
    return np.asarray(found(np.ascontiguousarray(values), reach))


def squares(vectors: NDArray[Any]) -> NDArray[Any]:
    """Squared lengths of vectors (..., 3), summed from the first component on: `sum` takes much longer over an axis of three."""
    square = vectors * vectors
    return np.asarray(square[..., 0] + square[..., 1] + square[..., 2])


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
class Grid:
    """Places of cells, the same at all frames of a box that stands still."""

    corner: F64
    """Lower corner of the first cell [m], shape (3,)."""
    cell: float
    """[m]"""
    shape: tuple[int, ...]

    @cached_property
    def centers(self) -> F64:
        """Middles of cells [m], shape (nx, ny, nz, 3)."""
        grid = np.stack(np.meshgrid(*(np.arange(n) + 0.5 for n in self.shape), indexing="ij"), axis=-1)
        return np.asarray(self.corner + self.cell * grid)

    @cached_property
    def middle(self) -> F64:
        """Middle of all cells [m], shape (3,)."""
        return np.asarray(self.corner + 0.5 * (self.cell * np.array(self.shape)))

    @cached_property
    def arms(self) -> F64:
        """Ways from that middle to those of cells [m], shape (nx, ny, nz, 3)."""
        return np.asarray(self.centers - self.middle)

    def faces(self, axis: int) -> F64:
        """Middles of the faces between neighbours along an axis [m], one fewer along it than cells."""
        return np.asarray(neighbours(self.centers, axis)[0] + 0.5 * self.cell * np.eye(3)[axis])


class Fields:
    """Fields that are worked out from frames, kept of the last two that were asked about: watches compare a frame with the one before."""

    def __init__(self) -> None:
        self._frames: list[tuple[GasFrame, dict[Hashable, Any]]] = []

    def of(self, frame: GasFrame, name: Hashable, make: Callable[[], T]) -> T:
        """The field of a frame, made at the first call with this very frame; nobody writes to it."""
        known = next((fields for held, fields in self._frames if held is frame), None)
        if known is None:
            known = {}
            self._frames = [*self._frames[-1:], (frame, known)]
        if name not in known:
            known[name] = make()
        found: T = known[name]
        return found


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
    grid: Grid | None = None
    """Its places, where other frames have the same."""
    fields: Fields = field(default_factory=Fields, repr=False, compare=False)
    """Fields of it and of the frames about it."""

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
        return np.asarray(np.sqrt(squares(self.velocity)) * self.open, dtype=np.float32)

    @property
    def centers(self) -> F64:
        """Middles of cells [m], shape (nx, ny, nz, 3)."""
        return self.places.centers

    @cached_property
    def places(self) -> Grid:
        """Places of its cells."""
        return self.grid or Grid(self.corner, self.cell, self.soot.shape)

    @cached_property
    def held(self) -> Cells:
        """Soot by volume of the whole cell [kg/m^3]."""
        return np.asarray(self.soot * self.room)

    def place(self, cell: Sequence[Any]) -> list[float]:
        """Middle of a cell [m], to the millimetre."""
        return [round(float(c), 3) for c in self.corner + self.cell * (np.array(cell) + 0.5)]
