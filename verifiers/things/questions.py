"""Questions about things: what opens, how large their kind is, how well the shapes of their parts agree."""

from __future__ import annotations

from ..rows.questions import Question

__all__ = ["JOINT", "KIND", "QUESTIONS", "SHAPES"]

JOINT = Question(
    "navigability:joint",
    "what opens by joint {0} can be moved with everything as it stands at frame 0",
    "share of the joint's range that is free",
    "1",
    ">=",
    "DRAWN_SHARE of a slide; of a hinge OPEN_SHARE, or OPEN_ANGLE where that is less",
    ("joint",),
)
KIND = Question(
    "scale:kind",
    "measures of {0} are those of its kind",
    "the measure that is furthest out, or nearest to a bound",
    "m",
    "<=",
    "`verifiers/things/kinds.json`, by the generator or the role, with sources",
    ("entity",),
)
SHAPES = Question(
    "scale:shapes",
    "collision, simulation and visible shapes of each part of {0} are the same",
    "largest distance of a point of one from the other",
    "m",
    "<=",
    "SHAPES_SHARE of the part's size, at least SHAPES_LEAST",
    ("entity",),
)

QUESTIONS = (JOINT, KIND, SHAPES)
