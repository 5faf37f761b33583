"""An interior of the specification as entities, joints, relations and regions (JSON)."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ...execution import one_core, seldom_collected
from ...worlds.arrays import RigidPose, euler_to_quaternion
from ...worlds.spec import Interior
from ..assets.documents import body_id, feet
from ..assets.registry import generator
from .built import BuiltInterior, numbers, put_asset, suffix
from .fittings import hang_door, set_window
from .floor_space import FloorSpace
from .furnishing import Frame, Standing, furnished
from .ground import Heights, put_ground, seated
from .layout import STRIP, Storey, room_of, storeys_of
from .pieces import Stock
from .plans import OUTSIDE, STEPS, WING, Rect
from .programs import KINDS
from .shell import put_roof, put_shell
from .stilled import Still, lowerings
from .walls import Opening, clear_rect
from .wells import well_of

__all__ = ["BuiltInterior", "build_interior"]

LEAST_ROUTE = 0.6
"""[m] Width of the way through doors and between furniture that is declared and checked."""
UNDER = 0.05
"""[m] Own choice: regions end so far below the ceiling, so that the floor above is not within a step of them."""
HEADROOM = {"door": 1.95, "stairs": 2.0}
"""[m] Clear height of the ways that are declared and checked: under the lintel of a door, and on stairs."""


@seldom_collected()
@one_core()
def build_interior(name: str, interior: Interior, *, gap: float, ground: Heights | None = None) -> BuiltInterior:
    """Plan an interior, put up its walls, and furnish it.

    Args:
        name: id of the interior, with which all ids begin.
        interior: what is asked for.
        gap: between things and what carries them [m]: two collision skins.
        ground: height of the ground on which it stands; None where `interior.on` names none.

    Raises:
        InputError: there is no such plan, or the ground does not carry it.
    """
    rng = np.random.default_rng(interior.seed)
    storeys = storeys_of(interior, rng)
    plan, (x, y, z) = storeys[0].plan, interior.at
    site = None if ground is None else seated(interior, storeys[0], ground)
    found = BuiltInterior(plan, (x - plan.width / 2, y - plan.depth / 2, z if site is None else round(site.floor, 6)))
    if site is not None:
        put_ground(found, name, interior, plan, site)
        found.site = {
            "floor": round(site.floor, 3),
            "plinth": round(-site.lowest, 3),
            "steps": {s.front.door.rooms[0]: s.number for s in site.steps},
        }
    still = Still(interior)
    put_shell(found, name, interior, storeys)
    put_roof(found, name, interior, storeys[-1])
    for storey in storeys:
        for door in storey.doors:
            hang_door(found, name, interior, storey, door, rng, still)
        for window in storey.windows:
            set_window(found, name, interior, storey, window, still)
    supply = _Supply(Stock(rng), interior.density, rng, still)
    for storey in storeys:
        for part in storey.plan.rooms:
            _room(found, name, interior, storey, part, gap, supply)
        _routes(found, name, storey)
    _climbs(found, name, interior, storeys)
    found.lacking += still.unmet(found.entities, interior.rooms)
    return found


class _Supply(NamedTuple):
    """Things of a room: where they are taken from, how densely they lie, and random numbers for their places."""

    stock: Stock
    density: float
    rng: np.random.Generator
    still: Still


def _room(found: BuiltInterior, name: str, interior: Interior, storey: Storey, part: str, gap: float, supply: _Supply) -> None:
    """The region of a room or of a part of a corridor, and what stands in it."""
    wall, level = interior.wall, storey.levels.get(part, 0.0)
    own, asked = room_of(interior, part)
    rect = clear_rect(storey.plan.rooms[part], wall)
    if asked.kind == "stairs":
        well = well_of(storey, part, wall)
        rect = well.rectangle((0.0, 0.0), (well.across, STRIP))
    elif part == f"{own}_{STEPS}":
        return
    wing = part == f"{own}_{WING}"
    frame = Frame(f"{name}_{part}{suffix(storey.number) if asked.kind == 'stairs' else ''}", storey.height - level, gap)
    found.regions[frame.id] = {
        "kind": "box",
        "min": numbers(found.place(rect.x0, rect.y0, storey.z + level)),
        "max": numbers(found.place(rect.x1, rect.y1, storey.z + storey.height - UNDER)),
    }
    if wing:
        return
    standing: list[Standing] = []
    if asked.furniture and asked.kind != "stairs":
        space = _space(storey, part, wall, level, wing=f"{part}_{WING}" if asked.shape == "L" else "")
        kind = KINDS[asked.kind]
        filled = furnished(frame, kind, space, supply.stock, density=supply.density, rng=supply.rng, things=asked.things)
        standing = filled.standing
        found.lacking += filled.lacking
        found.left_out += filled.left_out
    still = supply.still.among(standing, own)
    lower = lowerings(standing, still, gap)
    for thing in standing:
        placed = replace(thing, z=thing.z - lower[thing.id])
        if still[thing.id]:
            placed = replace(placed, piece=supply.still.piece(thing.piece), still=True)
        _stand(found, name, storey, placed, level, fixed=still[thing.id])
    found.rooms[part + suffix(storey.number) if asked.kind == "stairs" else part] = {
        "kind": asked.kind,
        "size": _size(rect),
        "things": len(standing),
        "generators": len({t.piece.generator for t in standing}),
        **({"wing": _size(clear_rect(storey.plan.rooms[f"{part}_{WING}"], wall))} if asked.shape == "L" else {}),
        **({"storey": storey.number} if storey.number else {}),
        **({"level": round(level, 3)} if level else {}),
    }


def _size(rect: Rect) -> list[float]:
    return [round(rect.x1 - rect.x0, 3), round(rect.y1 - rect.y0, 3)]


def _space(storey: Storey, part: str, wall: float, level: float, *, wing: str) -> FloorSpace:
    """The floor of a room with the doors and windows about it; `wing` is the shorter part of an L-shaped one."""
    rects = [clear_rect(storey.plan.rooms[p], wall) for p in (part, wing) if p]
    inner = (part, wing)
    openings = [
        replace(o, sill=o.sill - level, head=o.head - level)
        for o in storey.openings
        if o.rooms != inner and any(_beside(o, r, wall) for r in rects)
    ]
    if wing:
        return FloorSpace.of_wing(rects[0], rects[1], openings, wall, names=(part, wing))
    return FloorSpace(rects[0], openings, wall, name=part)


def _stand(found: BuiltInterior, name: str, storey: Storey, thing: Standing, level: float, *, fixed: bool) -> None:
    """Write a thing of a room in its place, and what carries it; `fixed`: with what hangs on its joints."""
    place = found.place(thing.x, thing.y, storey.z + level + thing.z)
    pose = RigidPose(np.array(place), euler_to_quaternion((0.0, 0.0, thing.yaw)))
    motion = "static" if thing.still else generator(thing.piece.generator).motion
    put_asset(found, thing.id, thing.piece, pose, motion=motion, fixed=fixed)
    shell = thing.carrier in ("floor", "walls")
    carrier = f"{name}_{thing.carrier}{suffix(storey.number)}" if shell else body_id(thing.carrier, thing.body)
    for foot in feet(thing.piece.made, thing.piece.boxes, stands=generator(thing.piece.generator).stands):
        own = body_id(thing.id, foot)
        found.supports(f"{own}_stands", carrier, own)


def _beside(opening: Opening, rect: Rect, wall: float) -> bool:
    """True if an opening is in a wall of a room."""
    hole = opening.plan(wall)
    return hole.x0 <= rect.x1 + 1e-6 and hole.x1 >= rect.x0 - 1e-6 and hole.y0 <= rect.y1 + 1e-6 and hole.y1 >= rect.y0 - 1e-6


def _connect(found: BuiltInterior, relation: str, a: str, b: str, headroom: float) -> None:
    found.relations[relation] = {"kind": "connects", "a": a, "b": b, "width": LEAST_ROUTE, "headroom": headroom}


def _routes(found: BuiltInterior, name: str, storey: Storey) -> None:
    """That one can walk through every door inside, and over the steps of corridors."""
    ids = {part: f"{name}_{part}{suffix(storey.number) if part in storey.plan.fronts else ''}" for part in storey.plan.rooms}
    for a, b in storey.plan.doors:
        if b != OUTSIDE:
            _connect(found, f"{name}_{a}_to_{b}", ids[a], ids[b], HEADROOM["door"])
    for opening in storey.passages:
        low, high = opening.rooms
        if high == f"{low}_{WING}":
            _connect(found, f"{name}_{low}_to_{WING}", ids[low], ids[high], HEADROOM["stairs"])
        if low.endswith(f"_{STEPS}"):
            _connect(found, f"{name}_{low}_up", f"{name}_{low.removesuffix(f'_{STEPS}')}", f"{name}_{high}", HEADROOM["stairs"])


def _climbs(found: BuiltInterior, name: str, interior: Interior, storeys: tuple[Storey, ...]) -> None:
    """That one can walk up the stairs of every stairwell."""
    for below, above in itertools.pairwise(storeys):
        for room in below.plan.fronts:
            if room in above.plan.fronts:
                low, high = (f"{name}_{room}{suffix(s.number)}" for s in (below, above))
                _connect(found, f"{name}_{room}_up{suffix(above.number)}", low, high, HEADROOM["stairs"])
