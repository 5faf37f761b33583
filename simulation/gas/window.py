"""Active boxes inside a declared box: where one lies, and how it grows and shrinks in blocks of cells."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .solids import Solids

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .settings import Side

__all__ = ["BLOCK", "Window", "bounds_of", "cells_of", "fitted", "shrunk"]

BLOCK = 8
"""Cells by which a side moves."""
SLACK = 2
"""Own choice: blocks by which a side has to be too far out to come in, so that it does not move back and forth."""

Cells = tuple[int, int, int]


class Window(NamedTuple):
    """Cells from `low` up to, and without, `high`."""

    low: Cells
    high: Cells

    @property
    def shape(self) -> Cells:
        """Cells along each axis."""
        a, b = self.low, self.high
        return (b[0] - a[0], b[1] - a[1], b[2] - a[2])

    @property
    def cells(self) -> tuple[slice, ...]:
        """Its part of fields with one element per cell."""
        return tuple(slice(a, b) for a, b in zip(self.low, self.high, strict=True))

    @property
    def elements(self) -> tuple[slice, ...]:
        """Its part of fields with one element more than cells along each axis."""
        return tuple(slice(a, b + 1) for a, b in zip(self.low, self.high, strict=True))

    def inner(self, shape: Cells) -> tuple[int, ...]:
        """1 for each side, x-, x+, y-, y+, z-, z+, that lies inside a declared box."""
        return tuple(int(self.low[s // 2] > 0 if s % 2 == 0 else self.high[s // 2] < shape[s // 2]) for s in range(6))

    def sides(self, shape: Cells, declared: Sequence[Side]) -> tuple[Side, ...]:
        """Kinds of its sides: open inside the declared box, else as declared."""
        return tuple("open" if i else d for i, d in zip(self.inner(shape), declared, strict=True))

    def solids(self, whole: Solids) -> Solids:
        """Its part of what is not open."""
        at = self.elements
        return Solids(whole.room[at], whole.opening[at], whole.velocity[at])


def bounds_of(marks: NDArray[np.bool_], low: Cells = (0, 0, 0)) -> Window | None:
    """Smallest window around marked cells, which begin at a place; None without any."""
    first, last = [], []
    for axis in range(3):
        found = np.flatnonzero(marks.any(axis=tuple(a for a in range(3) if a != axis)))
        if not len(found):
            return None
        first.append(low[axis] + int(found[0]))
        last.append(low[axis] + int(found[-1]) + 1)
    return Window(cells_of(first), cells_of(last))


def fitted(needed: Sequence[Window], margin: int, shape: Cells, start: Window | None = None) -> Window:
    """Window of whole blocks that holds others with a margin around each, and another one as it is."""
    first = [[max(0, (a - margin) // BLOCK * BLOCK) for a in w.low] for w in needed]
    last = [[min(n, -(-(b + margin) // BLOCK) * BLOCK) for b, n in zip(w.high, shape, strict=True)] for w in needed]
    if start is not None:
        first, last = [*first, list(start.low)], [*last, list(start.high)]
    return Window(cells_of(np.min(first, axis=0)), cells_of(np.max(last, axis=0)))


def shrunk(now: Window, least: Window) -> Window:
    """A window whose sides have come in to those of the least one, where they are farther out by more than `SLACK` blocks."""
    most = SLACK * BLOCK
    low = [b if b - a > most else a for a, b in zip(now.low, least.low, strict=True)]
    high = [b if a - b > most else a for a, b in zip(now.high, least.high, strict=True)]
    return Window(cells_of(low), cells_of(high))


def cells_of(values: Any) -> Cells:
    """Three counts as such."""
    a, b, c = (int(v) for v in values)
    return (a, b, c)
