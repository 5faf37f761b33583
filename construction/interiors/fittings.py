"""Doors and windows in the openings of walls."""

from __future__ import annotations

import math

import numpy as np

from ...worlds.arrays import RigidPose, euler_to_quaternion
from ...worlds.spec import Interior
from .built import LOOSE, BuiltInterior, put_asset, suffix
from .layout import DOOR_HEIGHT, JAMB, Storey, gate_of
from .pieces import made_piece
from .plans import OUTSIDE
from .walls import Opening, hinge

__all__ = ["hang_door", "set_window"]

AJAR = 1.4
"""[rad] How far doors stand open, so that one can walk through: 80 degrees."""


def hang_door(
    found: BuiltInterior, name: str, interior: Interior, storey: Storey, door: Opening, rng: np.random.Generator
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
    put_asset(found, key, own, _in_wall(found, storey, door), motion="static", positions=positions)
    found.supports(f"{key}_set", f"{name}_floor{suffix(storey.number)}", key)


def set_window(found: BuiltInterior, name: str, interior: Interior, storey: Storey, window: Opening) -> None:
    """A window in its opening."""
    height = window.head - window.sill - 2 * JAMB - 2 * LOOSE
    parameters = {
        "width": round(window.width - 2 * JAMB - 2 * LOOSE, 6), "height": round(height, 6), "depth": round(interior.wall + 2 * LOOSE, 6),
        "sashes": 2 if window.width > 0.9 else 1,
    }  # fmt: skip
    own = made_piece("window", parameters, interior.seed)
    key = f"{name}_{window.id}_window"
    put_asset(found, key, own, _in_wall(found, storey, window), motion="static")
    found.supports(f"{key}_set", f"{name}_walls{suffix(storey.number)}", key)


def _in_wall(found: BuiltInterior, storey: Storey, opening: Opening) -> RigidPose:
    """Pose of what stands in an opening, its front (-y) towards the room that it belongs to."""
    rect = storey.plan.rooms[opening.rooms[0]]
    x, y = opening.center
    middle = ((rect.x0 + rect.x1) / 2, (rect.y0 + rect.y1) / 2)
    quarter = (0 if middle[1] < y else 2) if opening.along == "x" else (3 if middle[0] < x else 1)
    position = np.array(found.place(x, y, storey.z + opening.sill + LOOSE))
    # Front -y: a quarter turn brings it to +x, two to +y, three to -x.
    return RigidPose(position, euler_to_quaternion((0.0, 0.0, quarter * math.pi / 2)))
