"""Doors and windows in the openings of walls."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...worlds.arrays import RigidPose, euler_to_quaternion
from ...worlds.spec import Interior
from .arrangement import Fixture
from .built import LOOSE, BuiltInterior, put_asset, suffix
from .floor_space import FloorSpace
from .layout import DOOR_HEIGHT, JAMB, Storey, gate_of
from .pieces import made_piece
from .plans import OUTSIDE, Rect
from .stilled import Still
from .swept import Volume
from .walls import Opening, hinge

__all__ = ["hang_door", "set_window", "windows_in"]

AJAR = 1.4
"""[rad] How far doors stand open, so that one can walk through: 80 degrees."""


def hang_door(
    found: BuiltInterior, name: str, interior: Interior, storey: Storey, door: Opening, rng: np.random.Generator, still: Still
) -> None:
    """A door in its opening, ajar into the room that it belongs to."""
    gate = gate_of(interior, *door.rooms)
    style = "panelled" if door.rooms[1] != OUTSIDE else "planks"
    depth = round(interior.wall + 2 * LOOSE, 6)
    hinged = hinge(door, storey.plan.rooms[door.rooms[0]])
    if gate is None:
        parameters = {"width": interior.door, "height": DOOR_HEIGHT, "depth": depth, "hinged": hinged, "style": style}
        own, positions = made_piece("door", parameters, int(rng.integers(2**31))), {"leaf": AJAR}
    else:
        parameters = {"width": gate[0], "height": gate[1], "depth": depth, "style": style}
        own, positions = made_piece("double_door", parameters, int(rng.integers(2**31))), {"left": AJAR, "right": AJAR}
    key = f"{name}_{door.id}_door"
    fixed = still.of(key, own.generator, *door.rooms)
    put_asset(found, key, own, _in_wall(found, storey, door), motion="static", positions=positions, fixed=fixed)
    found.supports(f"{key}_set", f"{name}_floor{suffix(storey.number)}", key)


def set_window(found: BuiltInterior, name: str, interior: Interior, storey: Storey, window: Opening, still: Still) -> None:
    """A window in its opening."""
    own = made_piece("window", _window_parameters(window, interior.wall), interior.seed)
    key = f"{name}_{window.id}_window"
    fixed = still.of(key, own.generator, *window.rooms)
    put_asset(found, key, own, _in_wall(found, storey, window), motion="static", fixed=fixed)
    found.supports(f"{key}_set", f"{name}_walls{suffix(storey.number)}", key)


def windows_in(space: FloorSpace) -> list[Fixture]:
    """Windows of a room as what is furnished meets them."""
    found = []
    for window in (o for o in space.openings if o.kind == "window"):
        own, (x, y) = made_piece("window", _window_parameters(window, space.wall), 0), window.center
        at = (x, y, window.sill + LOOSE, _quarter(window, space.beside(window)) * math.pi / 2)
        low, high = (np.concatenate([corners[k] for corners in own.parts.values()]) for k in (0, 1))
        found.append(Fixture("window", Volume(low, high).placed(*at), own.swept.placed(*at)))
    return found


def _window_parameters(window: Opening, wall: float) -> dict[str, Any]:
    return {
        "width": round(window.width - 2 * JAMB - 2 * LOOSE, 6),
        "height": round(window.head - window.sill - 2 * JAMB - 2 * LOOSE, 6),
        "depth": round(wall + 2 * LOOSE, 6),
        "sashes": 2 if window.width > 0.9 else 1,
    }


def _quarter(opening: Opening, room: Rect) -> int:
    """Quarter turns of what stands in an opening, its front (-y) towards a room: one brings it to +x, two to +y, three to -x."""
    x, y = opening.center
    if opening.along == "x":
        return 0 if (room.y0 + room.y1) / 2 < y else 2
    return 3 if (room.x0 + room.x1) / 2 < x else 1


def _in_wall(found: BuiltInterior, storey: Storey, opening: Opening) -> RigidPose:
    """Pose of what stands in an opening, its front towards the room that it belongs to."""
    (x, y), quarter = opening.center, _quarter(opening, storey.plan.rooms[opening.rooms[0]])
    position = np.array(found.place(x, y, storey.z + opening.sill + LOOSE))
    return RigidPose(position, euler_to_quaternion((0.0, 0.0, quarter * math.pi / 2)))
