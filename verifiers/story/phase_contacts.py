"""First contact of a run, and who should meet whom by the specification (R77, S12).

- Bodies: the log of contacts, from the moment on at which a driver acts or a body moves.
- Other matter: what the judges of the categories say of whom it pressed (`Judge.touches`): grains each body; cloth all solids together,
  and bodies that felt a push that no other matter gave.

Impulses over a frame do not tell when in it they began: what presses in frame 1, or up to activation, touched from the start. Where
the specification names who should meet, sand that lands elsewhere and a curtain that brushes its rod are no first contact.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...worlds.categories.cloth.facts import pins_of
from ...worlds.categories.registry import shape_of
from ..categories.registry import JUDGES
from ..ledgers.exchanged import partners

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.spec import WorldSpec
    from ..categories.judge import Touch

__all__ = ["Meeting", "asks_for_contact", "carried_from_the_start", "first_contact", "promises"]


class Meeting(NamedTuple):
    """A new contact."""

    time: float
    """[s]; of grains and cloth the end of the frame."""
    frame: int
    mover: str
    text: str
    pressed: bool = False
    """True if grains or cloth are in it."""


class _Promise(NamedTuple):
    """A contact that the specification asks for."""

    entities: frozenset[str]
    direct: bool
    """These meet each other; else what one of them meets may pass it on."""


def asks_for_contact(candidate: Candidate) -> bool:
    """True if a beat, a relation or a cause of the specification needs two bodies to meet; so does a world without beats."""
    return not candidate.spec.story.beats or bool(promises(candidate.spec))


def promises(spec: WorldSpec) -> list[_Promise]:
    """Who should meet whom. What a liquid, grains or a pin of a cloth pass on needs no contact of bodies."""
    beats, relations = spec.story.beats, spec.graph.relations.values()
    solid = {n for n, e in spec.entities.items() if shape_of(e) != "loose"}
    pinned = {frozenset((n, p.to)) for n, e in spec.entities.items() for p in pins_of(e).values() if p.to is not None}
    pairs = {frozenset((beats[c].subject, b.subject)) for b in beats.values() for c in b.causes if c in beats}
    found = [_Promise(pair, False) for pair in sorted(pairs - pinned, key=sorted) if pair <= solid and len(pair) > 1]
    found += [_Promise(frozenset((r.a, r.b)), True) for r in relations if r.kind == "interacts"]
    carried = {(r.b, r.a) for r in relations if r.kind == "supports" and (r.frames is None or r.frames[0] == 0)}
    predicates = [b.predicate for b in beats.values()] + [r.predicate for r in spec.story.requirements.values()]
    for p in (part for predicate in predicates for part in _parts_of(predicate.model_dump(mode="json"))):
        if p.get("kind") == "contact":
            found.append(_Promise(frozenset((p["a"], p["b"])), True))
        elif p.get("kind") == "rests_on" and (p["entity"], p["on"]) not in carried:
            found.append(_Promise(frozenset((p["entity"], p["on"])), True))
    return found


def _parts_of(node: Any) -> Iterator[dict[str, Any]]:
    """A predicate and all predicates in it, as plain data."""
    if isinstance(node, dict):
        yield node
    for child in node.values() if isinstance(node, dict) else node if isinstance(node, list) else ():
        yield from _parts_of(child)


def first_contact(candidate: Candidate, activation: int, moved: int | None) -> Meeting | None:
    """The first new contact; None where there is none.

    Args:
        candidate: what is looked at.
        activation: frame from which on grains and cloth are looked at.
        moved: frame from which on bodies are: at which one moves or a driver acts; None where none does.
    """
    bodies = None if moved is None else _of_bodies(candidate, moved)
    if bodies is not None and not promises(candidate.spec):
        return bodies
    return min((m for m in (bodies, _of_matter(candidate, activation)) if m is not None), key=lambda m: m.time, default=None)


def carried_from_the_start(candidate: Candidate, activation: int) -> str:
    """That all who should meet touch from frame 0 on until they move, in words; empty where one pair does not.

    What stands on a lift is carried by a contact that is there already: none that begins later is missing.
    """
    asked = promises(candidate.spec)
    pairs = [frozenset(_touching(candidate, frame)) for frame in (1, max(1, activation) + 1) if frame < candidate.frame_count]
    if not asked or not pairs or not all(p.entities in pair for p in asked for pair in pairs):
        return ""
    told = sorted({" and ".join(sorted(p.entities)) for p in asked})
    return f"{', '.join(told)} touch from frame 0 on, and go on so: what is carried from the start meets nothing anew"


def _touching(candidate: Candidate, frame: int) -> Iterator[frozenset[str]]:
    """Pairs of bodies that the log of contacts has in the steps up to a frame."""
    for cache in candidate.rigid_caches.values():
        for pair in cache.ragged("contact/pair")[frame]["contact/pair"].tolist():
            yield frozenset(cache.index.colliders[i] for i in pair)


def _of_bodies(candidate: Candidate, moved: int) -> Meeting | None:
    fps = candidate.spec.simulation.fps
    found: Meeting | None = None
    for cache in candidate.rigid_caches.values():
        contacts, events = cache.ragged("contact/pair", "contact/impulse"), cache.ragged("event/time", "event/pair")
        before: set[tuple[int, ...]] = set()
        for frame in range(candidate.frame_count):
            log = events[frame]
            fresh = [(float(t), tuple(p)) for t, p in zip(log["event/time"], log["event/pair"].tolist(), strict=True)]
            for time, pair in fresh:
                if time * fps + 1e-9 >= moved and pair not in before and (found is None or time < found.time):
                    a, b = (cache.index.colliders[i] for i in pair)
                    mover = a if candidate.spec.entities[a].motion != "static" else b
                    found = Meeting(time, frame, mover, f"{a} meets {b} at {time:.3f} s")
            before |= {tuple(p) for p in contacts[frame]["contact/pair"].tolist()} | {p for _, p in fresh}
    return found


def _of_matter(candidate: Candidate, activation: int) -> Meeting | None:
    asked, spec = promises(candidate.spec), candidate.spec
    start = max(1, activation) + 1
    found: Meeting | None = None
    for touch in (t for judge in JUDGES.values() for t in judge.touches(candidate)):
        later = np.flatnonzero(touch.pressed[start:])
        if touch.pressed[:start].any() or not len(later) or not (not asked or any(_keeps(spec, p, touch) for p in asked)):
            continue
        frame = start + int(later[0])
        if found is None or frame < found.frame:
            names = ", ".join(sorted(touch.matter))
            moves = touch.body is not None and spec.entities[touch.body].motion != "static"
            mover = touch.body if moves and touch.body is not None else min(touch.matter)
            text = f"{names} and {touch.body or 'solids'} press each other from frame {frame} on"
            found = Meeting(frame / spec.simulation.fps, frame, mover, text, True)
    return found


def _keeps(spec: WorldSpec, promise: _Promise, touch: Touch) -> bool:
    """True if a touch is what was promised, or its beginning."""
    others = promise.entities - touch.matter - {"each"}
    if touch.body is None:
        # What presses a body that is coupled both ways is known by itself.
        told = {n for s, i in spec.simulation.rigid.items() if partners(spec, s) for n in i.members if _moves(spec, n)}
        return bool(promise.entities & touch.matter) and not others & told
    if promise.direct:
        return others == {touch.body} and bool(promise.entities - others)
    return bool(promise.entities & {touch.body, *touch.matter})


def _moves(spec: WorldSpec, name: str) -> bool:
    return name in spec.entities and spec.entities[name].motion == "dynamic"
