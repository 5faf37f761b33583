"""Events of grains, each by a physical definition; thresholds stand in `verifiers/categories/particles/bounds.py` (R28, R131)."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ...predicate_base import POSE, PredicateInfo, Subject
from ..event import MatterEvent

__all__ = ["EVENTS", "BuryEvent"]


class BuryEvent(MatterEvent):
    """Grains bury a body."""

    kind: Literal["buries"]
    other: Subject = Field(description="the rigid body that they bury")


EVENTS = (
    PredicateInfo(
        "buries",
        "1",
        ("origin", "particle/position", "particle/velocity", "particle/member", "particle/radius", *POSE),
        {"min": "up"},
        frames="narrower",
        bodily=True,
        matter="entity",
        event=True,
        adds_up=True,
        directed=True,
        gloss="Grains lie on at least 0.9 of what is seen of `other` from above: no faster than a fall by one grain gives, within two grains over it; "
        "and that share has risen by 0.5.",
        source="own choice: a body of which a tenth looks out is not buried; grains that fly past cover nothing",
    ),
)
