"""Rival readings of an event: other truths that its words exclude. One that holds in the recorded motion voids the claim (R154, R156).

- *Roles swapped*, where the kind is directed: the block that is hit hits the one that hits it.
- *A body at rest*: the same of a body that rests throughout. What is true of it is no event.

The same event before its onset is asked by `beat:vacuous`. Rivals that follow from the event itself are not made.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, NamedTuple

from ...worlds.predicates import describe_predicate, entities_of
from ...worlds.predicates.registry import PREDICATES
from ..categories.registry import judge_of
from .mapping import mapped

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.spec import SpecModel

__all__ = ["Rival", "rivals_of"]

STILL_BODIES = 3
"""Own choice: bodies at rest that an event is asked of."""


class Rival(NamedTuple):
    """Another reading of a beat."""

    beat: str
    text: str
    predicate: SpecModel
    frames: tuple[int, int]


def rivals_of(candidate: Candidate, beat_id: str) -> list[Rival]:
    """Rivals of a beat's predicate over its own frames."""
    beat = candidate.spec.story.beats[beat_id]
    found = []
    swapped = mapped(beat.predicate, _swapped)
    if swapped != beat.predicate:
        found.append(Rival(beat_id, f"{describe_predicate(swapped)} (roles swapped)", swapped, beat.frames))
    told = set(entities_of(beat.predicate))
    for body in [n for n in still_bodies(candidate) if n not in told][:STILL_BODIES]:
        of_body = mapped(beat.predicate, partial(_about, beat.subject, body))
        if of_body != beat.predicate:
            found.append(Rival(beat_id, f"{describe_predicate(of_body)} (of a body that rests throughout)", of_body, beat.frames))
    return found


def still_bodies(candidate: Candidate) -> list[str]:
    """Bodies that rest at every frame: first those that an engine moves, then static ones."""
    entities = candidate.spec.entities
    moved = [n for n in candidate.solids if entities[n].motion != "static" and candidate.moves(n)]
    at_rest = [n for n in moved if not judge_of(candidate.spec, n).moving(candidate, n).any()]
    return at_rest + [n for n in candidate.solids if entities[n].motion == "static"]


def _swapped(atom: SpecModel) -> SpecModel:
    info = PREDICATES.get(str(getattr(atom, "kind", "")))
    if info is None or not info.directed or getattr(atom, "other", None) is None:
        return atom
    return atom.model_copy(update={"entity": atom.other, "other": atom.entity})  # type: ignore[attr-defined]


def _about(subject: str, body: str, atom: SpecModel) -> SpecModel:
    """An event of the subject, told of another body; other atoms stay."""
    info = PREDICATES.get(str(getattr(atom, "kind", "")))
    event = info is not None and info.event and getattr(atom, "entity", None) == subject
    return atom.model_copy(update={"entity": body}) if event else atom
