"""What the modules of the shot checks share: their claims and how their rows are written."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .verdicts import make_row

if TYPE_CHECKING:
    from ..worlds.candidate import Candidate
    from ..worlds.requirements import Row, Status
    from ..worlds.spec import Shot

__all__ = ["CLAIMS", "SCREEN_STEP", "shot_row", "shots_at", "subjects_of"]

SCREEN_STEP = 0.2
"""Own choice: a picture that moves by more than a fifth of its width per frame cannot be followed by eye."""
CLAIMS = {
    "tiling": "shots follow each other over all planned frames without gap or overlap",
    "cover": "a shot runs while the beat happens",
    "visible": "the beat's subject is in view and unoccluded while it happens, and at the moment it comes true",
    "framed": "every subject of the shot is in view, and what it follows stays in view",
    "inside": "the camera is inside no solid, passes through no surface and cuts none off",
    "motion": f"the picture moves, turns and zooms by at most {SCREEN_STEP:g} of its width per frame",
}
"""Predicate of the rows of each kind."""


def shot_row(candidate: Candidate, row_id: str, status: Status, explanation: str, **more: Any) -> Row:
    """One row; its predicate follows from the second word of its id."""
    extra = [
        {n: s.model_dump(mode="json") for n, s in candidate.spec.shots.items()},
        candidate.spec.simulation.limits.model_dump(mode="json"),
    ]
    more.setdefault("frames", (0, candidate.spec.simulation.frames - 1))
    return make_row(
        candidate,
        row_id,
        check="shots",
        group="observational",
        predicate=CLAIMS[row_id.split(":")[1]],
        status=status,
        explanation=explanation,
        extra=extra,
        recipe_entities=list(candidate.spec.entities),
        **more,
    )


def shots_at(candidate: Candidate, frame: int) -> list[str]:
    """Shots that run at a frame."""
    return [n for n, s in candidate.spec.shots.items() if s.frames[0] <= frame <= s.frames[1]]


def subjects_of(candidate: Candidate, shot: Shot) -> list[str]:
    """Entities that a shot must frame: its own list, else the subjects of the beats it covers."""
    beats = candidate.spec.story.beats
    return list(dict.fromkeys(shot.subjects or [beats[b].subject for b in shot.covers if b in beats]))
