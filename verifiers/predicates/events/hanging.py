"""Evaluators of events about what holds a body: swings, comes_loose, opens, closes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.spatial import cKDTree

from ....worlds.arrays import F64, compose, pose_of, rotation_matrix
from ....worlds.errors import EvidenceError
from ....worlds.spec import BallJoint, DetachDriver, HingeJoint, Rope, SlideJoint, SpringJoint
from ...ledgers import motion
from ...scene.surfaces import surfaces_of
from ..outcome import Outcome
from .bounds import LOOSE_WAY, MIDDLE, OPEN_GAP, SHUT_GAP, SWING_BLOW, SWING_EVEN, SWING_SLOW, SWING_TURN
from .course import Course, course_of
from .measures import happened, span_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from ....worlds.candidate import Candidate
    from ....worlds.predicates import BodyEvent, TouchEvent
    from ..scope import Scope

__all__ = ["closes", "comes_loose", "opens", "swings"]

Point = tuple[float, float, float]


def carried_point(candidate: Candidate, entity: str | None, point: Point) -> F64:
    """Path of a point [m], shape (F, 3), that moves with an entity's first body; given in the world as specified."""
    place = np.array(point, dtype=np.float64)
    if entity is None or candidate.spec.entities[entity].motion == "static":
        return np.tile(place, (candidate.frame_count, 1))
    built = candidate.entity(entity).bodies[0]
    start = compose(pose_of(candidate.spec.entities[entity].pose), built.pose)
    return motion.carried(*motion.entity_poses(candidate, entity), start.inverse().apply(place[None])[0])


# ---------------------------------------------------------------- swings


def _pivots(course: Course) -> Iterator[tuple[str, F64]]:
    """Points about which the body can swing [m], each shape (F, 3), with what gives them."""
    candidate, spec = course.candidate, course.candidate.spec
    for name, joint in spec.simulation.joints.items():
        if isinstance(joint, HingeJoint | BallJoint) and course.entity in (joint.child, joint.parent):
            other = joint.parent if course.entity == joint.child else joint.child
            yield f"joint {name}", carried_point(candidate, other, joint.anchor)
        elif isinstance(joint, SpringJoint) and course.entity in (joint.child, joint.parent):
            mine = course.entity == joint.child
            other, point = (joint.parent, joint.parent_point) if mine else (joint.child, joint.child_point)
            yield f"rope {name}", carried_point(candidate, other, point)
    for name, entity in spec.entities.items():
        rope = entity.generator
        if isinstance(rope, Rope) and course.entity in (rope.attach_start, rope.attach_end):
            far, point = (
                (rope.attach_end, rope.points[-1]) if rope.attach_start == course.entity else (rope.attach_start, rope.points[0])
            )
            local = pose_of(entity.pose).apply(np.array(point, dtype=np.float64)[None])[0]
            yield f"rope {name}", carried_point(candidate, far, (float(local[0]), float(local[1]), float(local[2])))


def swings(scope: Scope, p: BodyEvent) -> Outcome:
    """Measured: turning points on the way to and fro about what it hangs on [1]."""
    course, span = course_of(scope.candidate, p.entity), span_of(scope)
    count = span.stop - span.start
    best, on = np.zeros(count), ""
    if scope.candidate.spec.entities[p.entity].motion == "dynamic":
        for name, pivot in _pivots(course):
            turns = _turning_points(course, pivot, span)
            if turns.max(initial=0.0) > best.max(initial=0.0):
                best, on = turns, name
    least = max(1.0, p.min or 0.0)

    def tell(i: int) -> str:
        if best[i] <= 0.0:
            return f"{p.entity} does not swing to and fro about a joint or a rope in frames {scope.frames[0]}..{scope.frames[1]}"
        return f"{p.entity} swings about {on}: {best[i]:.0f} turning points up to frame {span.start + i + 1} (needed {least:g})"

    return happened(scope, p.entity, best, least, "1", tell, lambda i: {"about": on or None})


def _turning_points(course: Course, pivot: F64, span: slice) -> F64:
    """Turning points so far, each after and before a turn of at least `SWING_TURN`, not by a blow, and evenly in time; per interval."""
    at = slice(span.start, span.stop + 1)
    arm = course.centers[at] - pivot[at]
    speed = course.velocities[at] - np.gradient(pivot, course.step, axis=0)[at]
    square = np.maximum(np.sum(arm**2, axis=1, keepdims=True), 1e-300)
    rates = np.cross(arm, speed) / square
    axis = np.linalg.eigh(rates.T @ rates)[1][:, -1]
    speeds = rates @ axis
    turned = 0.5 * (speeds[:-1] + speeds[1:]) * course.step
    struck = _struck(course)[span]
    result, turns = np.zeros(len(turned)), 0
    half, before, since, last = 0.0, 0.0, 0, 0
    for i, step in enumerate(turned):
        if half != 0.0 and np.sign(step) != np.sign(half) and step != 0.0:
            # The last frame of the old sense: a weight has slowed it by then.
            old = i if np.sign(speeds[i]) == np.sign(half) else i - 1
            stopped = SWING_SLOW * float(np.abs(speeds[since : i + 1]).max()) < abs(float(speeds[old]))
            blow = stopped or bool(struck[max(i - 1, 0) : i + 1].any())
            before, half = (0.0 if blow else half), 0.0
            last, since = since, i
        half += float(step)
        if abs(before) >= SWING_TURN and abs(half) >= SWING_TURN:
            even = last == 0 or turns == 0 or (i - since + 1) <= SWING_EVEN * max(since - last, 1)
            turns, before = (turns + 1, 0.0) if even else (0, 0.0)
        result[i] = turns
    return result


def _struck(course: Course) -> F64:
    """1 where contacts of others changed its momentum more than by `SWING_BLOW` of the change, else 0, shape (F - 1,)."""
    count = course.candidate.frame_count - 1
    given = np.zeros((count, 3))
    for origin, found in course.origins.items():
        if origin.kind in ("contact", "driver"):
            given += found.impulse[:count]
    change = course.mass * np.linalg.norm(np.diff(course.velocities, axis=0), axis=1)
    return np.asarray(np.linalg.norm(given, axis=1) > SWING_BLOW * np.maximum(change, 1e-12))


# ---------------------------------------------------------------- comes loose


def comes_loose(scope: Scope, p: TouchEvent) -> Outcome:
    """Measured: how far it moves against what a joint held it to until then [m]."""
    course, span = course_of(scope.candidate, p.entity), span_of(scope)
    best, told, held = np.zeros(span.stop - span.start), "", False
    for name, other, opened in _opened(course):
        if p.other is not None and other != p.other:
            continue
        held = True
        if not span.start <= opened <= span.stop or opened >= scope.candidate.frame_count:
            continue
        offset = _offset(course, other)
        apart = np.linalg.norm(offset - offset[opened], axis=1)[span.start + 1 : span.stop + 1]
        off = np.where(np.arange(span.start + 1, span.stop + 1) > opened, apart, 0.0)
        if off.max(initial=0.0) > best.max(initial=0.0):
            best, told = off, f"{name}, which opened at frame {opened}, held it to {other or 'the world'}"
    least = max(LOOSE_WAY * course.size, p.min or 0.0)

    def tell(i: int) -> str:
        if best[i] <= 0.0:
            why = "what held it does not open then" if held else "no joint that held it is opened"
            return f"{p.entity} does not come loose in frames {scope.frames[0]}..{scope.frames[1]}: {why}"
        return f"{p.entity} is {best[i]:.3g} m off at frame {span.start + i + 1}: joint {told} (needed {least:.3g})"

    return happened(scope, p.entity, best, least, "m", tell)


def _opened(course: Course) -> Iterator[tuple[str, str | None, int]]:
    """Joints of a body that are opened: name, the other end, and the frame at or before that moment."""
    plan = course.candidate.spec.simulation
    for driver in plan.drivers.values():
        if not isinstance(driver, DetachDriver) or driver.joint not in plan.joints:
            continue
        joint = plan.joints[driver.joint]
        if course.entity in (joint.child, joint.parent):
            other = joint.parent if course.entity == joint.child else joint.child
            yield driver.joint, other, int(np.floor(driver.time * plan.fps + 1e-9))


def _offset(course: Course, other: str | None) -> F64:
    """Centre of the body in the frame of another entity [m], shape (F, 3)."""
    if other is None or course.candidate.spec.entities[other].motion == "static":
        return course.centers
    positions, quaternions = motion.entity_poses(course.candidate, other)
    result: F64 = np.einsum("fji,fj->fi", rotation_matrix(quaternions), course.centers - positions)
    return result


# ---------------------------------------------------------------- opens and closes


def opens(scope: Scope, p: TouchEvent) -> Outcome:
    """Measured: gap between the leaf's free edge and what it lay against [1] of its reach from the hinge."""
    if not _hung(scope, p):
        return _unhung(scope, p, "open")
    gaps, span, other = _gap(scope, p)
    values = [np.where(np.maximum.accumulate(gap <= SHUT_GAP), gap, 0.0)[1:] for gap in gaps]
    return _leaf(scope, p, span, values, gaps, other, max(OPEN_GAP, p.min or 0.0), "opens")


def closes(scope: Scope, p: TouchEvent) -> Outcome:
    """Measured: how far its free edge had been off when it comes to what it lies against [1] of its reach from the hinge."""
    if not _hung(scope, p):
        return _unhung(scope, p, "close")
    gaps, span, other = _gap(scope, p)
    values = [np.where(gap <= SHUT_GAP, np.maximum.accumulate(gap), 0.0)[1:] for gap in gaps]
    return _leaf(scope, p, span, values, gaps, other, max(OPEN_GAP, p.min or 0.0), "closes")


def _hung(scope: Scope, p: TouchEvent) -> bool:
    """True if it turns on a hinge or runs on a slide."""
    course_of(scope.candidate, p.entity)
    joints = scope.candidate.spec.simulation.joints.values()
    return any(isinstance(j, HingeJoint | SlideJoint) and j.child == p.entity for j in joints)


def _unhung(scope: Scope, p: TouchEvent, verb: str) -> Outcome:
    span = span_of(scope)
    text = f"{p.entity} turns on no hinge and runs on no slide: it does not {verb}"
    return happened(scope, p.entity, np.zeros(span.stop - span.start), OPEN_GAP, "1", lambda i: text)


def _leaf(
    scope: Scope, p: TouchEvent, span: slice, values: list[F64], gaps: tuple[F64, F64], other: str, least: float, verb: str
) -> Outcome:
    """Outcome by the whole free edge, or by the middle of it where that tells more."""
    edge = int(np.argmax([v.max(initial=0.0) for v in values]))
    value, gap = values[edge], gaps[edge]

    def tell(i: int) -> str:
        if value[i] <= 0.0:
            return f"{p.entity} never {verb} on {other}: its free edge is {gap.min():.2g} to {gap.max():.2g} of its reach off"
        return f"{p.entity} {verb} on {other}: gap {gap[i + 1]:.2g} of its reach at frame {span.start + i + 1}, {value[i]:.2g} measured (needed {least:g})"

    def detail(i: int) -> dict[str, Any]:
        return {"other": other, "gap": float(gap[i + 1])}

    return happened(scope, p.entity, value, least, "1", tell, detail)


def _gap(scope: Scope, p: TouchEvent) -> tuple[tuple[F64, F64], slice, str]:
    """Distance of the leaf's farthest points from what it closes against, by their reach from the hinge, per frame of the span.

    Of the whole free edge, and of the middle of it: the floor under a door may be of the same body as its frame, and the lower end of the
    edge is near it however the door stands.
    """
    candidate, span = scope.candidate, span_of(scope)
    hinge = next(
        (j for j in candidate.spec.simulation.joints.values() if isinstance(j, HingeJoint) and j.child == p.entity), None
    )
    if hinge is None:
        raise EvidenceError(
            f"{p.entity!r} runs on a slide; whether a slide opens something, surfaces do not tell: ask joint_angle"
        )
    other = p.other or hinge.parent
    if other is None:
        raise EvidenceError(f"{p.entity!r} is hinged to the world; say in `other` what it closes against")
    motion.require_motion(candidate, other)
    vertices = candidate.vertices(p.entity, 0)
    axis = np.array(hinge.axis, dtype=np.float64)
    axis /= np.linalg.norm(axis)
    arms = vertices - np.array(hinge.anchor)
    reach = np.linalg.norm(arms - (arms @ axis)[:, None] * axis, axis=1)
    far = reach >= (1.0 - SHUT_GAP) * reach.max()
    surfaces = surfaces_of(candidate)
    frames = range(span.start, span.stop + 1)
    across = _opposite(arms[far], axis)
    whole, middle = [], []
    for k in frames:
        ends = candidate.vertices(p.entity, k)[far]
        whole.append(_nearest(surfaces, ends, other, k))
        middle.append(_nearest(surfaces, ends + MIDDLE * (ends[across] - ends), other, k))
    return (np.array(whole) / float(reach.max()), np.array(middle) / float(reach.max())), span, other


def _opposite(arms: F64, axis: F64) -> NDArray[np.intp]:
    """For each point of a free edge the nearest in line with it at the other end of the edge; itself where none is, shape (n,)."""
    along = arms @ axis
    side = along > 0.5 * (along.min() + along.max())
    flat, found = arms - along[:, None] * axis, np.arange(len(arms))
    for mine in (side, ~side):
        if mine.any() and not mine.all():
            found[mine] = np.flatnonzero(~mine)[cKDTree(flat[~mine]).query(flat[mine])[1]]
    return found


def _nearest(surfaces: Any, points: F64, other: str, frame: int) -> float:
    """Distance of points from a surface at a frame [m]."""
    from ....geometry import distance_to_surface

    least = np.inf
    for row in surfaces.parts_of[other]:
        part = surfaces.parts[row]
        pose = surfaces.track(other, part.body).at(frame)
        least = min(
            least, float(distance_to_surface(surfaces.shapes.solid(row, frame), pose.inverse().apply(points)).distance.min())
        )
    return least
