"""Entity contracts: what each body of matter is, what it is made of, who moves it (R17-R19, R61-R66)."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from ..categories.cloth.models import ClothPin, ClothTear
from ..categories.elastic.models import ElasticPhysics
from ..categories.fracture.models import Breakable
from ..vocabulary import (
    EntityRef,
    FrameInterval,
    Id,
    MaterialRef,
    NonNegative,
    Positive,
    SpecModel,
    Text,
    Vec3,
)
from .shapes import Pose, Shape

__all__ = [
    "Appearance",
    "Category",
    "ClothPhysics",
    "Current",
    "Dimensions",
    "ElasticPhysics",
    "Entity",
    "GasPhysics",
    "LiquidPhysics",
    "Material",
    "Part",
    "ParticlePhysics",
    "RigidPhysics",
    "Rope",
    "StateChannel",
]

Category = Literal["rigid", "elastic", "cloth", "liquid", "gas", "particles"]
Unit = Annotated[float, Field(ge=0, le=1)]


class Appearance(SpecModel):
    """How a material looks (principled BSDF); never used by physics."""

    color: tuple[Unit, Unit, Unit] = Field(default=(0.6, 0.6, 0.6), description="linear RGB, 0..1")
    roughness: Unit = 0.5
    metallic: Unit = 0.0
    transmission: Unit = 0.0
    pattern: Literal["plain", "wood", "checker", "concrete"] = "plain"
    pattern_scale: Positive = Field(default=0.1, description="size of one pattern period [m]")
    drying: Positive = Field(default=600.0, description="of liquids: time in which the film they leave fades to 1/e [s]")


class Material(SpecModel):
    """Physical and visible properties of a material.

    Contact between two materials uses the larger friction and the smaller restitution, unless
    `simulation.contacts` gives the pair its own.
    """

    density: Positive = Field(description="[kg/m^3]")
    friction: NonNegative = Field(default=0.5, le=4, description="Coulomb coefficient")
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
    appearance: Appearance = Appearance()


class Part(SpecModel):
    """One piece of an entity. Parts of an entity move together unless a generator says otherwise."""

    shape: Shape
    pose: Pose = Field(default=Pose(), description="relative to the entity's frame")
    material: MaterialRef | None = Field(default=None, description="default: the entity's material")
    collides: bool = Field(default=True, description="false: drawn only, and listed as an approximation")


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


class RigidPhysics(SpecModel):
    """Rigid body."""

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


class ClothPhysics(SpecModel):
    """Cloth: its parts are sheets or meshes, which need not be closed; every triangle of them is one of the simulation.

    Stiffnesses are those of the sheet: Young's or shear modulus times thickness. Fabrics: stretch 500 to 5000 N/m, shear a tenth of
    that, bend 1e-6 (silk) to 1e-4 N m (canvas); the step falls with the edge length and the root of the stretch stiffness.
    """

    category: Literal["cloth"] = "cloth"
    area_density: Positive = Field(description="[kg/m^2]")
    thickness: Positive = Field(description="[m]")
    stretch_stiffness: Positive = Field(description="along the warp, the sheet's x [N/m]")
    weft_stiffness: Positive | None = Field(default=None, description="across the warp [N/m]; default: as along it")
    shear_stiffness: Positive | None = Field(default=None, description="[N/m]; default: a tenth of the stretch stiffness")
    bend_stiffness: NonNegative = Field(default=0.0, description="[N m]")
    damping: NonNegative = Field(
        default=0.0, le=0.1, description="stress by strain rate over stress by strain [s]; above 1e-5 it shortens the step"
    )
    self_collision: bool = True
    drag: NonNegative = Field(default=1.2, le=5, description="coefficient of the air that meets the sheet's faces")
    skin_drag: NonNegative = Field(default=0.03, le=1, description="coefficient of the air that sweeps along them")
    flat: bool = Field(default=False, description="true: it wants to be flat; default: it wants the shape in which it is built")
    linear_velocity: Vec3 = Field(default=(0, 0, 0), description="at frame 0 [m/s]")
    pins: Annotated[dict[Id, ClothPin], Field(max_length=64)] = {}
    ignores: Annotated[list[EntityRef], Field(max_length=64)] = Field(
        default=[], description="rigid entities that it passes through; listed as an approximation"
    )
    tear: ClothTear | None = Field(default=None, description="what tears it; default: it never tears")
    max_stretch: Positive = Field(default=0.05, le=1, description="largest allowed extension of an edge / its length at rest")


class Current(SpecModel):
    """A stream that runs at frame 0: the same velocity all over each of its cross sections."""

    line: Annotated[list[Vec3], Field(min_length=2, max_length=400)] = Field(
        description="its course downstream, in the entity's frame [m]"
    )
    speeds: Annotated[list[NonNegative], Field(min_length=2, max_length=400)] = Field(description="at each of these points [m/s]")
    width: Positive = Field(description="of the stream [m]: liquid within half of it from the course, seen from above, runs")

    @model_validator(mode="after")
    def _one_each(self) -> Current:
        if len(self.line) != len(self.speeds):
            raise ValueError(f"a current has {len(self.line)} points and {len(self.speeds)} speeds; give one speed per point")
        return self


class LiquidPhysics(SpecModel):
    """Free-surface liquid; the entity's parts are its initial volume."""

    category: Literal["liquid"] = "liquid"
    viscosity: NonNegative = Field(default=1e-3, description="dynamic [Pa s], at `temperature`")
    surface_tension: NonNegative = Field(
        default=0.072,
        description="[N/m]; felt by dfsph below spacings of about three capillary lengths (water 8.6 mm); flip leaves it out",
    )
    resolution: Positive = Field(description="particle spacing or cell size [m]")
    linear_velocity: Vec3 = Field(default=(0, 0, 0), description="at frame 0, or where a preroll begins [m/s]")
    currents: Annotated[dict[Id, Current], Field(max_length=64)] = Field(
        default={}, description="streams that run at frame 0, or where a preroll begins; liquid beside them has linear_velocity"
    )
    temperature: float = Field(default=293.15, gt=0, le=5000, description="at frame 0 [K]")
    conductivity: NonNegative = Field(default=0.0, le=1000, description="thermal [W/(m K)]; 0: heat is carried, not conducted")
    heat_capacity: Positive = Field(default=4186.0, description="[J/(kg K)]")
    activation: NonNegative = Field(
        default=0.0,
        le=1e5,
        description="of viscosity [K]: viscosity(T) = viscosity exp(activation (1/T - 1/temperature)); lava 2e4 or so",
    )


class GasPhysics(SpecModel):
    """Smoke or fire; the entity's parts are its source."""

    category: Literal["gas"] = "gas"
    temperature: Positive = Field(default=400.0, description="source temperature [K]")
    soot_density: NonNegative = Field(default=1.0, description="[kg/m^3]")
    fuel: bool = False
    resolution: Positive = Field(description="cell size [m]")


class ParticlePhysics(SpecModel):
    """Ballistic or granular matter; the entity's parts are its initial volume.

    Density, friction and restitution are those of the entity's material.
    """

    category: Literal["particles"] = "particles"
    law: Literal["granular", "ballistic"] = Field(
        default="granular", description="granular: grains that touch, engine dem; ballistic: flying alone, engine ballistic"
    )
    radius: Positive = Field(description="mean [m]")
    radius_spread: float = Field(default=0.1, ge=0, le=0.5, description="radii lie evenly within 1 +- this share of the mean")
    linear_velocity: Vec3 = Field(default=(0, 0, 0), description="at frame 0 [m/s]; after a preroll, added to what it left")
    young_modulus: float = Field(
        default=1e7, ge=1e4, le=1e11, description="[Pa]; grains are commonly taken softer than they are: steps are longer then"
    )
    poisson_ratio: float = Field(default=0.25, ge=0, le=0.49)
    rolling: float = Field(
        default=0.1,
        ge=0,
        le=2,
        description="rolling resistance in effective radii: 0 for spheres, 0.1 to 0.3 for sand, more for gravel",
    )
    cohesion: NonNegative = Field(
        default=0.0,
        le=1e3,
        description="energy of adhesion [J/m^2]: pulls two grains together with 2 pi cohesion times effective radius",
    )
    packing: float = Field(
        default=0.58, ge=0.2, le=0.61, description="granular: share of the volume that grains take up before they settle"
    )
    count: int = Field(
        default=0, ge=0, le=5_000_000, description="ballistic: particles in the volume at frame 0, at random places"
    )
    on_hit: Literal["bounce", "stick", "die"] = Field(
        default="bounce", description="ballistic: what a particle does at a surface"
    )
    life: Positive | None = Field(default=None, description="ballistic: seconds until it vanishes; default: it stays")
    life_spread: float = Field(default=0.0, ge=0, le=1, description="lives lie evenly within 1 +- this share")


Physics = Annotated[
    RigidPhysics | ElasticPhysics | ClothPhysics | LiquidPhysics | GasPhysics | ParticlePhysics,
    Field(discriminator="category"),
]


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
    afloat: Annotated[str, Field(min_length=12, max_length=300, pattern=r"\S\s+\S")] | None = Field(
        default=None,
        description="why nothing holds it up; printed",
    )

    @model_validator(mode="after")
    def _has_geometry(self) -> Entity:
        if not self.parts and self.generator is None:
            raise ValueError("an entity needs parts or a generator")
        if self.parts and self.generator is not None:
            raise ValueError("give parts or a generator, not both")
        return self
