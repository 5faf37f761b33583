"""Grains and particles that fly alone: engines, their settings, and what emits particles (R65)."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from ...matter import Instance, Matter, MatterShape, TimedDriver
from ...shapes import Pose
from ...vocabulary import EntityRef, NonNegative, Positive, SpecModel, Vec3

__all__ = [
    "BallisticInstance",
    "BallisticSettings",
    "DemInstance",
    "DemSettings",
    "EmitterDriver",
    "ParticleDomain",
    "ParticlePhysics",
]


class ParticleDomain(SpecModel):
    """Axis-aligned box in which particles are followed; what leaves it is counted as outflow and is gone."""

    center: Vec3 = Field(description="[m]")
    size: tuple[Positive, Positive, Positive] = Field(description="full extents x, y, z [m]")


class DemSettings(SpecModel):
    """Settings of grains that touch (discrete element method)."""

    domain: ParticleDomain
    step_share: float = Field(
        default=0.15,
        ge=0.02,
        le=0.3,
        description="step in times that a Rayleigh wave takes across the smallest grain; a fast collision shortens it further",
    )
    exchange: float = Field(
        default=1e-3, ge=1e-5, le=5e-3, description="longest time between exchanges with bodies and fields [s]"
    )
    device: Literal["cpu", "cuda"] = "cpu"


class DemInstance(Instance):
    """Grains with Hertz-Mindlin contacts, and the granular entities that it moves.

    Rigid entities that reach into the domain are their walls; a two-way coupling lets them give way.
    """

    moves: ClassVar[tuple[str, ...]] = ("particles",)
    meets: ClassVar[tuple[str, ...]] = ("elastic", "cloth")
    engine: Literal["dem"] = "dem"
    members: Annotated[list[EntityRef], Field(min_length=1, max_length=16)]
    settings: DemSettings


class BallisticSettings(SpecModel):
    """Settings of particles that fly alone."""

    domain: ParticleDomain
    max_step: float = Field(default=2e-3, ge=1e-5, le=0.02, description="longest step [s]")
    device: Literal["cpu", "cuda"] = "cpu"


class BallisticInstance(Instance):
    """Sparks, dust, rain, ash: particles that do not meet each other and push nothing, and the entities that it moves."""

    moves: ClassVar[tuple[str, ...]] = ("particles",)
    engine: Literal["ballistic"] = "ballistic"
    members: Annotated[list[EntityRef], Field(min_length=1, max_length=16)]
    settings: BallisticSettings


class EmitterDriver(TimedDriver):
    """Lets ballistic particles out of a disc, in a cone about its local +z, during [start, end) seconds."""

    later: ClassVar[frozenset[str]] = frozenset({"pose", "size", "rate", "speed", "speed_spread", "cone", "start", "end"})
    kind: Literal["emitter"] = "emitter"
    entity: EntityRef = Field(description="the ballistic particles")
    pose: Pose = Field(default=Pose(), description="of the disc in the world")
    size: tuple[NonNegative, NonNegative] = Field(
        default=(0.0, 0.0), description="full extents of the disc (an ellipse) along its x and y [m]; 0: a point"
    )
    rate: Positive = Field(description="[1/s]")
    speed: NonNegative = Field(description="mean [m/s]")
    speed_spread: float = Field(default=0.0, ge=0, le=1, description="speeds lie evenly within 1 +- this share of the mean")
    cone: float = Field(
        default=0.0, ge=0, le=3.141592653589793, description="half angle of the cone [rad]; directions are even in it"
    )
    start: NonNegative = 0.0
    end: Positive | None = Field(default=None, description="[s]; default: to the end")


class ParticlePhysics(Matter):
    """Ballistic or granular matter; the entity's parts are its initial volume.

    Density, friction and restitution are those of the entity's material.
    """

    shape: ClassVar[MatterShape] = "loose"
    feels_fields: ClassVar[bool] = True
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
