"""Judges whether a body at rest needs another one to stay where it is: the balance of its contacts with it and without it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ....worlds.errors import EvidenceError
from ...scene.surfaces import surfaces_of
from ...support.bounds import MISSING, OUTSIDE
from ...support.equilibrium import Group, solve
from ...support.touching import contacts_of
from .bounds import LEVEL

if TYPE_CHECKING:
    from .course import Course

__all__ = ["held_by"]


def held_by(course: Course, other: str, frame: int) -> str | None:
    """Why another entity does not hold a body from the side at a frame, in words; None where it does.

    Raises:
        EvidenceError: a surface is missing, or joints hold the body too.
    """
    if any(course.entity in (j.child, j.parent) for j in course.candidate.spec.simulation.joints.values()):
        raise EvidenceError(f"joints hold {course.entity!r} too, so that contacts alone do not tell what it rests against")
    surfaces = surfaces_of(course.candidate)
    met = contacts_of(surfaces, course.entity, other, frame)
    if not len(met.points):
        return f"they do not touch at frame {frame}"
    if not (np.abs(met.normals @ course.up) < LEVEL).any():
        return f"{other} touches it from above or below at frame {frame}, not from the side"
    around = [
        n
        for n in surfaces.neighbours[course.entity]
        if surfaces.series(course.entity, n)[frame] <= surfaces.contact_gap(course.entity, n)
    ]
    group = Group(
        (course.entity,),
        tuple((course.entity, n, contacts_of(surfaces, course.entity, n, frame)) for n in around),
        course.centers[frame][None],
        np.array([course.mass * course.strength]),
        np.array([surfaces.size(course.entity)]),
        -course.up,
    )
    if _stays(group.without(course.entity, other), course.entity):
        return f"without {other} it would stay as well"
    return None if _stays(group, course.entity) else f"its contacts do not hold it at frame {frame} either"


def _stays(group: Group, entity: str) -> bool:
    """True if contacts and friction hold the body at rest."""
    if not any(len(c.points) for _, _, c in group.contacts):
        return False
    found = solve(group, shift=OUTSIDE)[entity]
    return found.shift <= OUTSIDE and found.missing <= MISSING
