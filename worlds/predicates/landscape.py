"""Predicates about the land itself: its water bodies and its fields (R33-R45). They hold at every frame or at none."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, field_validator, model_validator

from ..predicate_base import some_bound
from ..vocabulary import Finite, Id, NonNegative, SpecModel

__all__ = ["LandscapeField", "LandscapeWater"]

MEASURED = (
    "height", "sediment", "wear", "deposit", "basin_depth", "accumulation", "discharge", "rain", "slope", "roughness", "sun_hours",
    "sunlight", "sky", "wind_exposure", "water_distance", "height_above_water", "wetness", "moisture", "temperature", "soil_depth",
    "snow", "tree_density", "shrub_density", "grass_density", "rock_density", "pebble_density",
)  # fmt: skip
"""Fields whose mean over an area means something."""


class LandscapeWater(SpecModel):
    """The landscape has at least `min` such waters.

    With a zone: lakes and seas with a cell in it, rivers and streams that pass through it.
    """

    kind: Literal["landscape_water"] = "landscape_water"
    terrain: Id = Field(description="id under /terrains")
    water: Literal["lake", "river", "stream", "sea"]
    min: int = Field(default=1, ge=1, le=1000, description="how many")
    max: int | None = Field(default=None, ge=1, le=10000, description="how many at most")
    zone: Id | None = Field(default=None, description="zone of the terrain")
    ends_in: Literal["sea", "lake", "edge"] | None = Field(
        default=None, description="rivers and streams: where the water goes at last, through the reaches it joins"
    )
    min_depth: NonNegative = Field(default=0.0, description="greatest depth [m]")
    min_area: NonNegative = Field(default=0.0, description="lakes and seas [m^2]")
    min_length: NonNegative = Field(default=0.0, description="rivers and streams, along the bed to their end [m]")
    min_width: NonNegative = Field(default=0.0, description="rivers and streams, at the widest [m]")

    @model_validator(mode="after")
    def _fits(self) -> LandscapeWater:
        if self.max is not None and self.max < self.min:
            raise ValueError("max must be >= min")
        flowing = self.water in ("river", "stream")
        wrong = ("min_area",) if flowing else ("ends_in", "min_length", "min_width")
        given = [n for n in wrong if getattr(self, n)]
        if given:
            raise ValueError(f"{given[0]} does not apply to water {self.water!r}")
        return self


class LandscapeField(SpecModel):
    """Mean of a field over dry land in a zone, or its ratio to the mean in another zone."""

    kind: Literal["landscape_field"] = "landscape_field"
    terrain: Id = Field(description="id under /terrains")
    field: str = Field(description=f"one of {', '.join(MEASURED)}")
    zone: Id | None = Field(default=None, description="zone of the terrain; default all of it")
    relative_to: Id | None = Field(default=None, description="zone whose mean it is divided by")
    min: Finite | None = Field(default=None, description="in the field's unit; with relative_to a ratio")
    max: Finite | None = None

    @field_validator("field")
    @classmethod
    def _known(cls, name: str) -> str:
        if name not in MEASURED:
            raise ValueError(f"unknown field {name!r}; use one of {', '.join(MEASURED)}")
        return name

    _ordered = model_validator(mode="after")(some_bound)
