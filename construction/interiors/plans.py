"""Plans of storeys: rooms as rectangles that tile one rectangle on every storey, and what is asked of them (R48, R95)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

__all__ = ["CELL", "OUTSIDE", "SLACK", "STEPS", "UPPER", "WING", "Need", "Plan", "Rect", "Side", "cells"]

CELL = 0.25
"""[m] Own choice: grid of plans; walls stand on its lines."""
OUTSIDE = "outside"
"""Name that stands for the outside among the doors of a room."""
SLACK = 0.3
"""Own choice: share by which a room's area may differ from what is asked for."""
STEPS, UPPER = "steps", "upper"
"""Ends of the ids of the parts of a corridor with steps: the flight, and the part above it."""
WING = "wing"
"""End of the id of the shorter part of an L-shaped room."""

Side = Literal["west", "south", "east", "north"]


@dataclass(frozen=True)
class Need:
    """Area, doors and daylight of a room."""

    area: float
    """[m^2]"""
    width: float
    """Least clear side [m]."""
    aspect: float
    """Longest side over the shortest, at most."""
    doors: tuple[str, ...] = ()
    """Rooms to which a door leads, or `OUTSIDE`."""
    daylight: bool = False
    """It has a side on the outside."""
    storeys: tuple[int, ...] = (0,)
    """Storeys that it stands on: one, or all of a stairwell."""
    asked: bool = True
    """The area is asked for; else it may be stretched to fill the storey."""
    corridor: bool = False
    """Its width is `width` and no more, it runs between rooms."""
    flight: float = 0.0
    """Length of a flight of steps in a corridor [m]; 0 for none."""
    well: tuple[float, float] | None = None
    """Clear sides of a stairwell across and along the climb [m]."""
    straight: bool = False
    """Its stairs are one straight flight along a side wall, with floor on the other side."""
    wing: bool = False
    """It is L-shaped: two rectangles that meet, flush on one side."""


@dataclass(frozen=True)
class Rect:
    """A rectangle of the plan between the middles of its walls [m]."""

    x0: float
    y0: float
    x1: float
    y1: float

    @property
    def area(self) -> float:
        """[m^2]"""
        return (self.x1 - self.x0) * (self.y1 - self.y0)


@dataclass(frozen=True)
class Plan:
    """Rooms of a storey, its corner at the origin."""

    width: float
    """Extent x [m]."""
    depth: float
    """Extent y [m]."""
    rooms: Mapping[str, Rect]
    raised: frozenset[str] = frozenset()
    """Rooms whose floor is level with the upper part of the corridor."""
    fronts: Mapping[str, Side] = field(default_factory=dict)
    """Side of each stairwell at which one gets on the stairs."""
    mirrored: frozenset[str] = frozenset()
    """Stairwells whose straight flight is on the right of who climbs."""
    doors: tuple[tuple[str, str], ...] = ()
    """Rooms between which a door leads, each pair once; parts of corridors by their own ids."""


def cells(length: float) -> int:
    """Cells that a length takes at least."""
    return math.ceil(length / CELL - 1e-9)
