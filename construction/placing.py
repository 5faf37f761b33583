"""Poses by exact clearance: resting on something, beside it, turned to its sides."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..worlds.arrays import F64, RigidPose, quaternion_of, quaternion_product, rotation_matrix
from ..worlds.errors import InputError
from .scenes import Body, Scene, clearance

__all__ = ["approach", "beside", "frame_of", "lowered", "seat", "side_direction", "turned"]

TOLERANCE = 1e-6
"""Clearance to which a place is found [m]."""
MOST_STEPS = 2000
"""Steps of an approach: at 85 degrees each leaves nine tenths of the way."""


def approach(body: Body, pose: RigidPose, other: Body, there: RigidPose, direction: F64, gap: float) -> RigidPose | None:
    """The pose at which a body that comes along a unit direction from outside first has that clearance to another.

    Args:
        body: what comes.
        pose: its orientation, and the line on which its origin comes.
        other: what stands.
        there: where.
        direction: of the motion, a unit vector.
        gap: clearance [m].

    Returns:
        None where it passes by.
    """
    own, others = body.points(pose) @ direction, other.points(there) @ direction
    start = float(others.min() - own.max()) - gap - 1e-3
    way = float(np.ptp(own) + np.ptp(others)) + 2 * gap + float(np.ptp(own)) + 1.1e-2
    return lowered(body, RigidPose(pose.position + start * direction, pose.quaternion), other, there, direction, gap, way)


def lowered(
    body: Body, pose: RigidPose, other: Body, there: RigidPose, direction: F64, gap: float, most: float
) -> RigidPose | None:
    """As `approach`, from where the body is and at most so far [m]."""
    # Nothing is nearer than the clearance, so it may come by what that exceeds the gap: the first place where it closes.
    gone = 0.0
    for _ in range(MOST_STEPS):
        here = RigidPose(pose.position + gone * direction, pose.quaternion)
        left = clearance(body, here, other, there) - gap
        if left <= TOLERANCE:
            return here
        gone += left
        if gone > most:
            return None
    return RigidPose(pose.position + gone * direction, pose.quaternion)


def seat(scene: Scene, names: Sequence[str], body: Body, on: str, pose: RigidPose, *, above: float = 0.0) -> RigidPose:
    """Lower entities, as one body, along -z until they rest on another, the two skins and `above` [m] apart.

    Raises:
        InputError: they are not above the other one.
    """
    gap = scene.standing_gap(names, on) + above
    found, name = approach(body, pose, scene.body(on), scene.pose(on), np.array([0.0, 0.0, -1.0]), gap), names[0]
    if found is None:
        raise InputError(
            f"{name!r} at x, y = {pose.position[0]:.4g}, {pose.position[1]:.4g} m is not above {on!r}; give `at` over its surface"
        )
    return found


def beside(scene: Scene, body: Body, pose: RigidPose, other: str, side: str, gap: float, shift: float) -> RigidPose:
    """The pose beside another entity at the height that it has, or on top of it; both boxes in line with the side.

    Args:
        scene: the world.
        body: what is placed.
        pose: its orientation and height.
        other: the other entity.
        side: see `side_direction`.
        gap: free distance [m].
        shift: to the left as seen from the other one; on its top along its x [m].

    Raises:
        InputError: at this height the two pass each other.
    """
    there, made = scene.pose(other), scene.spec.entities[other].asset is not None
    away = side_direction(side, there, generated=made)
    left = np.cross([0.0, 0.0, 1.0], away) if side != "top" else side_direction("front", there)
    low, high = body.box(pose)
    other_low, other_high = scene.body(other).box(there)
    move = 0.5 * (other_low + other_high - low - high) * [1.0, 1.0, 0.0]
    found = approach(body, RigidPose(pose.position + move + shift * left, pose.quaternion), scene.body(other), there, -away, gap)
    if found is None:
        raise InputError(
            f"at its height of {pose.position[2]:.4g} m and shift {shift:g} m nothing of {other!r} is on its side {side!r}; "
            "give another shift, or on: what carries it"
        )
    return found


def side_direction(side: str, pose: RigidPose, *, generated: bool = False) -> F64:
    """Unit vector of a side: `+x` ... `-z` of the world; `front`, `back`, `left`, `right` by an entity's own x and y, level.

    The front of an entity is its own +x; of one that a generator made it is -y, from where it is used.
    """
    axes = {"x": [1.0, 0.0, 0.0], "y": [0.0, 1.0, 0.0], "z": [0.0, 0.0, 1.0]}
    if side[0] in "+-":
        return np.array(axes[side[1]]) * (1.0 if side[0] == "+" else -1.0)
    if side == "top":
        return np.array(axes["z"])
    front, left = ([0.0, -1.0, 0.0], axes["x"]) if generated else (axes["x"], axes["y"])
    own = np.array(front if side in ("front", "back") else left) * (1.0 if side in ("front", "left") else -1.0)
    level = (rotation_matrix(pose.quaternion) @ own)[:2]
    if np.linalg.norm(level) < 1e-6:
        raise InputError(
            f"the other entity is turned so that its {side!r} looks up or down; give a side of the world, '+x' to '-z'"
        )
    return np.array([*(level / np.linalg.norm(level)), 0.0])


def turned(pose: RigidPose, yaw: float) -> RigidPose:
    """The pose turned about z through its own origin by an angle [rad]."""
    turn = np.array([np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2)])
    return RigidPose(pose.position, quaternion_product(turn, pose.quaternion))


def frame_of(forward: F64) -> F64:
    """Quaternion of the level frame whose x looks along a horizontal direction."""
    x = np.array([forward[0], forward[1], 0.0]) / np.hypot(forward[0], forward[1])
    return quaternion_of(np.column_stack([x, [-x[1], x[0], 0.0], [0.0, 0.0, 1.0]]))
