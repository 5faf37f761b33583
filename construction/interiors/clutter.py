"""Small things on the surfaces of a room, by function of what it lies on, each where its box touches no other (R95)."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ...worlds.arrays import F64
from ..assets.made import Place
from .arrangement import Arrangement, Standing, over
from .pieces import Piece, Stock
from .plans import Rect
from .programs import NOTHING_ON
from .swept import LIGHT, Volume
from .wishes import RoomKind

__all__ = ["Wanted", "fill"]

TRIES = 12
"""Places anywhere on a surface that are tried for a small thing, before those beside what lies there."""
TURNS = 4
"""Turns of a small thing that are tried."""
KINDS_TRIED = 6
"""Things of which one is chosen that is not too large for a surface."""
EDGE = 0.012
"""[m] Own choice: how far small things stay from the edge of what they lie on."""
SPACING = 0.008
"""[m] Own choice: gap between small things."""
AREA = 0.03
"""[m^2] Own choice: of a surface for one small thing at density 1."""
MOST_ON_SURFACE = 9
"""Own choice: small things on one surface at density 1."""
CROWDED = 16
"""Own choice: small things on one surface at most, where a number of things is asked for."""
CLOSED = 0.3
"""[m] Own choice: drawers and shelves with less free height than this are filled last; what lies in drawers is not seen."""


@dataclass(frozen=True)
class Wanted:
    """Small things that a room is to have."""

    kind: RoomKind
    stock: Stock
    density: float
    """0 to 1."""
    things: int | None
    """Number of things in the whole room, where it is asked for."""


@dataclass
class _Surface:
    carrier: Standing
    place: Place
    names: Sequence[str]
    clearance: float
    """Free height above it [m]."""
    count: int
    """Things that it takes at density 1."""
    taken: list[Rect] = field(default_factory=list)
    full: bool = False


def fill(room: Arrangement, wanted: Wanted) -> None:
    """Put small things on the surfaces of a room: by density, or evenly until a number of things is reached."""
    surfaces = _surfaces(room, wanted)
    used = Counter(s.piece.generator for s in room.standing)
    if wanted.things is None:
        for surface in surfaces:
            for _ in range(round(wanted.density * surface.count)):
                _add(room, wanted.stock, surface, used)
        return
    for closed in (False, True):
        own = [s for s in surfaces if _closed(s) == closed]
        while len(room.standing) < wanted.things and (open_ones := [s for s in own if not s.full]):
            # The emptiest for its size first, so that all fill evenly.
            surface = min(open_ones, key=lambda s: (len(s.taken) + 1) / s.count)
            surface.full = len(surface.taken) >= CROWDED or not _add_any(room, wanted.stock, surface, used)


def _add_any(room: Arrangement, stock: Stock, surface: _Surface, used: Counter[str]) -> bool:
    """Put one more thing on a surface: of any of its kinds where a first choice does not fit, rare ones first."""
    if _add(room, stock, surface, used):
        return True
    names = sorted(set(surface.names), key=lambda name: (used[name], name))
    return any(_add(room, stock, surface, used, name) for name in names)


def _closed(surface: _Surface) -> bool:
    return (
        surface.clearance < CLOSED
        and surface.place.clearance < CLOSED
        and surface.carrier.piece.generator not in ("bookcase", "wall_shelf")
    )


def _surfaces(room: Arrangement, wanted: Wanted) -> list[_Surface]:
    found = []
    for carrier in room.standing:
        name = carrier.piece.generator
        if carrier.spot is None or (name in NOTHING_ON and name not in wanted.kind.clutter):
            continue
        names = wanted.kind.clutter.get(name, wanted.kind.clutter.get("", ()))
        for place in carrier.piece.made.places.values() if names else ():
            above = _clearance(room, carrier, place)
            taken = [_local(carrier, place, s) for s in room.standing if s.carrier == carrier.id and s.body == place.body]
            count = max(1, min(MOST_ON_SURFACE, round(place.size[0] * place.size[1] / AREA)))
            found.append(_Surface(carrier, place, names, above, count, taken))
    return found


def _corners(carrier: Standing, center: tuple[float, float], half: tuple[float, float]) -> Rect:
    """Upright box about a level rectangle of a carrier's frame, in the room [m]."""
    c, s = math.cos(carrier.yaw), math.sin(carrier.yaw)
    x, y = carrier.x + c * center[0] - s * center[1], carrier.y + s * center[0] + c * center[1]
    wide, deep = abs(c) * half[0] + abs(s) * half[1], abs(s) * half[0] + abs(c) * half[1]
    return Rect(x - wide, y - deep, x + wide, y + deep)


def _clearance(room: Arrangement, carrier: Standing, place: Place) -> float:
    """Free height over a place: its own, under what hangs there, and under the ceiling [m]."""
    z = carrier.z + float(place.center[2])
    mine = _corners(carrier, (float(place.center[0]), float(place.center[1])), (place.size[0] / 2, place.size[1] / 2))
    hung = [
        h.low - z
        for h in room.hung
        if h.low > z and h.foot.x0 < mine.x1 and mine.x0 < h.foot.x1 and h.foot.y0 < mine.y1 and mine.y0 < h.foot.y1
    ]
    return min([place.clearance, room.frame.height - z, *hung])


def _local(carrier: Standing, place: Place, thing: Standing) -> Rect:
    """Box of a thing on a place, about the place's middle [m]."""
    c, s = math.cos(-carrier.yaw), math.sin(-carrier.yaw)
    dx, dy = thing.x - carrier.x, thing.y - carrier.y
    x, y = c * dx - s * dy - float(place.center[0]), s * dx + c * dy - float(place.center[1])
    low, high = _turned(thing.piece, thing.yaw - carrier.yaw)
    return Rect(x + low[0], y + low[1], x + high[0], y + high[1])


def _turned(own: Piece, yaw: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """Least and greatest corner of a thing's footprint after a turn [m]."""
    c, s = math.cos(yaw), math.sin(yaw)
    points = np.array([(c * x - s * y, s * x + c * y) for x in (own.foot.x0, own.foot.x1) for y in (own.foot.y0, own.foot.y1)])
    low, high = points.min(0), points.max(0)
    return (float(low[0]), float(low[1])), (float(high[0]), float(high[1]))


def _add(room: Arrangement, stock: Stock, surface: _Surface, used: Counter[str], name: str = "") -> bool:
    """Put one more thing on a surface, of a kind or of one of which the room has few; says whether there was place."""
    own = _small(room, stock, surface, used, [name] if name else surface.names)
    where = None if own is None else _free(room, own, surface)
    if own is None or where is None:
        return False
    x, y, yaw, rect = where
    surface.taken.append(rect)
    carrier, place = surface.carrier, surface.place
    c, s = math.cos(carrier.yaw), math.sin(carrier.yaw)
    px, py = float(place.center[0]) + x, float(place.center[1]) + y
    z = carrier.z + float(place.center[2]) + room.frame.gap
    room.lay(
        Standing(own, carrier.x + c * px - s * py, carrier.y + s * px + c * py, z, carrier.yaw + yaw, carrier.id, place.body)
    )
    used[own.generator] += 1
    return True


def _small(room: Arrangement, stock: Stock, surface: _Surface, used: Counter[str], names: Sequence[str]) -> Piece | None:
    """A small thing that fits between a surface and what is above it; rare ones are more likely."""
    across = min(surface.place.size)
    share = np.array([1.0 / (1.0 + used[name]) for name in names])
    for _ in range(KINDS_TRIED if len(names) > 1 else 1):
        own = stock.small(str(room.rng.choice(names, p=share / share.sum())))
        least = min(own.foot.x1 - own.foot.x0, own.foot.y1 - own.foot.y0)
        if own.height + 2 * room.frame.gap + 0.005 < surface.clearance and least + 2 * EDGE < across:
            return own
    return None


def _free(room: Arrangement, own: Piece, surface: _Surface) -> tuple[float, float, float, Rect] | None:
    """A free place on a surface about its middle: x, y, turn and the box that is taken."""
    half = np.array(surface.place.size) / 2 - EDGE
    for _ in range(TURNS):
        yaw = int(room.rng.integers(4)) * math.pi / 2 + float(room.rng.normal(0.0, 0.08))
        low, high = (np.array(v) for v in _turned(own, yaw))
        low, high = low - SPACING / 2, high + SPACING / 2
        free = 2 * half - (high - low)
        if (free < 0).any():
            continue
        loose = -half + room.rng.random((TRIES, 2)) * free
        corners = [*loose.tolist(), *_flush(surface, half, high - low)]
        for u, v in corners:
            rect = Rect(u, v, u + float(high[0] - low[0]), v + float(high[1] - low[1]))
            if rect.x1 > half[0] + 1e-9 or rect.y1 > half[1] + 1e-9 or any(over(rect, t, 0.0) for t in surface.taken):
                continue
            x, y = u - float(low[0]), v - float(low[1])
            if not _before_opening(room, own, surface, (x, y)):
                return x, y, yaw, rect
    return None


def _before_opening(room: Arrangement, own: Piece, surface: _Surface, at: tuple[float, float]) -> bool:
    """True where a thing about a place of a surface would stand before a turning door, or heavy where something else opens."""
    carrier, place = surface.carrier, surface.place
    half = math.hypot(own.foot.x1 - own.foot.x0, own.foot.y1 - own.foot.y0) / 2
    around = _corners(carrier, (float(place.center[0]) + at[0], float(place.center[1]) + at[1]), (0.0, 0.0))
    around = Rect(around.x0 - half, around.y0 - half, around.x1 + half, around.y1 + half)
    if room.space.before_door(around):
        return True
    level = carrier.z + float(place.center[2])
    box = Volume(np.array([[around.x0, around.y0, level]]), np.array([[around.x1, around.y1, level + own.height]]))
    return room.shut(box) is not None and own.mass > LIGHT


def _flush(surface: _Surface, half: F64, size: F64) -> list[tuple[float, float]]:
    """Least corners of a box that touches what lies there or the edges of a surface [m]: the only ones that matter where it is crowded."""
    xs = [-half[0], half[0] - size[0], *(t.x1 for t in surface.taken), *(t.x0 - size[0] for t in surface.taken)]
    ys = [-half[1], half[1] - size[1], *(t.y1 for t in surface.taken), *(t.y0 - size[1] for t in surface.taken)]
    return [(float(x), float(y)) for x in xs if x >= -half[0] for y in ys if y >= -half[1]]
