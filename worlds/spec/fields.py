"""Force fields: wind, turbulence, vortices, still air, attraction, each within a region and a time (R18, R63)."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from ...physics.substances import AIR_DENSITY, AIR_VISCOSITY
from ..matter import DriverBase, TimedDriver
from ..shapes import Pose
from ..vocabulary import EntityRef, Finite, NonNegative, Positive, SpecModel, Vec3

__all__ = [
    "AttractionField",
    "DragField",
    "FieldBox",
    "FieldDriver",
    "FieldSphere",
    "TurbulenceField",
    "VortexField",
    "WindField",
]


class FieldBox(SpecModel):
    """A box in which a field acts."""

    kind: Literal["box"] = "box"
    pose: Pose = Field(default=Pose(), description="of its centre in the world")
    size: tuple[Positive, Positive, Positive] = Field(description="full extents x, y, z [m]")


class FieldSphere(SpecModel):
    """A sphere in which a field acts."""

    kind: Literal["sphere"] = "sphere"
    center: Vec3
    radius: Positive


FieldRegion = Annotated[FieldBox | FieldSphere, Field(discriminator="kind")]


class _Medium(SpecModel):
    """The medium in which things move where the field acts. Velocities of overlapping fields add up; of their media the densest holds."""

    density: Positive = Field(default=AIR_DENSITY, le=2000, description="of the medium [kg/m^3]; air at 20 degrees C")
    viscosity: NonNegative = Field(
        default=AIR_VISCOSITY, le=100, description="of the medium, dynamic [Pa s]: felt by grains and sparks"
    )
    coefficient: NonNegative = Field(
        default=1.0,
        le=5,
        description="drag coefficient of rigid bodies, by the area that their hull shows to the flow: sphere 0.47, cube 1.05",
    )


class WindField(_Medium):
    """Air that moves everywhere with the same velocity; gusts come and go along it."""

    kind: Literal["wind"] = "wind"
    velocity: Vec3 = Field(description="[m/s]")
    gust: float = Field(default=0.0, ge=0, le=1, description="share of the speed by which it swells and ebbs")
    gust_period: Positive = Field(default=4.0, description="mean time between gusts [s]")


class TurbulenceField(_Medium):
    """Eddies of many sizes: a sum of waves without divergence, with the spectrum of Kolmogorov."""

    kind: Literal["turbulence"] = "turbulence"
    speed: Positive = Field(le=200, description="root mean square of the velocity [m/s]")
    length: Positive = Field(description="of the largest eddies [m]; the smallest are an eighth of it")


class VortexField(_Medium):
    """Air that turns about an axis, fastest at the core's edge."""

    kind: Literal["vortex"] = "vortex"
    center: Vec3 = Field(description="a point of the axis [m]")
    axis: Vec3 = Field(default=(0.0, 0.0, 1.0), description="the air turns about it by the right hand")
    speed: Finite = Field(description="at the core's edge [m/s]")
    core: Positive = Field(description="distance of the fastest air from the axis [m]")
    updraft: Finite = Field(default=0.0, description="velocity along the axis, greatest there [m/s]")

    @model_validator(mode="after")
    def _turns(self) -> VortexField:
        if not any(self.axis):
            raise ValueError("axis must not be zero")
        return self


class DragField(_Medium):
    """A medium at rest that slows what moves through it."""

    kind: Literal["drag"] = "drag"


class AttractionField(SpecModel):
    """Acceleration towards a point, or towards an axis through it; negative: away from it."""

    kind: Literal["attraction"] = "attraction"
    center: Vec3
    axis: Vec3 | None = Field(default=None, description="towards this line through the centre; default: towards the centre")
    acceleration: Finite = Field(description="at `distance` [m/s^2]")
    distance: Positive = Field(description="[m]; nearer than this it falls to zero in proportion")
    exponent: float = Field(default=2.0, ge=0, le=4, description="farther away it falls as distance to this power")

    @model_validator(mode="after")
    def _has_line(self) -> AttractionField:
        if self.axis is not None and not any(self.axis):
            raise ValueError("axis must not be zero")
        return self


class FieldDriver(TimedDriver):
    """A force field during [start, end) seconds on all that moves, or on some entities.

    Air acts by the velocity relative to it: on rigid bodies as drag at the centre of mass, and lift where they declare it, on cloth and elastic bodies by their
    faces, on grains and sparks as on spheres, on liquids by the surface that it blows against; it bears nothing. Attraction
    accelerates all alike.
    """

    later: ClassVar[frozenset[str]] = frozenset({"field", "region", "fade", "start", "rise", "end", "seed"})
    switched: ClassVar[bool] = True
    absent: ClassVar[frozenset[str]] = frozenset({"field", "region", "fade", "seed"})
    kind: Literal["field"] = "field"
    field: Annotated[
        WindField | TurbulenceField | VortexField | DragField | AttractionField,
        Field(discriminator="kind"),
    ]
    region: FieldRegion | None = Field(default=None, description="default: everywhere")
    fade: NonNegative = Field(
        default=0.0, description="within this distance of the region's border the field falls to nothing [m]"
    )
    entities: Annotated[list[EntityRef], Field(min_length=1, max_length=2000)] | None = Field(
        default=None, description="that it acts on; default: all that a solver moves"
    )
    start: float = Field(
        default=0.0, ge=-60, le=1e5, description="[s]; negative: within the preroll, so that cloth hangs still in air at frame 0"
    )
    rise: NonNegative = Field(default=0.0, description="time to full strength [s]")
    end: Positive | None = Field(default=None, description="[s]; default: to the end")
    seed: int = Field(default=0, ge=0, lt=2**31, description="of gusts and eddies")

    def alike_until(self, other: DriverBase | None) -> float:
        """As of every driver; another kind of field makes other matter of it from the start: still air or none."""
        if isinstance(other, FieldDriver) and other.field.kind != self.field.kind:
            return 0.0
        return super().alike_until(other)
