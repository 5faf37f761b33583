"""Forces that a joint can give between two bodies, for balances of contacts: those along and about every axis that it does not leave free."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.arrays import F64, cross
from ...worlds.spec import BallJoint, HingeJoint, SlideJoint, WeldJoint
from ..ledgers import motion
from .bounds import FLATS, MISSING
from .links import path_of
from .touching import Contacts

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ..scene.surfaces import Surfaces

__all__ = ["FreeJoint", "joint_forces", "joint_hold", "rounded"]

FreeJoint = HingeJoint | SlideJoint | BallJoint | WeldJoint
"""Joints that tie two bodies and leave some ways free."""


def joint_hold(candidate: Candidate, name: str, joint: Any, *, driven: bool) -> str | None:
    """Name of the part of a joint that may hold its bodies beside tying them; None where there is none.

    Args:
        candidate: the world.
        name: of the joint.
        joint: the joint.
        driven: whether a motor drives it.
    """
    if joint.parent is None or candidate.spec.entities[joint.parent].motion == "static":
        return "a joint to what never moves"
    if driven or getattr(joint, "stiffness", 0.0) > 0.0:
        return "a motor" if driven else "a joint's spring"
    if getattr(joint, "range", None) is not None:
        return "a joint with stops"
    gravity = float(np.linalg.norm(candidate.spec.simulation.gravity))
    least = MISSING * min(motion.entity_mass(candidate, n) for n in (joint.child, joint.parent)) * gravity
    reach = 0.5 * min(candidate.spec.entities[joint.child].dimensions.size) if isinstance(joint, HingeJoint) else 1.0
    return "a joint's friction" if getattr(joint, "friction", 0.0) > least * reach else None


def joint_forces(surfaces: Surfaces, joint: FreeJoint, frame: int) -> Contacts:
    """Forces of the parent on the child at a frame, as contacts without friction that push either way.

    A ball holds one point in all directions, a hinge two points of its axis, a weld three; a slide holds three points across its axis.
    """
    anchor = np.array(joint.anchor, dtype=np.float64)
    size = surfaces.size(joint.child)

    def place(point: F64) -> F64:
        return np.asarray(path_of(surfaces, joint.child, point)[frame])

    axis = np.array(getattr(joint, "axis", (0.0, 0.0, 1.0)), dtype=np.float64)
    axis /= np.linalg.norm(axis)
    aside = cross(axis, np.array([1.0, 0.0, 0.0]) if abs(axis[0]) < 0.7 else np.array([0.0, 1.0, 0.0]))
    aside /= np.linalg.norm(aside)
    arms = {"ball": (), "hinge": (axis,), "weld": (axis, aside), "slide": (axis, aside)}[joint.kind]
    points = np.array([place(anchor), *(place(anchor + size * arm) for arm in arms)])
    ways = np.eye(3)
    if isinstance(joint, SlideJoint):
        along = (points[1] - points[0]) / np.linalg.norm(points[1] - points[0])
        off = (points[2] - points[0]) / np.linalg.norm(points[2] - points[0])
        ways = np.array([off, cross(along, off)])
    both = np.concatenate([ways, -ways])
    count = len(points) * len(both)
    return Contacts(np.repeat(points, len(both), axis=0), np.tile(both, (len(points), 1)), np.zeros(count))


def rounded(surfaces: Surfaces, hinge: HingeJoint, contacts: Contacts, frame: int, gap: float) -> Contacts:
    """Contacts of a hinge's child, those at the flats of a wheel moved to where a round wheel touches: its normals pass through the axle.

    A flat that is wider than `FLATS` of the radius to either side stays as it is, but for what lies within the gap at which a round wheel would still
    count as touching.

    Args:
        surfaces: of the world.
        hinge: the joint.
        contacts: what its child touches with.
        frame: of them.
        gap: distance up to which things count as touching [m].
    """
    anchor, axis = np.array(hinge.anchor, dtype=np.float64), np.array(hinge.axis, dtype=np.float64)
    start, end = (path_of(surfaces, hinge.child, p)[frame] for p in (anchor, anchor + axis / np.linalg.norm(axis)))
    axle, arms, normals = end - start, contacts.points - start, contacts.normals
    radius = np.linalg.norm(arms - (arms @ axle)[:, None] * axle, axis=1)
    lever = cross(arms, normals) @ axle
    across = 1.0 - (normals @ axle) ** 2
    flat = (np.abs(lever) <= FLATS * radius + np.sqrt(2.0 * gap * radius)) & (across > 0.5)
    moved = np.where(flat, lever / np.where(flat, across, 1.0), 0.0)[:, None] * cross(axle, normals)
    return contacts._replace(points=contacts.points + moved)
