"""Which plates a candidate needs: of the subject of each mandatory observed beat, where it is largest while the beat comes true, and of each
body whose colour the prompt names, where it is largest."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

from ...worlds.described import coloured_bodies
from ...worlds.plates import MOST_PLATES, View
from ...worlds.predicates import atoms_of
from ...worlds.predicates.registry import PREDICATES
from ..predicates.evaluators import beat_times
from .plan import outcome_frames, shots_at
from .sight import sight_of
from .views import SAMPLES, samples

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.spec import WorldSpec
    from .sight import Seen, Sight

__all__ = ["Wanted", "best_look", "largest", "seen_beats", "wanted"]

LOOKS = 5
"""Own choice: frames of each shot at which a body is looked for; its ends, its middle and between."""


class Wanted(NamedTuple):
    """Views to be taken, the most important first, and by beat the one that shows its outcome."""

    views: tuple[View, ...]
    of: Mapping[str, View]
    left: tuple[str, ...]
    """Beats whose view is one too many, after `MOST_PLATES` others."""
    shown: Mapping[str, View]
    """By body, the view that tells its colour."""
    beyond: tuple[str, ...]
    """Bodies whose view is one too many."""


def seen_beats(spec: WorldSpec) -> list[str]:
    """Beats whose subject must be seen."""
    return [n for n, b in spec.story.beats.items() if b.mandatory and b.observe]


def wanted(candidate: Candidate, sight: Sight | None = None) -> Wanted:
    """The plates that a candidate needs.

    Every subject has its first beat seen before any has a second; between the two stand bodies whose colour is named and that no beat is
    about. Else as the story has them. Beats of one view share its plate. What is in no picture has none.

    Raises:
        EvidenceError: a camera or a body cannot be placed.
    """
    sight = sight or sight_of(candidate)
    of = {n: v for n in seen_beats(candidate.spec) if (v := _best(sight, n)) is not None}
    first = {v.subject: v for v in reversed(of.values())}
    bodies = {b for named in coloured_bodies(candidate.spec).values() for b in named}
    shown = {b: v for b in candidate.spec.entities if b in bodies and (v := first.get(b) or largest(sight, b)) is not None}
    views = list(dict.fromkeys([*(first[v.subject] for v in of.values()), *shown.values(), *of.values()]))
    kept = tuple(views[:MOST_PLATES])
    left, beyond = ([n for n, v in found.items() if v not in kept] for found in (of, shown))
    return Wanted(kept, of, tuple(left), shown, tuple(beyond))


def largest(sight: Sight, body: str) -> View | None:
    """The shot and frame that show most of a body, of some frames of every shot; None where none shows it."""
    candidate, looks = sight.candidate, []
    for name, shot in candidate.spec.shots.items():
        frames = (shot.frames[0], min(shot.frames[1], candidate.last_frame))
        looks += [sight.seen(body, name, k) for k in samples(frames, LOOKS)] if frames[0] <= frames[1] else []
    best = max(looks, key=lambda look: look.share, default=None)
    return None if best is None or best.share <= 0.0 else View(body, best.shot, best.frame)


def _best(sight: Sight, beat_id: str) -> View | None:
    """The shot and frame that show most of a beat's subject, of those that show its outcome; None where none shows it."""
    look = best_look(sight, beat_id)
    subject = sight.candidate.spec.story.beats[beat_id].subject
    return None if look is None or look.share <= 0.0 else View(subject, look.shot, look.frame)


def best_look(sight: Sight, beat_id: str) -> Seen | None:
    """The look at a beat's subject, of those at its outcome, that shows most of it, or would if nothing stood before it.

    What is gone by its outcome, as a fire that goes out, is looked for from the beat's first frame to that.
    """
    candidate = sight.candidate
    beat = candidate.spec.story.beats[beat_id]
    first, last = outcome_frames(candidate, beat_id) or beat.frames
    if any(PREDICATES[kind].ends for a in atoms_of(beat.predicate) if (kind := getattr(a, "kind", "")) in PREDICATES):
        first, last = beat.frames[0], beat_times(candidate).outcome(beat_id).first_true_frame or beat.frames[1]
    named = [n for n, s in candidate.spec.shots.items() if beat_id in s.covers]
    looks = []
    for frame in samples((first, min(last, candidate.last_frame)), SAMPLES):
        running = shots_at(candidate, frame)
        looks += [sight.seen(beat.subject, s, frame) for s in [s for s in running if s in named] or running]
    return max(looks, key=lambda look: (look.share, look.in_picture), default=None)
