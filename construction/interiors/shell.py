"""Floors, walls, stairs and ceilings of the storeys of an interior."""

from __future__ import annotations

import math

import numpy as np

from ...worlds.arrays import RigidPose, euler_to_quaternion
from ...worlds.errors import InputError
from ...worlds.spec import Interior
from ..assets.registry import generator
from .built import LOOSE, SLAB, BuiltInterior, block_entity, put_asset, suffix
from .layout import GOING, RISER, Storey, room_of
from .pieces import made_piece
from .plans import STEPS, UPPER
from .programs import KINDS
from .walls import Block, clear_rect, floor_blocks, wall_blocks
from .wells import ledges, put_stairs

__all__ = ["put_roof", "put_shell"]


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
        put_stairs(found, name, interior, storey, storeys)
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
            found |= {k: (b, material) for k, b in ledges(interior, storey, storeys, part, thickness).items()}
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
