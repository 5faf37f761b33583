"""Simulation plan: solver instances, joints, drivers, couplings, limits (R18, R30, R61, R66, R76-R80)."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, get_args

from pydantic import Field, model_validator

from ..categories.cloth.models import ClothInstance
from ..categories.liquid.models import DfsphInstance, FlipInstance, InflowDriver, OutflowDriver, WavesDriver
from ..categories.particles.models import BallisticInstance, DemInstance, EmitterDriver
from ..vocabulary import (
    EntityRef,
    Finite,
    Id,
    JointRef,
    NonNegative,
    Positive,
    SolverRef,
    SpecModel,
    Vec3,
)
from .fields import FieldDriver
from .shapes import Pose

__all__ = [
    "MOVED",
    "BallJoint",
    "ContactPair",
    "Coupling",
    "DetachDriver",
    "Driver",
    "ForceDriver",
    "HingeJoint",
    "Joint",
    "Limits",
    "LiquidInstance",
    "MotorDriver",
    "ParticleInstance",
    "PathDriver",
    "PathKey",
    "ReleaseDriver",
    "RigidInstance",
    "RigidSettings",
    "SimulationPlan",
    "SlideJoint",
    "SolverInstance",
    "SpringJoint",
    "WeldJoint",
]


Ratio = Annotated[float, Field(ge=1e-4, le=1e4)]


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


class RigidInstance(SpecModel):
    """A running rigid engine and the entities it moves or collides with."""

    moves: ClassVar[tuple[str, ...]] = ("rigid", "elastic")
    engine: Literal["mujoco"]
    members: Annotated[list[EntityRef], Field(min_length=1, max_length=20000)]
    settings: RigidSettings = RigidSettings()


SolverInstance = Annotated[
    RigidInstance | DfsphInstance | FlipInstance | ClothInstance | DemInstance | BallisticInstance, Field(discriminator="engine")
]
LiquidInstance = DfsphInstance | FlipInstance
ParticleInstance = DemInstance | BallisticInstance
MOVED: tuple[str, ...] = tuple(dict.fromkeys(c for i in get_args(get_args(SolverInstance)[0]) for c in i.moves))
"""Categories that some engine of this build moves."""


class _Joint(SpecModel):
    parent: EntityRef | None = Field(default=None, description="default: the world")
    child: EntityRef
    anchor: Vec3 = Field(description="world coordinates at frame 0 [m], on or in both bodies (a hinge: some point of its axis)")
    damping: NonNegative = Field(default=0.0, description="[N m s/rad] or [N s/m]")
    stiffness: NonNegative = Field(default=0.0, description="spring towards the initial position [N m/rad] or [N/m]")
    collide: bool = Field(default=False, description="whether parent and child collide with each other")


class HingeJoint(_Joint):
    """One rotation about `axis` through `anchor`."""

    kind: Literal["hinge"] = "hinge"
    axis: Vec3
    range: tuple[Finite, Finite] | None = Field(default=None, description="[rad]")
    friction: NonNegative = Field(default=0.0, description="dry friction torque [N m]")


class SlideJoint(_Joint):
    """One translation along `axis`."""

    kind: Literal["slide"] = "slide"
    axis: Vec3
    range: tuple[Finite, Finite] | None = Field(default=None, description="[m]")
    friction: NonNegative = Field(default=0.0, description="dry friction force [N]")


class BallJoint(_Joint):
    """Three rotations about `anchor`."""

    kind: Literal["ball"] = "ball"


class WeldJoint(_Joint):
    """No relative motion, until a `detach` driver opens it."""

    kind: Literal["weld"] = "weld"


class SpringJoint(SpecModel):
    """Linear spring between a point of the child and a point of the parent; with `rope`, it only pulls."""

    kind: Literal["spring"] = "spring"
    parent: EntityRef | None = None
    child: EntityRef
    parent_point: Vec3 = Field(description="world coordinates at frame 0 [m], on or in the parent")
    child_point: Vec3 = Field(description="world coordinates at frame 0 [m], on or in the child")
    stiffness: Positive = Field(description="[N/m]")
    damping: NonNegative = Field(default=0.0, description="[N s/m]")
    rest_length: NonNegative | None = Field(default=None, description="[m]; default the initial distance")
    rope: bool = False


Joint = Annotated[HingeJoint | SlideJoint | BallJoint | WeldJoint | SpringJoint, Field(discriminator="kind")]


class ReleaseDriver(SpecModel):
    """Holds the entity where it is at frame 0 and lets go at `time`."""

    kind: Literal["release"] = "release"
    entity: EntityRef
    time: NonNegative = Field(description="[s]")


class PathKey(SpecModel):
    """Pose at a time."""

    time: NonNegative
    pose: Pose


class PathDriver(SpecModel):
    """Moves a kinematic entity along poses (shape-preserving cubic in position, slerp in rotation)."""

    kind: Literal["path"] = "path"
    entity: EntityRef
    keys: Annotated[dict[Id, PathKey], Field(min_length=2, max_length=200)]


class ForceDriver(SpecModel):
    """Constant force and torque on an entity during [start, end) seconds."""

    kind: Literal["force"] = "force"
    entity: EntityRef
    force: Vec3 = (0, 0, 0)
    torque: Vec3 = (0, 0, 0)
    start: NonNegative = 0.0
    end: Positive

    @model_validator(mode="after")
    def _ordered(self) -> ForceDriver:
        if self.end <= self.start:
            raise ValueError("end must be > start")
        return self


class MotorDriver(SpecModel):
    """Drives a hinge or slide towards a velocity with at most `max_effort` during [start, end) seconds."""

    kind: Literal["motor"] = "motor"
    joint: JointRef
    velocity: Finite = Field(description="[rad/s] or [m/s]")
    max_effort: Positive = Field(description="[N m] or [N]")
    start: NonNegative = 0.0
    end: Positive


class DetachDriver(SpecModel):
    """Opens a weld or cuts a spring or rope at `time`."""

    kind: Literal["detach"] = "detach"
    joint: JointRef
    time: NonNegative


Driver = Annotated[
    ReleaseDriver
    | PathDriver
    | ForceDriver
    | MotorDriver
    | DetachDriver
    | FieldDriver
    | EmitterDriver
    | InflowDriver
    | OutflowDriver
    | WavesDriver,
    Field(discriminator="kind"),
]


class ContactPair(SpecModel):
    """Own friction and restitution for contacts between two entities."""

    a: EntityRef
    b: EntityRef
    friction: NonNegative | None = Field(default=None, le=4)
    restitution: float | None = Field(default=None, ge=0, le=1)


class Coupling(SpecModel):
    """Exchange between two solver instances (R66); `one_way` is an approximation and recorded as one.

    A liquid that carries bodies needs `two_way` with their rigid instance; without a coupling it only reads their motion.
    """

    source: SolverRef
    target: SolverRef
    direction: Literal["one_way", "two_way"]
    variables: Annotated[list[Literal["motion", "wrench", "pressure", "heat", "mass"]], Field(min_length=1)]


class Limits(SpecModel):
    """Bounds of checks where the paper is silent (S2-S10). Widening one after a failure is a weakening edit.

    A bound looser than its default stands in the verdict's register, from the start or not, and no bound may be looser than its
    range here.
    """

    # Own choice: a coin (2 cm) beside a hill (200 m) is 1 : 10 000; more is an error of units.
    scale_ratio: tuple[Ratio, Ratio] = Field(
        default=(0.002, 500.0), description="S2: size ratio of related entities, 1e-4 to 1e4"
    )
    # 1 cm is seen as a gap on whatever one can lift.
    contact_gap: float = Field(
        default=0.003, gt=0, le=0.01, description="S3: largest gap that counts as actual contact [m]; at least the two skins"
    )
    # Nothing that this build simulates is faster than a rifle bullet (about 1200 m/s, NATO 5.56 x 45 mm at 940).
    max_speed: float = Field(default=60.0, gt=0, le=1500, description="S6: [m/s]")
    # A fifth of all energy out of nothing is seen by anyone; 5 cm of creep is walking.
    energy_growth: float = Field(default=0.02, gt=0, le=0.2, description="S11: unexplained energy gain / energy scale")
    support_drift: float = Field(default=0.005, gt=0, le=0.05, description="how far a supported body may creep [m]")
    # 1e-4 of 640 x 360 is a dot of 23 pixels; below a twentieth seen, or in view, nobody can tell what it was.
    visible_pixels: float = Field(
        default=0.0004, ge=1e-4, le=0.5, description="S9: smallest share of the picture a subject must fill"
    )
    visible_share: float = Field(
        default=0.25, ge=0.05, le=1, description="S9: smallest unoccluded share of a subject, over the beat's best frame"
    )
    beat_seen_frames: float = Field(
        default=0.3, ge=0.05, le=1, description="S10: share of a beat's frames with its subject in view"
    )


class SimulationPlan(SpecModel):
    """Everything that decides the motion."""

    fps: int = Field(default=24, ge=1, le=240)
    frames: int = Field(ge=2, le=20000, description="number of frames; frame k is the state at k / fps seconds")
    preroll: float = Field(default=0.0, ge=0, le=60, description="simulated before frame 0, with held bodies held [s]")
    gravity: Vec3 = (0.0, 0.0, -9.81)
    seed: int = Field(default=0, ge=0, lt=2**31)
    solvers: Annotated[dict[Id, SolverInstance], Field(max_length=16)] = {}
    order: list[SolverRef] = Field(default=[], description="bake order; default: derived from couplings")
    joints: Annotated[dict[Id, Joint], Field(max_length=5000)] = {}
    drivers: Annotated[dict[Id, Driver], Field(max_length=1000)] = {}
    contacts: Annotated[dict[Id, ContactPair], Field(max_length=5000)] = {}
    couplings: Annotated[dict[Id, Coupling], Field(max_length=64)] = {}
    limits: Limits = Limits()

    @property
    def cloth(self) -> dict[str, ClothInstance]:
        """Cloth instances by id."""
        return {k: s for k, s in self.solvers.items() if isinstance(s, ClothInstance)}

    @property
    def rigid(self) -> dict[str, RigidInstance]:
        """Rigid instances by id."""
        return {k: s for k, s in self.solvers.items() if isinstance(s, RigidInstance)}

    @property
    def liquid(self) -> dict[str, LiquidInstance]:
        """Liquid instances by id."""
        return {k: s for k, s in self.solvers.items() if isinstance(s, DfsphInstance | FlipInstance)}

    @property
    def particles(self) -> dict[str, ParticleInstance]:
        """Instances of grains and of flying particles by id."""
        return {k: s for k, s in self.solvers.items() if isinstance(s, DemInstance | BallisticInstance)}
