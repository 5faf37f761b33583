"""The floor of one room: what stands where, what has to stay free, and whether one can still walk everywhere."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from .faces import WallLine, wall_lines
from .plans import Rect
from .walls import WIDE, Opening, leaves, swing

__all__ = ["FloorSpace", "Spot", "in_rows", "turned_size"]

GRID = 0.05
"""[m] Own choice: cells in which ways are looked for."""
WALKER = 0.6
"""[m] Width of the way that stays between furniture: a person with something in the hands (Neufert); S4 asks for 0.51 m."""
BESIDE_LEAF = 0.2
"""[m] From the middle of a door away from its hinges, where one enters beside the open leaf."""
APART = 0.01
"""[m] Own choice: gap between things on the floor."""


class Spot(NamedTuple):
    """Where a thing stands: x, y of its origin [m] and its turn about z in quarters."""

    x: float
    y: float
    quarter: int

    @property
    def yaw(self) -> float:
        """[rad]"""
        return self.quarter * math.pi / 2

    def rect(self, box: Rect) -> Rect:
        """A rectangle of the thing's own frame, in the room."""
        c, s = ((1, 0), (0, 1), (-1, 0), (0, -1))[self.quarter % 4]
        xs = [c * x - s * y for x in (box.x0, box.x1) for y in (box.y0, box.y1)]
        ys = [s * x + c * y for x in (box.x0, box.x1) for y in (box.y0, box.y1)]
        return Rect(self.x + min(xs), self.y + min(ys), self.x + max(xs), self.y + max(ys))


def turned_size(box: Rect, quarter: int) -> tuple[float, float]:
    """Extents x, y of a rectangle after so many quarter turns [m]."""
    size = (box.x1 - box.x0, box.y1 - box.y0)
    return size if quarter % 2 == 0 else (size[1], size[0])


def in_rows(room: Rect, foot: Rect, number: int, count: int, rows: int) -> Spot:
    """Place of a thing of several that stand in one or two rows along a room.

    Args:
        room: between its walls [m].
        foot: of the thing in its own frame [m].
        number: of the thing among the others, from 0.
        count: of things.
        rows: 1 in the middle of the room, 2 at a quarter of its width from either wall.
    """
    wide, deep = room.x1 - room.x0, room.y1 - room.y0
    along = (number // rows + 0.5) / math.ceil(count / rows)
    across = 0.5 if rows == 1 else (0.25, 0.75)[number % 2]
    u, v = (along, across) if wide >= deep else (across, along)
    x, y = room.x0 + u * wide, room.y0 + v * deep
    return Spot(x - (foot.x0 + foot.x1) / 2, y - (foot.y0 + foot.y1) / 2, 0)


def _meet(a: Rect, b: Rect, gap: float = 0.0) -> bool:
    return a.x0 < b.x1 + gap and b.x0 < a.x1 + gap and a.y0 < b.y1 + gap and b.y0 < a.y1 + gap


def _inside(a: Rect, b: Rect) -> bool:
    return a.x0 >= b.x0 - 1e-9 and a.y0 >= b.y0 - 1e-9 and a.x1 <= b.x1 + 1e-9 and a.y1 <= b.y1 + 1e-9


@dataclass
class FloorSpace:
    """A room between its walls, with the doors and windows in them."""

    room: Rect
    """All of it; with the corner that an L-shaped room leaves out."""
    openings: list[Opening]
    wall: float
    solid: list[Rect] = field(default_factory=list)
    """Footprints of what stands there."""
    access: list[Rect] = field(default_factory=list)
    """Floor from which things are used; free of other things."""
    name: str = ""
    """Room of the plan; doors that belong to it open into it."""
    wing: str = ""
    """Shorter part of an L-shaped room."""
    parts: Mapping[str, Rect] = field(default_factory=dict)
    """Both parts of an L-shaped room between their walls."""
    notch: Rect | None = None
    """Corner that an L-shaped room leaves out, up to the faces of its walls."""

    @classmethod
    def of_wing(cls, main: Rect, wing: Rect, openings: list[Opening], wall: float, *, names: tuple[str, str]) -> FloorSpace:
        """An L-shaped room.

        Args:
            main: its longer part between its walls [m].
            wing: its shorter part between its walls [m].
            openings: doors and windows in its walls.
            wall: thickness of walls [m].
            names: of both parts.
        """
        room = Rect(min(main.x0, wing.x0), min(main.y0, wing.y0), max(main.x1, wing.x1), max(main.y1, wing.y1))
        beside = wing.x0 > main.x1 or wing.x1 < main.x0
        if beside:
            x0, x1 = (main.x1, room.x1) if wing.x0 > main.x1 else (room.x0, main.x0)
            y0, y1 = (wing.y1, room.y1) if wing.y0 - room.y0 < 1e-9 else (room.y0, wing.y0)
        else:
            y0, y1 = (main.y1, room.y1) if wing.y0 > main.y1 else (room.y0, main.y0)
            x0, x1 = (wing.x1, room.x1) if wing.x0 - room.x0 < 1e-9 else (room.x0, wing.x0)
        own = dict(zip(names, (main, wing), strict=True))
        return cls(room, openings, wall, name=names[0], wing=names[1], parts=own, notch=Rect(x0, y0, x1, y1))

    def __post_init__(self) -> None:
        ways = [o for o in self.openings if o.kind in ("door", "archway")]
        self.doors = [swing(o, self.wall) for o in ways]
        self.leaves = [r for o in self._own_doors() for r in leaves(o, self.beside(o))]
        self.entries = [self._entry(o) for o in ways]
        if not self._walkable():
            # A way that the leaf alone bars is none that furniture could leave free.
            self.leaves = []
        self.windows = [(o.plan(self.wall), o.sill) for o in self.openings if o.kind == "window"]

    @property
    def area(self) -> float:
        """[m^2]"""
        return self.room.area - (self.notch.area if self.notch else 0.0)

    def beside(self, opening: Opening) -> Rect:
        """The room, or the part of an L-shaped one, in whose wall an opening is."""
        return next((self.parts[n] for n in opening.rooms if n in self.parts), self.room)

    def holds(self, rect: Rect) -> bool:
        """True if a rectangle lies between the walls of the room."""
        return _inside(rect, self.room) and not self.beyond(rect)

    def beyond(self, rect: Rect) -> bool:
        """True if a rectangle reaches into the corner that an L-shaped room leaves out."""
        return self.notch is not None and _meet(rect, self.notch, -1e-9)

    def walls(self) -> list[WallLine]:
        """Faces of the walls: of a rectangle by quarter, of an L six."""
        return wall_lines(self.room, self.notch)

    def _own_doors(self) -> list[Opening]:
        return [o for o in self.openings if o.kind == "door" and o.rooms[0] in {self.name, self.wing} - {""}]

    def _entry(self, opening: Opening) -> tuple[float, float]:
        """Point just inside of a door, beside its leaf."""
        (x, y), own = opening.center, self.beside(opening)
        reach = self.wall / 2 + WALKER / 2 + GRID
        if opening in self._own_doors() and opening.width <= WIDE:
            if opening.along == "x":
                x += BESIDE_LEAF if 2 * x < own.x0 + own.x1 else -BESIDE_LEAF
            else:
                y += BESIDE_LEAF if 2 * y < own.y0 + own.y1 else -BESIDE_LEAF
        if opening.along == "x":
            return (x, y + (reach if y < (own.y0 + own.y1) / 2 else -reach))
        return (x + (reach if x < (own.x0 + own.x1) / 2 else -reach), y)

    def fits(self, foot: Rect, use: Rect | None, height: float) -> str | None:
        """The constraint that stands in the way of a thing, in words; None where it fits, ways and what opens not asked yet.

        Args:
            foot: its footprint.
            use: floor from which it is used.
            height: [m]
        """
        if not self.holds(foot):
            return "the walls"
        if any(_meet(foot, s, APART) for s in self.solid):
            return "other furniture"
        if any(_meet(foot, d) for d in self.doors):
            return "the free space of a door"
        if any(height > sill and _meet(foot, w, 0.05) for w, sill in self.windows):
            return "a window"
        if any(_meet(foot, a) for a in self.access):
            return "floor from which other furniture is used"
        if use is not None and (not self.holds(use) or any(_meet(use, s) for s in self.solid)):
            return "too little room before it"
        return None

    def before_door(self, foot: Rect) -> bool:
        """True where a door's leaf would turn over a piece of the room."""
        return any(_meet(foot, d) for d in self.doors)

    def add(self, foot: Rect, use: Rect | None) -> bool:
        """Put a thing there if one can still walk from every door to every thing; says whether it stands."""
        self.solid.append(foot)
        if use is not None:
            self.access.append(use)
        if self._walkable():
            return True
        self.solid.pop()
        if use is not None:
            self.access.pop()
        return False

    def _walkable(self) -> bool:
        """True if every door and every place of use is reached by a person from the first door."""
        from scipy.ndimage import distance_transform_edt, label

        room = self.room
        nx, ny = math.ceil((room.x1 - room.x0) / GRID), math.ceil((room.y1 - room.y0) / GRID)
        free = np.zeros((nx + 2, ny + 2), dtype=bool)
        free[1:-1, 1:-1] = True
        for s in (*self.solid, *self.leaves, *((self.notch,) if self.notch else ())):
            i0, j0 = (math.floor((s.x0 - room.x0) / GRID), math.floor((s.y0 - room.y0) / GRID))
            i1, j1 = (math.ceil((s.x1 - room.x0) / GRID), math.ceil((s.y1 - room.y0) / GRID))
            free[max(0, i0) + 1 : i1 + 1, max(0, j0) + 1 : j1 + 1] = False
        wide = distance_transform_edt(free) * GRID >= WALKER / 2
        parts, _ = label(wide)
        wanted = set()
        for x, y in self.entries:
            cell = parts[self._cell(x, room.x0, nx), self._cell(y, room.y0, ny)]
            if cell == 0:
                return False
            wanted.add(int(cell))
        if len(wanted) > 1:
            return False
        reach = wanted.pop() if wanted else int(np.bincount(parts[parts > 0]).argmax()) if parts.any() else 0
        near = distance_transform_edt(parts != reach) * GRID <= WALKER / 2 + GRID if reach else np.zeros_like(wide)
        return all(
            near[
                self._cell(u.x0, room.x0, nx) : self._cell(u.x1, room.x0, nx) + 1,
                self._cell(u.y0, room.y0, ny) : self._cell(u.y1, room.y0, ny) + 1,
            ].any()
            for u in self.access
        )

    @staticmethod
    def _cell(at: float, start: float, count: int) -> int:
        return min(count, max(1, math.floor((at - start) / GRID) + 1))
