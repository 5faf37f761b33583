"""Predicates about gases. Their evidence is the cells of an engine."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from ...predicate_base import BAND, Band, PredicateInfo, Subject, When
from ...vocabulary import EntityRef, Finite, Positive, RegionRef, SpecModel, Vec3
from ..event import MatterEvent
from .noise import GAS_NOISE

__all__ = [
    "PREDICATES",
    "BurntShare",
    "FireEvent",
    "GasArrives",
    "GasClears",
    "GasDensityIn",
    "GasTemperatureIn",
    "HeatRelease",
    "LightThrough",
    "PlumeHeight",
]


class GasDensityIn(Band):
    """Soot of a gas in a region [kg/m^3]."""

    kind: Literal["gas_density_in"] = "gas_density_in"
    entity: Subject = Field(description="the gas")
    region: RegionRef
    measure: Literal["mean", "largest"] = Field(default="mean", description="mean: by volume, of what is open there")
    when: When = "eventually"


class GasTemperatureIn(Band):
    """Temperature of a gas in a region [K]."""

    kind: Literal["gas_temperature_in"] = "gas_temperature_in"
    entity: Subject = Field(description="the gas")
    region: RegionRef | None = Field(default=None, description="default: all of its box")
    measure: Literal["mean", "lowest", "highest"] = Field(default="mean", description="mean: by volume, of what is open there")
    when: When = "eventually"


class PlumeHeight(Band):
    """Height over `base` [m] below which 95 % of its soot is."""

    kind: Literal["plume_height"] = "plume_height"
    entity: Subject = Field(description="the gas")
    base: Finite = Field(default=0.0, description="height z that counts as 0 [m]")
    when: When = "eventually"


class GasArrives(SpecModel):
    """A gas comes into a region or to an entity."""

    kind: Literal["gas_arrives"] = "gas_arrives"
    entity: Subject = Field(description="the gas")
    region: RegionRef | None = None
    target: EntityRef | None = Field(default=None, description="entity that it reaches; give region or target")
    within: Positive | None = Field(default=None, description="of the target's surface [m]; default: one cell")
    min_density: Positive | None = Field(
        default=None, description="soot that arrives [kg/m^3]; default: a hundredth of that of its source"
    )

    @model_validator(mode="after")
    def _one_place(self) -> GasArrives:
        if (self.region is None) == (self.target is None):
            raise ValueError("give either region or target")
        return self


class LightThrough(Band):
    """Share of light that passes a gas along a line, 0..1."""

    kind: Literal["light_through"] = "light_through"
    entity: Subject = Field(description="the gas")
    start: Vec3 = Field(description="where the line begins [m]")
    end: Vec3 = Field(description="where it ends [m]")
    when: When = "eventually"

    @model_validator(mode="after")
    def _has_length(self) -> LightThrough:
        if sum((a - b) ** 2 for a, b in zip(self.start, self.end, strict=True)) < 1e-12:
            raise ValueError("start and end must differ")
        return self


class HeatRelease(Band):
    """Power of the flames of a gas [W]."""

    kind: Literal["heat_release"] = "heat_release"
    entity: Subject = Field(description="the gas, which has a fuel")
    region: RegionRef | None = Field(default=None, description="default: all of its box")
    when: When = "eventually"


class BurntShare(Band):
    """Share of the mass of a solid or of cloth that can become gas which has burnt away, 0..1."""

    kind: Literal["burnt_share"] = "burnt_share"
    entity: Subject = Field(description="what may burn")
    when: When = "eventually"


class FireEvent(MatterEvent):
    """A gas, or a solid or cloth that may burn, does, or its fire goes out."""

    kind: Literal["burns", "goes_out"]


class GasClears(SpecModel):
    """A gas clears away, or goes out: little is left of the most that was there."""

    kind: Literal["gas_clears"] = "gas_clears"
    entity: Subject = Field(description="the gas")
    region: RegionRef | None = Field(default=None, description="default: all of its box")
    max_share: Positive = Field(default=0.05, le=0.5, description="of the most soot that was there, that may be left")


_GAS = ("gas_soot", "gas_room", "gas_corner")
PREDICATES = (
    PredicateInfo("gas_density_in", "kg/m^3", _GAS, BAND, noise=GAS_NOISE),
    PredicateInfo("gas_temperature_in", "K", (*_GAS, "gas_temperature"), BAND, noise=GAS_NOISE),
    PredicateInfo("plume_height", "m", _GAS, BAND, noise=GAS_NOISE),
    PredicateInfo(
        "gas_arrives",
        "kg/m^3",
        _GAS,
        {"min_density": "up", "within": "down"},
        frames="narrower",
        event=True,
        noise=GAS_NOISE,
        gloss="At least `min_density` of its soot (0.01 of that of its source) comes into a cell of the region, or to the target's surface.",
        source="cells of its box; the share is an own choice between a haze and what rounding spreads",
    ),
    PredicateInfo("light_through", "1", _GAS, BAND, noise=GAS_NOISE),
    PredicateInfo(
        "gas_clears",
        "1",
        _GAS,
        {"max_share": "down"},
        frames="narrower",
        event=True,
        ends=True,
        gloss="Of the most of its soot that was there at a frame before, no more than `max_share` is left, and an eye saw the most: an optical depth of 0.05.",
        source="own choice: what was never seen does not clear; Koschmieder's contrast of 0.02 to 0.05",
    ),
    PredicateInfo("heat_release", "W", (*_GAS, "gas_released"), BAND, noise=GAS_NOISE),
    PredicateInfo("burnt_share", "1", ("burning_left", "burning_area"), BAND, matter="entity", least={"min": 1e-3}),
    PredicateInfo(
        "burns",
        "W",
        (*_GAS, "gas_released"),
        {"min": "up"},
        frames="narrower",
        matter="entity",
        event=True,
        gloss="Its flames give at least 10 W at every frame of 0.2 s; of a solid or of cloth, what the gas that it gives off has, as far as flames at its surface give it.",
        source="own choice: a tenth of what a candle gives (80 W: Hamins, Bundy and Dillon 2005, Journal of Fire Protection Engineering 15, 265); a flash is no fire",
    ),
    PredicateInfo(
        "goes_out",
        "1",
        (*_GAS, "gas_released"),
        {"min": "up"},
        frames="narrower",
        matter="entity",
        event=True,
        ends=True,
        gloss="It burns within the interval, and then its flames give no more than 0.01 of the most that they gave, to the last frame of the world.",
        source="own choice: the share at which no flame is seen beside what was there",
    ),
)
