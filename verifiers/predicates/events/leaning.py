"""Judges whether another body holds one at rest: the balance of its contacts and joints without it, or that it took its motion."""

from __future__ import annotations

import numpy as np

from ....worlds.errors import EvidenceError
from ....worlds.spec import HingeJoint, MotorDriver, SpringJoint
from ...scene.surfaces import surfaces_of
from ...support.bounds import MISSING, OUTSIDE
from ...support.equilibrium import Group, solve
from ...support.joint_forces import FreeJoint, joint_forces, joint_hold, rounded
from ...support.touching import Contacts, contacts_of
from .bounds import APPROACH, LEVEL, TAKEN
from .course import Course, between, course_of

__all__ = ["held_by"]


def held_by(course: Course, other: str, since: int, frame: int) -> str | None:
    """Why another entity does not hold a body from the side at a frame, in words; None where it does.

    It does where the body would not stay without it, or where it came to rest by it: a ball that rolls into a wall and stays there.
    What joints tie to the body counts as its own: a wedge under a wheel holds the cart. Joints give the forces that they can give.

    Args:
        course: of the body.
        other: whom it touches.
        since: frame from which it is still.
        frame: the frame.

    Raises:
        EvidenceError: a surface is missing, or a joint holds the body to the ground, by a spring, by friction or at its stop.
    """
    surfaces = surfaces_of(course.candidate)
    joints = _joints(course)
    members = tuple(dict.fromkeys((course.entity, *(n for j in joints for n in (j.child, j.parent) if n is not None))))
    if other in members:
        return f"{other} hangs on {course.entity} by a joint"
    met = [contacts_of(surfaces, name, other, frame) for name in members]
    if not any(len(c.points) for c in met):
        return f"they do not touch at frame {frame}"
    if not any((np.abs(c.normals @ course.up) < LEVEL).any() for c in met):
        return f"{other} touches it from above or below at frame {frame}, not from the side"
    courses = [course_of(course.candidate, name) for name in members]
    axles = {j.child: j for j in joints if isinstance(j, HingeJoint)}

    def touching(name: str, n: str) -> Contacts:
        found = contacts_of(surfaces, name, n, frame)
        return rounded(surfaces, axles[name], found, frame, surfaces.contact_gap(name, n)) if name in axles else found

    contacts = [
        (name, n, touching(name, n))
        for name in members
        for n in surfaces.neighbours[name]
        if n not in members and surfaces.series(name, n)[frame] <= surfaces.contact_gap(name, n)
    ]
    tied = [(j.child, str(j.parent), joint_forces(surfaces, j, frame)) for j in joints]
    group = Group(
        members,
        (*contacts, *tied),
        np.array([c.centers[frame] for c in courses]),
        np.array([c.mass * c.strength for c in courses]),
        np.array([surfaces.size(name) for name in members]),
        -course.up,
    )
    if _stays(_without(group, other)):
        return (
            None if _stopped(course, other, met, since) else f"without {other} it would stay as well, and {other} did not stop it"
        )
    return None if _stays(group) else f"its contacts do not hold it at frame {frame} either"


def _stopped(course: Course, other: str, met: list[Contacts], since: int) -> bool:
    """True if the body last came towards the other before it was still, and contact with that took most of this motion."""
    ways = np.concatenate([c.normals for c in met])
    way = ways[np.abs(ways @ course.up) < LEVEL].mean(axis=0)
    size = float(np.linalg.norm(way))
    if size < LEVEL:  # it is clamped between two sides of the other
        return False
    way /= size
    towards = -(course.velocities[: since + 1] @ way)
    coming = np.flatnonzero(towards >= APPROACH)
    if len(coming) == 0 or course.books is None:
        return False
    last = int(coming[-1])
    given = between(course.candidate, other, course.entity).impulse[last:since].sum(axis=0) @ way
    return bool(given >= TAKEN * course.mass * towards[last])


def _joints(course: Course) -> list[FreeJoint]:
    """Joints that tie the body to others, and those to others again.

    Raises:
        EvidenceError: one of them may hold it in a way that contacts do not tell.
    """
    plan, found = course.candidate.spec.simulation, dict[str, FreeJoint]()
    driven = {d.joint for d in plan.drivers.values() if isinstance(d, MotorDriver)}
    members, grown = {course.entity}, True
    while grown:
        mine = {n: j for n, j in plan.joints.items() if {j.child, j.parent} & members and n not in found}
        for name, joint in mine.items():
            held = joint_hold(course.candidate, name, joint, driven=name in driven)
            if held is not None or isinstance(joint, SpringJoint):
                why = held or "a spring"
                raise EvidenceError(
                    f"{why} ({name!r}) holds {course.entity!r} too, so that contacts alone do not tell what it rests against"
                )
            found[name] = joint
            members |= {joint.child, str(joint.parent)}
        grown = bool(mine)
    return list(found.values())


def _without(group: Group, other: str) -> Group:
    """The same bodies as if another entity were not there."""
    for name in group.members:
        group = group.without(name, other)
    return group


def _stays(group: Group) -> bool:
    """True if contacts, joints and friction hold all bodies at rest."""
    if not any(len(c.points) for _, n, c in group.contacts if n not in group.members):
        return False
    return all(found.shift <= OUTSIDE and found.missing <= MISSING for found in solve(group, shift=OUTSIDE).values())
