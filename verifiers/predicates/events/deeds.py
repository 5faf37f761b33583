"""Impulse and work of one entity on another: by contact, springs and ropes between them, and joints that hold nothing else to it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ....worlds.arrays import F64
from ....worlds.spec import Rope, SpringJoint
from .course import course_of

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.spec import WorldSpec

__all__ = ["Deed", "deed_of", "tied"]


class Deed(NamedTuple):
    """Impulse and work of one entity on another, per interval."""

    impulse: F64
    """[N s], shape (F - 1, 3)."""
    work: F64
    """On the motion of the other's centre [J], shape (F - 1,)."""
    how: tuple[str, ...]
    """Ways by which it was done: contact, spring, joint."""


def tied(spec: WorldSpec, one: str, two: str) -> bool:
    """True if joints or rope entities lead from one to the other, and no joint holds the second to anything else."""
    links = _links(spec)
    if any(j.parent is None and j.child == two for j in spec.simulation.joints.values()):
        return False
    reached, waiting = {one}, [one]
    while waiting:
        for other in links.get(waiting.pop(), ()):
            if other not in reached and (other == two or isinstance(spec.entities[other].generator, Rope)):
                reached.add(other)
                waiting += [other] if other != two else []
    return two in reached and links.get(two, set()) <= reached


def _links(spec: WorldSpec) -> dict[str, set[str]]:
    """Entities that joints or the ends of ropes hold together."""
    pairs = [(j.parent, j.child) for j in spec.simulation.joints.values() if not isinstance(j, SpringJoint)]
    for name, entity in spec.entities.items():
        if isinstance(entity.generator, Rope):
            pairs += [(end, name) for end in (entity.generator.attach_start, entity.generator.attach_end) if end is not None]
    found: dict[str, set[str]] = {}
    for one, two in pairs:
        if one is not None:
            found.setdefault(one, set()).add(two)
            found.setdefault(two, set()).add(one)
    return found


def deed_of(candidate: Candidate, by: str, on: str) -> Deed:
    """Impulse and work of one entity on another; zero where no record tells of any.

    Raises:
        EvidenceError: an entity is unknown, or a channel is missing or damaged.
    """
    return candidate.memo(("deed", by, on), lambda: _deed(candidate, by, on))


def _deed(candidate: Candidate, by: str, on: str) -> Deed:
    spec, course = candidate.spec, course_of(candidate, on)
    course_of(candidate, by)
    count = candidate.frame_count - 1
    impulse, work, how = np.zeros((count, 3)), np.zeros(count), []
    springs = {n for n, j in spec.simulation.joints.items() if isinstance(j, SpringJoint) and {j.parent, j.child} == {by, on}}
    joined = tied(spec, by, on)
    for origin, given in course.origins.items():
        mine = (
            (origin.kind == "contact" and origin.name == by)
            or (origin.kind == "spring" and origin.name in springs)
            or (origin.kind == "unlisted" and joined)
        )
        if mine and given.impulse.any():
            impulse, work = impulse + given.impulse[:count], work + given.work[:count]
            how.append("joint" if origin.kind == "unlisted" else origin.kind)
    return Deed(impulse, work, tuple(dict.fromkeys(how)))
