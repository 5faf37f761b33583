"""Stairwells: floors with their openings, the stairs that stand in them, and railings at the edges (R48, R95)."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from ...worlds.arrays import RigidPose, euler_to_quaternion
from ...worlds.spec import Interior
from ..assets.stairs import stairs_run
from .built import LOOSE, BuiltInterior, put_asset, suffix
from .layout import ARRIVAL, FLIGHT, Storey, straight_stairs, well_stairs
from .pieces import made_piece
from .plans import Rect, Side
from .walls import Block, clear_rect, slab_rect

__all__ = ["Well", "ledges", "put_stairs", "well_of"]

GUARD = 0.95
"""[m] Height of the railing at the opening of a floor (homes: 0.9, UK Approved Document K)."""

FLANGE, BESIDE = 0.05, 0.01
"""[m] How far the feet of a railing reach beyond its length, and its distance from the wall and the edge."""
BEARING = 0.4
"""[m] Own choice: floor on which the foot of a straight flight stands, over the one below too."""
ASIDE = 0.05
"""[m] Own choice: between a straight flight and the edge of the floor beside it; caps of its newels reach over it by half of that."""


class Well(NamedTuple):
    """The frame of a stairwell: u across from the left, v along the climb from the front, both between its walls."""

    rect: Rect
    """Between the faces of its walls [m]."""
    front: Side
    mirrored: bool = False
    """A straight flight is on the right of who climbs; u is then from the right."""

    @property
    def across(self) -> float:
        """[m]"""
        r = self.rect
        return r.y1 - r.y0 if self.front in ("west", "east") else r.x1 - r.x0

    @property
    def along(self) -> float:
        """[m]"""
        r = self.rect
        return r.x1 - r.x0 if self.front in ("west", "east") else r.y1 - r.y0

    @property
    def yaw(self) -> float:
        """Turn of what looks towards its front [rad]."""
        return {"south": 0.0, "east": math.pi / 2, "north": math.pi, "west": -math.pi / 2}[self.front]

    def at(self, u: float, v: float) -> tuple[float, float]:
        """A point in the plan [m]."""
        r, u = self.rect, self.across - u if self.mirrored else u
        return {
            "south": (r.x0 + u, r.y0 + v),
            "north": (r.x1 - u, r.y1 - v),
            "west": (r.x0 + v, r.y1 - u),
            "east": (r.x1 - v, r.y0 + u),
        }[self.front]

    def rectangle(self, low: tuple[float, float], high: tuple[float, float]) -> Rect:
        """A rectangle in the plan from two of its corners (u, v) [m]."""
        (ax, ay), (bx, by) = self.at(*low), self.at(*high)
        return Rect(min(ax, bx), min(ay, by), max(ax, bx), max(ay, by))


def well_of(storey: Storey, name: str, wall: float) -> Well:
    """The frame of a stairwell of a storey."""
    return Well(clear_rect(storey.plan.rooms[name], wall), storey.plan.fronts[name], name in storey.plan.mirrored)


def _strip(storeys: tuple[Storey, ...], number: int, well: Well) -> float:
    """Depth of the floor before the stairs that lead up to a storey [m]."""
    below, here = storeys[number - 1], storeys[number]
    own = made_piece("well_stairs", _stair_parameters(here.z - below.z, well), 0)
    return well.along - (own.foot.y1 - own.foot.y0) - LOOSE


def _stair_parameters(rise: float, well: Well) -> dict[str, float]:
    own = well_stairs(rise, well.across)
    return {"rise": own.rise, "width": own.width, "landing": own.landing}


class _Hole(NamedTuple):
    """The opening of a floor in the frame of its well, from the left wall on [m]."""

    across: float
    start: float
    end: float


def _hole(interior: Interior, storeys: tuple[Storey, ...], number: int, name: str, well: Well) -> _Hole:
    """The opening in the floor of a storey over the stairs from the one below."""
    if interior.rooms[name].stairs != "straight":
        return _Hole(well.across, _strip(storeys, number, well), well.along)
    start = _foot(storeys, number, well)
    return _Hole(FLIGHT + LOOSE + ASIDE, start + BEARING, well.along - ARRIVAL)


def _foot(storeys: tuple[Storey, ...], number: int, well: Well) -> float:
    """Where a straight flight up to a storey begins, from the front [m]."""
    return well.along - ARRIVAL - LOOSE - stairs_run(straight_stairs(storeys[number].z - storeys[number - 1].z))


def ledges(interior: Interior, storey: Storey, storeys: tuple[Storey, ...], name: str, thickness: float) -> dict[str, Block]:
    """The floor of a stairwell over another storey: all but the opening over its stairs."""
    well, slab = well_of(storey, name, interior.wall), slab_rect(storey.plan, name, interior.wall)
    hole = _hole(interior, storeys, storey.number, name, well)
    corner = [slab.x0, slab.y0, slab.x1, slab.y1]
    clear = well.rect
    margins = {
        "west": clear.x0 - corner[0],
        "south": clear.y0 - corner[1],
        "east": corner[2] - clear.x1,
        "north": corner[3] - clear.y1,
    }
    order = {
        "south": ("west", "east", "north"),
        "north": ("east", "west", "south"),
        "west": ("north", "south", "east"),
        "east": ("south", "north", "west"),
    }
    left, right, back = (margins[s] for s in order[well.front])
    if well.mirrored:
        left, right = right, left
    front = margins[well.front]
    across, along = well.across, well.along
    rects = {
        name: well.rectangle((-left, -front), (across + right, hole.start)),
        f"{name}_left": well.rectangle((-left, hole.start), (0.0, hole.end)),
        f"{name}_right": well.rectangle((hole.across, hole.start), (across + right, hole.end)),
        f"{name}_back": well.rectangle((-left, hole.end), (across + right, along + back)),
    }
    return {k: Block((r.x0, r.y0, -thickness), (r.x1, r.y1, 0.0)) for k, r in rects.items()}


def put_stairs(found: BuiltInterior, name: str, interior: Interior, storey: Storey, storeys: tuple[Storey, ...]) -> None:
    """Stairs from a storey to the next one, and a railing where a floor ends at the opening."""
    for room in storey.plan.fronts:
        well, key = well_of(storey, room, interior.wall), f"{name}_{room}_flights{suffix(storey.number)}"
        if interior.rooms[room].stairs == "straight":
            _straight(found, name, interior, room, storeys, storey.number)
        elif storey.number + 1 < len(storeys) and room in storeys[storey.number + 1].plan.rooms:
            strip = _strip(storeys, storey.number + 1, well)
            own = made_piece("well_stairs", _stair_parameters(storeys[storey.number + 1].z - storey.z, well), interior.seed)
            x, y = well.at(well.across / 2, (strip + well.along) / 2)
            pose = RigidPose(np.array(found.place(x, y, storey.z + LOOSE)), euler_to_quaternion((0.0, 0.0, well.yaw)))
            put_asset(found, key, own, pose, motion="static")
            found.supports(f"{key}_stand", f"{name}_floor{suffix(storey.number)}", key)
        elif storey.number:
            strip = _strip(storeys, storey.number, well)
            _guard(found, name, f"{name}_{room}_railing", storey, well, strip)


def _straight(found: BuiltInterior, name: str, interior: Interior, room: str, storeys: tuple[Storey, ...], number: int) -> None:
    """The straight flight from a storey to the next, and railings about the opening over the one from below."""
    storey, end = storeys[number], suffix(number)
    well, floor = well_of(storey, room, interior.wall), f"{name}_floor{end}"
    goes_on = number + 1 < len(storeys) and room in storeys[number + 1].plan.rooms
    if goes_on:
        own = straight_stairs(storeys[number + 1].z - storey.z, railing="left" if well.mirrored else "right")
        run, key = stairs_run(own), f"{name}_{room}_flights{end}"
        x, y = well.at(LOOSE + FLIGHT / 2, _foot(storeys, number + 1, well) + run / 2)
        _put(found, floor, key, "stairs", own.model_dump(exclude_defaults=True), (x, y, storey.z + LOOSE, well.yaw))
    if number and room in storeys[number - 1].plan.rooms:
        hole, key = _hole(interior, storeys, number, room, well), f"{name}_{room}_railing{end}"
        half = FLANGE + BESIDE
        x, y = well.at(hole.across + half, (hole.start + hole.end) / 2)
        _rail(found, floor, key, hole.end - hole.start, (x, y, storey.z + LOOSE, well.yaw + math.pi / 2))
        if not goes_on:
            x, y = well.at(hole.across / 2, hole.start - half)
            _rail(found, floor, f"{key}_front", hole.across, (x, y, storey.z + LOOSE, well.yaw))


def _rail(found: BuiltInterior, floor: str, key: str, length: float, at: tuple[float, float, float, float]) -> None:
    """A railing along an edge of a length, at its middle and turn about z."""
    own = {"length": round(length - 2 * FLANGE - 2 * BESIDE, 6), "height": GUARD}
    _put(found, floor, key, "railing", own, at)


def _put(
    found: BuiltInterior, floor: str, key: str, generator: str, own: dict[str, Any], at: tuple[float, float, float, float]
) -> None:
    """A thing that stands on a floor, its middle at a point of the plan, with its turn about z."""
    *place, yaw = at
    piece = made_piece(generator, own, 0)
    pose = RigidPose(np.array(found.place(*place)), euler_to_quaternion((0.0, 0.0, yaw)))
    put_asset(found, key, piece, pose, motion="static")
    found.supports(f"{key}_stands", floor, key)


def _guard(found: BuiltInterior, name: str, key: str, storey: Storey, well: Well, strip: float) -> None:
    """A railing at the edge over the lower flight."""
    length = well.across / 2 - 2 * FLANGE - 2 * BESIDE
    own = made_piece("railing", {"length": round(length, 6), "height": GUARD}, 0)
    x, y = well.at(BESIDE - own.foot.x0, strip - own.foot.y1 - BESIDE)
    pose = RigidPose(np.array(found.place(x, y, storey.z + LOOSE)), euler_to_quaternion((0.0, 0.0, well.yaw)))
    put_asset(found, key, own, pose, motion="static")
    found.supports(f"{key}_stands", f"{name}_floor{suffix(storey.number)}", key)
