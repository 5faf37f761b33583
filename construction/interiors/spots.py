"""Places that are tried for a thing on the floor or a wall: along walls, in the room, or beside what it belongs to (R95)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from .arrangement import Arrangement, Standing, over
from .fitting import Item
from .floor_space import APART, Spot, in_rows, turned_size
from .pieces import Piece
from .plans import Rect

__all__ = ["along_walls", "at_corner", "spots"]

STEP = 0.1
"""[m] Own choice: distance of the places along a wall that are tried."""
BEFORE = 0.4
"""[m] Between a sofa and the table before it: 0.45 to 0.6 m (Infinigen), from the edge of the seat."""
TUCKED = 0.02
"""[m] Between a chair and its table."""
ASIDE = 1.2
"""[m] Own choice: how far what faces a thing may be from the line before it."""
TRIES = 120
"""Places in the room that are tried for what stands free."""
CORNER = 0.4
"""Own choice: dearness of a place by its distance from a corner [1/m], against a random number up to 1."""


def spots(room: Arrangement, item: Item, own: Piece, anchor: Standing | None) -> Iterator[Spot]:
    """Places of a thing by its rule, the better first; by every thing that it may belong to where no anchor is given."""
    wish = item.wish
    if wish.rule == "wall":
        yield from along_walls(room, own)
    elif wish.rule == "row":
        yield from _in_row(room, own)
    elif wish.rule == "free":
        yield from _anywhere(room, own)
    elif wish.rule == "flat":
        yield from sorted(_anywhere(room, own), key=lambda s: _out_of_place(room, s.rect(own.foot)))
    elif wish.rule in ("pairs", "line"):
        yield in_rows(room.space.room, own.foot, item.number, wish.count[1], 2 if wish.rule == "pairs" else 1)
    else:
        others = [anchor] if anchor is not None else [s for s in room.standing if s.piece.generator == wish.to]
        for other in others:
            if other.spot is not None:
                yield from _relative(room, wish.rule, own, other, other.spot)


def along_walls(room: Arrangement, own: Piece, only: Sequence[int] = (0, 1, 2, 3)) -> Iterator[Spot]:
    """Places with the back to a wall, corners a little before the rest, and flush with what stands or opens there."""
    found = []
    things = [*room.space.solid, *room.space.doors]
    for quarter, across, start, end in (w for q in only for w in room.space.walls() if w.quarter == q):
        wide, deep = turned_size(own.foot, quarter)
        level = quarter % 2 == 0
        length = wide if level else deep
        span = end - start - length
        if span < 2 * APART:
            continue
        edges = [((t.x0, t.x1) if level else (t.y0, t.y1)) for t in things]
        flush = [e for low, high in edges for e in (low - start - length - APART, high - start + APART)]
        grid = [min(APART + k * STEP, span - APART) for k in range(max(2, math.floor(span / STEP) + 1))]
        for shift in (*grid, *(f for f in flush if APART < f < span - APART)):
            back = {
                0: (start + shift, across - APART - deep),
                1: (across + APART, start + shift),
                2: (start + shift, across + APART),
                3: (across - APART - wide, start + shift),
            }[quarter]
            corner = min(shift, span - shift)
            found.append((float(room.rng.random()) + CORNER * corner, at_corner(own, quarter, back)))
    yield from (spot for _, spot in sorted(found))


def at_corner(own: Piece, quarter: int, low: tuple[float, float]) -> Spot:
    """The spot whose footprint has its least corner at a point."""
    rect = Spot(0.0, 0.0, quarter).rect(own.foot)
    return Spot(low[0] - rect.x0, low[1] - rect.y0, quarter)


def _in_row(room: Arrangement, own: Piece) -> Iterator[Spot]:
    """Places side by side with a thing of the row first, then along walls."""
    width, depth = own.foot.x1 - own.foot.x0, own.foot.y1 - own.foot.y0
    for other in reversed(room.standing):
        if other.row and other.spot is not None:
            base = other.piece.foot
            for low in ((base.x1 + APART, base.y1 - depth), (base.x0 - APART - width, base.y1 - depth)):
                yield _local(other.spot, own, 0, low)
    yield from along_walls(room, own)


def _anywhere(room: Arrangement, own: Piece) -> Iterator[Spot]:
    r = room.space.room
    for _ in range(TRIES):
        quarter = int(room.rng.integers(4))
        wide, deep = turned_size(own.foot, quarter)
        if wide + 2 * APART > r.x1 - r.x0 or deep + 2 * APART > r.y1 - r.y0:
            continue
        low = (room.rng.uniform(r.x0 + APART, r.x1 - wide - APART), room.rng.uniform(r.y0 + APART, r.y1 - deep - APART))
        yield at_corner(own, quarter, (float(low[0]), float(low[1])))


def _out_of_place(room: Arrangement, foot: Rect) -> tuple[bool, bool]:
    """Faults of a place for a rug: it lies before a door, or across the room."""
    r = room.space.room
    across = (r.x1 - r.x0 > r.y1 - r.y0) != (foot.x1 - foot.x0 > foot.y1 - foot.y0)
    return any(over(foot, d, 0.0) for d in room.space.doors), across


def _relative(room: Arrangement, rule: str, own: Piece, other: Standing, spot: Spot) -> Iterator[Spot]:
    base, mine = other.piece.foot, own.foot
    width, depth = mine.x1 - mine.x0, mine.y1 - mine.y0
    if rule == "facing":
        axis = 0 if spot.quarter % 2 == 0 else 1
        walls = sorted(along_walls(room, own, [(spot.quarter + 2) % 4]), key=lambda s: abs(s[axis] - spot[axis]))
        yield from (s for s in walls if abs(s[axis] - spot[axis]) < ASIDE)
    elif rule == "beside":
        for edge in (base.x0 - APART - width, base.x1 + APART):
            yield _local(spot, own, 0, (edge, base.y1 - depth))
    elif rule == "before":
        turn = 2 if other.piece.generator == "desk" else 0
        gap = TUCKED if turn else BEFORE
        middle = (base.x0 + base.x1 - width) / 2
        for shift in (0.0, 0.1, -0.1, 0.2, -0.2):
            yield _local(spot, own, turn, (middle + shift, base.y0 - gap - depth))
    else:
        yield from _around(own, base, spot)


def _around(own: Piece, base: Rect, spot: Spot) -> Iterator[Spot]:
    """Places about a table, the front of the thing towards it."""
    x, y = (base.x0 + base.x1) / 2, (base.y0 + base.y1) / 2
    for k in range(3):
        for turn in (0, 2, 1, 3):
            wide, deep = turned_size(own.foot, turn)
            along = (base.x1 - base.x0) if turn % 2 == 0 else (base.y1 - base.y0)
            across = wide if turn % 2 == 0 else deep
            count = max(1, math.floor(along / (across + 0.08)))
            if k >= count:
                continue
            at = -along / 2 + along * (k + 0.5) / count - across / 2
            low = {
                0: (x + at, base.y1 + TUCKED),
                2: (x + at, base.y0 - TUCKED - deep),
                1: (base.x0 - TUCKED - wide, y + at),
                3: (base.x1 + TUCKED, y + at),
            }[turn]
            yield _local(spot, own, turn, low)


def _local(spot: Spot, own: Piece, turn: int, low: tuple[float, float]) -> Spot:
    """A spot from the least corner of the footprint in the frame of another thing, and the turn in it."""
    inner = at_corner(own, turn, low)
    moved = spot.rect(Rect(inner.x, inner.y, inner.x, inner.y))
    return Spot(moved.x0, moved.y0, (spot.quarter + turn) % 4)
