"""Parts of a job: reports of each count as one stretch of the whole."""

from __future__ import annotations

import math
from typing import Protocol

__all__ = ["Part", "Tell"]


class Tell(Protocol):
    """Takes how far the work is."""

    def __call__(self, done: float, total: float, message: str, ends: float | None = None) -> None:
        """`ends`: how far the work is when what goes on at the present pace ends, in the unit of `done`."""
        ...


class Part:
    """One part of a job, from one share of the whole to another.

    Args:
        tell: takes the reports of the whole, of which `total` is 1.
        first: share of the whole at which the part begins, in [0, 1].
        last: at which it ends.
        alike: in how many equal stretches its own work falls; the pace of one says nothing of the next.
    """

    def __init__(self, tell: Tell, first: float = 0.0, last: float = 1.0, *, alike: int = 1) -> None:
        self._tell, self._first, self._last, self._alike = tell, first, last, max(1, alike)

    def __call__(self, done: float, total: float, message: str, ends: float | None = None) -> None:
        """Report that `done` of `total` of the part is done."""
        share = min(1.0, max(0.0, done / total)) if total > 0 else 1.0
        stretch = max(1, math.ceil(share * self._alike - 1e-9)) / self._alike if ends is None else min(1.0, ends / total)
        self._tell(self._at(share), 1.0, message, self._at(stretch))

    def _at(self, share: float) -> float:
        return self._first + share * (self._last - self._first)

    def part(self, first: float, last: float, *, alike: int = 1) -> Part:
        """A part of this part, between two shares of it."""
        return Part(self, first, last, alike=alike)
