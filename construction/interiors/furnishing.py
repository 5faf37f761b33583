"""Furniture by function, and what lies on it: placed where nothing stands in the way (R48, R95).

Order as in Infinigen Indoors (arXiv:2406.11824): things on the floor, large and bound ones before small, seats together with their table,
then what hangs, then what lies on surfaces. After every piece one can still walk from the door to all that stands there. Where a thing
finds no place the room is furnished anew with that thing earlier, as in squeaky wheel optimization (Joslin and Clements 1999,
doi:10.1613/jair.561), and the best of a few such rounds stays.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field, replace

import numpy as np

from ..assets.made import Place
from .arrangement import Arrangement, Frame, Standing, over, within
from .clutter import Wanted, fill
from .fitting import Fitted, Item, everything, fitted
from .fittings import windows_in
from .floor_space import FloorSpace, Spot
from .hanging import ROOM_ABOVE, hang
from .pieces import Piece, Stock
from .plans import Rect
from .spots import spots
from .wishes import RoomKind, Wish

__all__ = ["Frame", "Furnished", "Standing", "furnished"]

ROUNDS = 40
"""Own choice: times that a room is furnished anew at most."""
SHRINK = 4
"""Own choice: rounds after which things are tried in their next smaller sizes."""
GROUP_TRIES = 30
"""Own choice: places of a thing at which its companions are tried."""
URGENCY = 1.5
"""Own choice: by so many times its own claim a thing that found no place comes earlier in the next round."""
HANGING = ("hung", "above")


@dataclass
class Furnished:
    """A room with its things, and what there is to say."""

    standing: list[Standing]
    lacking: list[str] = field(default_factory=list)
    """Sentences about what found no place, with the constraint that stood in the way."""
    left_out: list[str] = field(default_factory=list)
    """Sentences about what the room is too small for: it was not asked for."""


def furnished(
    frame: Frame,
    kind: RoomKind,
    space: FloorSpace,
    stock: Stock,
    *,
    density: float,
    rng: np.random.Generator,
    things: int | None = None,
) -> Furnished:
    """Things of a room in their places.

    Args:
        frame: of the room.
        kind: what belongs into it.
        space: its floor.
        stock: where things are taken from.
        density: 0 (only furniture) to 1 (every surface full).
        rng: decides among places that are as good.
        things: surfaces are filled evenly until there are so many in the room, whatever `density` says.
    """
    asked = fitted(frame, kind, space, stock, rng)
    room = Arrangement(frame, space, rng, fixtures=windows_in(space))
    failed = _best_round(room, asked)
    for item in asked.extras:
        _put(room, item, None)
    wanted = Wanted(kind, stock, density, things)
    for name in _loose(wanted, rng):
        _place(room, Item(Wish((name,)), [stock.take(name)], 0), None)
    fill(room, wanted)
    lacking = [f"{frame.id}: a {name} found no place: {why} stood in the way" for name, why in failed]
    if things is not None and len(room.standing) < things:
        lacking.append(f"{frame.id}: {len(room.standing)} of {things} things: its surfaces hold no more")
    return Furnished(room.standing, lacking, asked.left_out)


def _loose(wanted: Wanted, rng: np.random.Generator) -> list[str]:
    """Small things on the floor along the walls."""
    names = wanted.kind.loose
    return [str(rng.choice(names)) for _ in range(round(wanted.density * len(names)))]


def _best_round(room: Arrangement, asked: Fitted) -> list[tuple[str, str]]:
    """Place what is asked for in the best of a few rounds; names of what found no place, and why."""
    urgency: Counter[int] = Counter()
    best: tuple[tuple[int, float], list[tuple[str, str]], Arrangement] | None = None
    start = room.mark()
    for number in range(ROUNDS):
        failed = _round(room, asked.items, urgency, number)
        told = [(f"{i.name}", why) for i, why in failed]
        # Of rounds with as many without a place the one that leaves out the smaller things.
        loss = len(failed), sum(i.claim for i, _ in failed)
        if best is None or loss < best[0]:
            best = loss, told, _copy(room)
        if not told:
            break
        for item, _ in failed:
            urgency[id(item)] += 1
        if number % SHRINK == SHRINK - 1:
            for item in everything(asked.items):
                item.size = min(item.size + 1, len(item.pieces) - 1)
        room.back(start)
    assert best is not None
    _, told, kept = best
    room.standing, room.hung, room.flat = kept.standing, kept.hung, kept.flat
    room.space.solid, room.space.access = kept.space.solid, kept.space.access
    return told


def _copy(room: Arrangement) -> Arrangement:
    space = replace(room.space, solid=[*room.space.solid], access=[*room.space.access])
    return Arrangement(room.frame, space, room.rng, [*room.standing], [*room.hung], [*room.flat], room.fixtures)


def _round(room: Arrangement, items: list[Item], urgency: Counter[int], number: int) -> list[tuple[Item, str]]:
    """Place all once: the floor, then the walls, then rugs; what found no place, and why."""
    failed = []

    def when(item: Item) -> tuple[int, float]:
        # What stands in rows has one place each.
        late = {"pairs": -1, "line": -1, "hung": 1, "above": 1, "flat": 2}.get(item.wish.rule, 0)
        # What is urgent hangs before furniture is in the way.
        late = 0 if late == 1 and urgency[id(item)] >= 2 else late
        noise = 1.0 + 0.25 * float(room.rng.random()) * min(number, 2)
        return late, -item.claim * noise * (1.0 + URGENCY * urgency[id(item)]) - 0.2 * urgency[id(item)]

    for _, item in sorted(((when(i), i) for i in items), key=lambda pair: pair[0]):
        why = _put(room, item, None)
        if why is not None:
            failed.append((item, why))
    return failed


def _put(room: Arrangement, item: Item, anchor: Standing | None) -> str | None:
    """Put a thing with its companions where its rule says."""
    if item.wish.rule == "on":
        return _lay_on(room, item, anchor)
    if item.wish.rule in HANGING:
        return hang(room, item, anchor, lambda i, s: _companions(room, i, s))
    return _place(room, item, anchor)


def _place(room: Arrangement, item: Item, anchor: Standing | None) -> str | None:
    """Put a thing and its companions on the floor; the constraint that stood in the way most often where there is no place for all of them."""
    reasons: Counter[str] = Counter()
    for piece in item.pieces[item.size :]:
        tries = 0
        for spot in spots(room, item, piece, anchor):
            mark = room.mark()
            why = _stand(room, item, spot, item.pieces.index(piece))
            if why is None:
                why = _companions(room, item, room.standing[-1])
                if why is None:
                    return None
                room.back(mark)
                tries += 1
            reasons[why] += 1
            if tries >= GROUP_TRIES:
                break
    if reasons:
        return reasons.most_common(1)[0][0]
    return f"no {item.wish.to or 'wall'} to place it by"


def _companions(room: Arrangement, item: Item, anchor: Standing) -> str | None:
    for companion in item.companions:
        why = _put(room, companion, anchor)
        if why is not None:
            return f"no place for its {companion.name} ({why})"
    return None


def _stand(room: Arrangement, item: Item, spot: Spot, size: int) -> str | None:
    """Put a thing on the floor at a spot, or say what stands in the way."""
    wish, own = item.wish, item.pieces[size]
    foot = spot.rect(own.foot)
    if wish.rule == "flat":
        if not within(foot, room.space.room) or room.space.beyond(foot):
            return "the walls"
        if any(over(foot, s) for _, s in room.on_floor()) or any(over(foot, f) for f in room.flat):
            return "furniture"
        why = room.barred(own, (spot.x, spot.y, room.frame.gap), spot.yaw)
        if why is None:
            room.flat.append(foot)
            room.put(own, spot, room.frame.gap, "floor")
        return why
    before = spot.rect(Rect(own.foot.x0, own.foot.y0 - wish.use, own.foot.x1, own.foot.y0)) if wish.use else None
    why = room.space.fits(foot, before, own.height)
    if why is None and any(over(foot, f) for f in room.flat):
        why = "a rug"
    free = ROOM_ABOVE if own.made.places else 0.03
    if why is None and any(over(foot, h.foot) and own.height + free > h.low for h in room.hung):
        why = "what hangs there"
    if why is None:
        why = room.barred(own, (spot.x, spot.y, room.frame.gap), spot.yaw, seat_of=wish.to if wish.seat else "")
    if why is None and not room.space.add(foot, foot if before is None and wish.seat else before):
        why = "a way that has to stay free"
    if why is None:
        room.put(own, spot, room.frame.gap, "floor").row = wish.rule == "row"
    return why


def _fits_on(own: Piece, place: Place) -> bool:
    wide, deep = own.foot.x1 - own.foot.x0, own.foot.y1 - own.foot.y0
    return place.clearance > own.height + 0.02 and place.size[0] > wide and place.size[1] > deep


def _lay_on(room: Arrangement, item: Item, anchor: Standing | None) -> str | None:
    """Put a thing in the middle of the highest surface of another, where it shuts nothing."""
    if anchor is None:
        return f"no {item.wish.to} to put it on"
    places = anchor.piece.made.places.values()
    fitting = [(own, p) for own in item.pieces[item.size :] for p in places if _fits_on(own, p)]
    if not fitting or anchor.spot is None:
        return f"the size of the {anchor.piece.generator}"
    own, place = max(fitting, key=lambda f: float(f[1].center[2]))
    x = float(place.center[0]) - (own.foot.x0 + own.foot.x1) / 2
    y = float(place.center[1]) - (own.foot.y0 + own.foot.y1) / 2
    at = anchor.spot.rect(Rect(x, y, x, y))
    z = anchor.z + float(place.center[2]) + room.frame.gap
    why = room.barred(own, (at.x0, at.y0, z), anchor.yaw)
    if why is None:
        room.lay(Standing(own, at.x0, at.y0, z, anchor.yaw, anchor.id, place.body))
    return why
