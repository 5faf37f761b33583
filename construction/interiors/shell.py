"""Floors, walls, stairs and ceilings of the storeys of an interior."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ...worlds.arrays import RigidPose, euler_to_quaternion
from ...worlds.errors import InputError
from ...worlds.spec import Interior
from ..assets.registry import generator
from .built import LOOSE, SLAB, BuiltInterior, block_entity, put_asset, suffix
from .layout import GOING, RISER, Storey, room_of, well_stairs
from .pieces import made_piece
from .plans import STEPS, UPPER, Rect, Side
from .programs import KINDS
from .walls import Block, clear_rect, floor_blocks, slab_rect, wall_blocks

__all__ = ["Well", "put_roof", "put_shell", "well_of"]

GUARD = 0.95
"""[m] Height of the railing at the opening of a floor (homes: 0.9, UK Approved Document K)."""

FLANGE, BESIDE = 0.05, 0.01
"""[m] How far the feet of a railing reach beyond its length, and its distance from the wall and the edge."""


class Well(NamedTuple):
    """The frame of a stairwell: u across from the left, v along the climb from the front, both between its walls."""

    rect: Rect
    """Between the faces of its walls [m]."""
    front: Side

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
        r = self.rect
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
    return Well(clear_rect(storey.plan.rooms[name], wall), storey.plan.fronts[name])


def put_shell(found: BuiltInterior, name: str, interior: Interior, storeys: tuple[Storey, ...]) -> None:
    """Write floors, walls and stairs of all storeys, and the ceiling where one is asked for."""
    for storey in storeys:
        end, origin = suffix(storey.number), found.place(0.0, 0.0, storey.z)
        floor = _floor(interior, storey, storeys)
        found.entities[f"{name}_floor{end}"] = block_entity("floor of the rooms", "oak", floor, origin)
        if storey.number:
            found.supports(f"{name}_floor{end}_lies", f"{name}_walls{suffix(storey.number - 1)}", f"{name}_floor{end}")
        blocks = wall_blocks(storey.plan, storey.openings, wall=interior.wall, height=storey.height, levels=storey.levels)
        grounds = {0.0, *storey.levels.values()}
        raised = [Block((*b.low[:2], b.low[2] + LOOSE), b.high) if b.low[2] in grounds else b for b in blocks]
        walls: dict[str, tuple[Block, str | None]] = {f"wall_{k + 1}": (b, None) for k, b in enumerate(raised)}
        material = interior.walls or KINDS[next(iter(interior.rooms.values())).kind].walls
        found.entities[f"{name}_walls{end}"] = block_entity("walls between the rooms", material, walls, origin)
        found.supports(f"{name}_walls{end}_stand", f"{name}_floor{end}", f"{name}_walls{end}")
        _stairs(found, name, interior, storey, storeys)
    if interior.ceiling:
        top = storeys[-1]
        slab = {
            k: (Block((*b.low[:2], top.height + LOOSE), (*b.high[:2], top.height + SLAB)), None)
            for k, b in floor_blocks(top.plan, wall=interior.wall, thickness=SLAB).items()
        }
        origin = found.place(0.0, 0.0, top.z)
        found.entities[f"{name}_ceiling"] = block_entity("ceiling of the rooms", "gypsum_plaster", slab, origin)
        found.supports(f"{name}_ceiling_lies", f"{name}_walls{suffix(top.number)}", f"{name}_ceiling")


def put_roof(found: BuiltInterior, name: str, interior: Interior, top: Storey) -> None:
    """A roof on the outer walls, its ridge along the longer side.

    Raises:
        InputError: the plan is larger than roofs are made.
    """
    if interior.roof == "none":
        return
    wide, deep = top.plan.width + interior.wall, top.plan.depth + interior.wall
    length, width = max(wide, deep), min(wide, deep)
    fields = generator(f"{interior.roof}_roof").model.model_json_schema()["properties"]
    most = tuple(fields[side]["maximum"] for side in ("length", "width"))
    if length > most[0] or width > most[1]:
        raise InputError(
            f"the building is {length:g} x {width:g} m, roofs reach over {most[0]:g} x {most[1]:g} m: give a smaller size, fewer rooms or "
            "smaller areas, or roof 'none'"
        )
    own = made_piece(f"{interior.roof}_roof", {"length": round(length, 6), "width": round(width, 6)}, interior.seed)
    under = top.height + (SLAB if interior.ceiling else 0.0) + LOOSE
    place = found.place(top.plan.width / 2, top.plan.depth / 2, top.z + under)
    yaw = 0.0 if wide >= deep else math.pi / 2
    put_asset(found, f"{name}_roof", own, RigidPose(np.array(place), euler_to_quaternion((0.0, 0.0, yaw))), motion="static")
    carrier = f"{name}_ceiling" if interior.ceiling else f"{name}_walls{suffix(top.number)}"
    found.supports(f"{name}_roof_lies", carrier, f"{name}_roof")


def _floor(interior: Interior, storey: Storey, storeys: tuple[Storey, ...]) -> dict[str, tuple[Block, str | None]]:
    """Slabs under the rooms of a storey, each of its material, with steps and without the openings of stairwells."""
    thickness = SLAB - LOOSE if storey.number else SLAB
    found: dict[str, tuple[Block, str | None]] = {}
    blocks = floor_blocks(storey.plan, wall=interior.wall, thickness=thickness, levels=storey.levels)
    for part, block in blocks.items():
        name, room = room_of(interior, part)
        material = KINDS[room.kind].floor
        if room.kind == "stairs" and storey.number and part in storeys[storey.number - 1].plan.rooms:
            found |= {k: (b, material) for k, b in _ledges(interior, storey, storeys, part, thickness).items()}
            continue
        found[part] = (block, material)
        if part == f"{name}_{STEPS}":
            found |= {k: (b, material) for k, b in _steps(storey, part, f"{name}_{UPPER}", room.steps, interior.wall).items()}
    return found


def _steps(storey: Storey, part: str, upper: str, count: int, wall: float) -> dict[str, Block]:
    """Steps before the upper part of a corridor; the last riser is its edge."""
    r, above = storey.plan.rooms[part], storey.plan.rooms[upper]
    clear = clear_rect(r, wall)
    found = {}
    for k in range(1, count):
        far, near = (count - k) * GOING, (count - k - 1) * GOING
        if abs(above.x0 - r.x1) < 1e-9:
            low, high = (r.x1 - far, clear.y0 + LOOSE), (r.x1 - near, clear.y1 - LOOSE)
        else:
            low, high = (clear.x0 + LOOSE, r.y1 - far), (clear.x1 - LOOSE, r.y1 - near)
            if abs(above.x1 - r.x0) < 1e-9:
                low, high = (r.x0 + near, clear.y0 + LOOSE), (r.x0 + far, clear.y1 - LOOSE)
        found[f"{part}_{k}"] = Block((*low, 0.0), (*high, k * RISER))
    return found


def _strip(storeys: tuple[Storey, ...], number: int, well: Well) -> float:
    """Depth of the floor before the stairs that lead up to a storey [m]."""
    below, here = storeys[number - 1], storeys[number]
    own = made_piece("well_stairs", _stair_parameters(here.z - below.z, well), 0)
    return well.along - (own.foot.y1 - own.foot.y0) - LOOSE


def _stair_parameters(rise: float, well: Well) -> dict[str, float]:
    own = well_stairs(rise, well.across)
    return {"rise": own.rise, "width": own.width, "landing": own.landing}


def _ledges(interior: Interior, storey: Storey, storeys: tuple[Storey, ...], name: str, thickness: float) -> dict[str, Block]:
    """The floor of a stairwell over another storey: a strip at the front, and what lies under the walls about the opening."""
    well, slab = well_of(storey, name, interior.wall), slab_rect(storey.plan, name, interior.wall)
    strip = _strip(storeys, storey.number, well)
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
    front = margins[well.front]
    across, along = well.across, well.along
    rects = {
        name: well.rectangle((-left, -front), (across + right, strip)),
        f"{name}_left": well.rectangle((-left, strip), (0.0, along)),
        f"{name}_right": well.rectangle((across, strip), (across + right, along)),
        f"{name}_back": well.rectangle((-left, along), (across + right, along + back)),
    }
    return {k: Block((r.x0, r.y0, -thickness), (r.x1, r.y1, 0.0)) for k, r in rects.items()}


def _stairs(found: BuiltInterior, name: str, interior: Interior, storey: Storey, storeys: tuple[Storey, ...]) -> None:
    """Stairs from a storey to the next one, and a railing where a floor ends at the opening."""
    for room in storey.plan.fronts:
        well, key = well_of(storey, room, interior.wall), f"{name}_{room}_flights{suffix(storey.number)}"
        if storey.number + 1 < len(storeys) and room in storeys[storey.number + 1].plan.rooms:
            strip = _strip(storeys, storey.number + 1, well)
            own = made_piece("well_stairs", _stair_parameters(storeys[storey.number + 1].z - storey.z, well), interior.seed)
            x, y = well.at(well.across / 2, (strip + well.along) / 2)
            pose = RigidPose(np.array(found.place(x, y, storey.z + LOOSE)), euler_to_quaternion((0.0, 0.0, well.yaw)))
            put_asset(found, key, own, pose, motion="static")
            found.supports(f"{key}_stand", f"{name}_floor{suffix(storey.number)}", key)
        elif storey.number:
            strip = _strip(storeys, storey.number, well)
            _guard(found, name, f"{name}_{room}_railing", storey, well, strip)


def _guard(found: BuiltInterior, name: str, key: str, storey: Storey, well: Well, strip: float) -> None:
    """A railing at the edge over the lower flight."""
    length = well.across / 2 - 2 * FLANGE - 2 * BESIDE
    own = made_piece("railing", {"length": round(length, 6), "height": GUARD}, 0)
    x, y = well.at(BESIDE - own.foot.x0, strip - own.foot.y1 - BESIDE)
    pose = RigidPose(np.array(found.place(x, y, storey.z + LOOSE)), euler_to_quaternion((0.0, 0.0, well.yaw)))
    put_asset(found, key, own, pose, motion="static")
    found.supports(f"{key}_stands", f"{name}_floor{suffix(storey.number)}", key)
