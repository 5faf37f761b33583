"""Events of cloth, each by a physical definition; thresholds stand in `verifiers/categories/cloth/bounds.py` (R28, R131)."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ...predicate_base import PredicateInfo, Subject
from ..event import MatterEvent

__all__ = ["EVENTS", "TearEvent"]


class TearEvent(MatterEvent):
    """A cloth tears."""

    kind: Literal["tears"]
    other: Subject | None = Field(default=None, description="the logged cause of its tears; default: any")


EVENTS = (
    PredicateInfo(
        "tears",
        "1",
        ("vertex/position", "edge/open", "tear/corner", "tear/side", "tear/cause"),
        {"min": "up"},
        frames="narrower",
        event=True,
        adds_up=True,
        gloss="Edges of the cloth open, by `other` where it is named, over at least 0.05 of the side of a square as large as it, and the lips of "
        "a tear part by at least 0.005 of that side.",
        source="tearing strength of fabrics (ISO 13937) counts a length that parts under a pull; the shares are own choices, above a snag",
    ),
)
