"""Simulation plan: solver instances, joints, drivers, couplings, limits (R18, R30, R61, R66, R76-R80)."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal, Self, get_args

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from ..categories.cloth.models import ClothInstance
from ..categories.gas.models import DustDriver, EmissionDriver, GasInstance, IgnitionDriver, SteamDriver
from ..categories.liquid.models import DfsphInstance, FlipInstance, InflowDriver, OutflowDriver, WavesDriver
from ..categories.particles.models import BallisticInstance, DemInstance, EmitterDriver
from ..categories.rigid.joints import BallJoint, HingeJoint, SlideJoint, SpringJoint, WeldJoint
from ..categories.rigid.models import DetachDriver, ForceDriver, MotorDriver, PathDriver, RigidInstance
from ..matter import DriverBase
from ..vocabulary import (
    EntityRef,
    Id,
    NonNegative,
    SolverRef,
    SpecModel,
    Vec3,
)
from .fields import FieldDriver
from .surfaces import STATIC_FRICTION, check_static_friction

__all__ = [
    "MOVED",
    "ContactPair",
    "Coupling",
    "Driver",
    "Joint",
    "Limits",
    "LiquidInstance",
    "ParticleInstance",
    "ReleaseDriver",
    "Settle",
    "SimulationPlan",
    "SolverInstance",
]


Ratio = Annotated[float, Field(ge=1e-4, le=1e4)]


SolverInstance = Annotated[
    RigidInstance
    | DfsphInstance
    | FlipInstance
    | GasInstance
    | ClothInstance
    | DemInstance
    | BallisticInstance,
    Field(discriminator="engine"),
]  # fmt: skip
LiquidInstance = DfsphInstance | FlipInstance
ParticleInstance = DemInstance | BallisticInstance
MOVED: tuple[str, ...] = tuple(dict.fromkeys(c for i in get_args(get_args(SolverInstance)[0]) for c in i.moves))
"""Categories that some engine of this build moves."""


Joint = Annotated[HingeJoint | SlideJoint | BallJoint | WeldJoint | SpringJoint, Field(discriminator="kind")]


class ReleaseDriver(DriverBase):
    """Holds the entity where it is at frame 0 and lets go at `time`."""

    later: ClassVar[frozenset[str]] = frozenset({"time"})
    absent: ClassVar[frozenset[str]] = frozenset({"time"})
    switched: ClassVar[bool] = True
    kind: Literal["release"] = "release"
    entity: EntityRef
    time: NonNegative = Field(description="[s]")


Driver = Annotated[
    ReleaseDriver
    | PathDriver
    | ForceDriver
    | MotorDriver
    | DetachDriver
    | FieldDriver
    | EmissionDriver
    | EmitterDriver
    | IgnitionDriver
    | DustDriver
    | SteamDriver
    | InflowDriver
    | OutflowDriver
    | WavesDriver,
    Field(discriminator="kind"),
]


class ContactPair(SpecModel):
    """Own friction and restitution for contacts between two entities; values far from those of their materials say why."""

    a: EntityRef
    b: EntityRef
    friction: NonNegative | None = Field(default=None, le=4)
    static_friction: NonNegative | None = Field(default=None, le=8, description=STATIC_FRICTION)
    restitution: float | None = Field(default=None, ge=0, le=1)
    reason: Annotated[str, Field(min_length=10, max_length=300)] | None = Field(
        default=None, description="what lies between the two, where their materials alone would rub or bounce otherwise; printed"
    )

    @property
    def friction_at_rest(self) -> float | None:
        """Coulomb coefficient of the two where they do not slide; None without a friction of their own."""
        return self.friction if self.static_friction is None else self.static_friction

    @model_validator(mode="after")
    def _holds_more_at_rest(self) -> Self:
        check_static_friction(self.friction, self.static_friction)
        return self

    @model_serializer(mode="wrap")
    def _said(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Pairs without static friction are written as they always were, so that digests of older worlds stay."""
        written: dict[str, Any] = handler(self)
        return {k: v for k, v in written.items() if v is not None or k != "static_friction"}


class Coupling(SpecModel):
    """Exchange between two solver instances (R66); `one_way` is an approximation and recorded as one.

    A liquid that carries bodies needs `two_way` with their rigid instance; without a coupling it only reads their motion. A gas carries what it is the
    source of a coupling to, and feels it where that is `two_way`.
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


class Settle(SpecModel):
    """Bodies and matter that come to rest before frame 0, in a run of their own in which no driver acts.

    What is not listed is held where it is declared. The declared places are those from which things settle. It takes the place of
    `preroll`.
    """

    entities: Annotated[list[EntityRef], Field(max_length=5000)] = Field(
        default=[], description="what settles; empty: all dynamic entities that start without speed and that no release holds"
    )
    max_time: float = Field(default=5.0, gt=0, le=120, description="it ends at rest, or after this time [s]")


class SimulationPlan(SpecModel):
    """Everything that decides the motion."""

    fps: int = Field(default=24, ge=1, le=240)
    frames: int = Field(ge=2, le=20000, description="number of frames; frame k is the state at k / fps seconds")
    preroll: float = Field(default=0.0, ge=0, le=60, description="simulated before frame 0, with held bodies held [s]")
    settle: Settle | None = Field(default=None, description="what comes to rest before frame 0")
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
    def lead(self) -> float:
        """Longest time that is simulated before frame 0 [s]."""
        return max(self.preroll, 0.0 if self.settle is None else self.settle.max_time)

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
    def gas(self) -> dict[str, GasInstance]:
        """Gas instances by id."""
        return {k: s for k, s in self.solvers.items() if isinstance(s, GasInstance)}

    @property
    def particles(self) -> dict[str, ParticleInstance]:
        """Instances of grains and of flying particles by id."""
        return {k: s for k, s in self.solvers.items() if isinstance(s, DemInstance | BallisticInstance)}
