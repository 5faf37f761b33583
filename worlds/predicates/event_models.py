"""Predicates that say that something happens to a body, each by a physical definition (R15, R131, R157).

Definitions and thresholds stand in `event_kinds.py`; effects are relative to the body's size, where half of its smallest extent is its
half-size. An event is judged over its frames: it is true from the frame on at which its measure is reached, while it goes on.
"""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from ..predicate_base import Subject, When
from ..vocabulary import Positive, SpecModel

__all__ = ["BodyEvent", "Compares", "PairEvent", "TouchEvent"]


class _Event(SpecModel):
    entity: Subject
    min: Positive | None = Field(
        default=None, description="least measured value, in the kind's unit; the kind's own threshold holds besides"
    )


class BodyEvent(_Event):
    """Something happens to the entity: it falls, rises, spins, swings, jumps, drifts, slows, comes to rest."""

    kind: Literal["falls", "rises", "spins", "stops", "slows", "swings", "jumps", "drifts"]


class TouchEvent(_Event):
    """Something happens to the entity at `other`: what it touches, or what holds it."""

    kind: Literal["rolls", "slides", "tips", "lands", "bounces", "goes_uphill", "comes_loose", "opens", "closes"]
    other: Subject | None = Field(
        default=None,
        description="default: what bears it where it rolls, slides or tips, else anything that it touches or that held it",
    )


class PairEvent(_Event):
    """The entity does something to `other`; the two exchanged are another event."""

    kind: Literal["hits", "pushes", "pulls", "lifts", "lowers", "throws", "rests_against", "jams"]
    other: Subject


class Compares(SpecModel):
    """A quantity of `a` less that of `b`, at one frame: at least `margin` more, at least `margin` less, or the same within it."""

    kind: Literal["compares"] = "compares"
    a: Subject
    b: Subject
    quantity: Literal["height", "speed", "tilt", "size", "mass", "distance_to"] = Field(
        description="of the centre, against gravity [m]; [m/s]; of the own z axis against frame 0 [rad]; largest extent [m]; [kg]; "
        "of the centre from that of `target` [m]"
    )
    relation: Literal["more", "less", "same"]
    margin: Positive = Field(description="least difference, of `same` the largest one; in the quantity's unit")
    target: Subject | None = Field(default=None, description="`distance_to` alone: from whom")
    when: When = "eventually"

    @model_validator(mode="after")
    def _from_somebody(self) -> Compares:
        if (self.target is None) == (self.quantity == "distance_to"):
            raise ValueError("give target for distance_to, and for no other quantity")
        return self
