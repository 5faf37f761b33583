"""Entities that beats of the story move, and intervals of `supports` relations that end when their carrier may move."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING, Any

from ...worlds.predicates import entities_of
from ...worlds.predicates.event_kinds import BODY_EVENTS
from ...worlds.predicates.registry import is_invariant
from ...worlds.spec import Rope, Supports

if TYPE_CHECKING:
    from ...worlds.spec import Beat, WorldSpec

__all__ = ["Moves", "atoms", "beat_moves", "moves_of", "spoken_of", "support_interval"]

STAYING = frozenset({"rests_against", "jams"})
"""Events in which nothing leaves its place."""
MOVING_KINDS = (
    frozenset({"topples", "tilts", "displacement", "reaches", "crosses", *(info.kind for info in BODY_EVENTS)}) - STAYING
)
"""Predicates that say that an entity leaves its place."""
MOVED_BY = frozenset({"pushes", "pulls", "lifts", "lowers", "throws"})
"""Events of which `other` leaves its place."""
PRESSED_BY = frozenset({"buries"})
"""Events of which `other` may be pushed aside: nothing has to hold it from there on."""


def atoms(data: Any, each: tuple[str, ...] = ()) -> Iterator[dict[str, Any]]:
    """Every atom in a dumped predicate that names an entity; `each` of a count stands for its entities."""
    if isinstance(data, list):
        for item in data:
            yield from atoms(item, each)
    elif isinstance(data, dict):
        each = tuple(data.get("entities", each))
        entity = data.get("entity")
        if isinstance(entity, str):
            for name in each if entity == "each" else (entity,):
                yield {**data, "entity": name}
        for value in data.values():
            if isinstance(value, dict | list):
                yield from atoms(value, each)


def beat_moves(beat: Beat) -> frozenset[str]:
    """Entities that a beat moves: its subject, and those asked to topple, tilt, be displaced, reach or cross something.

    What a beat says to stay as it is, it does not move.
    """
    found = list(atoms(beat.predicate.model_dump()))
    if is_invariant(beat.predicate):
        return frozenset(a["entity"] for a in found if a["kind"] == "speed" and (a.get("min") or 0.0) > 0.0)
    moved = {a["entity"] for a in found if a["kind"] in MOVING_KINDS} | {
        a["other"] for a in found if a["kind"] in MOVED_BY | PRESSED_BY
    }
    return frozenset({beat.subject, *moved})


class Moves:
    """Who is moved by the beats of a story, and who is carried by whom as declared."""

    def __init__(self, spec: WorldSpec) -> None:
        self.spec = spec

    @cached_property
    def direct(self) -> dict[str, int]:
        """First frame of the earliest beat that moves an entity, by entity."""
        found: dict[str, int] = {}
        for beat in self.spec.story.beats.values():
            for name in beat_moves(beat):
                found[name] = min(beat.frames[0], found.get(name, beat.frames[0]))
        return found

    @cached_property
    def carriers(self) -> dict[str, set[str]]:
        """Entities on which each hangs or stands: parents of its joints, its ropes and their ends, its pins, its supports."""
        found: dict[str, set[str]] = {name: set() for name in self.spec.entities}
        pairs: list[tuple[str, str | None]] = [(j.child, j.parent) for j in self.spec.simulation.joints.values()]
        pairs += [(r.b, r.a) for r in self.spec.graph.relations.values() if isinstance(r, Supports)]
        for name, entity in self.spec.entities.items():
            pairs += [(name, pin.to) for pin in getattr(entity.physics, "pins", {}).values()]
            if isinstance(entity.generator, Rope):
                ends = [e for e in (entity.generator.attach_start, entity.generator.attach_end) if e is not None]
                pairs += [*((name, e) for e in ends), *((e, name) for e in ends)]
        for carried, carrier in pairs:
            if carried in found and carrier in found and carried != carrier:
                found[carried].add(str(carrier))
        return found

    def first(self, entity: str) -> int | None:
        """First frame of the earliest beat that moves the entity or something free that it hangs on, also through others.

        What follows an authored path goes on holding what it holds.
        """
        waiting, seen = [entity], {entity}
        frames = []
        while waiting:
            name = waiting.pop()
            if name in self.direct:
                frames.append(self.direct[name])
            for other in self.carriers.get(name, set()) - seen:
                if self.spec.entities[other].motion == "dynamic":
                    seen.add(other)
                    waiting.append(other)
        return min(frames, default=None)


_recent: list[Moves] = []


def moves_of(spec: WorldSpec) -> Moves:
    """Moves of a specification; the last four specifications are remembered."""
    for known in _recent:
        if known.spec is spec:
            return known
    made = Moves(spec)
    _recent.insert(0, made)
    del _recent[4:]
    return made


def spoken_of(spec: WorldSpec, entity: str) -> bool:
    """True where a beat names an entity, or moves what it hangs on or stands on: its release or throw is part of the story then."""
    told = any(entity in (beat.subject, *entities_of(beat.predicate)) for beat in spec.story.beats.values())
    return told or moves_of(spec).first(entity) is not None


def support_interval(spec: WorldSpec, relation: Supports) -> tuple[int, int]:
    """Frames over which `a` must carry `b`: declared, else from frame 0 until the frame before a beat moves `b`.

    A beat that moves what `b` hangs on or stands on moves `b` with it.
    """
    if relation.frames is not None:
        return relation.frames
    last, first = spec.simulation.frames - 1, moves_of(spec).first(relation.b)
    return 0, last if first is None else min(last, max(0, first - 1))
