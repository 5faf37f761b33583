"""Questions of the check `shots`."""

from __future__ import annotations

from ..rows.questions import Question
from .bounds import SCREEN_STEP, SEEN_NOISE

__all__ = ["COVER", "FRAMED", "INSIDE", "MOTION", "OBSERVED", "QUESTIONS", "SEEN", "TILING", "VISIBLE"]

TILING = Question(
    "shots:tiling",
    "shots follow each other over all planned frames without gap or overlap",
    "gaps and overlaps",
    "faults",
    "<=",
    "0",
)
COVER = Question(
    "shots:cover",
    "a shot runs when the beat comes true",
    "frames around the one at which it comes true that lie in one shot",
    "frames",
    ">=",
    "1",
    ("beat",),
)
OBSERVED = Question(
    "shots:observed",
    "at least one mandatory beat is observed; those that no camera is asked to see are printed",
    "mandatory beats that are observed",
    "beats",
    ">=",
    "1",
    ("story",),
)
VISIBLE = Question(
    "shots:visible",
    "the beat's subject is in view and unoccluded while it happens, and at the moment it comes true",
    "first that is missed: share of the picture, unoccluded share, share of frames in view, unoccluded share at the moment",
    "1",
    ">=",
    "limits.visible_pixels, limits.visible_share, limits.beat_seen_frames",
    ("beat",),
)
FRAMED = Question(
    "shots:framed",
    "every subject of the shot is in view, and what it follows stays in view",
    "share of the picture that the smallest subject fills at best; share of the frames that show what the shot follows",
    "1",
    ">=",
    "limits.visible_pixels, limits.beat_seen_frames",
    ("shot",),
)
INSIDE = Question("shots:inside", "the camera is inside no solid, passes through no surface and cuts none off", subject=("shot",))
MOTION = Question(
    "shots:motion",
    f"the picture moves, turns and zooms by at most {SCREEN_STEP:g} of its width per frame",
    "largest change of the picture from frame to frame, in widths",
    "1",
    "<=",
    "SCREEN_STEP",
    ("shot",),
)
SEEN = Question(
    "shots:seen",
    "in the light of the film, the beat's subject differs from what is behind it",
    f"share of the subject's pixels whose colour, with and without it, differs by more than {SEEN_NOISE:g} times the noise",
    "1",
    ">=",
    "SEEN_SHARE",
    ("beat",),
)

QUESTIONS = (TILING, COVER, OBSERVED, VISIBLE, FRAMED, INSIDE, MOTION, SEEN)
