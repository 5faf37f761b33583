"""Rival readings of an event: other truths that its words exclude. One that holds in the recorded motion voids the claim (R154, R156).

- *Roles swapped*, where the kind is directed: the block that is hit hits the one that hits it, and not once that is over (`roles.py`).
- *A body at rest*: the same of a body that rests throughout, in the place of who does it. What is true of it is no event.

- *Before its onset*: the same before the beat's interval begins, unless another beat of the story tells of that. `beat:vacuous` asks this too,
  of every kind of predicate; here an event counts that goes on.

Rivals that follow from the event itself are not made: kinds that both do to each
other have no roles, what leans or floats may well rest throughout, and what is fastened to who does it belongs to that.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, NamedTuple

from ...worlds.predicates import atoms_of, describe_predicate, entities_of
from ...worlds.predicates.registry import is_event
from ..categories.registry import judge_of
from ..predicates.evaluators import beat_times
from ..predicates.events import EVENTS
from .bounds import STILL_BODIES
from .mapping import mapped
from .roles import swapped_roles

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.spec import SpecModel

__all__ = ["Rival", "rivals_of"]

AT_REST = frozenset({"rests_against", "jams", "floats"})
"""Kinds of which a body at rest throughout may be as true, by their definitions."""


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
    swapped = swapped_roles(candidate, beat.predicate, beat.frames)
    if swapped != beat.predicate:
        found.append(Rival(beat_id, f"{describe_predicate(swapped)} (roles swapped)", swapped, beat.frames))
    told = set(entities_of(beat.predicate))
    for doer in doers_of(beat.predicate):
        others = [n for n in still_bodies(candidate) if n not in told | _fastened(candidate, doer)]
        for body in others[:STILL_BODIES]:
            of_body = mapped(beat.predicate, partial(_about, doer, body))
            text = f"{describe_predicate(of_body)} (of a body that rests throughout)"
            found.append(Rival(beat_id, text, of_body, beat.frames))
    if beat.frames[0] > 0 and _signature(beat.predicate) and not _told_before(candidate, beat_id):
        text = f"{describe_predicate(beat.predicate)} (before frame {beat.frames[0]}, where its interval begins)"
        found.append(Rival(beat_id, text, beat.predicate, (0, beat.frames[0] - 1)))
    return found


def _signature(predicate: SpecModel) -> set[tuple[object, ...]]:
    """Kinds of the events of bodies in a predicate, with whom they are about."""
    return {(getattr(a, "kind", ""), entities_of(a)) for a in atoms_of(predicate) if getattr(a, "kind", "") in EVENTS}


def _told_before(candidate: Candidate, beat_id: str) -> bool:
    """True where another beat tells that the same happened before the interval of a beat."""
    beats, times = candidate.spec.story.beats, beat_times(candidate)
    mine, start = _signature(beats[beat_id].predicate), beats[beat_id].frames[0]
    for name, beat in beats.items():
        if name != beat_id and _signature(beat.predicate) & mine:
            first = times.first(name)
            if first is not None and first < start:
                return True
    return False


def doers_of(predicate: SpecModel) -> list[str]:
    """Who does the events that a predicate speaks of, but for those of which rest may be as true."""
    asked = [a for a in atoms_of(predicate) if is_event(a) and getattr(a, "kind", "") not in AT_REST]
    names = [str(n) for a in asked if (n := getattr(a, "entity", None)) is not None]
    return [n for n in dict.fromkeys(names) if n != "each"]


def _fastened(candidate: Candidate, entity: str) -> set[str]:
    """Bodies that a weld or a relation fastens to an entity."""
    plan = candidate.spec.simulation
    pairs = [{j.child, j.parent} for j in plan.joints.values() if j.kind == "weld"]
    pairs += [{r.a, r.b} for r in candidate.spec.graph.relations.values() if r.kind == "fastened"]
    return {str(n) for pair in pairs if entity in pair for n in pair - {entity}}


def still_bodies(candidate: Candidate) -> list[str]:
    """Bodies that rest at every frame: first those that an engine moves, then static ones."""
    entities = candidate.spec.entities
    moved = [n for n in candidate.solids if entities[n].motion != "static" and candidate.moves(n)]
    at_rest = [n for n in moved if not judge_of(candidate.spec, n).moving(candidate, n).any()]
    return at_rest + [n for n in candidate.solids if entities[n].motion == "static"]


def _about(doer: str, body: str, atom: SpecModel) -> SpecModel:
    """An atom about who does it, told of another body."""
    return atom.model_copy(update={"entity": body}) if getattr(atom, "entity", None) == doer else atom
