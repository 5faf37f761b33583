"""Rigid bodies, the instance that moves them, and their drivers (R27, R61)."""

from __future__ import annotations

import itertools
import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from ...matter import DriverBase, Instance, Matter, MatterShape, TimedDriver
from ...shapes import Pose
from ...vocabulary import EntityRef, Finite, Id, JointRef, NonNegative, Positive, SpecModel, Vec3

__all__ = [
    "DetachDriver",
    "ForceDriver",
    "MotorDriver",
    "PathDriver",
    "PathKey",
    "RigidInstance",
    "RigidPhysics",
    "RigidSettings",
]


AHEAD = 1e-3
"""The spin of a path at a time is taken from its turn within this time ahead [s]."""


class RigidPhysics(Matter):
    """Rigid body."""

    shape: ClassVar[MatterShape] = "solid"
    feels_fields: ClassVar[bool] = True
    body: ClassVar[bool] = True
    category: Literal["rigid"] = "rigid"
    mass: Positive | None = Field(
        default=None, description="[kg]; default: density x volume; within the substance's range of densities x volume"
    )
    hollow: bool = Field(
        default=False,
        description="closed shell around air: may weigh as little as a wall of 0.1 mm; listed",
    )
    linear_velocity: Vec3 = Field(default=(0, 0, 0), description="at frame 0, of the centre of mass [m/s]")
    angular_velocity: Vec3 = Field(default=(0, 0, 0), description="at frame 0, world axes [rad/s]")
    linear_damping: NonNegative = Field(default=0.0, description="viscous drag on the body [N s/m]")
    lift: bool = Field(
        default=False,
        description="true: wind, or a gas that carries it, also pushes it across the flow and turns it, by the law of plates as far as its hull is flat: card, "
        "leaf, roof tile; the medium's coefficient is then that across the flow, of a plate 1.15",
    )

    @property
    def lifted(self) -> bool:
        """True if a medium pushes it across the flow too."""
        return self.lift

    def geometry(self) -> dict[str, Any]:
        """The declared mass."""
        return {"mass": self.mass}


class RigidSettings(SpecModel):
    """Settings of a MuJoCo instance."""

    step: float = Field(default=5e-4, ge=2e-5, le=5e-3, description="time step [s]")
    skin: float = Field(
        default=5e-4, ge=0, le=0.02, description="collision skin of every part [m]; contacts act at the sum of two"
    )
    contact_steps: float = Field(
        default=10.0,
        ge=2.0,
        le=40.0,
        description="how slowly depth inside the skins is pushed out: natural period / 2 pi, in steps",
    )
    impratio: float = Field(default=20.0, ge=1, le=1000, description="friction to normal impedance ratio")
    iterations: int = Field(default=60, ge=5, le=1000)
    tolerance: float = Field(default=1e-8, ge=0, le=1e-4)
    sleep: bool = Field(default=True, description="islands at rest are put to sleep")
    speculative: bool = Field(default=False, description="contacts ahead of time for fast thin bodies")
    refine: int = Field(default=3, ge=0, le=6, description="most halvings of the step within one frame that would overlap")


class RigidInstance(Instance):
    """A running rigid engine and the entities it moves or collides with."""

    moves: ClassVar[tuple[str, ...]] = ("rigid", "elastic")
    engine: Literal["mujoco"]
    members: Annotated[list[EntityRef], Field(min_length=1, max_length=20000)]
    settings: RigidSettings = RigidSettings()


class PathKey(SpecModel):
    """Pose at a time."""

    time: NonNegative
    pose: Pose


class PathDriver(DriverBase):
    """Moves a kinematic entity along poses (shape-preserving cubic in position, slerp in rotation)."""

    kind: Literal["path"] = "path"
    entity: EntityRef
    keys: Annotated[dict[Id, PathKey], Field(min_length=2, max_length=200)]

    @property
    def begins(self) -> float:
        """When its poses first change [s]: leading keys with equal poses are a wait."""
        keys = sorted(self.keys.values(), key=lambda k: k.time)
        start = keys[0].time
        for before, after in itertools.pairwise(keys):
            if before.pose != keys[0].pose or after.pose != keys[0].pose:
                break
            start = after.time
        return start

    def alike_until(self, other: DriverBase | None) -> float:
        """As of every driver; a path is the same up to the last key but one that both have at their start, and while both wait.

        The slope at a key follows from its neighbours, at the first one from the first three; the spin looks ahead by less than `AHEAD`.
        """
        if not isinstance(other, PathDriver) or self.entity != other.entity:
            return 0.0
        one, two = (sorted(d.keys.values(), key=lambda k: k.time) for d in (self, other))
        if one == two:
            return math.inf
        same = [a for a, _ in itertools.takewhile(lambda pair: pair[0] == pair[1], zip(one, two, strict=False))]
        waits = [k.time for k in itertools.takewhile(lambda k: k.pose == same[0].pose, same)] if same else []
        times = [waits[-1]] if len(waits) > 1 else []
        times += [min(same[-2].time, same[-1].time - AHEAD)] if len(same) > 2 else []
        return max(0.0, max(times, default=0.0) - AHEAD)


class ForceDriver(TimedDriver):
    """Constant force and torque on an entity during [start, end) seconds."""

    later: ClassVar[frozenset[str]] = frozenset({"entity", "force", "torque", "start", "end"})
    absent: ClassVar[frozenset[str]] = frozenset({"force", "torque"})
    switched: ClassVar[bool] = True
    kind: Literal["force"] = "force"
    entity: EntityRef
    force: Vec3 = (0, 0, 0)
    torque: Vec3 = (0, 0, 0)
    start: NonNegative = 0.0
    end: Positive

    def alike_until(self, other: DriverBase | None) -> float:
        """As of every driver; a body without it has the same model."""
        return self.start if other is None else super().alike_until(other)


class MotorDriver(DriverBase):
    """Drives a hinge or slide towards a velocity with at most `max_effort` during [start, end) seconds."""

    later: ClassVar[frozenset[str]] = frozenset({"start", "end"})
    switched: ClassVar[bool] = True
    kind: Literal["motor"] = "motor"
    joint: JointRef
    velocity: Finite = Field(description="[rad/s] or [m/s]")
    max_effort: Positive = Field(description="[N m] or [N]")
    start: NonNegative = 0.0
    end: Positive


class DetachDriver(DriverBase):
    """Opens a weld or cuts a spring or rope at `time`."""

    later: ClassVar[frozenset[str]] = frozenset({"time"})
    switched: ClassVar[bool] = True
    kind: Literal["detach"] = "detach"
    joint: JointRef
    time: NonNegative
