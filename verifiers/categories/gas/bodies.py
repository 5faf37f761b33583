"""Bodies among the cells, measured from the surfaces of the entities where they are at a frame (R106).

The room of cells, which the frames hold, is the solver's word; this is another route to it.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from ....worlds.arrays import F64
from ..liquid.solids import pieces_of, rows_within
from .cells import layer

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ..liquid.solids import Piece
    from .cells import GasFrame, Mask

__all__ = ["Bodies", "depth_in"]

T = TypeVar("T")
TOUCH = 1e-6
"""[cells] Bodies whose sides are those of a cell do not cut it."""


def depth_in(pieces: tuple[Piece, ...], points: F64, frame: int, margin: float, *, known: F64 | None = None) -> F64:
    """Depth of points in bodies [m], shape (n,): positive inside; NaN outside, but in a body's box with a margin; else minus infinity.

    Args:
        pieces: parts of the bodies.
        points: (n, 3).
        frame: where the bodies are.
        margin: [m]
        known: the same in other bodies, which count too.
    """
    found = np.full(len(points), -np.inf) if known is None else known.copy()
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
        self._kept: dict[Hashable, tuple[F64, Any]] = {}

        def near(piece: Piece) -> bool:
            ends = [piece.box(k) for k in ((0,) if piece.still else range(frames))]
            return any(bool((a <= upper).all() and (b >= lower).all()) for a, b in ends)

        self.pieces = tuple(p for p in pieces_of(candidate) if p.entity not in passed and near(p))
        """Parts that come into the box between two corners at some frame, but for those of entities that are `passed`."""
        self._still, self._movers = (tuple(p for p in self.pieces if p.still == still) for still in (True, False))

    @property
    def moving(self) -> bool:
        """True where one of them moves."""
        return bool(self._movers)

    def depth(self, frame: GasFrame) -> F64:
        """Depth of the middles of cells [m], (nx, ny, nz): positive in a body; minus infinity where no body's box cuts the cell; NaN between."""
        return self._depths("depth", frame, lambda: frame.centers, (0.5 - TOUCH) * frame.cell)

    def apart(self, frame: GasFrame, sides: tuple[str, ...]) -> Mask:
        """False for cells along an open side beyond which a body's box cuts the next cell, (nx, ny, nz): it may close that side to them."""

        def look() -> Mask:
            found = np.ones(frame.room.shape, dtype=bool)
            for side in (s for s in range(6) if sides[s] == "open"):
                axis, sign = side // 2, 1.0 if side % 2 else -1.0
                beyond = np.take(frame.centers, -1 if side % 2 else 0, axis=axis) + sign * frame.cell * np.eye(3)[axis]
                at: list[slice | int] = [slice(None)] * 3
                at[axis] = -1 if side % 2 else 0
                margin = (0.5 - TOUCH) * frame.cell
                found[tuple(at)] &= self._depths(f"beyond {side}", frame, partial(np.asarray, beyond), margin) == -np.inf
            return found

        return self._made("apart", frame, look)

    def beyond(self, frame: GasFrame, side: int, reach: float) -> F64:
        """Depth as `depth_in` of points so far beyond a side [cells], one for each cell along it."""

        def points() -> F64:
            found = layer(frame.centers, side)
            found[..., side // 2] += (0.5 + reach) * (1.0 if side % 2 else -1.0) * frame.cell
            return found

        return self._depths(f"past {side} {reach}", frame, points, 0.0)

    def blocked(self, frame: GasFrame) -> tuple[Mask, Mask, Mask]:
        """Faces between neighbours along each axis whose middles are in a body, (nx - 1, ny, nz), (nx, ny - 1, nz), (nx, ny, nz - 1)."""

        def look(axis: int) -> Mask:
            depth = self._depths(f"face {axis}", frame, lambda: frame.places.faces(axis), 0.0)
            return np.asarray(depth > 0.0)

        x, y, z = (self._made(f"blocked {axis}", frame, partial(look, axis)) for axis in range(3))
        return x, y, z

    def _depths(self, name: str, frame: GasFrame, points: Callable[[], F64], margin: float) -> F64:
        """Depth of points that go with the cells, of any shape; bodies that stand still are measured once for each place of the box."""

        def of(pieces: tuple[Piece, ...], known: F64 | None) -> F64:
            at = points()
            whole = None if known is None else known.reshape(-1)
            return depth_in(pieces, at.reshape(-1, 3), frame.index, margin, known=whole).reshape(at.shape[:-1])

        still = self._standing(name, frame, lambda: of(self._still, None))
        return frame.fields.of(frame, ("bodies", name), lambda: of(self._movers, still)) if self.moving else still

    def _made(self, name: str, frame: GasFrame, make: Callable[[], T]) -> T:
        """A field that follows from bodies, made anew where they or the box have moved."""
        return frame.fields.of(frame, ("of bodies", name), make) if self.moving else self._standing(("of", name), frame, make)

    def _standing(self, name: Hashable, frame: GasFrame, make: Callable[[], T]) -> T:
        """A field that is the same while the box stands, made once for each place of it."""
        kept = self._kept.get(name)
        if kept is None or not bool((kept[0] == frame.corner).all()):
            kept = self._kept[name] = (frame.corner, make())
        found: T = kept[1]
        return found
