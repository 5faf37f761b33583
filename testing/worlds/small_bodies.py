"""Small worlds of rigid and breakable bodies: a ball and a door in the wind, a brick wall that a ball strikes."""

from __future__ import annotations

from ...worlds.categories.fracture.models import Bond, Breakable, BrickPattern
from ...worlds.categories.rigid.joints import HingeJoint
from ...worlds.categories.rigid.models import RigidPhysics
from ...worlds.spec import FieldDriver, Material, RigidSettings, WorldSpec
from .small_worlds import ball, box, ground, world

__all__ = ["door_spec", "struck_wall_spec"]


def door_spec(*, frames: int = 24) -> WorldSpec:
    """A ball that rolls, and a door on a post, in the wind."""
    entities = {
        "ground": ground(),
        "ball": ball(0.1, motion="dynamic", at=(1, 0, 0.11), velocity=(0.5, 0, 0)),
        "post": box(0.05, 0.05, 2.0, at=(0, 0, 1.0)),
        "door": box(0.6, 0.04, 1.0, motion="dynamic", at=(0.4, 0, 1)),
    }
    hinge = HingeJoint(parent="post", child="door", axis=(0, 0, 1), anchor=(0, 0, 1))
    wind = FieldDriver.model_validate({"kind": "field", "field": {"kind": "wind", "velocity": [2.0, 0.0, 0.0]}})
    return world(entities, frames=frames, joints={"hinge": hinge}, drivers={"wind": wind})


def struck_wall_spec(*, frames: int = 24, speed: float = 12.0, tension: float = 1e4) -> WorldSpec:
    """A wall of bricks on the ground, bonded at its foot, and an iron ball that flies at its middle."""
    pattern = BrickPattern(size=(0.25, 0.12, 0.08), joint=0.01)
    broken = Breakable(pattern=pattern, bond=Bond(tension=tension, shear=1.5 * tension), fixed=["z-"])
    entities = {
        "floor": ground(),
        "wall": box(0.75, 0.12, 0.4, motion="dynamic", at=(0, 0, 0.201), material="brick", breakable=broken),
        "ball": ball(
            0.05, motion="dynamic", at=(0.01, -0.3, 0.24), material="iron", physics=RigidPhysics(linear_velocity=(0, speed, 0))
        ),
    }
    materials = {
        "wood": Material(density=600.0),
        "brick": Material(density=1800.0, friction=0.6),
        "iron": Material(density=7200.0, friction=0.4),
    }
    return world(entities, frames=frames, materials=materials, settings=RigidSettings(refine=1))
