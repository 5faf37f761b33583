"""Predicates about liquids. Their evidence is the particles of an engine; painted water has none and meets none of them."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from ...predicate_base import BAND, Band, PredicateInfo, Subject, When
from ...vocabulary import EntityRef, Finite, NonNegative, Positive, RegionRef, SpecModel, Vec3

__all__ = [
    "PREDICATES",
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
    """Volume of a liquid in a region [m^3]."""

    kind: Literal["liquid_volume_in"] = "liquid_volume_in"
    entity: Subject = Field(description="the liquid")
    region: RegionRef
    when: When = "eventually"


class LiquidLevelAt(Band):
    """Height z of a liquid's surface over a point [m]."""

    kind: Literal["liquid_level_at"] = "liquid_level_at"
    entity: Subject = Field(description="the liquid")
    point: tuple[Finite, Finite] = Field(description="x, y [m]")
    radius: Positive | None = Field(
        default=None,
        description="of the upright column whose highest liquid counts [m]; default: two spacings. A dry column has the height of the domain's bottom",
    )
    when: When = "eventually"


class LiquidFluxThrough(Band):
    """Volume of a liquid that passes an opening [m^3], or its rate [m^3/s]."""

    kind: Literal["liquid_flux_through"] = "liquid_flux_through"
    entity: Subject = Field(description="the liquid")
    point: Vec3 = Field(description="middle [m]")
    normal: Vec3 = Field(description="what passes against it counts negative")
    radius: Positive | None = Field(default=None, description="of a disc [m]; give radius or size")
    size: tuple[Positive, Positive] | None = Field(
        default=None, description="of a rectangle [m]: level extent across the normal, and the extent across both"
    )
    measure: Literal["total", "rate"] = Field(default="total", description="total: since the interval began")
    when: When = "eventually"

    @model_validator(mode="after")
    def _one_shape(self) -> LiquidFluxThrough:
        if (self.radius is None) == (self.size is None):
            raise ValueError("give either radius or size")
        if sum(c * c for c in self.normal) < 1e-12:
            raise ValueError("normal must have a length")
        return self


class LiquidArrives(SpecModel):
    """A liquid comes into a region or to an entity."""

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
    """Share of an entity under a liquid's surface, 0..1."""

    kind: Literal["submerged_fraction"] = "submerged_fraction"
    entity: Subject
    liquid: EntityRef
    when: When = "eventually"


class WetArea(Band):
    """Area of an entity that a liquid wets [m^2]."""

    kind: Literal["wet_area"] = "wet_area"
    entity: Subject
    liquid: EntityRef
    measure: Literal["now", "ever"] = Field(
        default="now", description="liquid within one spacing at the frame, or at any frame of the interval so far"
    )
    when: When = "eventually"


class SplashHeight(Band):
    """Height of a liquid's splash [m]."""

    kind: Literal["splash_height"] = "splash_height"
    entity: Subject = Field(description="the liquid")
    over: Finite | None = Field(
        default=None,
        description="height z that counts as 0 [m]; default: the liquid's highest point at frame 0. Eight particles make a splash",
    )
    when: When = "eventually"


class LiquidSpeed(Band):
    """Speed of a liquid [m/s]."""

    kind: Literal["liquid_speed"] = "liquid_speed"
    entity: Subject = Field(description="the liquid")
    region: RegionRef | None = Field(default=None, description="default: all of the liquid")
    measure: Literal["mean", "largest"] = Field(default="mean", description="mean: by mass; 0 where there is none")
    when: When = "eventually"


class LiquidTemperature(Band):
    """Temperature of a liquid [K]."""

    kind: Literal["liquid_temperature"] = "liquid_temperature"
    entity: Subject = Field(description="the liquid")
    region: RegionRef | None = Field(default=None, description="default: all of the liquid")
    measure: Literal["mean", "lowest", "highest"] = Field(default="mean", description="mean: by mass")
    when: When = "eventually"


_LIQUID = ("origin", "particle/position", "particle/fluid", "particle/volume")
PREDICATES = (
    PredicateInfo("liquid_volume_in", "m^3", _LIQUID, BAND),
    PredicateInfo("liquid_level_at", "m", _LIQUID, BAND),
    PredicateInfo(
        "liquid_flux_through",
        "m^3",
        (*_LIQUID, "particle/id"),
        BAND,
        frames="either",
        event=True,
        gloss="At least `min` of it passes the opening along its normal.",
        source="particles by their ids",
    ),
    PredicateInfo(
        "liquid_arrives",
        "m^3",
        _LIQUID,
        {"min_volume": "up", "within": "down"},
        frames="narrower",
        event=True,
        gloss="At least `min_volume` of it comes into the region.",
        source="particles' volumes",
    ),
    PredicateInfo("submerged_fraction", "1", _LIQUID, BAND),
    PredicateInfo("wet_area", "m^2", _LIQUID, BAND),
    PredicateInfo(
        "splash_height",
        "m",
        _LIQUID,
        BAND,
        event=True,
        gloss="Eight of its particles are at least `min` above where its highest point was at frame 0.",
        source="own choice: eight particles make a splash",
    ),
    PredicateInfo("liquid_speed", "m/s", (*_LIQUID, "particle/velocity"), BAND),
    PredicateInfo("liquid_temperature", "K", (*_LIQUID, "particle/temperature"), BAND),
)
