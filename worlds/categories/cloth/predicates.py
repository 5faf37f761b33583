"""Predicates about cloth: how it drapes and flutters, where it tears, whether its pins keep it."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ...predicate_base import BAND, Band, PredicateInfo, Subject, When
from ...vocabulary import EntityRef, Id, NonNegative, Positive, SpecModel, Vec3

__all__ = ["PREDICATES", "Drape", "Flutters", "Pinned", "Torn"]


class Drape(Band):
    """Drape coefficient (Cusick): (shadow of a cloth from above - the body's) / (its flat area - the body's shadow); 1: it stays flat."""

    kind: Literal["drape"] = "drape"
    entity: Subject
    over: EntityRef = Field(description="rigid entity that carries it")
    when: When = "end"


class Flutters(SpecModel):
    """A cloth goes to and fro, by so much to either side along the main direction of each of its points: a tenth of its free area at least."""

    kind: Literal["flutters"] = "flutters"
    entity: Subject
    point: Vec3 | None = Field(
        default=None,
        description="of the cloth, in the entity's frame [m]: it alone is judged; default: a tenth of the area that no pin holds",
    )
    min_amplitude: Positive = Field(description="[m]")
    max_amplitude: Positive | None = Field(default=None, description="[m]")
    min_cycles: Positive = Field(default=2.0, description="to and fro about the mean, within the interval")
    min_frequency: NonNegative = Field(default=0.0, description="[Hz]")
    max_frequency: Positive | None = Field(default=None, description="[Hz]; frames tell frequencies below half their rate only")


class Torn(Band):
    """Length of the edges of a cloth that opened since the interval began [m]."""

    kind: Literal["torn"] = "torn"
    entity: Subject
    by: EntityRef | None = Field(default=None, description="count only tears whose logged cause is this entity; default: all")
    when: When = "eventually"


class Pinned(SpecModel):
    """What pins hold of a cloth is where they take it."""

    kind: Literal["pinned"] = "pinned"
    entity: Subject
    pin: Id | None = Field(default=None, description="one of its pins; default: all")
    max_slip: NonNegative = Field(default=1e-4, description="farthest that a held vertex may be off [m]")
    when: When = "always"


_SHEETS = ("vertex/position",)
PREDICATES = (
    PredicateInfo("drape", "1", _SHEETS, BAND),
    PredicateInfo(
        "flutters",
        "m",
        _SHEETS,
        {"min_amplitude": "up", "max_amplitude": "down", "min_cycles": "up", "min_frequency": "up", "max_frequency": "down"},
        frames="either",
        event=True,
        gloss="It goes to and fro by `min_amplitude` to either side, `min_cycles` times, over a tenth of its free area.",
        source="spectrum of the motion of its points",
    ),
    PredicateInfo(
        "torn",
        "m",
        (*_SHEETS, "edge/open", "tear/corner", "tear/side", "tear/cause"),
        BAND,
        event=True,
        gloss="At least `min` of its edges, in metres, open in the interval.",
        source="log of tears",
    ),
    PredicateInfo("pinned", "m", _SHEETS, {"max_slip": "down"}),
)
