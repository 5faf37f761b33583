"""An asset with its joints at other positions than those it is made in: doors ajar, drawers pulled out."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ...worlds.arrays import F64, RigidPose, compose, pose_of, rotation_matrix
from ...worlds.errors import InputError
from ...worlds.shapes import Pose
from .made import Body, Joint, Made

__all__ = ["posed"]

DIGITS = 12
"""Decimals to which poses are kept: far below those that are written."""


def posed(made: Made, positions: Mapping[str, float]) -> Made:
    """The asset with joints moved, and what hangs on their children with them; ranges count from there.

    Args:
        made: the asset.
        positions: of hinges [rad] and slides [m], from where they were made, by joint.

    Raises:
        InputError: there is no such joint, or the position is out of its range.
    """
    for name, q in positions.items():
        joint = made.joints.get(name)
        if joint is None or joint.axis is None or joint.kind not in ("hinge", "slide"):
            raise InputError(f"there is no hinge or slide {name[:60]!r}; the asset has {sorted(made.joints)}")
        low, high = joint.range or (-math.inf, math.inf)
        if not low - 1e-9 <= q <= high + 1e-9:
            raise InputError(f"position {q:g} of joint {name!r} is out of its range [{low:.4g}, {high:.4g}] rad or m")
        if q:
            made = _moved(made, name, joint, q)
    return made


def _moved(made: Made, name: str, joint: Joint, q: float) -> Made:
    assert joint.axis is not None
    axis, anchor = np.array(joint.axis, dtype=np.float64), np.array(joint.anchor, dtype=np.float64)
    axis /= np.linalg.norm(axis)
    if joint.kind == "slide":
        motion = RigidPose(q * axis, np.array([1.0, 0.0, 0.0, 0.0]))
    else:
        turn = np.array([math.cos(q / 2), *(math.sin(q / 2) * axis)])
        motion = RigidPose(anchor - rotation_matrix(turn) @ anchor, turn)
    moving = {joint.child}
    for _ in made.joints:
        moving |= {j.child for j in made.joints.values() if j.parent in moving}
    bodies = {k: _at(b, motion) if k in moving else b for k, b in made.bodies.items()}
    joints = {k: _carried(j, motion) if j.parent in moving else j for k, j in made.joints.items()}
    shifted = None if joint.range is None else (joint.range[0] - q, joint.range[1] - q)
    joints[name] = replace(joint, range=shifted)
    places = {
        k: replace(p, center=motion.apply(np.array([p.center], dtype=np.float64))[0]) if p.body in moving else p
        for k, p in made.places.items()
    }
    return replace(made, bodies=bodies, joints=joints, places=places)


def _at(body: Body, motion: RigidPose) -> Body:
    parts = {}
    for name, part in body.parts.items():
        pose = compose(motion, pose_of(part.pose))
        placed = Pose(position=_numbers(pose.position), quaternion=tuple(round(float(v), DIGITS) for v in pose.quaternion))
        parts[name] = part.model_copy(update={"pose": placed})
    return replace(body, parts=parts)


def _carried(joint: Joint, motion: RigidPose) -> Joint:
    turn = rotation_matrix(motion.quaternion)
    axis = None if joint.axis is None else turn @ np.array(joint.axis, dtype=np.float64)
    return replace(joint, anchor=motion.apply(np.array([joint.anchor], dtype=np.float64))[0], axis=axis)


def _numbers(values: F64) -> tuple[float, float, float]:
    x, y, z = (round(float(v), DIGITS) + 0.0 for v in values)
    return (x, y, z)
