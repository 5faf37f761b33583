"""Furniture by function, and what lies on it: placed one after the other where nothing stands in the way (R48, R95).

Order as in Infinigen Indoors (arXiv:2406.11824): things on the floor, large before small, then what hangs, then what lies on surfaces. After
every piece one can still walk from the door to all that stands there.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from .floor_space import APART, FloorSpace, Spot, in_rows, turned_size
from .pieces import Piece, Stock
from .plans import Rect
from .programs import RoomKind, Wish

__all__ = ["Frame", "Standing", "furnished"]

STEP = 0.1
"""[m] Own choice: distance of the places along a wall that are tried."""
BEFORE = 0.4
"""[m] Between a sofa and the table before it: 0.45 to 0.6 m (Infinigen), from the edge of the seat."""
TRIES = 40
"""Places that are tried for a small thing on a surface."""
EDGE = 0.012
"""[m] Own choice: how far small things stay from the edge of what they lie on."""
SPACING = 0.008
"""[m] Own choice: gap between small things."""
STILL = 1e-4
"""[m] Gap between a wall and what hangs on it; both never move."""
MOST_ON_SURFACE = 9
"""Own choice: small things on one surface at density 1."""
BESIDE = 0.08
"""[m] Own choice: wall that stays free about what hangs there; more than mouldings of openings take."""
BULKY = 5e-3
"""[m^3] Own choice: what is larger (a chest, no jar) does not stand where a window's sash swings; smaller things it pushes away."""
SHALLOW = 0.1
"""[m] Own choice: what hangs on a wall and stands out further is in the way of people."""


@dataclass
class Standing:
    """A thing in its place."""

    piece: Piece
    x: float
    y: float
    z: float
    yaw: float
    """[rad]"""
    carrier: str
    """`floor`, `walls`, or the id of what it lies on."""
    body: str = ""
    """Body of the carrier, "" for the main one."""
    id: str = ""
    still: bool = False
    """It never moves: what hangs on a wall."""


class Frame(NamedTuple):
    """Name, height and gaps of a room."""

    id: str
    """Beginning of the ids of all that stands in it."""
    height: float
    """[m]"""
    gap: float
    """[m] between a thing and what carries it: two collision skins."""


@dataclass
class _Room:
    frame: Frame
    kind: RoomKind
    space: FloorSpace
    stock: Stock
    rng: np.random.Generator
    standing: list[Standing] = field(default_factory=list)
    spots: dict[int, Spot] = field(default_factory=dict)
    hung: list[tuple[Rect, float, float]] = field(default_factory=list)
    flat: list[Rect] = field(default_factory=list)
    lacking: list[str] = field(default_factory=list)
    names: Counter[str] = field(default_factory=Counter)

    def put(self, own: Piece, spot: Spot, z: float, carrier: str, *, still: bool = False) -> Standing:
        found = Standing(own, spot.x, spot.y, z, spot.yaw, carrier, id=self.named(own.generator), still=still)
        self.spots[len(self.standing)] = spot
        self.standing.append(found)
        return found

    def named(self, generator: str) -> str:
        self.names[generator] += 1
        number = self.names[generator]
        return f"{self.frame.id}_{generator}" if number == 1 else f"{self.frame.id}_{generator}_{number}"


def furnished(
    frame: Frame, kind: RoomKind, space: FloorSpace, stock: Stock, *, density: float, rng: np.random.Generator
) -> tuple[list[Standing], list[str]]:
    """Things of a room in their places, and sentences about what could not be placed with the constraint that stood in the way.

    Args:
        frame: of the room.
        kind: what belongs into it.
        space: its floor.
        stock: where things are taken from.
        density: 0 (only furniture) to 1 (every surface full).
        rng: decides among places that are as good.
    """
    room = _Room(frame, kind, space, stock, rng)
    for wish in kind.wishes:
        low, high = wish.count
        for number in range(int(rng.integers(low, high + 1))):
            _grant(room, wish, number, needed=number < low)
    _on_floor(room, density)
    for place in list(room.standing):
        _fill(room, place, density)
    return room.standing, room.lacking


def _grant(room: _Room, wish: Wish, number: int, *, needed: bool) -> None:
    name = str(room.rng.choice(wish.generators))
    own = room.stock.take(
        name, {**wish.parameters, "height": round(room.frame.height - wish.under, 3)} if wish.under else wish.parameters
    )
    why = _hang(room, wish, own) if wish.rule == "hung" else _stand(room, wish, own, number)
    if why is not None and needed:
        room.lacking.append(f"{room.frame.id}: a {name} found no place: {why} stood in the way")


def _stand(room: _Room, wish: Wish, own: Piece, number: int) -> str | None:
    """Put a thing on the floor; the constraint that stood in the way most often where it finds no place."""
    reasons: Counter[str] = Counter()
    use = None
    if wish.use:
        use = Rect(own.foot.x0, own.foot.y0 - wish.use, own.foot.x1, own.foot.y0)
    travel = max((j.range[1] for j in own.made.joints.values() if j.kind == "slide" and j.range is not None), default=0.0)
    drawers = Rect(own.foot.x0, own.foot.y0 - travel, own.foot.x1, own.foot.y0) if travel > 0.0 else None
    for spot in _spots(room, wish, own, number):
        foot = spot.rect(own.foot)
        before = None if use is None else spot.rect(use)
        if wish.rule == "flat":
            if any(_over(foot, s) for s in (*room.space.solid, *room.flat)) or not _within(foot, room.space.room):
                reasons["furniture"] += 1
                continue
            room.flat.append(foot)
            room.put(own, spot, room.frame.gap, "floor")
            return None
        drawn = None if drawers is None else spot.rect(drawers)
        why = room.space.fits(foot, before, own.height, drawn=drawn, belongs=bool(wish.to))
        if why is None and any(_over(foot, f) for f in room.flat):
            why = "a rug"
        if why is None and not room.space.add(foot, before):
            why = "a way that has to stay free"
        if why is None:
            if drawn is not None:
                room.space.drawn.append(drawn)
            room.put(own, spot, room.frame.gap, "floor")
            return None
        reasons[why] += 1
    return reasons.most_common(1)[0][0] if reasons else f"no {wish.to or 'wall'} to place it by"


def _over(a: Rect, b: Rect) -> bool:
    return a.x0 < b.x1 + APART and b.x0 < a.x1 + APART and a.y0 < b.y1 + APART and b.y0 < a.y1 + APART


def _within(a: Rect, b: Rect) -> bool:
    return a.x0 >= b.x0 and a.y0 >= b.y0 and a.x1 <= b.x1 and a.y1 <= b.y1


def _spots(room: _Room, wish: Wish, own: Piece, number: int) -> Iterator[Spot]:
    if wish.rule == "wall":
        yield from _along_walls(room, own)
    elif wish.rule in ("free", "flat"):
        yield from _anywhere(room, own)
    elif wish.rule in ("pairs", "line"):
        yield in_rows(room.space.room, own.foot, number, wish.count[1], 2 if wish.rule == "pairs" else 1)
    else:
        for index, other in enumerate(room.standing):
            if other.piece.generator == wish.to and index in room.spots:
                yield from _relative(room, wish.rule, own, other, room.spots[index], number)


def _along_walls(room: _Room, own: Piece, only: Sequence[int] = (0, 1, 2, 3)) -> Iterator[Spot]:
    """Places with the back to a wall, corners a little before the rest."""
    r, found = room.space.room, []
    for quarter in only:
        wide, deep = turned_size(own.foot, quarter)
        level = quarter % 2 == 0
        span = (r.x1 - r.x0 - wide) if level else (r.y1 - r.y0 - deep)
        if span < 2 * APART:
            continue
        for k in range(max(2, math.floor(span / STEP) + 1)):
            shift = APART + min(k * STEP, span - 2 * APART)
            back = {
                0: (r.x0 + shift, r.y1 - APART - deep),
                1: (r.x0 + APART, r.y0 + shift),
                2: (r.x0 + shift, r.y0 + APART),
                3: (r.x1 - APART - wide, r.y0 + shift),
            }[quarter]
            corner = min(shift, span - shift)
            found.append((float(room.rng.random()) + 0.4 * corner, _at_corner(own, quarter, back)))
    yield from (spot for _, spot in sorted(found))


def _at_corner(own: Piece, quarter: int, low: tuple[float, float]) -> Spot:
    """The spot whose footprint has its least corner at a point."""
    rect = Spot(0.0, 0.0, quarter).rect(own.foot)
    return Spot(low[0] - rect.x0, low[1] - rect.y0, quarter)


def _anywhere(room: _Room, own: Piece) -> Iterator[Spot]:
    r = room.space.room
    for _ in range(3 * TRIES):
        quarter = int(room.rng.integers(4))
        wide, deep = turned_size(own.foot, quarter)
        if wide + 2 * APART > r.x1 - r.x0 or deep + 2 * APART > r.y1 - r.y0:
            continue
        low = (room.rng.uniform(r.x0 + APART, r.x1 - wide - APART), room.rng.uniform(r.y0 + APART, r.y1 - deep - APART))
        yield _at_corner(own, quarter, (float(low[0]), float(low[1])))


def _relative(room: _Room, rule: str, own: Piece, other: Standing, spot: Spot, number: int) -> Iterator[Spot]:
    base, mine = other.piece.foot, own.foot
    width, depth = mine.x1 - mine.x0, mine.y1 - mine.y0
    if rule == "facing":
        walls = _along_walls(room, own, [(spot.quarter + 2) % 4])
        axis = 0 if spot.quarter % 2 == 0 else 1
        yield from sorted(walls, key=lambda s: abs(s[axis] - spot[axis]))
        return
    if rule == "beside":
        for side in (-1, 1) if number % 2 == 0 else (1, -1):
            edge = base.x0 - APART - width if side < 0 else base.x1 + APART
            yield _local(spot, own, 0, (edge, base.y1 - depth))
        return
    if rule == "before":
        turn = 2 if other.piece.generator == "desk" else 0
        gap = 0.02 if turn else BEFORE
        middle = (base.x0 + base.x1 - width) / 2
        for shift in (0.0, 0.1, -0.1, 0.2, -0.2):
            yield _local(spot, own, turn, (middle + shift, base.y0 - gap - depth))
        return
    sides = [(turn, k) for turn in (0, 2, 1, 3) for k in range(3)]  # around
    for turn, k in sides:
        wide, deep = turned_size(mine, turn)
        along = (base.x1 - base.x0) if turn % 2 == 0 else (base.y1 - base.y0)
        across = wide if turn % 2 == 0 else deep
        count = max(1, math.floor(along / (across + 0.15)))
        if k >= count:
            continue
        at = -along / 2 + along * (k + 0.5) / count - across / 2
        x, y = (base.x0 + base.x1) / 2, (base.y0 + base.y1) / 2
        # Its front, -y, towards the table.
        low = {
            0: (x + at, base.y1 + 0.02),
            2: (x + at, base.y0 - 0.02 - deep),
            1: (base.x0 - 0.02 - wide, y + at),
            3: (base.x1 + 0.02, y + at),
        }[turn]
        yield _local(spot, own, turn, low)


def _local(spot: Spot, own: Piece, turn: int, low: tuple[float, float]) -> Spot:
    """A spot from the least corner of the footprint in the frame of another thing, and the turn in it."""
    inner = _at_corner(own, turn, low)
    moved = spot.rect(Rect(inner.x, inner.y, inner.x, inner.y))
    return Spot(moved.x0, moved.y0, (spot.quarter + turn) % 4)


def _hang(room: _Room, wish: Wish, own: Piece) -> str | None:
    """Put a thing on a wall where nothing is behind or before it."""
    r, reasons = room.space.room, Counter[str]()
    tall, thick = own.height, own.foot.y1 - own.foot.y0
    z = wish.height - tall / 2
    for spot in _along_walls(room, own):
        # From the gap of furniture to that of what hangs.
        back = APART - STILL
        dx, dy = ((0, back), (-back, 0), (0, -back), (back, 0))[spot.quarter]
        spot = Spot(spot.x + dx, spot.y + dy, spot.quarter)
        foot = spot.rect(own.foot)
        near = Rect(foot.x0 - BESIDE, foot.y0 - BESIDE, foot.x1 + BESIDE, foot.y1 + BESIDE)
        openings = [(o.plan(room.space.wall), o.sill, o.head) for o in room.space.openings]
        if any(_over(near, rect) and z < head + 0.15 and z + tall > sill - 0.15 for rect, sill, head in openings):
            reasons["a door or window"] += 1
        elif any(_over(near, d) for d in room.space.doors) and thick > 0.08:
            reasons["the free space of a door"] += 1
        elif any(_over(near, rect) and z < high + 0.03 and z + tall > low - 0.03 for rect, low, high in room.hung):
            reasons["what hangs there"] += 1
        elif z + tall > room.frame.height - 0.05 or z < 0.05 or not _within(foot, Rect(r.x0 - 1, r.y0 - 1, r.x1 + 1, r.y1 + 1)):
            reasons["the ceiling"] += 1
        elif any(_over(near, s.rect(p.piece.foot)) and z < p.z + p.piece.height + 0.35 for p, s in _on_ground(room)):
            reasons["furniture"] += 1
        elif thick > SHALLOW and not room.space.add(foot, None):
            reasons["a way that has to stay free"] += 1
        else:
            room.hung.append((foot, z, z + tall))
            room.put(own, spot, z, "walls", still=True)
            return None
    return reasons.most_common(1)[0][0] if reasons else "the size of its walls"


def _on_ground(room: _Room) -> Iterator[tuple[Standing, Spot]]:
    return ((p, room.spots[k]) for k, p in enumerate(room.standing) if p.carrier == "floor" and k in room.spots)


def _on_floor(room: _Room, density: float) -> None:
    """Small things along the walls."""
    for _ in range(round(density * len(room.kind.loose))):
        own = room.stock.take(str(room.rng.choice(room.kind.loose)))
        _stand(room, Wish((own.generator,)), own, 0)


def _fill(room: _Room, carrier: Standing, density: float) -> None:
    """Put small things on the surfaces of a thing, each where its box touches no other."""
    names = room.kind.clutter.get(carrier.piece.generator, room.kind.clutter.get("", ()))
    if not names or carrier.carrier not in ("floor", "walls"):
        return
    for place in carrier.piece.made.places.values():
        wide, deep = place.size
        taken: list[Rect] = []
        count = max(1, min(MOST_ON_SURFACE, round(wide * deep / 0.03)))
        for _ in range(round(density * count)):
            own = _small(room, names, min(wide, deep), place.clearance)
            where = None if own is None else _free(room, own, (wide, deep), taken)
            if own is None or where is None:
                continue
            x, y, yaw, rect = where
            c, s = math.cos(carrier.yaw), math.sin(carrier.yaw)
            px, py = float(place.center[0]) + x, float(place.center[1]) + y
            at = (carrier.x + c * px - s * py, carrier.y + s * px + c * py, carrier.z + float(place.center[2]) + room.frame.gap)
            half = math.hypot(own.foot.x1 - own.foot.x0, own.foot.y1 - own.foot.y0) / 2
            around = Rect(at[0] - half, at[1] - half, at[0] + half, at[1] + half)
            before_sash = half * half * own.height > BULKY and room.space.before_sash(around, at[2] + own.height)
            if before_sash or room.space.before_door(around):
                continue
            taken.append(rect)
            room.standing.append(
                Standing(
                    own,
                    *at,
                    carrier.yaw + yaw,
                    carrier.id,
                    place.body,
                    room.named(own.generator),
                )
            )


def _small(room: _Room, names: Sequence[str], across: float, clearance: float) -> Piece | None:
    """A small thing that fits between a surface and what is above it."""
    for _ in range(6):
        own = room.stock.take(str(room.rng.choice(names)))
        least = min(own.foot.x1 - own.foot.x0, own.foot.y1 - own.foot.y0)
        if own.height + 2 * room.frame.gap + 0.005 < clearance and least + 2 * EDGE < across:
            return own
    return None


def _free(room: _Room, own: Piece, size: tuple[float, float], taken: Sequence[Rect]) -> tuple[float, float, float, Rect] | None:
    """A free place on a surface about its middle: x, y, turn and the box that is taken."""
    for _ in range(TRIES):
        quarter = int(room.rng.integers(4))
        yaw = quarter * math.pi / 2 + float(room.rng.normal(0.0, 0.08))
        c, s = math.cos(yaw), math.sin(yaw)
        corners = np.array(
            [(c * x - s * y, s * x + c * y) for x in (own.foot.x0, own.foot.x1) for y in (own.foot.y0, own.foot.y1)]
        )
        low, high = corners.min(0) - SPACING / 2, corners.max(0) + SPACING / 2
        free = np.array(size) - 2 * EDGE - (high - low)
        if (free < 0).any():
            continue
        start = -np.array(size) / 2 + EDGE + room.rng.random(2) * free
        x, y = (float(v) for v in start - low)
        rect = Rect(x + float(low[0]), y + float(low[1]), x + float(high[0]), y + float(high[1]))
        if not any(rect.x0 < t.x1 and t.x0 < rect.x1 and rect.y0 < t.y1 and t.y0 < rect.y1 for t in taken):
            return x, y, yaw, rect
    return None
