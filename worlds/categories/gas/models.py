"""Smoke and fire in entity contracts (R61)."""

from __future__ import annotations

from typing import ClassVar, Literal

from pydantic import Field

from ...matter import Matter, MatterShape
from ...vocabulary import NonNegative, Positive

__all__ = ["GasPhysics"]


class GasPhysics(Matter):
    """Smoke or fire; the entity's parts are its source."""

    shape: ClassVar[MatterShape] = "loose"
    category: Literal["gas"] = "gas"
    temperature: Positive = Field(default=400.0, description="source temperature [K]")
    soot_density: NonNegative = Field(default=1.0, description="[kg/m^3]")
    fuel: bool = False
    resolution: Positive = Field(description="cell size [m]")

    @property
    def flow_cell(self) -> float:
        """Cell or particle spacing [m]."""
        return self.resolution
