"""Questions of the check `contact`."""

from __future__ import annotations

from ..rows.questions import Question

__all__ = ["CONTACT_SCENE", "DRAWN", "OVERLAP", "QUESTIONS", "THROUGH"]

CONTACT_SCENE = Question(
    "contact:scene",
    "every pair that can touch is inspected at every frame, none overlaps and none pushes where nothing is drawn",
    "rows that fail, and entities whose pose is not finite",
    "1",
    "<=",
    "0",
)
OVERLAP = Question(
    "contact",
    "visible surfaces of {0} and {1} do not overlap on any written frame",
    "least signed clearance over all frames",
    "m",
    ">=",
    "query noise; `max_depth` of a `fastened` relation; the depth to which faces of a breakable body crumble",
    ("entity", "entity"),
)
THROUGH = Question(
    "contact:through",
    "{0} does not pass through {1} between two frames",
    "least overlap on every path that the states allow",
    "m",
    "<=",
    "TUNNEL_SHARE of the thinner wall",
    ("entity", "entity"),
)
DRAWN = Question(
    "contact:drawn",
    "{0} and {1} push each other only where their visible surfaces meet",
    "least distance of the visible surfaces on every path that the states allow, in the frame of a push",
    "m",
    "<=",
    "limits.contact_gap, or skins and facet error where that is more, at most GAP_CAP",
    ("entity", "entity"),
)

QUESTIONS = (CONTACT_SCENE, OVERLAP, THROUGH, DRAWN)
