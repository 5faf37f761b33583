"""Events of bodies that deform, each by a physical definition; thresholds stand in `verifiers/categories/elastic/bounds.py` (R28, R131)."""

from __future__ import annotations

from typing import Literal

from ...predicate_base import PredicateInfo
from ..event import MatterEvent

__all__ = ["EVENTS", "DeformEvent"]


class DeformEvent(MatterEvent):
    """An elastic body bends, stretches, or wobbles; a sheet may bend too, as an awning that sags."""

    kind: Literal["bends", "stretches", "wobbles"]


def _event(kind: str, gloss: str, source: str) -> PredicateInfo:
    return PredicateInfo(
        kind, "1", ("vertex/position",), {"min": "up"}, "narrower", event=True, adds_up=True, gloss=gloss, source=source
    )


EVENTS = (
    _event(
        "bends",
        "Its middle line, less its best straight line and compared with that of the first frame, is off by at least 0.02 of its length; of a sheet along "
        "either side.",
        "beam theory: bending is the curvature of the middle line, which no turn of the whole body has; the share is an own choice",
    ),
    _event(
        "stretches",
        "Its middle line becomes longer than at the first frame by at least 0.05.",
        "strain of the middle line, which bending leaves alone; the share is an own choice",
    ),
    _event(
        "wobbles",
        "A point of it goes to and fro against the rest of it: two turning points at least, each 0.01 of its length from the one before.",
        "vibration: two turning points make a period; the share is an own choice, above what a body settles by",
    ),
)
