"""Predicates about bodies that break. Their evidence is the log of bonds of a rigid engine and the poses of the pieces."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from ...predicate_base import BAND, POSE, Band, PredicateInfo, Subject, When
from ...vocabulary import EntityRef, NonNegative, Positive, RegionRef, SpecModel, Vec3

__all__ = ["PREDICATES", "Breach", "Broken", "Debris"]


class Broken(Band):
    """Share of a breakable entity's bonds that broke since the interval began, 0 to 1."""

    kind: Literal["broken"] = "broken"
    entity: Subject
    by: EntityRef | None = Field(
        default=None,
        description="count only bonds whose logged cause is this entity, or pieces that it set in motion; default: all",
    )
    when: When = "eventually"


class Breach(SpecModel):
    """A breakable entity has an opening: seen along a direction, a rectangle in which no piece of it stands any more."""

    kind: Literal["breach"] = "breach"
    entity: Subject
    direction: Vec3 = Field(description="along which one looks through, level, world axes")
    point: Vec3 = Field(description="that the opening must hold, world [m]; where the ball hits")
    min_width: Positive = Field(description="level extent of the opening [m]")
    min_height: Positive = Field(description="[m]")
    when: When = "eventually"

    @model_validator(mode="after")
    def _looks_somewhere(self) -> Breach:
        if self.direction[0] ** 2 + self.direction[1] ** 2 < 1e-12:
            raise ValueError("direction must have a level part")
        return self


class Debris(Band):
    """Number of loose lumps of a breakable entity that lie off their place; pieces that still hold together are one lump."""

    kind: Literal["debris"] = "debris"
    entity: Subject
    min_distance: NonNegative = Field(default=0.05, description="of the lump's centre of mass from where it was built [m]")
    axis: Vec3 | None = Field(
        default=None, description="measure the distance along this direction only, world; [0, 0, -1]: how far it fell"
    )
    region: RegionRef | None = Field(
        default=None,
        description="count only lumps whose centre of mass was built in it, so that others do not count, such as those that the "
        "blow itself drives out; a region of the world, without relative_to",
    )
    when: When = "eventually"

    @model_validator(mode="after")
    def _points_somewhere(self) -> Debris:
        if self.axis is not None and sum(c * c for c in self.axis) < 1e-12:
            raise ValueError("axis must have a length")
        return self


_BONDS = ("bond/broken", "break/time", "break/bond", "break/cause")
PREDICATES = (
    PredicateInfo(
        "broken",
        "1",
        _BONDS,
        BAND,
        event=True,
        gloss="At least `min` of its bonds break in the interval.",
        source="log of breaks",
    ),
    PredicateInfo(
        "breach",
        "m",
        (*POSE, *_BONDS),
        {"min_width": "up", "min_height": "up"},
        event=True,
        gloss="A rectangle of `min_width` by `min_height` opens in which no piece stands any more.",
        source="geometry",
    ),
    PredicateInfo("debris", "1", (*POSE, *_BONDS), {**BAND, "min_distance": "up"}),
)
