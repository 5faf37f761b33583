"""Where two entities touch over the frames, how the point of contact slips and how it runs around the body, from visible surfaces."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations, pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64, rotation_matrix
from ....worlds.errors import EvidenceError
from ...ledgers import motion
from ...ledgers.pieces import whole_frames
from ...scene.surfaces import surfaces_of
from ...support.touching import contacts_of
from .course import Course, between, course_of

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate

__all__ = ["Meeting", "meeting_of", "single"]


@dataclass(frozen=True)
class Meeting:
    """One entity in contact with another, per interval between frames; zero where they do not touch at both ends."""

    touching: NDArray[np.bool_]
    """True where they touch at both ends of the interval, shape (F - 1,)."""
    slip: F64
    """Velocity of the entity's point of contact past the other's [m/s], mean of both ends, shape (F - 1, 3)."""
    way: F64
    """Velocity of the entity's centre past the other's point of contact [m/s], the same."""
    turned: F64
    """Angle that it turns through [rad], as a vector, shape (F - 1, 3)."""
    lever: F64
    """From the point of contact to the centre [m], shape (F - 1, 3)."""
    around: F64
    """Way of the point of contact over the entity, in its own frame, across its axis of turning [m], shape (F - 1,)."""
    axes: F64
    """Direction of the axis of turning in the entity's frame, shape (F - 1, 3)."""
    middles: F64
    """Middle of the patch of contact in the entity's frame at every frame of the span [m], shape (F, 3); NaN where they do not touch."""


def single(course: Course) -> None:
    """Hold that an entity is of one body, or of pieces that are one body as long as their bonds hold.

    Raises:
        EvidenceError: it is of several.
    """
    built = course.candidate.entity(course.entity)
    if len(built.bodies) != 1 and built.bonds is None:
        raise EvidenceError(
            f"{course.entity!r} is of several bodies, which roll, slide and tip each by itself; ask this of a single body"
        )


def meeting_of(candidate: Candidate, entity: str, other: str, span: slice, hop: float = 0.0) -> Meeting:
    """Contact of an entity that is one body with another entity over the intervals of a span; arrays are of that length.

    Of what breaks only the intervals count in which all its pieces are bonded to one another still.

    Args:
        candidate: what is judged.
        entity: one of a single body, or one that breaks.
        other: the other.
        span: intervals.
        hop: between its first and last contact it counts as touching at the nearest points where it is no farther off than this [m].

    Raises:
        EvidenceError: the entity is of several bodies, or no log or surface tells.
    """
    return candidate.memo(
        ("meeting", entity, other, span.start, span.stop, hop), lambda: _meeting(candidate, entity, other, span, hop)
    )


def _meeting(candidate: Candidate, entity: str, other: str, span: slice, hop: float) -> Meeting:
    single(course_of(candidate, entity))
    course, partner = course_of(candidate, entity), course_of(candidate, other)
    logged = between(candidate, other, entity).touched[span]
    frames = np.arange(span.start, span.stop + 1)
    asked = np.zeros(len(frames), dtype=bool)
    asked[:-1] |= logged
    asked[1:] |= logged
    if hop > 0.0 and asked.any():
        asked[np.argmax(asked) : len(asked) - np.argmax(asked[::-1])] = True
        logged = asked[:-1] & asked[1:]
    patches = [_patch(candidate, entity, other, int(f), hop) if ask else None for f, ask in zip(frames, asked, strict=True)]
    points = np.array([np.full(3, np.nan) if p is None else _middle(p) for p in patches])
    there = np.isfinite(points).all(axis=1)
    touching = logged & there[:-1] & there[1:] & _of_one_piece(course)[span]
    at = slice(span.start, span.stop + 1)
    arms = points - course.centers[at]
    spins = course.spins[at]
    theirs = _carried_at(partner, points, at)
    slips, ways = course.velocities[at] + np.cross(spins, arms) - theirs, course.velocities[at] - theirs
    turned = 0.5 * (spins[:-1] + spins[1:]) * course.step
    around = _around(course, patches, turned, at)
    off = ~touching

    def cleared(values: F64) -> F64:
        values = values.copy()
        values[off] = 0.0
        return values

    return Meeting(
        touching,
        cleared(0.5 * (slips[:-1] + slips[1:])),
        cleared(0.5 * (ways[:-1] + ways[1:])),
        cleared(turned),
        cleared(-0.5 * (arms[:-1] + arms[1:])),
        cleared(around),
        _axes(course, turned, at),
        _own_frame(course, points, at),
    )


def _of_one_piece(course: Course) -> NDArray[np.bool_]:
    """True where what it is of moves as one body over an interval, shape (F - 1,)."""
    built = course.candidate.entity(course.entity)
    if built.bonds is None:
        return np.ones(course.candidate.frame_count - 1, dtype=bool)
    whole = whole_frames(course.candidate, course.entity)
    return np.asarray(whole[:-1] & whole[1:])


def _patch(candidate: Candidate, entity: str, other: str, frame: int, hop: float) -> F64 | None:
    """Corners of the patch in which they touch [m], shape (n, 3), or the nearest point within `hop`; None where they are apart at that frame."""
    found = contacts_of(surfaces_of(candidate), entity, other, frame).points
    if len(found):
        return np.unique(np.round(found, 9), axis=0)
    nearest = surfaces_of(candidate).gap(entity, other, frame) if hop > 0.0 else None
    return nearest.point_a[None] if nearest is not None and nearest.distance <= hop else None


def _middle(patch: F64) -> F64:
    result: F64 = 0.5 * (patch.min(axis=0) + patch.max(axis=0))
    return result


def _axes(course: Course, turned: F64, at: slice) -> F64:
    _, quaternions = (v[at] for v in motion.entity_poses(course.candidate, course.entity))
    own = np.einsum("fji,fj->fi", rotation_matrix(quaternions)[:-1], turned)
    result: F64 = own / np.maximum(np.linalg.norm(own, axis=1, keepdims=True), 1e-300)
    return result


def _own_frame(course: Course, points: F64, at: slice) -> F64:
    positions, quaternions = (v[at] for v in motion.entity_poses(course.candidate, course.entity))
    result: F64 = np.einsum("fji,fj->fi", rotation_matrix(quaternions), points - positions)
    return result


def _carried_at(partner: Course, points: F64, at: slice) -> F64:
    """Velocity of the other body's matter at some points [m/s], shape (f, 3)."""
    if partner.candidate.spec.entities[partner.entity].motion == "static":
        return np.zeros_like(points)
    result: F64 = partner.velocities[at] + np.cross(partner.spins[at], points - partner.centers[at])
    return result


def _around(course: Course, patches: list[F64 | None], turned: F64, at: slice) -> F64:
    """Way of the middle of the patch of contact over the body, across the axis of turning [m], shape (f - 1,).

    It is counted as the middle leaves the patch that was touched when it was counted last: an edge of the face on which a body stands is no
    way, the next face of a die is, and the patch of a small ball, within what counts as contact, may be wider than its way between two frames.
    """
    positions, quaternions = (v[at] for v in motion.entity_poses(course.candidate, course.entity))
    turns = rotation_matrix(quaternions)
    result = np.zeros(len(turned))
    last: F64 | None = None
    for k, (old, new) in enumerate(pairwise(patches)):
        length = float(np.linalg.norm(turned[k]))
        if old is None or new is None:
            last = None
            continue
        here, there = ((patch - positions[f]) @ turns[f] for f, patch in ((k, old), (k + 1, new)))
        last = here if last is None else last
        if length == 0.0:
            continue
        axis = turns[k].T @ turned[k] / length
        flat = np.eye(3) - np.outer(axis, axis)
        middle = _middle(there) @ flat
        if _beyond(middle, last @ flat) > ROUNDING:
            result[k] = float(np.linalg.norm(middle - _middle(last) @ flat))
            last = there
    return result


ROUNDING = 1e-6
"""[m] Own choice: the middle of a patch no farther outside another lies on its border."""


def _beyond(point: F64, patch: F64) -> float:
    """Distance of a point from a patch seen along its plane, so that it is the segment between two of its corners [m]."""
    ends = np.array(list(combinations(patch, 2)) or [(patch[0], patch[0])])
    start, along = ends[:, 0], ends[:, 1] - ends[:, 0]
    share = np.sum((point - start) * along, axis=1) / np.maximum(np.sum(along**2, axis=1), 1e-300)
    nearest = start + np.clip(share, 0.0, 1.0)[:, None] * along
    return float(np.linalg.norm(point - nearest, axis=1).min())
