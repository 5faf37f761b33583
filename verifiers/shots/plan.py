"""The shot plan as all its judges read it: shots at a frame, subjects of a shot, frames of a beat's outcome, and their rows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ...worlds.predicates import atoms_of, describe_predicate
from ...worlds.predicates.registry import is_invariant
from ..predicates.evaluators import beat_times
from ..rows.answers import row_of
from ..rows.findings import Finding, judged
from .bounds import MOMENT

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Row
    from ...worlds.spec import Beat, Shot
    from ..rows.questions import Question

__all__ = ["outcome_frames", "shot_row", "shots_at", "subjects_of", "unseen_text"]


def shot_row(
    candidate: Candidate,
    question: Question,
    subject: tuple[str, ...],
    found: Finding | Callable[[], Finding],
    *,
    planned: bool = False,
) -> Row:
    """The row of a question about the shot plan.

    Args:
        candidate: what is judged.
        question: what is asked.
        subject: name of the beat or shot.
        found: the answer, or the judge that gives it.
        planned: whether the plan alone was looked at, and no frame.
    """
    spec = candidate.spec
    found = found if isinstance(found, Finding) else judged(found)
    shots = {n: s.model_dump(mode="json") for n, s in spec.shots.items()}
    return row_of(
        candidate,
        question,
        subject,
        replace(found, frames=found.frames or (0, spec.simulation.frames - 1)),
        extra=[shots, spec.simulation.limits.model_dump(mode="json")],
        recipe_entities=list(spec.entities),
        artifact="world.json" if planned else None,
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
