"""Events of liquids, each by a physical definition whose thresholds stand in `verifiers/categories/liquid/bounds.py` (R28, R131)."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ...predicate_base import PredicateInfo, Subject
from ..event import MatterEvent

__all__ = ["EVENTS", "BuoyancyEvent"]


class BuoyancyEvent(MatterEvent):
    """A body floats or sinks in a liquid, by what the liquid's push does to its weight."""

    kind: Literal["floats", "sinks"]
    other: Subject = Field(description="the liquid")


_PUSHES = ("origin", "particle/position", "particle/fluid", "particle/volume", "exchange/impulse")
EVENTS = (
    PredicateInfo(
        "floats",
        "1",
        _PUSHES,
        {"min": "up"},
        frames="narrower",
        bodily=True,
        event=True,
        directed=True,
        gloss="For half a second the push of `other` carries at least 0.8 of its weight and nothing else more than 0.2, while part of it is "
        "above the surface or it goes down by no more than 0.1 of its height.",
        source="Archimedes, On Floating Bodies I, 5: what floats is borne by the liquid that it displaces; shares and span are own choice",
    ),
    PredicateInfo(
        "sinks",
        "1",
        _PUSHES,
        {"min": "up"},
        frames="narrower",
        bodily=True,
        event=True,
        directed=True,
        adds_up=True,
        gloss="Wholly under the surface of `other` and denser than it, it goes down by its own height, by 0.5 of it where it comes to the "
        "bottom, while all others together give no more than 0.2 of its weight.",
        source="Archimedes, On Floating Bodies I, 7: what is heavier than the liquid goes down to the bottom; shares and ways are own choice",
    ),
)
