"""Events of bodies that break, each by a physical definition; thresholds stand in `verifiers/categories/fracture/bounds.py` (R28, R131)."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ...predicate_base import POSE, PredicateInfo, Subject
from ..event import MatterEvent

__all__ = ["EVENTS", "FractureEvent"]


class FractureEvent(MatterEvent):
    """A breakable body cracks, or breaks: then pieces have come off, too."""

    kind: Literal["cracks", "breaks"]
    other: Subject | None = Field(
        default=None, description="the logged cause of its bonds, or of those that its own pieces broke in turn; default: any"
    )


_BONDS = ("bond/broken", "break/time", "break/bond", "break/cause")
EVENTS = (
    PredicateInfo(
        "cracks",
        "1",
        _BONDS,
        {"min": "up"},
        frames="narrower",
        bodily=True,
        event=True,
        adds_up=True,
        gloss="At least 0.01 of its bonds break, one at least, by `other` where it is named, whether its pieces part or not.",
        source="fracture mechanics: a crack is a surface on which bonds have failed; the share is an own choice",
    ),
    PredicateInfo(
        "breaks",
        "1",
        (*POSE, *_BONDS),
        {"min": "up"},
        frames="narrower",
        bodily=True,
        event=True,
        adds_up=True,
        gloss="Its bonds break, by `other` where it is named, and lumps of at least 0.02 of its mass in all that were one with the rest of it "
        "come off: each is at least 0.02 of its diagonal from where it would be, had it moved with the rest.",
        source="fracture mechanics: separation into pieces; the shares are own choices, a chip and what one can see part",
    ),
)
