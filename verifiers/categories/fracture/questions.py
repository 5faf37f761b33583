"""Questions about breakable bodies: their pieces, what holds them together, and what broke it."""

from __future__ import annotations

from ...rows.questions import Question
from ..rigid.bounds import IMPULSE
from .bounds import APART, OVERLOAD, STEADY, VOLUME

__all__ = ["QUESTIONS"]

QUESTIONS = (
    Question(
        "category:fracture:pieces",
        f"pieces are closed and hold volume and mass of the specified parts to {VOLUME:g}",
        "largest relative deviation of volume or mass; or pieces that are open or have no surface",
        "1",
        "<=",
        "VOLUME, ROUND_VOLUME, CAPPED_VOLUME; 0",
        ("entity",),
    ),
    Question(
        "category:fracture:bonded",
        f"pieces whose bonds hold move as one, to {APART:g} of a piece",
        "largest way by which bonded pieces, or one that is bonded to the world, move apart",
        "m",
        "<=",
        "APART of a piece's size",
        ("entity",),
    ),
    Question(
        "category:fracture:events",
        "every bond breaks once, in its frame, at its face, and its energy is recorded",
        "faults of the log of broken bonds",
        "1",
        "<=",
        "0",
        ("entity",),
    ),
    Question(
        "category:fracture:cause",
        "every bond broke under a stress over its strength, from loads that something gave",
        "least stress over strength, difference from the stress of the event, breaks without a touch, or load over what its cause can "
        "have given: the first of these that fails",
        "1",
        "<=",
        "1, RATIO, 0, 1",
        ("entity",),
    ),
    Question(
        "category:fracture:flight",
        f"loose pieces that nothing is near change their velocity by gravity to {IMPULSE:g} m/s per frame",
        "change of velocity or displacement that gravity does not explain: the one that is nearer to its bound",
        "various",
        "<=",
        "IMPULSE; PLACE",
        ("entity",),
    ),
    Question(
        "category:fracture:standing",
        f"no bond holds under more than {OVERLOAD:g} of its strength for {STEADY:g} s",
        "largest mean stress over strength of a bond that holds",
        "1",
        "<=",
        "OVERLOAD",
        ("entity",),
    ),
)
