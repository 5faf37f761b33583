"""Walls, openings and floors of a plan, as upright boxes that tile them without overlap (R48, R95)."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from ...worlds.errors import InputError
from .plans import OUTSIDE, Plan, Rect

__all__ = [
    "CORNER",
    "Block",
    "Opening",
    "clear_rect",
    "common_area",
    "doors_of",
    "floor_blocks",
    "free_wall",
    "hinge",
    "leaf",
    "swing",
    "wall_blocks",
    "windows_of",
]

CORNER = 0.12
"""[m] Own choice: wall that is left between an opening and the corner of a room."""
BEFORE_DOOR = 0.9
"""[m] Own choice: depth that stays free on both sides of a door, so that its leaf turns and one passes."""
CASING = 0.08
"""[m] How far the mouldings of a door reach beyond its opening, see `assets/openings.py`, and a little."""
MOST_WINDOW = 1.6
"""[m] Own choice: width of a window at most; longer walls get several."""
LEAST_WINDOW = 0.5
LEAF_REACH, LEAF_ACROSS = 0.955, 0.26
"""Reach of an open leaf (80 degrees) into its room, and its extent along the wall less a cell of ways, over the width of the opening."""
STRIP = 0.35
"""[m] Own choice: depth before a wall that has to be free for furniture along it."""
LEAST_WALL = 0.45
"""[m] Own choice: shorter pieces of wall are of no use to furniture."""
PIER = 0.5
"""[m] Own choice: wall between a window and the next, or a corner."""


class Block(NamedTuple):
    """An upright box: least and greatest corner [m]."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]


@dataclass(frozen=True)
class Opening:
    """A door or window in a wall."""

    id: str
    kind: Literal["door", "window"]
    along: Literal["x", "y"]
    """Axis along which its wall runs."""
    center: tuple[float, float]
    """Middle in the plan [m]."""
    width: float
    sill: float
    """Height of its lower edge [m]; 0 of a door."""
    head: float
    """Height of its upper edge [m]."""
    rooms: tuple[str, str]
    """Room from which it is seen, and what is behind."""

    def plan(self, wall: float) -> Rect:
        """Its rectangle in a wall of that thickness."""
        x, y = self.center
        half = (self.width / 2, wall / 2) if self.along == "x" else (wall / 2, self.width / 2)
        return Rect(x - half[0], y - half[1], x + half[0], y + half[1])


def clear_rect(room: Rect, wall: float) -> Rect:
    """A room between the faces of its walls [m]."""
    return Rect(room.x0 + wall / 2, room.y0 + wall / 2, room.x1 - wall / 2, room.y1 - wall / 2)


class _Edge(NamedTuple):
    """Straight piece of a wall: along which axis, where across, and from where to where [m]."""

    along: Literal["x", "y"]
    across: float
    start: float
    end: float

    def at(self, where: float) -> tuple[float, float]:
        return (where, self.across) if self.along == "x" else (self.across, where)


def _shared(a: Rect, b: Rect) -> list[_Edge]:
    """Pieces of wall that two rooms have in common."""
    found: list[_Edge] = []
    for one, two in ((a, b), (b, a)):
        low, high = max(a.y0, b.y0), min(a.y1, b.y1)
        if abs(one.x1 - two.x0) < 1e-9 and high > low:
            found.append(_Edge("y", one.x1, low, high))
        low, high = max(a.x0, b.x0), min(a.x1, b.x1)
        if abs(one.y1 - two.y0) < 1e-9 and high > low:
            found.append(_Edge("x", one.y1, low, high))
    return found


def _outer(plan: Plan, room: Rect) -> list[_Edge]:
    """Pieces of a room's walls that are on the outside."""
    sides = [
        (room.x0 <= 1e-9, _Edge("y", room.x0, room.y0, room.y1)),
        (room.x1 >= plan.width - 1e-9, _Edge("y", room.x1, room.y0, room.y1)),
        (room.y0 <= 1e-9, _Edge("x", room.y0, room.x0, room.x1)),
        (room.y1 >= plan.depth - 1e-9, _Edge("x", room.y1, room.x0, room.x1)),
    ]
    return [edge for there, edge in sides if there]


def swing(opening: Opening, wall: float) -> Rect:
    """Floor on both sides of a door over which its leaf turns and one passes."""
    r = opening.plan(wall)
    if opening.along == "x":
        return Rect(r.x0 - CASING, r.y0 - BEFORE_DOOR, r.x1 + CASING, r.y1 + BEFORE_DOOR)
    return Rect(r.x0 - BEFORE_DOOR, r.y0 - CASING, r.x1 + BEFORE_DOOR, r.y1 + CASING)


def _meet(a: Rect, b: Rect) -> bool:
    return a.x0 < b.x1 and b.x0 < a.x1 and a.y0 < b.y1 and b.y0 < a.y1


def doors_of(
    plan: Plan, pairs: Sequence[tuple[str, str]], *, wall: float, width: float, head: float, rng: np.random.Generator
) -> list[Opening]:
    """A door for each pair of rooms, near an end of the wall that they share, so that walls stay free for furniture.

    Raises:
        InputError: two rooms share no wall that is wide enough.
    """
    found: list[Opening] = []
    for a, b in pairs:
        edges = _outer(plan, plan.rooms[a]) if b == OUTSIDE else _shared(plan.rooms[a], plan.rooms[b])
        margin = wall / 2 + CORNER + width / 2
        wide = [e for e in edges if e.end - e.start >= 2 * margin]
        if not wide:
            raise InputError(
                f"rooms {a!r} and {b!r} share no wall of {2 * margin:.2f} m for a door {width:g} m wide; leave that door out or ask for larger rooms"
            )
        if b == OUTSIDE:
            wide = [min(wide, key=lambda e: e.end - e.start)]
        places = [(e, where) for e in wide for where in (e.start + margin, e.end - margin)]
        order = [places[k] for k in rng.permutation(len(places))]
        options = [Opening(f"{a}_{b}", "door", e.along, e.at(where), width, 0.0, head, (a, b)) for e, where in order]
        # Leaves of two doors of a corner would meet.
        free = [o for o in options if not any(_meet(swing(o, wall), swing(d, wall)) for d in found)]
        sides = [clear_rect(plan.rooms[n], wall) for n in (a, b) if n != OUTSIDE]
        found.append(max(free or options, key=lambda o: sum(free_wall(r, [swing(d, wall) for d in (*found, o)]) for r in sides)))
    return found


def windows_of(
    plan: Plan, rooms: Sequence[str], doors: Sequence[Opening], *, wall: float, sill: float, head: float
) -> list[Opening]:
    """Windows in the outer walls of rooms, as many as there is room for with piers between them."""
    found: list[Opening] = []
    for name in rooms:
        for edge in _outer(plan, plan.rooms[name]):
            own = 1 if edge.along == "y" else 0
            taken = [d for d in doors if d.along == edge.along and abs(d.center[1 - own] - edge.across) < 1e-6]
            spans = sorted((d.center[own], d.width / 2) for d in taken if edge.start < d.center[own] < edge.end)
            cuts = [edge.start + wall / 2, *itertools.chain.from_iterable((c - h, c + h) for c, h in spans), edge.end - wall / 2]
            for start, end in zip(cuts[::2], cuts[1::2], strict=True):
                found += _in_span(name, edge, start, end, len(found), sill, head)
    return found


def _in_span(room: str, edge: _Edge, start: float, end: float, first: int, sill: float, head: float) -> list[Opening]:
    length = end - start
    count = max(1, round((length - PIER) / (MOST_WINDOW + 2 * PIER)))
    width = min(MOST_WINDOW, (length - PIER) / count - PIER)
    if width < LEAST_WINDOW:
        return []
    width = round(width - 0.005, 2)
    places = (start + length * (k + 0.5) / count for k in range(count))
    return [
        Opening(f"{room}_{first + k + 1}", "window", edge.along, edge.at(c), width, sill, head, (room, OUTSIDE))
        for k, c in enumerate(places)
    ]


def wall_blocks(plan: Plan, openings: Sequence[Opening], *, wall: float, height: float) -> list[Block]:
    """Boxes that fill all walls of a plan and leave its openings free."""
    strips = [strip for room in plan.rooms.values() for strip in _strips(room, wall)]
    holes = [(o.plan(wall), o.sill, o.head) for o in openings]
    rects = [*strips, *(h[0] for h in holes)]
    xs, ys = _lines(rects, "x0", "x1"), _lines(rects, "y0", "y1")
    solid = np.full((len(xs) - 1, len(ys) - 1), -1, dtype=int)
    kinds: list[tuple[tuple[float, float], ...]] = [((0.0, height),)]
    for strip in strips:
        solid[_cells(xs, strip.x0, strip.x1), _cells(ys, strip.y0, strip.y1)] = 0
    for hole, sill, head in holes:
        ranges = tuple(r for r in ((0.0, sill), (head, height)) if r[1] - r[0] > 1e-6)
        if ranges not in kinds:
            kinds.append(ranges)
        solid[_cells(xs, hole.x0, hole.x1), _cells(ys, hole.y0, hole.y1)] = kinds.index(ranges)
    return [
        Block((xs[i0], ys[j0], low), (xs[i1], ys[j1], high))
        for i0, i1, j0, j1, kind in _merged(solid)
        for low, high in kinds[kind]
    ]


def _strips(room: Rect, wall: float) -> list[Rect]:
    h = wall / 2
    return [
        Rect(room.x0 - h, room.y0 - h, room.x1 + h, room.y0 + h),
        Rect(room.x0 - h, room.y1 - h, room.x1 + h, room.y1 + h),
        Rect(room.x0 - h, room.y0 - h, room.x0 + h, room.y1 + h),
        Rect(room.x1 - h, room.y0 - h, room.x1 + h, room.y1 + h),
    ]


def _lines(rects: Sequence[Rect], low: str, high: str) -> list[float]:
    return sorted({round(getattr(r, k), 9) for r in rects for k in (low, high)})


def _cells(lines: Sequence[float], low: float, high: float) -> slice:
    return slice(lines.index(round(low, 9)), lines.index(round(high, 9)))


def _merged(solid: np.ndarray[tuple[int, int], np.dtype[np.int_]]) -> list[tuple[int, int, int, int, int]]:
    """Largest rectangles of equal cells, taken greedily: first and end of rows, of columns, and the kind; cells of -1 are left out."""
    left, found = solid.copy(), []
    for i, j in np.ndindex(*solid.shape):
        kind = left[i, j]
        if kind < 0:
            continue
        options = []
        for first in (0, 1):
            i1, j1 = i + 1, j + 1
            for axis in (first, 1 - first):
                if axis == 0:
                    while i1 < solid.shape[0] and (left[i1, j:j1] == kind).all():
                        i1 += 1
                else:
                    while j1 < solid.shape[1] and (left[i:i1, j1] == kind).all():
                        j1 += 1
            options.append(((i1 - i) * (j1 - j), i1, j1))
        _, i1, j1 = max(options)
        left[i:i1, j:j1] = -1
        found.append((i, i1, j, j1, int(kind)))
    return found


def floor_blocks(plan: Plan, *, wall: float, thickness: float) -> dict[str, Block]:
    """The slab under each room, to the middle of the walls between rooms and to the outer face of outer ones; upper side at z = 0."""
    found = {}
    for name, r in plan.rooms.items():
        x0, x1 = (r.x0 - (wall / 2 if r.x0 <= 1e-9 else 0.0), r.x1 + (wall / 2 if r.x1 >= plan.width - 1e-9 else 0.0))
        y0, y1 = (r.y0 - (wall / 2 if r.y0 <= 1e-9 else 0.0), r.y1 + (wall / 2 if r.y1 >= plan.depth - 1e-9 else 0.0))
        found[name] = Block((x0, y0, -thickness), (x1, y1, 0.0))
    return found


def hinge(opening: Opening, room: Rect) -> Literal["left", "right"]:
    """Side of a door's hinges seen from the room into which it opens, so that its leaf stands towards the nearer wall."""
    x, y = opening.center
    if opening.along == "x":
        near_low, left_is_low = 2 * x < room.x0 + room.x1, y > (room.y0 + room.y1) / 2
    else:
        near_low, left_is_low = 2 * y < room.y0 + room.y1, x < (room.x0 + room.x1) / 2
    return "left" if near_low == left_is_low else "right"


def leaf(opening: Opening, room: Rect) -> Rect:
    """Floor under the open leaf of a door that opens into a room, hinged as `hinge` says."""
    (x, y), half = opening.center, opening.width / 2
    along, (start, end) = (x, (room.x0, room.x1)) if opening.along == "x" else (y, (room.y0, room.y1))
    low = along - half if 2 * along < start + end else along + half - LEAF_ACROSS * opening.width
    high = low + LEAF_ACROSS * opening.width
    if opening.along == "x":
        far = y - LEAF_REACH * opening.width if y > (room.y0 + room.y1) / 2 else y + LEAF_REACH * opening.width
        return Rect(low, min(y, far), high, max(y, far))
    far = x - LEAF_REACH * opening.width if x > (room.x0 + room.x1) / 2 else x + LEAF_REACH * opening.width
    return Rect(min(x, far), low, max(x, far), high)


def common_area(a: Rect, b: Rect) -> float:
    """Area of what two rectangles have in common [m^2]."""
    return max(0.0, min(a.x1, b.x1) - max(a.x0, b.x0)) * max(0.0, min(a.y1, b.y1) - max(a.y0, b.y0))


def free_wall(r: Rect, taken: Sequence[Rect]) -> float:
    """Length of the walls of a room of clear size `r` before which nothing is, in pieces that furniture fits [m]."""
    strips = [
        (Rect(r.x0, r.y0 - STRIP, r.x1, r.y0 + STRIP), True),
        (Rect(r.x0, r.y1 - STRIP, r.x1, r.y1 + STRIP), True),
        (Rect(r.x0 - STRIP, r.y0, r.x0 + STRIP, r.y1), False),
        (Rect(r.x1 - STRIP, r.y0, r.x1 + STRIP, r.y1), False),
    ]
    total = 0.0
    for strip, level in strips:
        start, end = (strip.x0, strip.x1) if level else (strip.y0, strip.y1)
        cuts = sorted((t.x0, t.x1) if level else (t.y0, t.y1) for t in taken if common_area(t, strip) > 0)
        for low, high in [*cuts, (end, end)]:
            total += max(0.0, low - start) if low - start >= LEAST_WALL else 0.0
            start = max(start, high)
    return total
