"""Bodies among the cells, measured from the surfaces of the entities where they are at a frame (R106).

The room of cells, which the frames hold, is the solver's word; this is another route to it.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import F64
from ..liquid.solids import pieces_of, rows_within
from .cells import neighbours
from .outflow import layer

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ..liquid.solids import Piece
    from .cells import GasFrame, Mask

__all__ = ["Bodies", "depth_in"]

TOUCH = 1e-6
"""[cells] Bodies whose sides are those of a cell do not cut it."""


def depth_in(pieces: tuple[Piece, ...], points: F64, frame: int, margin: float) -> F64:
    """Depth of points in bodies [m], shape (n,): positive inside; NaN outside, but in a body's box with a margin; else minus infinity."""
    found = np.full(len(points), -np.inf)
    for piece in pieces:
        low, high = piece.box(frame)
        near = rows_within(points, low - margin, high + margin)
        depth = piece.depth(piece.local(points[near], frame)) if piece.solid_through and len(near) else np.full(len(near), -1.0)
        here = found[near]
        found[near] = np.where(depth > 0.0, np.fmax(here, depth), np.where(here > 0.0, here, np.nan))
    return found


class Bodies:
    """All parts of rigid entities that come near the box."""

    def __init__(self, candidate: Candidate, frames: int, lower: F64, upper: F64, passed: frozenset[str]) -> None:
        self._kept: dict[str, tuple[int, F64, F64]] = {}

        def near(piece: Piece) -> bool:
            ends = [piece.box(k) for k in ((0,) if piece.still else range(frames))]
            return any(bool((a <= upper).all() and (b >= lower).all()) for a, b in ends)

        self.pieces = tuple(p for p in pieces_of(candidate) if p.entity not in passed and near(p))
        """Parts that come into the box between two corners at some frame, but for those of entities that are `passed`."""

    @cached_property
    def moving(self) -> bool:
        """True where one of them moves."""
        return not all(p.still for p in self.pieces)

    def depth(self, frame: GasFrame) -> F64:
        """Depth of the middles of cells [m], (nx, ny, nz): positive in a body; minus infinity where no body's box cuts the cell; NaN between."""
        return self._made("depth", frame, self._depth)

    def apart(self, frame: GasFrame, sides: tuple[str, ...]) -> Mask:
        """False for cells along an open side beyond which a body's box cuts the next cell, (nx, ny, nz): it may close that side to them."""

        def look(frame: GasFrame) -> F64:
            found = np.ones(frame.room.shape)
            for side in (s for s in range(6) if sides[s] == "open"):
                axis, sign = side // 2, 1.0 if side % 2 else -1.0
                beyond = np.take(frame.centers, -1 if side % 2 else 0, axis=axis) + sign * frame.cell * np.eye(3)[axis]
                at: list[slice | int] = [slice(None)] * 3
                at[axis] = -1 if side % 2 else 0
                found[tuple(at)] *= self._points(beyond, frame, (0.5 - TOUCH) * frame.cell) == -np.inf
            return found

        return self._made("apart", frame, look) > 0.0

    def beyond(self, frame: GasFrame, side: int, reach: float) -> F64:
        """Depth as `depth_in` of points so far beyond a side [cells], one for each cell along it."""

        def look(frame: GasFrame) -> F64:
            points = layer(frame.centers, side)
            points[..., side // 2] += (0.5 + reach) * (1.0 if side % 2 else -1.0) * frame.cell
            return self._points(points, frame, 0.0)

        return self._made(f"beyond {side} {reach}", frame, look)

    def blocked(self, frame: GasFrame) -> tuple[Mask, Mask, Mask]:
        """Faces between neighbours along each axis whose middles are in a body, (nx - 1, ny, nz), (nx, ny - 1, nz), (nx, ny, nz - 1)."""

        def look(axis: int) -> F64:
            lower, _ = neighbours(frame.centers, axis)
            return self._points(lower + 0.5 * frame.cell * np.eye(3)[axis], frame, 0.0)

        x, y, z = (self._made(f"blocked {axis}", frame, lambda _, a=axis: look(a)) > 0.0 for axis in range(3))
        return x, y, z

    def _depth(self, frame: GasFrame) -> F64:
        return self._points(frame.centers, frame, (0.5 - TOUCH) * frame.cell)

    def _points(self, points: F64, frame: GasFrame, margin: float) -> F64:
        return depth_in(self.pieces, points.reshape(-1, 3), frame.index, margin).reshape(points.shape[:-1])

    def _made(self, name: str, frame: GasFrame, make: object) -> F64:
        """A field, made anew where bodies or the box have moved."""
        kept = self._kept.get(name)
        fresh = kept is not None and (kept[0] == frame.index or (not self.moving and bool((kept[1] == frame.corner).all())))
        if kept is None or not fresh:
            kept = (frame.index, frame.corner, make(frame))  # type: ignore[operator]
            self._kept[name] = kept
        return kept[2]
