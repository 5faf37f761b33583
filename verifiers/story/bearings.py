"""Friction that a slide joint spares a body whose drawn surface lies on what the joint guides it along."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...worlds.arrays import F64
from ...worlds.spec import SlideJoint
from ..categories.registry import judge_of
from ..ledgers.balance import frictions
from ..ledgers.origins import Origin
from ..scene.surfaces import surfaces_of

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ..ledgers.balance import Books

__all__ = ["Spared", "spared_by"]


class Spared(NamedTuple):
    """Friction that surfaces which touch would have had, less what the joint has of its own."""

    work: F64
    """Since frame 0 [J], shape (F,)."""
    friction: float
    """Largest friction that the surfaces would have had [N]."""


def spared_by(candidate: Candidate, books: Books, joint: SlideJoint) -> Spared | None:
    """Friction of which a slide relieves its child; None where its two ends do not touch at frame 0, or the child does not move freely.

    The load is what the joint gives the child across its axis: impulse that no contact explains. Friction is the least that the materials
    of both give, as Coulomb has it; dry friction and damping of the joint are taken off.
    """
    row = books.row.get(joint.child)
    if row is None or books.kinematic[row] or joint.parent is None or not _touch(candidate, joint.child, joint.parent):
        return None
    given = judge_of(candidate.spec, joint.child).origins(candidate, joint.child).get(Origin("unlisted", ""))
    if given is None:
        return None
    other = books.row.get(joint.parent)
    axis = _axis(books, joint, other)
    across = given.impulse - np.sum(given.impulse * axis, axis=1, keepdims=True) * axis
    centers = books.centers[:, row] - (0.0 if other is None else books.centers[:, other])
    way = np.abs(np.sum(np.diff(centers, axis=0) * axis, axis=1))
    low, _ = frictions(candidate, (joint.child, joint.parent))
    surfaces = float(low[0, 1]) * np.linalg.norm(across, axis=1) / books.duration
    own = joint.friction + joint.damping * way / books.duration
    work = np.concatenate([[0.0], np.cumsum(np.maximum(surfaces - own, 0.0) * way)])
    moving = way > 0.0
    return Spared(work, float(surfaces[moving].max(initial=0.0)))


def _touch(candidate: Candidate, a: str, b: str) -> bool:
    """True if two entities touch at frame 0."""
    surfaces = surfaces_of(candidate)
    gap = surfaces.first.get((a, b), surfaces.first.get((b, a), np.inf))
    return gap <= candidate.spec.simulation.limits.contact_gap


def _axis(books: Books, joint: SlideJoint, parent: int | None) -> F64:
    """Direction of the slide over the intervals, shape (F - 1, 3): it turns with the parent."""
    axis: F64 = np.array(joint.axis, dtype=np.float64)
    axis /= np.linalg.norm(axis)
    if parent is None:
        return np.tile(axis, (books.frames - 1, 1))
    turns = books.turns[:-1, books.first[parent]]
    return np.asarray(np.einsum("fij,j->fi", turns, books.turns[0, books.first[parent]].T @ axis))
