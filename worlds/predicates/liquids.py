"""Predicates about liquids. Their evidence is the particles of an engine; painted water has none and meets none of them."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from ..vocabulary import EntityRef, Finite, NonNegative, Positive, RegionRef, SpecModel, Vec3
from .fields import Band, Subject, When

__all__ = [
    "LiquidArrives",
    "LiquidFluxThrough",
    "LiquidLevelAt",
    "LiquidSpeed",
    "LiquidTemperature",
    "LiquidVolumeIn",
    "SplashHeight",
    "SubmergedFraction",
    "WetArea",
]


class LiquidVolumeIn(Band):
    """Volume of the liquid inside a region [m^3]."""

    kind: Literal["liquid_volume_in"] = "liquid_volume_in"
    entity: Subject = Field(description="the liquid")
    region: RegionRef
    when: When = "eventually"


class LiquidLevelAt(Band):
    """Height of the liquid's highest point [m] in the upright column of `radius` about a point; the domain's bottom where it is dry."""

    kind: Literal["liquid_level_at"] = "liquid_level_at"
    entity: Subject = Field(description="the liquid")
    point: tuple[Finite, Finite] = Field(description="x, y [m]")
    radius: Positive | None = Field(default=None, description="[m]; default: two spacings of the liquid")
    when: When = "eventually"


class LiquidFluxThrough(Band):
    """Volume of the liquid that has passed a disc or rectangle along its normal since the interval began [m^3], or its rate [m^3/s].

    What passes against the normal counts negative.
    """

    kind: Literal["liquid_flux_through"] = "liquid_flux_through"
    entity: Subject = Field(description="the liquid")
    point: Vec3 = Field(description="middle [m]")
    normal: Vec3
    radius: Positive | None = Field(default=None, description="of a disc [m]; give radius or size")
    size: tuple[Positive, Positive] | None = Field(
        default=None, description="of a rectangle [m]: level extent across the normal, and the extent across both"
    )
    measure: Literal["total", "rate"] = "total"
    when: When = "eventually"

    @model_validator(mode="after")
    def _one_shape(self) -> LiquidFluxThrough:
        if (self.radius is None) == (self.size is None):
            raise ValueError("give either radius or size")
        if sum(c * c for c in self.normal) < 1e-12:
            raise ValueError("normal must have a length")
        return self


class LiquidArrives(SpecModel):
    """At least `min_volume` of the liquid has come into a region, or to within `within` of an entity's surface."""

    kind: Literal["liquid_arrives"] = "liquid_arrives"
    entity: Subject = Field(description="the liquid")
    region: RegionRef | None = None
    target: EntityRef | None = Field(default=None, description="entity that it reaches; give region or target")
    within: Positive | None = Field(default=None, description="of the target's surface [m]; default: one spacing")
    min_volume: NonNegative = Field(default=0.0, description="[m^3]; 0: one particle")

    @model_validator(mode="after")
    def _one_place(self) -> LiquidArrives:
        if (self.region is None) == (self.target is None):
            raise ValueError("give either region or target")
        return self


class SubmergedFraction(Band):
    """Share of the entity's volume that lies under the liquid's surface about it, 0..1."""

    kind: Literal["submerged_fraction"] = "submerged_fraction"
    entity: Subject
    liquid: EntityRef
    when: When = "eventually"


class WetArea(Band):
    """Area of the entity's visible surface within one spacing of the liquid [m^2]: now, or at any frame of the interval so far."""

    kind: Literal["wet_area"] = "wet_area"
    entity: Subject
    liquid: EntityRef
    measure: Literal["now", "ever"] = "now"
    when: When = "eventually"


class SplashHeight(Band):
    """Height that at least eight particles of the liquid exceed, above its highest point at frame 0 or above `over` [m]."""

    kind: Literal["splash_height"] = "splash_height"
    entity: Subject = Field(description="the liquid")
    over: Finite | None = Field(default=None, description="height z that counts as 0 [m]")
    when: When = "eventually"


class LiquidSpeed(Band):
    """Mean (by mass) or largest speed of the liquid [m/s], all of it or what is inside a region; 0 where there is none."""

    kind: Literal["liquid_speed"] = "liquid_speed"
    entity: Subject = Field(description="the liquid")
    region: RegionRef | None = None
    measure: Literal["mean", "largest"] = "mean"
    when: When = "eventually"


class LiquidTemperature(Band):
    """Mean (by mass), lowest or highest temperature of the liquid [K], all of it or what is inside a region."""

    kind: Literal["liquid_temperature"] = "liquid_temperature"
    entity: Subject = Field(description="the liquid")
    region: RegionRef | None = None
    measure: Literal["mean", "lowest", "highest"] = "mean"
    when: When = "eventually"
