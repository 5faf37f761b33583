"""Balloons in entity contracts, the engine that moves them, and what can be asked of them."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from ...matter import Instance, Matter, MatterShape
from ...predicate_base import BAND, Band, PredicateInfo, Subject, When
from ...vocabulary import EntityRef, Positive, SpecModel

__all__ = ["PREDICATES", "Ascends", "BalloonInstance", "BalloonPhysics", "BalloonSettings"]


class BalloonPhysics(Matter):
    """Balloons: each spherical part of the entity is one. Their density, skin and gas together, is that of the material."""

    shape: ClassVar[MatterShape] = "loose"
    category: Literal["balloons"] = "balloons"
    air_drag: Positive = Field(description="drag of one balloon over its speed [kg/s]")


class BalloonSettings(SpecModel):
    """Settings of balloons in still air."""

    air_density: Positive = Field(default=1.2, description="[kg/m^3]")


class BalloonInstance(Instance):
    """Balloons that rise through still air, and the entities that it moves. They meet nothing."""

    moves: ClassVar[tuple[str, ...]] = ("balloons",)
    engine: Literal["aerostat"] = "aerostat"
    members: Annotated[list[EntityRef], Field(min_length=1, max_length=16)]
    settings: BalloonSettings = BalloonSettings()


class Ascends(Band):
    """Mean height that the balloons of an entity have gained since frame 0 [m]."""

    kind: Literal["ascends"] = "ascends"
    entity: Subject = Field(description="the balloons")
    when: When = "eventually"


PREDICATES = (
    PredicateInfo(
        "ascends",
        "m",
        ("origin", "particle/position", "balloon/member"),
        BAND,
        event=True,
        gloss="The mean height of its balloons has grown since frame 0 by what `min` says.",
        source="own choice: the law of Archimedes is judged by `category:balloons:balance`",
    ),
)
