"""An interior of the specification as entities, joints, relations and regions (JSON)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from ...worlds.arrays import RigidPose, euler_to_quaternion
from ...worlds.spec import Interior, Room
from ..assets.documents import asset_documents, body_id, feet
from ..assets.posing import posed
from ..assets.registry import generator
from .floor_space import FloorSpace
from .furnishing import Frame, Standing, furnished
from .pieces import Piece, Stock, made_piece
from .plans import OUTSIDE, Need, Plan, Rect, solve_plan
from .programs import KINDS
from .walls import CORNER, Block, Opening, clear_rect, doors_of, floor_blocks, hinge, wall_blocks, windows_of

__all__ = ["BuiltInterior", "build_interior"]

JAMB = 0.045
"""[m] Thickness of the frames of doors and windows, see `assets/openings.py`."""
LOOSE = 1e-4
"""[m] Gap around frames in walls; neither moves."""
DOOR_HEIGHT, SILL, WINDOW_HEAD = 2.03, 0.9, 2.1
"""[m] Clear height of doors (2.0 m of headroom: DIN 18101); lower and upper edge of windows in the wall (sill 0.9: SceneSmith)."""
AJAR = 1.4
"""[rad] How far doors stand open, so that one can walk through: 80 degrees."""
SLAB = 0.2
"""[m] Thickness of floor and ceiling."""
LEAST_ROUTE = 0.6
"""[m] Width of the way through doors and between furniture that is declared and checked."""


@dataclass
class BuiltInterior:
    """Members of collections of a specification, by id, and what there is to say."""

    plan: Plan
    corner: tuple[float, float, float]
    """World position of the plan's corner [m]."""
    entities: dict[str, dict[str, Any]] = field(default_factory=dict)
    joints: dict[str, dict[str, Any]] = field(default_factory=dict)
    relations: dict[str, dict[str, Any]] = field(default_factory=dict)
    regions: dict[str, dict[str, Any]] = field(default_factory=dict)
    rooms: dict[str, dict[str, Any]] = field(default_factory=dict)
    """Per room: rectangle [m], things and generators."""
    lacking: list[str] = field(default_factory=list)
    """Sentences about what could not be placed."""
    left_out: list[str] = field(default_factory=list)
    """Sentences about furniture that rooms are too small for, so that it was not asked for."""


def build_interior(name: str, interior: Interior, *, gap: float) -> BuiltInterior:
    """Plan an interior, put up its walls, and furnish it.

    Args:
        name: id of the interior, with which all ids begin.
        interior: what is asked for.
        gap: between things and what carries them [m]: two collision skins.

    Raises:
        InputError: there is no such plan.
    """
    wall, rng = interior.wall, np.random.default_rng(interior.seed)
    needs = {k: _need(r.kind, r.area, tuple(r.doors), r.windows) for k, r in interior.rooms.items()}
    opening = interior.door + 2 * JAMB + 2 * LOOSE
    plan = solve_plan(needs, size=interior.size, wall=wall, door=opening + 2 * CORNER, seed=interior.seed)
    pairs = list({frozenset((a, b)): (a, b) for a, r in interior.rooms.items() for b in r.doors}.values())
    doors = doors_of(plan, pairs, wall=wall, width=opening, head=DOOR_HEIGHT + JAMB + LOOSE, rng=rng)
    lit = [k for k, n in needs.items() if n.daylight]
    windows = windows_of(plan, lit, doors, wall=wall, sill=SILL, head=WINDOW_HEAD)
    x, y, z = interior.at
    found = BuiltInterior(plan, (x - plan.width / 2, y - plan.depth / 2, z))
    _shell(found, name, interior, doors, windows)
    for door in doors:
        _hang_door(found, name, interior, door, rng)
    for window in windows:
        _set_window(found, name, interior, window)
    stock = Stock(rng)
    for room, rect in plan.rooms.items():
        own = clear_rect(rect, wall)
        space = FloorSpace(own, [o for o in (*doors, *windows) if _beside(o, own, wall)], wall, name=room)
        frame = Frame(f"{name}_{room}", interior.height, gap)
        _furnish(found, frame, interior.rooms[room], space, _Supply(stock, interior.density, rng), name)
    _routes(found, name, interior, pairs)
    return found


def _need(kind: str, area: float | None, doors: tuple[str, ...], windows: bool | None) -> Need:
    own = KINDS[kind]
    return Need(area or own.area, own.width, own.aspect, doors, own.daylight if windows is None else windows)


def _block_entity(
    role: str, material: str, blocks: dict[str, tuple[Block, str | None]], origin: tuple[float, float, float]
) -> dict[str, Any]:
    """A static entity of boxes, its own origin at the plan's corner."""
    low = np.min([b.low for b, _ in blocks.values()], axis=0)
    high = np.max([b.high for b, _ in blocks.values()], axis=0)
    parts = {}
    for key, (block, own) in blocks.items():
        size, middle = np.subtract(block.high, block.low), np.add(block.high, block.low) / 2
        parts[key] = {
            "shape": {"kind": "box", "size": _numbers(size)},
            "pose": {"position": _numbers(middle)},
            **({} if own is None else {"material": own}),
        }
    return {
        "role": role,
        "motion": "static",
        "material": material,
        "dimensions": {"size": _numbers(high - low)},
        "pose": {"position": _numbers(origin)},
        "parts": parts,
    }


def _numbers(values: Any) -> list[float]:
    return [round(float(v), 9) + 0.0 for v in values]


def _shell(found: BuiltInterior, name: str, interior: Interior, doors: list[Opening], windows: list[Opening]) -> None:
    plan, wall, origin = found.plan, interior.wall, found.corner
    floors = floor_blocks(plan, wall=wall, thickness=SLAB)
    floor: dict[str, tuple[Block, str | None]] = {k: (b, KINDS[interior.rooms[k].kind].floor) for k, b in floors.items()}
    found.entities[f"{name}_floor"] = _block_entity("floor of the rooms", "oak", floor, origin)
    raised = [
        Block((b.low[0], b.low[1], b.low[2] + LOOSE), b.high) if b.low[2] == 0.0 else b
        for b in wall_blocks(plan, [*doors, *windows], wall=wall, height=interior.height)
    ]
    walls: dict[str, tuple[Block, str | None]] = {f"wall_{k + 1}": (b, None) for k, b in enumerate(raised)}
    found.entities[f"{name}_walls"] = _block_entity("walls between the rooms", "gypsum_plaster", walls, origin)
    found.relations[f"{name}_walls_stand"] = {"kind": "supports", "a": f"{name}_floor", "b": f"{name}_walls"}
    if interior.ceiling:
        slab = {
            k: (Block((*b.low[:2], interior.height + LOOSE), (*b.high[:2], interior.height + SLAB)), None)
            for k, b in floors.items()
        }
        found.entities[f"{name}_ceiling"] = _block_entity("ceiling of the rooms", "gypsum_plaster", slab, origin)  # type: ignore[arg-type]
        found.relations[f"{name}_ceiling_lies"] = {"kind": "supports", "a": f"{name}_walls", "b": f"{name}_ceiling"}


def _asset(
    found: BuiltInterior, key: str, own: Piece, pose: RigidPose, *, motion: str, positions: dict[str, float] | None = None
) -> None:
    record: dict[str, Any] = {"generator": own.generator, "parameters": dict(own.parameters), "seed": own.seed}
    if positions:
        record["positions"] = positions
    boxes = None if positions else own.boxes
    documents = asset_documents(key, record, posed(own.made, positions or {}), pose, motion=motion, boxes=boxes)
    found.entities |= documents.entities
    found.joints |= documents.joints
    found.relations |= documents.relations


def _hang_door(found: BuiltInterior, name: str, interior: Interior, door: Opening, rng: np.random.Generator) -> None:
    """A door in its opening, ajar into the room that it belongs to."""
    parameters = {
        "width": interior.door, "height": DOOR_HEIGHT, "depth": round(interior.wall + 2 * LOOSE, 6),
        "hinged": hinge(door, found.plan.rooms[door.rooms[0]]), "style": "panelled" if door.rooms[1] != OUTSIDE else "planks",
    }  # fmt: skip
    own = made_piece("door", parameters, int(rng.integers(2**31)))
    _asset(
        found, f"{name}_{door.id}_door", own, _in_wall(found, interior, door, LOOSE), motion="static", positions={"leaf": AJAR}
    )
    found.relations[f"{name}_{door.id}_door_set"] = {"kind": "supports", "a": f"{name}_floor", "b": f"{name}_{door.id}_door"}


def _set_window(found: BuiltInterior, name: str, interior: Interior, window: Opening) -> None:
    height = WINDOW_HEAD - SILL - 2 * JAMB - 2 * LOOSE
    parameters = {
        "width": round(window.width - 2 * JAMB - 2 * LOOSE, 6), "height": round(height, 6), "depth": round(interior.wall + 2 * LOOSE, 6),
        "sashes": 2 if window.width > 0.9 else 1,
    }  # fmt: skip
    own = made_piece("window", parameters, interior.seed)
    _asset(found, f"{name}_{window.id}_window", own, _in_wall(found, interior, window, SILL + LOOSE), motion="static")
    found.relations[f"{name}_{window.id}_window_set"] = {
        "kind": "supports",
        "a": f"{name}_walls",
        "b": f"{name}_{window.id}_window",
    }


def _in_wall(found: BuiltInterior, interior: Interior, opening: Opening, z: float) -> RigidPose:
    """Pose of what stands in an opening, its front (-y) towards the room that it belongs to."""
    origin, rect = found.corner, found.plan.rooms[opening.rooms[0]]
    x, y = opening.center
    middle = ((rect.x0 + rect.x1) / 2, (rect.y0 + rect.y1) / 2)
    quarter = (0 if middle[1] < y else 2) if opening.along == "x" else (3 if middle[0] < x else 1)
    position = np.array([origin[0] + x, origin[1] + y, origin[2] + z])
    # Front -y: a quarter turn brings it to +x, two to +y, three to -x.
    return RigidPose(position, euler_to_quaternion((0.0, 0.0, quarter * math.pi / 2)))


class _Supply(NamedTuple):
    """Things of a room: where they are taken from, how densely they lie, and random numbers for their places."""

    stock: Stock
    density: float
    rng: np.random.Generator


def _furnish(found: BuiltInterior, frame: Frame, asked: Room, space: FloorSpace, supply: _Supply, name: str) -> None:
    x0, y0, z0 = found.corner
    rect, room = space.room, frame.id.removeprefix(f"{name}_")
    found.regions[frame.id] = {
        "kind": "box",
        "min": _numbers((x0 + rect.x0, y0 + rect.y0, z0)),
        "max": _numbers((x0 + rect.x1, y0 + rect.y1, z0 + frame.height)),
    }
    standing: list[Standing] = []
    if asked.furniture:
        kind = KINDS[asked.kind]
        filled = furnished(frame, kind, space, supply.stock, density=supply.density, rng=supply.rng, things=asked.things)
        standing = filled.standing
        found.lacking += filled.lacking
        found.left_out += filled.left_out
    for thing in standing:
        pose = RigidPose(np.array([x0 + thing.x, y0 + thing.y, z0 + thing.z]), euler_to_quaternion((0.0, 0.0, thing.yaw)))
        _asset(found, thing.id, thing.piece, pose, motion="static" if thing.still else generator(thing.piece.generator).motion)
        carrier = f"{name}_{thing.carrier}" if thing.carrier in ("floor", "walls") else body_id(thing.carrier, thing.body)
        for foot in feet(thing.piece.made, thing.piece.boxes, stands=generator(thing.piece.generator).stands):
            own = body_id(thing.id, foot)
            found.relations[f"{own}_stands"] = {"kind": "supports", "a": carrier, "b": own}
    found.rooms[room] = {
        "kind": asked.kind,
        "size": [round(rect.x1 - rect.x0, 3), round(rect.y1 - rect.y0, 3)],
        "things": len(standing),
        "generators": len({t.piece.generator for t in standing}),
    }


def _beside(opening: Opening, rect: Rect, wall: float) -> bool:
    """True if an opening is in a wall of a room."""
    hole = opening.plan(wall)
    return hole.x0 <= rect.x1 + 1e-6 and hole.x1 >= rect.x0 - 1e-6 and hole.y0 <= rect.y1 + 1e-6 and hole.y1 >= rect.y0 - 1e-6


def _routes(found: BuiltInterior, name: str, interior: Interior, pairs: list[tuple[str, str]]) -> None:
    """That one can walk through every door inside."""
    for a, b in pairs:
        if b != OUTSIDE:
            found.relations[f"{name}_{a}_to_{b}"] = {
                "kind": "connects", "a": f"{name}_{a}", "b": f"{name}_{b}", "width": LEAST_ROUTE, "headroom": 1.95,
            }  # fmt: skip
