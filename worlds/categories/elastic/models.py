"""Elastic bodies (R62, R64): material, resolution, pins, and the bounds that the contract sets to their deformation."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from ...matter import Matter, MatterShape
from ...vocabulary import EntityRef, Id, NonNegative, Positive, SpecModel, Vec3

__all__ = ["ElasticPhysics", "Pin"]


class Pin(SpecModel):
    """A box of the body that is held: fixed in the world, or carried by another entity."""

    center: Vec3 = Field(description="of the box, in the entity's frame at rest [m]")
    size: tuple[Positive, Positive, Positive] = Field(description="of the box, along the entity's axes [m]")
    to: EntityRef | None = Field(default=None, description="who carries it; default: the world")


class ElasticPhysics(Matter):
    """Elastic body; its rest shape is its one part, a closed solid."""

    shape: ClassVar[MatterShape] = "deforming"
    feels_fields: ClassVar[bool] = True
    body: ClassVar[bool] = True
    category: Literal["elastic"] = "elastic"
    young_modulus: Positive = Field(description="[Pa]; jelly 1e3..1e4, rubber 1e6..1e7")
    poisson_ratio: float = Field(default=0.3, ge=0, le=0.49)
    damping: NonNegative = Field(default=0.0, le=1.0, description="Rayleigh stiffness damping [s]")
    yield_strain: NonNegative = Field(
        default=0.0, le=1.0, description="elastic strain beyond which the body keeps its new shape; 0: it never does"
    )
    resolution: Positive | None = Field(
        default=None,
        description="edge of the cells in which displacements are quadratic [m]; default: half the smallest extent, all of it where "
        "the body is slender",
    )
    pins: Annotated[dict[Id, Pin], Field(max_length=16)] = {}
    linear_velocity: Vec3 = Field(default=(0, 0, 0), description="at frame 0 [m/s]")
    # Rubber of the best kind tears at a stretch of 7 to 8 (Treloar 1975).
    max_strain: Positive = Field(default=0.5, le=8, description="largest allowed principal strain")
    # What stays bent by half of its size has not come back.
    recovery: Positive = Field(default=0.02, le=0.5, description="allowed residual deformation / size at rest")

    def geometry(self) -> dict[str, Any]:
        """The edge of the cells."""
        return {"resolution": self.resolution}
