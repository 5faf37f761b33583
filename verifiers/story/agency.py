"""Helpers that the story is silent about: loaded springs, slides that bear, bodies on paths, drivers that no beat leading to an outcome owns, and bodies that start with a velocity and are in none.

(R97, R156.)

A helper counts where it worked on the subject of the beat before that came true, directly or through bodies that touched each other
or are joined one after the other: from the frame on in which its work on a body exceeds a share of the greatest kinetic energy that the body
had, what this body does to others is the helper's work too. Works are those of `ledgers/origins.py`, on bodies of rigid instances, with that of
torques. Ways through liquids, grains, cloth and bodies of several joints, and drivers whose work no record tells apart (releases, motors), are
left to the run without them (`untold.py`).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...worlds.arrays import F64
from ...worlds.drivers import acts_from, behind
from ...worlds.predicates import atoms_of, entities_of
from ...worlds.predicates.registry import is_invariant
from ...worlds.spec import ForceDriver, PathDriver, SlideJoint, SpringJoint
from ..categories.registry import judge_of
from ..ledgers.balance import books_of
from ..ledgers.origins import Origin
from .bearings import spared_by
from .bodies import moves_by_declaration
from .bounds import HELPED, LEAST_WORK
from .chains import joined

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.spec import Beat, WorldSpec
    from ..ledgers.balance import Books

__all__ = ["Help", "helped"]


class Help(NamedTuple):
    """Work of a helper that no beat leading to an outcome tells of."""

    pointer: str
    """JSON pointer of the helper in the specification."""
    helper: str
    """In words: `spring 'k'`, `'stick', which follows driver 'p'`, `driver 'f'`."""
    body: str
    """The body of the outcome that it reached."""
    frame: int
    """Frame at which its work first counted."""
    work: float
    """Work up to the outcome on the first body that it reached [J]."""
    share: float
    """That work as share of the greatest kinetic energy that this body had."""
    through: tuple[str, ...]
    """Bodies from the helper to the outcome's."""
    friction: float | None = None
    """[N] Of a slide: the friction that the surfaces would have had; its work is what it spares the body."""


@dataclass(frozen=True)
class _Tale:
    """Drivers, joints and initial states of which the beats that lead to an outcome tell."""

    owners: frozenset[str]
    joints: frozenset[str]
    """Joints that their predicates ask about."""
    started: frozenset[str]
    """Entities of the beats among them that have no cause: the initial states of the story."""
    bodies: frozenset[str]
    """All of their entities."""


def helped(candidate: Candidate, beat_id: str, until: int, bodies: Iterable[str]) -> Help | None:
    """The first helper that the story does not tell of and that worked on one of a beat's bodies by frame `until`; None where none did.

    Raises:
        EvidenceError: a helper is there, and a channel that tells of its work is missing or damaged.
    """
    spec = candidate.spec
    beat = spec.story.beats[beat_id]
    if is_invariant(beat.predicate):
        return None
    tale, moved = _tale(spec, beat_id), sorted(bodies)
    for cache in candidate.rigid_caches.values():
        if not set(moved) & {b.split("/", 1)[0] for b in cache.index.bodies}:
            continue
        for helper in _helpers(candidate, books_of(candidate, cache), tale):
            found = next((f for body in moved if (f := helper.reaches(body, until)) is not None), None)
            if found is not None:
                return found
    return None


def _tale(spec: WorldSpec, beat_id: str) -> _Tale:
    beats = spec.story.beats
    told = [beats[n] for n in (behind(spec, beat_id) if beats[beat_id].causes else beats)]
    return _Tale(
        frozenset(b.owner for b in told),
        frozenset(j for b in told for a in atoms_of(b.predicate) if (j := getattr(a, "joint", None))),
        frozenset(n for b in told if not b.causes for n in _bodies(b)),
        frozenset(n for b in told for n in _bodies(b)),
    )


def _bodies(beat: Beat) -> tuple[str, ...]:
    return (beat.subject, *entities_of(beat.predicate))


@dataclass(frozen=True)
class _Helper:
    candidate: Candidate
    books: Books
    pointer: str
    words: str
    work: dict[str, F64]
    """Work on every entity that it works on directly, summed since frame 0 [J], shape (F,)."""
    friction: float | None = None
    """As `Help.friction`."""

    def reaches(self, subject: str, until: int) -> Help | None:
        """The help that reaches a body by a frame; None where its share does not count then.

        Bodies on the way pass on what they do to others from the frame at which their share counts.
        """
        since: dict[str, int] = {}
        first: dict[str, tuple[str | None, float, float]] = {}
        waiting: list[tuple[str | None, str, F64]] = [(None, name, work) for name, work in self.work.items()]
        while waiting:
            source, name, work = waiting.pop(0)
            if name in since or name not in self.books.row or self.books.kinematic[self.books.row[name]]:
                continue
            had = np.maximum.accumulate(self.books.kinetic[:, self.books.row[name]])[: until + 1]
            work = work[: until + 1]
            counts = np.flatnonzero((work > HELPED * had) & (work > LEAST_WORK))
            if not len(counts) or (name == subject and counts[-1] < len(work) - 1):
                continue
            since[name] = int(counts[0])
            first[name] = (source, float(work[-1]), float(work[-1] / max(had[-1], LEAST_WORK)))
            waiting += [(name, other, given) for other, given in self._handed_on(name, since[name]).items()]
        if subject not in since:
            return None
        way = [subject]
        while (source := first[way[0]][0]) is not None:
            way.insert(0, source)
        _, done, share = first[way[0]]
        return Help(self.pointer, self.words, subject, since[way[0]], done, share, tuple(way), self.friction)

    def _handed_on(self, name: str, start: int) -> dict[str, F64]:
        """Work of a body on others from a frame on, by contact and by a joint that is their only one, summed [J], shape (F,)."""
        found: dict[str, F64] = {}
        held = joined(self.candidate.spec)
        for other in self.books.entities:
            if other == name:
                continue
            # Of several joints none can be told apart: `unlisted` is what all of them give.
            tied = [ends for ends in held if other in ends] == [{name, other}]
            asked = (Origin("contact", name), *((Origin("unlisted", ""),) if tied else ()))
            origins = judge_of(self.candidate.spec, other).origins(self.candidate, other)
            given = [origins[o].work for o in asked if o in origins]
            if given:
                work = np.sum(given, axis=0)
                found[other] = _summed(np.where(np.arange(len(work)) >= start - 1, work, 0.0))
        return found


def _summed(work: F64) -> F64:
    """Work done in the direction of motion since frame 0 [J], shape (F,), of works per interval, shape (F - 1,)."""
    return np.concatenate([[0.0], np.cumsum(np.maximum(work, 0.0))])


def _helpers(candidate: Candidate, books: Books, tale: _Tale) -> list[_Helper]:
    """Everything that can work on bodies of an instance, and of which the story does not tell."""
    spec, found = candidate.spec, []
    for name, joint in spec.simulation.joints.items():
        if isinstance(joint, SpringJoint) and not _told(spec, name, joint, tale):
            work = _released(books, name)
            if work:
                found.append(_Helper(candidate, books, f"/simulation/joints/{name}", f"spring {name!r}", work))
        if isinstance(joint, SlideJoint) and name not in tale.joints:
            spared = spared_by(candidate, books, joint)
            if spared is not None and spared.work[-1] > LEAST_WORK:
                place, given = f"/simulation/joints/{name}", {joint.child: spared.work}
                found.append(_Helper(candidate, books, place, f"slide {name!r}", given, spared.friction))
    for name, driver in spec.simulation.drivers.items():
        place = f"/simulation/drivers/{name}"
        if name in tale.owners:
            continue
        if isinstance(driver, PathDriver) and driver.entity in books.row:
            words = f"{driver.entity!r}, which follows driver {name!r},"
            found.append(_Helper(candidate, books, place, words, _by_hand(candidate, books, driver.entity)))
        elif isinstance(driver, ForceDriver) or (driver.kind == "field" and driver.field.kind != "drag"):
            entities = [n for n in acts_from(spec, name)[1] if n in books.row]
            work = _by_driver(candidate, name, entities)
            if isinstance(driver, ForceDriver) and any(driver.torque) and driver.entity in entities:
                work[driver.entity] = work.get(driver.entity, 0.0) + _by_torque(books, driver)
            found.append(_Helper(candidate, books, place, f"driver {name!r}", work))
    for name in books.entities:
        if name not in tale.bodies and moves_by_declaration(spec, name):
            place, words = f"/entities/{name}/physics/linear_velocity", f"{name!r}, which starts with a velocity,"
            found.append(_Helper(candidate, books, place, words, _by_touch(candidate, books, name)))
    return found


def _told(spec: WorldSpec, name: str, joint: SpringJoint, tale: _Tale) -> bool:
    """True if the story tells of a spring: a predicate asks about it, a driver that lets it act owns a beat, or it is part of an initial state."""
    ends = {e for e in (joint.child, joint.parent) if e is not None and spec.entities[e].motion == "dynamic"}
    let_go = {
        n
        for n, d in spec.simulation.drivers.items()
        if getattr(d, "joint", None) == name or (d.kind == "release" and d.entity in ends)
    }
    opened = {n for n, d in spec.simulation.drivers.items() if d.kind == "detach" and ends & set(acts_from(spec, n)[1])}
    return name in tale.joints or bool((let_go | opened) & tale.owners) or bool(ends & tale.started)


def _released(books: Books, name: str) -> dict[str, F64]:
    """Energy that a spring held at frame 0 and has given since [J], shape (F,), by the moving entities at its ends."""
    for spring in books.springs:
        if spring.name == name and spring.energy[0] > LEAST_WORK:
            given = np.maximum.accumulate(np.maximum(spring.energy[0] - spring.energy, 0.0))
            given = np.where(books.times < spring.until, given, given[np.argmax(books.times >= spring.until) - 1])
            return {books.entities[r]: given for r in (spring.child, spring.parent) if r is not None and not books.kinematic[r]}
    return {}


def _by_hand(candidate: Candidate, books: Books, hand: str) -> dict[str, F64]:
    """Work of a body on a path on each body that it touches while it moves, summed [J], shape (F,)."""
    row, found = books.row[hand], {}
    moves = np.linalg.norm(np.diff(books.centers[:, row], axis=0), axis=1) > 0.0
    moves |= np.abs(np.diff(books.turns[:, books.first[row]], axis=0)).max(axis=(1, 2)) > 0.0
    for other in books.entities:
        given = judge_of(candidate.spec, other).origins(candidate, other).get(Origin("contact", hand)) if other != hand else None
        if given is not None:
            found[other] = _summed(np.where(moves, given.work, 0.0))
    return found


def _by_touch(candidate: Candidate, books: Books, hand: str) -> dict[str, F64]:
    """Work of a body on each body that it touches, summed [J], shape (F,)."""
    found = {}
    for other in books.entities:
        given = judge_of(candidate.spec, other).origins(candidate, other).get(Origin("contact", hand)) if other != hand else None
        if given is not None:
            found[other] = _summed(given.work)
    return found


def _by_driver(candidate: Candidate, name: str, entities: list[str]) -> dict[str, F64]:
    """Work of a force driver or field on each of some entities, summed [J], shape (F,); fields that one record tells of together count together."""
    found = {}
    for entity in entities:
        for origin, given in judge_of(candidate.spec, entity).origins(candidate, entity).items():
            if origin.kind in ("driver", "fields") and name in origin.name.split(", "):
                found[entity] = _summed(given.work)
    return found


def _by_torque(books: Books, driver: ForceDriver) -> F64:
    """Work of the torque of a force driver on the turning of its body, summed [J], shape (F,); of bodies in pieces that of the first."""
    row = books.row[driver.entity]
    spin = books.spin[:, books.first[row]]
    acting = books.overlap(max(driver.start, float(books.released[row])), driver.end)
    return _summed(acting * (0.5 * (spin[:-1] + spin[1:]) @ np.array(driver.torque)))
