"""Things on the walls of a room: where no opening, no furniture and nothing else that hangs is in the way (R48, R95)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator

from .arrangement import Arrangement, Hung, Standing, over, within
from .fitting import Item
from .floor_space import APART, Spot
from .pieces import Piece
from .plans import Rect
from .spots import along_walls, at_corner

__all__ = ["ROOM_ABOVE", "hang"]

STILL = 1e-4
"""[m] Gap between a wall and what hangs on it; both never move."""
BESIDE = 0.08
"""[m] Own choice: wall that stays free about what hangs there; more than mouldings of openings take."""
SHALLOW = 0.1
"""[m] Own choice: what hangs on a wall and stands out further is in the way of people."""
ROOM_ABOVE = 0.35
"""[m] Own choice: free height over furniture and shelves, for what lies on them."""
CLOSE = 0.08
"""[m] Own choice: wall between a thing and what belongs above it."""
ABOUT_OPENING = 0.15
"""[m] Own choice: above and below openings."""
UNDER_CEILING = 0.05
"""[m] Own choice."""


def hang(
    room: Arrangement, item: Item, anchor: Standing | None, then: Callable[[Item, Standing], str | None] = lambda *_: None
) -> str | None:
    """Put a thing on a wall, above another where it belongs to one; the constraint that stood in the way most often.

    Args:
        room: where.
        item: the thing.
        anchor: what it belongs to, if that is decided.
        then: places its companions, or says what stands in their way.
    """
    reasons: Counter[str] = Counter()
    for own in item.pieces[item.size :]:
        for spot, z in _places(room, item, own, anchor):
            foot = spot.rect(own.foot)
            why = _barred(room, own, foot, z, close=item.wish.rule == "above") or room.barred(own, (spot.x, spot.y, z), spot.yaw)
            mark, deep = room.mark(), own.foot.y1 - own.foot.y0 > SHALLOW
            if why is None and deep and not room.space.add(foot, None):
                why = "a way that has to stay free"
            if why is None:
                above = ROOM_ABOVE if own.made.places else 0.0
                room.hung.append(Hung(foot, z, z + own.height + above))
                why = then(item, room.put(own, spot, z, "walls", still=True))
                if why is None:
                    return None
            room.back(mark)
            reasons[why] += 1
    return reasons.most_common(1)[0][0] if reasons else "the size of its walls"


def _places(room: Arrangement, item: Item, own: Piece, anchor: Standing | None) -> Iterator[tuple[Spot, float]]:
    """Spots with their heights [m]."""
    back = APART - STILL
    if item.wish.rule == "above":
        others = [anchor] if anchor is not None else [s for s in room.standing if s.piece.generator == item.wish.to]
        for other in others:
            if other.spot is not None:
                base, mine = other.piece.foot, own.foot
                left = (base.x0 + base.x1 - mine.x1 + mine.x0) / 2
                behind = base.y1 + (0.0 if other.still else back)
                inner = at_corner(own, 0, (left, behind - mine.y1 + mine.y0))
                at = other.spot.rect(Rect(inner.x, inner.y, inner.x, inner.y))
                low = other.z + other.piece.height + CLOSE + 1e-6
                yield Spot(at.x0, at.y0, other.spot.quarter), max(low, item.wish.height - own.height / 2)
        return
    for spot in along_walls(room, own):
        # From the gap of furniture to that of what hangs.
        dx, dy = ((0, back), (-back, 0), (0, -back), (back, 0))[spot.quarter]
        yield Spot(spot.x + dx, spot.y + dy, spot.quarter), item.wish.height - own.height / 2


def _barred(room: Arrangement, own: Piece, foot: Rect, z: float, *, close: bool) -> str | None:
    """The constraint that stands in the way of a thing on a wall, in words."""
    tall, thick = own.height, own.foot.y1 - own.foot.y0
    near = Rect(foot.x0 - BESIDE, foot.y0 - BESIDE, foot.x1 + BESIDE, foot.y1 + BESIDE)
    if not within(foot, room.space.room) or room.space.beyond(foot):
        return "the walls"
    openings = ((o.plan(room.space.wall), o.sill - ABOUT_OPENING, o.head + ABOUT_OPENING) for o in room.space.openings)
    if any(over(near, rect) and z < head and z + tall > sill for rect, sill, head in openings):
        return "a door or window"
    if thick > BESIDE and any(over(near, d) for d in room.space.doors):
        return "the free space of a door"
    if any(
        over(near, h.foot) and z < h.high + 0.03 and z + tall + ROOM_ABOVE * bool(own.made.places) > h.low - 0.03
        for h in room.hung
    ):
        return "what hangs there"
    if z + tall > room.frame.height - UNDER_CEILING or z < UNDER_CEILING:
        return "the ceiling"
    free = CLOSE if close else ROOM_ABOVE
    if any(
        over(near, rect) and z < s.z + s.piece.height + (free if over(foot, rect, 0.0) else ROOM_ABOVE)
        for s, rect in room.on_floor()
    ):
        return "furniture"
    return None
