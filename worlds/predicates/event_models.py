"""Predicates that say that something happens to a body, each by a physical definition (R15, R131, R157).

Definitions and thresholds stand in `event_kinds.py`; effects are relative to the body's size, where half of its smallest extent is its
half-size. An event is judged over its frames: it is true from the frame on at which its measure is reached, while it goes on.
"""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ..predicate_base import Subject
from ..vocabulary import Positive, SpecModel

__all__ = ["BodyEvent", "PairEvent", "TouchEvent"]


class _Event(SpecModel):
    entity: Subject
    min: Positive | None = Field(
        default=None, description="least measured value, in the kind's unit; the kind's own threshold holds besides"
    )


class BodyEvent(_Event):
    """Something happens to the entity: it falls, rises, tips, spins, comes to rest."""

    kind: Literal["falls", "rises", "spins", "stops"]


class TouchEvent(_Event):
    """Something happens to the entity in contact with `other`, or with whatever it touches."""

    kind: Literal["rolls", "slides", "tips", "lands"]
    other: Subject | None = Field(default=None, description="default: anything that it touches")


class PairEvent(_Event):
    """The entity does something to `other`; the two exchanged are another event."""

    kind: Literal["hits", "pushes"]
    other: Subject
