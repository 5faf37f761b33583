"""Entity contracts: what each body of matter is, what it is made of, who moves it (R17-R19, R61-R66)."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Field, SerializerFunctionWrapHandler, StringConstraints, model_serializer, model_validator

from ..categories.cloth.models import ClothPhysics
from ..categories.elastic.models import ElasticPhysics
from ..categories.fracture.models import Breakable
from ..categories.gas.models import Flammable, GasPhysics
from ..categories.liquid.models import LiquidPhysics
from ..categories.particles.models import ParticlePhysics
from ..categories.rigid.models import RigidPhysics
from ..shapes import Pose, Shape
from ..vocabulary import (
    EntityRef,
    Finite,
    FrameInterval,
    Id,
    MaterialRef,
    NonNegative,
    Positive,
    SpecModel,
    Text,
    Vec3,
)
from .surfaces import STATIC_FRICTION, check_static_friction

__all__ = ["Appearance", "Asset", "Dimensions", "Entity", "Material", "Part", "Physics", "Rope", "StateChannel"]

Unit = Annotated[float, Field(ge=0, le=1)]


class Appearance(SpecModel):
    """How a material looks (principled BSDF); never used by physics."""

    color: tuple[Unit, Unit, Unit] = Field(default=(0.6, 0.6, 0.6), description="linear RGB, 0..1")
    roughness: Unit = 0.5
    metallic: Unit = 0.0
    transmission: Unit = 0.0
    pattern: Literal["plain", "wood", "checker", "concrete", "tiles", "bricks"] = Field(
        default="plain", description="tiles: square ones with joints; bricks: courses, each brick of its own tone, period 0.225 m"
    )
    pattern_scale: Positive = Field(default=0.1, description="size of one pattern period, or of one tile [m]")
    drying: Positive = Field(default=600.0, description="of liquids: time in which the film they leave fades to 1/e [s]")


class Material(SpecModel):
    """Physical and visible properties of a material.

    Contact between two materials uses the larger friction, the larger static friction and the smaller
    restitution, unless `simulation.contacts` gives the pair its own.
    """

    density: Positive = Field(description="[kg/m^3]")
    friction: NonNegative = Field(default=0.5, le=4, description="Coulomb coefficient, of motion where static_friction is given")
    static_friction: NonNegative | None = Field(default=None, le=8, description=STATIC_FRICTION)
    rolling_friction: NonNegative = Field(default=0.0, le=0.1, description="rolling resistance length [m]")
    restitution: Unit = Field(default=0.0, description="ratio of separation to approach speed in a normal impact")
    substance: Literal[
        "steel",
        "iron",
        "aluminium",
        "wood",
        "stone",
        "concrete",
        "brick",
        "sand",
        "soil",
        "glass",
        "plastic",
        "rubber",
        "ceramic",
        "ice",
        "paper",
        "foam",
        "fabric",
        "gel",
        "water",
        "oil",
        "lava",
        "other",
    ] = Field(default="other", description="lets the audit compare the density with the substance's real range")
    flammable: Flammable | None = Field(
        default=None, description="static rigid entities of it burn in the box of a gas with its fuel"
    )
    appearance: Appearance = Appearance()
    of: Text | None = Field(
        default=None,
        description="row of the table of materials that gives what is left out: density, substance, friction, restitution, look; "
        "inspect_world(part='materials', query=...)",
    )
    departs: Annotated[str, Field(min_length=12, max_length=300, pattern=r"\S\s+\S")] | None = Field(
        default=None,
        description="what makes it another than its row (waxed, wet, hollow), where values leave its ranges; printed",
    )

    @property
    def friction_at_rest(self) -> float:
        """Coulomb coefficient of what does not slide."""
        return self.friction if self.static_friction is None else self.static_friction

    @model_validator(mode="after")
    def _holds_more_at_rest(self) -> Self:
        check_static_friction(self.friction, self.static_friction)
        return self

    @model_serializer(mode="wrap")
    def _said(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Materials that name no row and no static friction are written as they always were, so that digests of older worlds stay."""
        written: dict[str, Any] = handler(self)
        return {k: v for k, v in written.items() if v is not None or k not in ("of", "departs", "static_friction")}


class Part(SpecModel):
    """One piece of an entity. Parts of an entity move together unless a generator says otherwise."""

    shape: Shape
    pose: Pose = Field(default=Pose(), description="relative to the entity's frame")
    material: MaterialRef | None = Field(default=None, description="default: the entity's material")
    collides: bool = Field(default=True, description="false: drawn only, and listed as an approximation")


class Asset(SpecModel):
    """Generator of an entity."""

    generator: Annotated[str, StringConstraints(min_length=1, max_length=64)]
    parameters: dict[
        Annotated[str, StringConstraints(max_length=64)], bool | int | float | Annotated[str, StringConstraints(max_length=64)]
    ] = {}
    seed: int = Field(default=0, ge=0, le=2**32 - 1, description="of its variation")
    positions: dict[Id, Finite] = Field(
        default={}, description="of its joints at frame 0, from where they are made: [rad] or [m]"
    )
    fixed: bool = Field(
        default=False, description="its leaves, drawers and lids are static where `positions` puts them: a door that stays shut"
    )
    bodies: Annotated[list[EntityRef], Field(max_length=500)] = Field(default=[], description="its further entities")


class Rope(SpecModel):
    """Generator: a chain of capsules with ball joints along a polyline in the entity's frame."""

    kind: Literal["rope"] = "rope"
    points: Annotated[list[Vec3], Field(min_length=2, max_length=64)]
    radius: Positive
    segments: int = Field(default=12, ge=2, le=200)
    stiffness: NonNegative = Field(default=0.0, description="bending stiffness per joint [N m/rad]")
    damping: NonNegative = Field(default=1e-4, description="bending damping per joint [N m s/rad]")
    attach_start: EntityRef | Literal["world"] | None = None
    attach_end: EntityRef | Literal["world"] | None = None


Physics = Annotated[
    RigidPhysics
    | ElasticPhysics
    | ClothPhysics
    | LiquidPhysics
    | GasPhysics
    | ParticlePhysics,
    Field(discriminator="category"),
]  # fmt: skip


class Dimensions(SpecModel):
    """Declared size of the entity as placed: bounding box in the entity's own frame (R87)."""

    size: tuple[Positive, Positive, Positive] = Field(description="bounding box x, y, z in the entity's frame [m]")
    tolerance: float = Field(default=0.01, gt=0, le=0.2, description="allowed relative deviation")


class StateChannel(SpecModel):
    """One exchanged quantity of an entity's solver (R17)."""

    quantity: Literal["motion", "wrench", "pressure", "heat", "mass"]
    with_entity: EntityRef
    direction: Literal["in", "out", "both"]


class Entity(SpecModel):
    """Contract of one object or body of matter.

    `motion`: `static` never moves; `dynamic` is moved by the solver instance that lists it as a member;
    `kinematic` follows an authored driver and is not affected by anything.
    """

    role: Text = Field(description="what it is and what it is for")
    motion: Literal["static", "dynamic", "kinematic"]
    physics: Physics = RigidPhysics()
    dimensions: Dimensions
    pose: Pose = Pose()
    material: MaterialRef
    parts: Annotated[dict[Id, Part], Field(max_length=256)] = {}
    generator: Rope | None = None
    breakable: Breakable | None = Field(default=None, description="pieces and bonds of a rigid body that may break")
    inputs: list[Text] = Field(default=[], description="what its solver reads: drivers, velocity, colliders")
    outputs: list[Text] = Field(default=[], description="what its solver writes: motion, contacts")
    exchanges: dict[Id, StateChannel] = {}
    active: FrameInterval | None = Field(default=None, description="frames in which it exists; default all")
    nominal_diagonal: Positive | None = Field(
        default=None, description="[m] bounding-box diagonal of such things in reality, if the role implies one"
    )
    asset: Asset | None = None
    afloat: Annotated[str, Field(min_length=12, max_length=300, pattern=r"\S\s+\S")] | None = Field(
        default=None,
        description="why nothing holds it up; printed",
    )

    @model_serializer(mode="wrap")
    def _said(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Entities that no generator made are written as they always were, so that digests of older worlds stay."""
        written: dict[str, Any] = handler(self)
        return {k: v for k, v in written.items() if v is not None or k != "asset"}

    @model_validator(mode="after")
    def _has_geometry(self) -> Entity:
        if not self.parts and self.generator is None:
            raise ValueError("an entity needs parts or a generator")
        if self.parts and self.generator is not None:
            raise ValueError("give parts or a generator, not both")
        return self
