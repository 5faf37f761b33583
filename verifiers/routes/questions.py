"""Questions of the check `navigability`."""

from __future__ import annotations

from ..rows.questions import Question

__all__ = ["NAVIGABILITY_SCENE", "QUESTIONS", "WAY"]

NAVIGABILITY_SCENE = Question("navigability:scene", "declared connections are traversable routes")
WAY = Question(
    "navigability",
    "the carrier of connection {0} gets from one region to the other",
    "clear width; or the slope, step, headroom, depth of water or gap that ends the way",
    "m",
    ">=",
    "fields of the `connects` relation (width, headroom, max_slope, max_step); of a walker at least those of a person",
    ("relation",),
)

QUESTIONS = (NAVIGABILITY_SCENE, WAY)
