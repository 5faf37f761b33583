"""Stretch of a sheet by place."""

from __future__ import annotations

from typing import NamedTuple

from ...worlds.arrays import F64

__all__ = ["Stretch"]


class Stretch(NamedTuple):
    """Extension of the edges of a sheet at a frame, over their length at rest."""

    largest: float
    place_at_rest: F64
    """Middle of that edge, in the entity's frame [m]."""
    point: F64
    """Its middle in the world [m]."""
    axes: str
    """The two longest of the sheet at rest, e.g. `xy`."""
    thirds: list[list[float | None]]
    """Largest in each of 3 x 3 parts along those axes: rows along the second; None where there is no edge."""
