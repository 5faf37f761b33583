"""Rigid bodies."""

from __future__ import annotations

from ...parameters import DRIVER, PHYSICS, POSE, SETTINGS, parameters
from ..category import CategorySpec
from ..resting import two_skins
from ..shared import LINEAR_VELOCITY, STEPS
from .channels import CHANNELS, DIMENSIONS, writers
from .facts import body_count, collision_pieces, rigid_counts, rigid_seconds
from .masses import mass_problems
from .models import DetachDriver, ForceDriver, MotorDriver, PathDriver, RigidInstance, RigidPhysics

__all__ = ["RIGID"]

_LAWS = "rows hold the motion against laws"
RIGID = CategorySpec(
    name="rigid",
    shape=RigidPhysics.shape,
    covers="rigid bodies, joints, ropes of links, drivers",
    physics=RigidPhysics,
    instances=(RigidInstance,),
    drivers=(ForceDriver, PathDriver, MotorDriver, DetachDriver),
    parameters=(
        *parameters(PHYSICS, "mass hollow", "mass", "repair", "by default density times volume", physical=True),
        *parameters(PHYSICS, "linear_damping", "mass", "repair", "its loss stands in the energy rows"),
        *parameters(PHYSICS, "lift", "drivers", "repair", "its law stands in the register"),
        *parameters(PHYSICS, "angular_velocity", "initial_state", "repair", "the state at frame 0 and what holds it"),
        *LINEAR_VELOCITY,
        *STEPS,
        *parameters(SETTINGS, "skin contact_steps impratio speculative", "contact", "repair", _LAWS),
        *parameters(SETTINGS, "step tolerance sleep refine", "step", "repair", _LAWS),
        *parameters(
            DRIVER,
            "joint keys keys/* keys/*/time force torque velocity max_effort",
            "drivers",
            "repair",
            "drivers stand in the register",
        ),
        *parameters(f"{DRIVER}/keys/*/pose", POSE, "drivers", "repair", "drivers stand in the register"),
    ),
    channels=CHANNELS,
    dimensions=DIMENSIONS,
    writers=writers,
    estimate=rigid_counts,
    seconds=rigid_seconds,
    masses=mass_problems,
    bodies=body_count,
    pieces=collision_pieces,
    rest_way=two_skins,
    starts_alone=True,
)
