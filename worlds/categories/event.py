"""Fields that the events of all categories of matter have in common."""

from __future__ import annotations

from pydantic import Field

from ..predicate_base import Subject
from ..vocabulary import Positive, SpecModel

__all__ = ["MatterEvent"]


class MatterEvent(SpecModel):
    """Something happens to the entity, by a physical definition."""

    entity: Subject
    min: Positive | None = Field(
        default=None, description="least measured value, in the kind's unit; the kind's own threshold holds besides"
    )
