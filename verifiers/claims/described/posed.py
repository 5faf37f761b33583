"""Answers to words of posture beside a place: whose posture, at which frames, and where no body of the place is measured together with it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ....worlds.poses import pose_said, spoken_later, subjects_of
from ...shots.views import samples
from .answers import Answer
from .bounds import OPENING
from .placed import Place
from .postures import is_measured, untold, why_not
from .rests import rest_said

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ....worlds.candidate import Candidate
    from ....worlds.poses import Posed
    from ....worlds.spec import WorldSpec

__all__ = ["SAYS", "frames_of", "pose_answers", "posed_things"]

LOOKS = 9
"""Own choice: frames at which a place is looked at; the first, the last and between."""
OPENS = 4
"""Own choice: frames of the first quarter of a second that are looked at where the prompt begins with a posture."""
SAYS = {"stand": "stands", "sit": "sits", "hang": "hangs", "lean": "leans", "lie": "lies"}
"""Verbs by which a posture is told."""


def posed_things(spec: WorldSpec, posed: Posed | None, things: Sequence[str]) -> list[str]:
    """Those of the things of a sentence that a posture may be about."""
    about = [] if posed is None else [t for t in subjects_of(spec, posed) if t in things]
    return about or list(things)


def frames_of(candidate: Candidate, name: str) -> list[int]:
    """Frames at which what a claim of place says is looked at: the last of what comes to rest, the first of the posture that a prompt begins with."""
    posed = pose_said(candidate.spec, name)
    if rest_said(candidate.spec, name) == "comes":
        return [candidate.last_frame]
    # What lies somewhere in a prompt that tells of no event may have come there.
    told = posed is not None and (posed.pose != "lie" or any(c.type == "event" for c in candidate.spec.claims.values()))
    if posed is not None and told and not spoken_later(candidate.spec, posed):
        last = min(round(OPENING * candidate.spec.simulation.fps), candidate.last_frame)
        return samples((0, last), OPENS)
    return samples((0, candidate.last_frame), LOOKS)


def pose_answers(candidate: Candidate, name: str, things: Sequence[str], grounds: Sequence[str]) -> list[Answer]:
    """The answer to whether something of a sentence has the posture that its words say; none where it speaks of no body.

    Args:
        candidate: what is judged.
        name: of the claim of place.
        things: bodies of its sentence.
        grounds: bodies of the place, as seen from which it is at rest.
    """
    posed = pose_said(candidate.spec, name)
    about = [t for t in posed_things(candidate.spec, posed, things) if is_measured(candidate, t)]
    if posed is None or not about:
        return []
    why: list[str] = []
    open_: list[str] = []
    for frame in frames_of(candidate, name):
        place = Place(candidate, list(grounds), frame)
        for thing in about:
            found = why_not(place, posed.pose, thing)
            unknown = untold(place, posed.pose, thing) if found is None else None
            if unknown is not None:
                open_.append(unknown)
            elif found is None:
                return [Answer(posed.word, True, f"{thing!r} {SAYS[posed.pose]} at frame {frame}", 1.0, 1.0)]
            else:
                why.append(f"{thing!r} does not {posed.pose} at frame {frame}: {found}")
    return [Answer(posed.word, None if open_ else False, (open_ or why)[0], None if open_ else 0.0, None if open_ else 1.0)]
