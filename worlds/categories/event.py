"""Fields that the events of all categories of matter have in common."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from ..predicate_base import Subject
from ..vocabulary import Positive, SpecModel, Vec3

__all__ = ["FlowEvent", "MatterEvent", "SpreadEvent", "VesselEvent"]


class MatterEvent(SpecModel):
    """Something happens to the entity, by a physical definition."""

    entity: Subject
    min: Positive | None = Field(
        default=None, description="least measured value, in the kind's unit; the kind's own threshold holds besides"
    )


class VesselEvent(MatterEvent):
    """A liquid or grains fill a vessel or leave it."""

    kind: Literal["pours", "fills", "overflows", "leaks"]
    other: Subject = Field(description="the vessel: rigid, walled all round")


class FlowEvent(MatterEvent):
    """A liquid or grains flow through a disc."""

    kind: Literal["flows"]
    point: Vec3 = Field(description="middle of the disc [m]")
    normal: Vec3 = Field(description="along which it flows")
    radius: Positive = Field(description="[m]")

    @model_validator(mode="after")
    def _points_somewhere(self) -> FlowEvent:
        if sum(c * c for c in self.normal) < 1e-12:
            raise ValueError("normal must have a length")
        return self


class SpreadEvent(MatterEvent):
    """A liquid or grains spread over what bears them."""

    kind: Literal["spreads"]
