"""Fields that the events of all categories of matter have in common."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ..predicate_base import Subject
from ..vocabulary import Positive, SpecModel

__all__ = ["MatterEvent", "VesselEvent"]


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
