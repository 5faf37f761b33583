"""Test that two surfaces are apart, without asking how deep they overlap where they are not: much cheaper than a clearance."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..worlds.arrays import RigidPose, rotation_matrix
from .inside import contains

if TYPE_CHECKING:
    from .solids import Solid

__all__ = ["apart"]


def apart(a: Solid, pose_a: RigidPose, b: Solid, pose_b: RigidPose, *, gap: float) -> bool:
    """True if the surfaces are at least `gap` [m], > 0, from each other and neither body holds a piece of the other.

    Args:
        a: one surface, in its own frame.
        pose_a: its pose in the world.
        b: the other surface.
        pose_b: its pose in the world.
        gap: [m]
    """
    import fcl

    first, second = (
        fcl.CollisionObject(s.bvh, fcl.Transform(rotation_matrix(p.quaternion), p.position))
        for s, p in ((a, pose_a), (b, pose_b))
    )
    if fcl.distance(first, second, fcl.DistanceRequest(), fcl.DistanceResult()) < gap:
        return False
    inside_b = contains(b, pose_b.inverse().apply(pose_a.apply(a.component_heads)))
    return not (inside_b.any() or contains(a, pose_a.inverse().apply(pose_b.apply(b.component_heads))).any())
