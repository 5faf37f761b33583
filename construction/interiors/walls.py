"""Walls, openings and floors of a plan, as upright boxes that tile them without overlap (R48, R95)."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from ...worlds.errors import InputError
from .faces import free_wall
from .plans import CELL, OUTSIDE, Plan, Rect, Side

__all__ = [
    "CORNER",
    "WIDE",
    "Block",
    "Doorway",
    "Opening",
    "clear_rect",
    "doors_of",
    "floor_blocks",
    "hinge",
    "leaves",
    "passages_of",
    "slab_rect",
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
PIER = 0.5
"""[m] Own choice: wall between a window and the next, or a corner."""
WIDE = 1.3
"""[m] Own choice: wider doors have two leaves and stand in the middle of their wall."""


class Block(NamedTuple):
    """An upright box: least and greatest corner [m]."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]


@dataclass(frozen=True)
class Opening:
    """A door, a window, a passage between parts of a room, or an archway as wide as the wall that two rooms share."""

    id: str
    kind: Literal["door", "window", "passage", "archway"]
    along: Literal["x", "y"]
    """Axis along which its wall runs."""
    center: tuple[float, float]
    """Middle in the plan [m]."""
    width: float
    sill: float
    """Height of its lower edge over the floor of the storey [m]; that of the room of a door."""
    head: float
    """Height of its upper edge over the floor of the storey [m]."""
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


def _outer(plan: Plan, room: Rect, side: Side | None = None) -> list[_Edge]:
    """Pieces of a room's walls that are on the outside, or on one side of it."""
    sides: list[tuple[bool, Side, _Edge]] = [
        (room.x0 <= 1e-9, "west", _Edge("y", room.x0, room.y0, room.y1)),
        (room.x1 >= plan.width - 1e-9, "east", _Edge("y", room.x1, room.y0, room.y1)),
        (room.y0 <= 1e-9, "south", _Edge("x", room.y0, room.x0, room.x1)),
        (room.y1 >= plan.depth - 1e-9, "north", _Edge("x", room.y1, room.x0, room.x1)),
    ]
    return [edge for there, name, edge in sides if there and side in (None, name)]


def swing(opening: Opening, wall: float) -> Rect:
    """Floor on both sides of a door over which its leaf turns and one passes."""
    r = opening.plan(wall)
    deep = max(BEFORE_DOOR, opening.width / 2 if opening.kind == "door" else 0.0)
    if opening.along == "x":
        return Rect(r.x0 - CASING, r.y0 - deep, r.x1 + CASING, r.y1 + deep)
    return Rect(r.x0 - deep, r.y0 - CASING, r.x1 + deep, r.y1 + CASING)


def _meet(a: Rect, b: Rect) -> bool:
    return a.x0 < b.x1 and b.x0 < a.x1 and a.y0 < b.y1 and b.y0 < a.y1


def passages_of(
    plan: Plan, parts: Sequence[tuple[str, str]], *, wall: float, head: float, kind: Literal["passage", "archway"] = "passage"
) -> list[Opening]:
    """Openings between parts of rooms, or rooms, as wide as what they share and as high."""
    found = []
    for a, b in parts:
        (edge,) = _shared(plan.rooms[a], plan.rooms[b])
        width = edge.end - edge.start - wall
        found.append(Opening(f"{a}_{b}", kind, edge.along, edge.at((edge.start + edge.end) / 2), width, 0.0, head, (a, b)))
    return found


class Doorway(NamedTuple):
    """A door that is asked for."""

    a: str
    """Room into which it opens."""
    b: str
    width: float
    """Width of the opening [m]."""
    head: float
    """Height of the opening over the floor of its room [m]."""
    level: float = 0.0
    """Floor of its rooms over that of the storey [m]."""
    side: Side | None = None
    """Side of the building for a door to the outside; None for any."""

    def at(self, edge: _Edge, where: float) -> Opening:
        """It in a wall, its middle at a place along it [m]."""
        key, head = f"{self.a}_{self.b}", self.level + self.head
        return Opening(key, "door", edge.along, edge.at(where), self.width, self.level, head, (self.a, self.b))


def doors_of(plan: Plan, doorways: Sequence[Doorway], *, wall: float, rng: np.random.Generator) -> list[Opening]:
    """A door for each pair of rooms, near an end of the wall that they share, so that walls stay free for furniture.

    Raises:
        InputError: two rooms share no wall that is wide enough.
    """
    found: list[Opening] = []
    others: list[list[Opening]] = []
    for own in doorways:
        a, b, width, _, _, side = own
        edges = _outer(plan, plan.rooms[a], side) if b == OUTSIDE else _shared(plan.rooms[a], plan.rooms[b])
        margin = wall / 2 + CORNER + width / 2
        wide = [e for e in edges if e.end - e.start >= 2 * margin]
        if not wide:
            raise InputError(
                f"rooms {a!r} and {b!r} share no wall of {2 * margin:.2f} m for a door {width:g} m wide; leave that door out or ask for larger rooms"
            )
        steps = [(e, w) for e in wide for w in np.arange(e.start + margin, e.end - margin + 1e-9, CELL).tolist()]
        others.append([own.at(e, w) for e, w in steps])
        if b == OUTSIDE:
            wide = [min(wide, key=lambda e: e.end - e.start)]
        places = [(e, where) for e in wide for where in (e.start + margin, e.end - margin)]
        if width > WIDE:
            places = [(e, (e.start + e.end) / 2) for e in wide]
        order = [places[k] for k in rng.permutation(len(places))]
        options = [own.at(e, where) for e, where in order]
        # Leaves of two doors of a corner would meet; where there is no better place, at least none stands before the other door.
        free = [o for o in options if not any(_meet(swing(o, wall), swing(d, wall)) for d in found)]
        free = free or [o for o in options if not any(_bars(plan, o, d, wall) or _bars(plan, d, o, wall) for d in found)]
        sides = [clear_rect(plan.rooms[n], wall) for n in (a, b) if n != OUTSIDE]
        found.append(max(free or options, key=lambda o: sum(free_wall(r, [swing(d, wall) for d in (*found, o)]) for r in sides)))
    return _moved_apart(plan, found, others, wall)


def _moved_apart(plan: Plan, doors: list[Opening], others: list[list[Opening]], wall: float) -> list[Opening]:
    """Doors of which one is moved to another of its places where the leaf of one stood before the other; the first that helps."""

    def barred(door: Opening, rest: Sequence[Opening]) -> bool:
        return any(_bars(plan, door, d, wall) or _bars(plan, d, door, wall) for d in rest)

    for k, door in enumerate(doors):
        rest = [*doors[:k], *doors[k + 1 :]]
        if barred(door, rest):
            doors[k] = next((o for o in others[k] if not barred(o, rest)), door)
    return doors


def _bars(plan: Plan, door: Opening, other: Opening, wall: float) -> bool:
    """True if the open leaf of a door stands on the floor before another."""
    floor = swing(other, wall)
    return any(_meet(leaf, floor) for leaf in leaves(door, clear_rect(plan.rooms[door.rooms[0]], wall)))


def windows_of(
    plan: Plan,
    rooms: Mapping[str, tuple[float, float]],
    doors: Sequence[Opening],
    *,
    wall: float,
) -> list[Opening]:
    """Windows in the outer walls of rooms, as many as there is room for with piers between them.

    Args:
        plan: of the storey.
        rooms: lower and upper edge of the windows of each room over the floor of the storey [m].
        doors: openings that are there already.
        wall: thickness of walls [m].
    """
    found: list[Opening] = []
    for name, (sill, head) in rooms.items():
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


def wall_blocks(
    plan: Plan, openings: Sequence[Opening], *, wall: float, height: float, levels: Mapping[str, float] | None = None
) -> list[Block]:
    """Boxes that fill all walls of a plan and leave its openings free; they stand on the floors of the rooms beside them.

    Args:
        plan: of the storey.
        openings: what is left free.
        wall: thickness of walls [m].
        height: of their upper side over the floor of the storey [m].
        levels: floors of rooms over that of the storey [m]; default 0.
    """
    strips = [strip for room in plan.rooms.values() for strip in _strips(room, wall)]
    raised = {n: slab_rect(plan, n, wall) for n in plan.rooms if (levels or {}).get(n)}
    rects = [*strips, *(o.plan(wall) for o in openings), *raised.values()]
    xs, ys = _lines(rects, "x0", "x1"), _lines(rects, "y0", "y1")
    solid = np.full((len(xs) - 1, len(ys) - 1), -1, dtype=int)
    base = np.zeros(solid.shape)
    for name, rect in raised.items():
        base[_cells(xs, rect.x0, rect.x1), _cells(ys, rect.y0, rect.y1)] = (levels or {})[name]
    kinds: list[tuple[tuple[float, float], ...]] = []
    for rect, sill, head in [
        *((s, height, height) for s in strips),
        *((o.plan(wall), o.sill, o.head) for o in openings),
    ]:
        where = np.s_[_cells(xs, rect.x0, rect.x1), _cells(ys, rect.y0, rect.y1)]
        part = solid[where]
        for level in np.unique(base[where]):
            ranges = tuple(r for r in ((float(level), sill), (head, height)) if r[1] - r[0] > 1e-6)
            if ranges not in kinds:
                kinds.append(ranges)
            part[base[where] == level] = kinds.index(ranges)
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


def slab_rect(plan: Plan, name: str, wall: float) -> Rect:
    """The floor of a room: to the middle of the walls between rooms, and to the outer face of outer ones."""
    r, h = plan.rooms[name], wall / 2
    return Rect(
        r.x0 - (h if r.x0 <= 1e-9 else 0.0),
        r.y0 - (h if r.y0 <= 1e-9 else 0.0),
        r.x1 + (h if r.x1 >= plan.width - 1e-9 else 0.0),
        r.y1 + (h if r.y1 >= plan.depth - 1e-9 else 0.0),
    )


def floor_blocks(plan: Plan, *, wall: float, thickness: float, levels: Mapping[str, float] | None = None) -> dict[str, Block]:
    """The slab under each room; upper side at z = 0 or the room's level, lower side level over the storey."""
    found = {}
    for name in plan.rooms:
        r = slab_rect(plan, name, wall)
        found[name] = Block((r.x0, r.y0, -thickness), (r.x1, r.y1, (levels or {}).get(name, 0.0)))
    return found


def hinge(opening: Opening, room: Rect) -> Literal["left", "right"]:
    """Side of a door's hinges seen from the room into which it opens, so that its leaf stands towards the nearer wall."""
    x, y = opening.center
    if opening.along == "x":
        near_low, left_is_low = 2 * x < room.x0 + room.x1, y > (room.y0 + room.y1) / 2
    else:
        near_low, left_is_low = 2 * y < room.y0 + room.y1, x < (room.x0 + room.x1) / 2
    return "left" if near_low == left_is_low else "right"


def leaves(opening: Opening, room: Rect) -> list[Rect]:
    """Floor under the open leaves of a door that opens into a room: one hinged as `hinge` says, or two of a wide door."""
    (x, y), half = opening.center, opening.width / 2
    along, (start, end) = (x, (room.x0, room.x1)) if opening.along == "x" else (y, (room.y0, room.y1))
    width = opening.width if opening.width <= WIDE else half
    across, reach = LEAF_ACROSS * width, LEAF_REACH * width
    lows = [along - half, along + half - across]
    if opening.width <= WIDE:
        lows = lows[:1] if 2 * along < start + end else lows[1:]
    if opening.along == "x":
        far = y - reach if y > (room.y0 + room.y1) / 2 else y + reach
        return [Rect(low, min(y, far), low + across, max(y, far)) for low in lows]
    far = x - reach if x > (room.x0 + room.x1) / 2 else x + reach
    return [Rect(min(x, far), low, max(x, far), low + across) for low in lows]
