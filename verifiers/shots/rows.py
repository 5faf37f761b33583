"""What the modules of the shot checks share: their claims and how their rows are written."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.predicates import atoms_of, describe_predicate
from ...worlds.predicates.registry import is_invariant
from ..predicates import beat_times
from ..rows.verdicts import make_row

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Row, RowId, Status
    from ...worlds.spec import Beat, Shot

__all__ = ["CLAIMS", "MOMENT", "SCREEN_STEP", "outcome_frames", "shot_row", "shots_at", "subjects_of", "unseen_text"]

SCREEN_STEP = 0.2
"""Own choice: a picture that moves by more than a fifth of its width per frame cannot be followed by eye."""
MOMENT = 0.25
"""[s] Own choice: the frame at which a beat comes true is shown when its subject is seen within this time of it."""
CLAIMS = {
    "shots:tiling": "shots follow each other over all planned frames without gap or overlap",
    "shots:cover": "a shot runs when the beat comes true",
    "shots:observed": "at least one mandatory beat is observed; those that no camera is asked to see are printed",
    "shots:visible": "the beat's subject is in view and unoccluded while it happens, and at the moment it comes true",
    "shots:framed": "every subject of the shot is in view, and what it follows stays in view",
    "shots:inside": "the camera is inside no solid, passes through no surface and cuts none off",
    "shots:motion": f"the picture moves, turns and zooms by at most {SCREEN_STEP:g} of its width per frame",
}
"""Predicate by question."""


def shot_row(candidate: Candidate, row_id: RowId, status: Status, explanation: str, **more: Any) -> Row:
    """One row; its predicate follows from its question."""
    extra = [
        {n: s.model_dump(mode="json") for n, s in candidate.spec.shots.items()},
        candidate.spec.simulation.limits.model_dump(mode="json"),
    ]
    more.setdefault("frames", (0, candidate.spec.simulation.frames - 1))
    return make_row(
        candidate,
        row_id,
        predicate=CLAIMS[row_id.question],
        status=status,
        explanation=explanation,
        extra=extra,
        recipe_entities=list(candidate.spec.entities),
        **more,
    )


def outcome_frames(candidate: Candidate, beat_id: str) -> tuple[int, int] | None:
    """First and last frame that count as those of a beat's outcome; None where it has none.

    Within `MOMENT` of the frame at which it comes true; of what is asked for at the end, from where it is true for good to the end; of
    a state that lasts, the whole interval.
    """
    beat, outcome = candidate.spec.story.beats[beat_id], beat_times(candidate).outcome(beat_id)
    first, reach = outcome.first_true_frame, round(MOMENT * candidate.spec.simulation.fps)
    if candidate.stage == "static" or first is None:
        return None
    if is_invariant(beat.predicate):
        return beat.frames
    last = first + reach
    if any(getattr(a, "when", "") == "end" for a in atoms_of(beat.predicate)):
        broken = [] if outcome.truth is None else np.flatnonzero(~outcome.truth).tolist()
        first, last = (beat.frames[0] + broken[-1] + 1 if broken else first), beat.frames[1]
        first = min(first, last)
    return max(0, first - reach), min(candidate.last_frame, last)


def shots_at(candidate: Candidate, frame: int) -> list[str]:
    """Shots that run at a frame."""
    return [n for n, s in candidate.spec.shots.items() if s.frames[0] <= frame <= s.frames[1]]


def subjects_of(candidate: Candidate, shot: Shot) -> list[str]:
    """Entities that a shot must frame: its own list, else the subjects of the beats it covers."""
    beats = candidate.spec.story.beats
    return list(dict.fromkeys(shot.subjects or [beats[b].subject for b in shot.covers if b in beats]))


def unseen_text(name: str, beat: Beat) -> str:
    """That no camera is asked to see a beat, and what it asks for."""
    return f"beat {name!r} is not seen by any camera (observe: false): {describe_predicate(beat.predicate)}"
