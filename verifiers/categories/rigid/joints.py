"""Joints and ropes of a rigid instance, measured from poses: gaps, bent axes, ranges, and the energy in their springs."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ....worlds.arrays import F64, RigidPose, compose, pose_of, rotation_matrix
from ....worlds.spec import BallJoint, HingeJoint, SlideJoint, SpringJoint, WeldJoint
from ...ledgers.balance import Books, books_of
from ...rows.corrections import halve_step
from ...rows.findings import Finding
from .bounds import DETACHED, JOINT_GAP, JOINT_SHARE, LIMIT_STEPS
from .corrections import closer_masses
from .links import owners
from .speeds import angle_of

if TYPE_CHECKING:
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate

__all__ = ["Opening", "joints", "openings", "stored"]


class Opening(NamedTuple):
    """Opening of a joint over the frames."""

    name: str
    child: str
    gap: F64
    """[m], shape (F,); NaN where a driver has opened it."""


class _Side(NamedTuple):
    """Motion of a body relative to where the specification puts it: a world point p0 is now at `turn (p0 - from) + to`."""

    turn: F64
    start: F64
    now: F64

    def carry(self, point: F64) -> F64:
        """Where a point of the body is that was at `point` in the specification, shape (F, 3)."""
        return self.turn @ (point - self.start) + self.now


def _side(books: Books, entity: str | None, body: str | None = None) -> _Side:
    if entity is None or entity not in books.row:
        eye = np.repeat(np.eye(3)[None], books.frames, axis=0)
        return _Side(eye, np.zeros(3), np.zeros((books.frames, 3)))
    built = books.candidate.entity(entity)
    own = next(b for b in built.bodies if body is None or b.name == body)
    row = books.cache.index.bodies.index(f"{entity}/{own.name}")
    start = compose(pose_of(books.candidate.spec.entities[entity].pose), own.pose)
    turn = books.turns[:, row] @ rotation_matrix(start.quaternion).T
    return _Side(turn, start.position, books.position[:, row])


def _relative(books: Books, joint: HingeJoint | SlideJoint | BallJoint | WeldJoint) -> tuple[F64, F64, F64]:
    """A joint over the frames: way between its two anchors [m], turn of the parent, and turn of the child within it."""
    child, parent = _side(books, joint.child), _side(books, joint.parent)
    anchor = np.array(joint.anchor, dtype=np.float64)
    return child.carry(anchor) - parent.carry(anchor), parent.turn, np.swapaxes(parent.turn, 1, 2) @ child.turn


def _size(candidate: Candidate, entity: str) -> float:
    """Diagonal of an entity's smallest body [m]."""
    found = []
    for body in candidate.entity(entity).bodies:
        parts = candidate.entity(entity).parts_of(body.name)
        points = np.concatenate([p.render.vertices for p in parts]) if parts else np.zeros((1, 3))
        found.append(float(np.linalg.norm(np.ptp(points, axis=0))))
    return min(found)


def openings(books: Books) -> list[Opening]:
    """Gap of every joint of the instance but springs, and of every link and end of its ropes."""
    candidate, found = books.candidate, []
    for name, joint in candidate.spec.simulation.joints.items():
        if isinstance(joint, SpringJoint) or joint.child not in books.row:
            continue
        apart, parent, relative = _relative(books, joint)
        size = _size(candidate, joint.child)
        if isinstance(joint, WeldJoint):
            gap = np.maximum(np.linalg.norm(apart, axis=1), size * angle_of(relative))
        elif isinstance(joint, SlideJoint):
            axis = parent @ _unit(joint.axis)
            along = np.sum(apart * axis, axis=1)
            gap = np.maximum(np.linalg.norm(apart - along[:, None] * axis, axis=1), size * angle_of(relative))
            gap = np.maximum(gap, _beyond(books, joint.range, along, 1.0))
        elif isinstance(joint, HingeJoint):
            axis = _unit(joint.axis)
            bent = np.linalg.norm(relative @ axis - axis, axis=1)
            gap = np.maximum(np.linalg.norm(apart, axis=1), size * bent)
            gap = np.maximum(gap, _beyond(books, joint.range, _turned(relative, axis), size))
        else:
            gap = np.linalg.norm(apart, axis=1)
        acting = books.times < books.detached.get(name, np.inf) - DETACHED
        found.append(Opening(name, joint.child, np.where(acting, gap, np.nan)))
    for name in books.entities:
        if candidate.spec.entities[name].generator is not None:
            found += _rope(books, name)
    return found


def joints(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    """Gap of every joint and rope, by the records and by poses."""
    plan = candidate.spec.simulation
    members = {*cache.index.colliders, *owners(cache)}
    jointed = {n: j for n, j in plan.joints.items() if j.kind != "spring" and j.child in members}
    ropes = [n for n, e in candidate.spec.entities.items() if e.generator is not None and n in members]
    if not jointed and not ropes:
        return Finding("not_applicable", "the plan has no hinge, slide, ball or weld and no rope in this instance")
    books = books_of(candidate, cache)
    sizes = {name: _size(candidate, name) for name in (*(j.child for j in jointed.values()), *ropes)}
    smallest = min(sizes, key=lambda n: sizes[n])
    bounds = {n: max(JOINT_GAP, JOINT_SHARE * size) for n, size in sizes.items()}
    # The record is the largest gap of all that the engine solves; poses show every joint by itself.
    series: F64 = books.record("joint_error")
    cases = [(smallest, "of the records", series), *((o.child, o.name, o.gap) for o in openings(books) if o.child in bounds)]
    worst, culprit, frame, bound, which = -1.0, None, None, bounds[smallest], ""
    for child, joint, gap in cases:
        wrong = ~((gap <= bounds[child]) | (np.isnan(gap) if gap is not series else False))
        value = float(np.nanmax(gap, initial=0.0)) if np.isfinite(gap[~np.isnan(gap)]).all() else np.inf
        first = int(np.argmax(wrong)) if wrong.any() else None
        if (first is not None, value / bounds[child]) > (frame is not None, worst):
            worst, culprit, frame, bound, which = value / bounds[child], child, first, bounds[child], joint
    largest_gap = worst * bound if np.isfinite(worst) and np.isfinite(series).all() else None
    text = f"largest joint gap, {which}, {'not finite' if largest_gap is None else f'{largest_gap:.3g} m'} against {bound:.3g} m"
    evidence = {"joints": list(jointed), "ropes": ropes, "smallest_body": sizes[smallest]}
    found = Finding("pass", text, largest_gap, bound, "m", entities=tuple(sizes), evidence=evidence)
    if frame is None:
        return found
    hints = (
        halve_step(candidate, solver, "joints give way under the load"),
        closer_masses("the load is too large for the jointed masses", "jointed"),
    )
    return replace(found, status="fail", text=f"{text}, first over it at frame {frame}", entity=culprit, frame=frame, hints=hints)


def _unit(axis: tuple[float, float, float]) -> F64:
    vector = np.array(axis, dtype=np.float64)
    result: F64 = vector / np.linalg.norm(vector)
    return result


def _turned(relative: F64, axis: F64) -> F64:
    """Angle about an axis [rad], followed over the frames from the specified pose; shape (F,)."""
    across = np.cross(axis, [1.0, 0.0, 0.0] if abs(axis[0]) < 0.9 else [0.0, 1.0, 0.0])
    across /= np.linalg.norm(across)
    now = relative @ across
    return np.unwrap(np.arctan2(now @ np.cross(axis, across), now @ across))


def _beyond(books: Books, limits: tuple[float, float] | None, value: F64, lever: float) -> F64:
    """Distance of a coordinate outside its range [m], less what a soft limit is overrun by at the coordinate's speed."""
    if limits is None:
        return np.zeros(books.frames)
    rate = np.abs(np.gradient(value, books.duration)) if books.frames > 1 else np.zeros(1)
    rate = np.maximum.reduce([rate, np.roll(rate, 1), np.roll(rate, -1)])
    give = rate * LIMIT_STEPS * books.step / np.e
    out: F64 = np.maximum(np.maximum(limits[0] - value, value - limits[1]) - give, 0.0) * lever
    return out


def _tips(books: Books, name: str) -> list[tuple[str, F64, F64]]:
    """Body, and where the first and last point of its axis are in the world as specified, of every segment of a rope."""
    built, base = books.candidate.entity(name), pose_of(books.candidate.spec.entities[name].pose)
    found = []
    for body in built.bodies:
        half = float(built.parts_of(body.name)[0].collision[0].params[1])
        pose: RigidPose = compose(base, body.pose)
        ends = pose.apply(np.array([[0.0, 0.0, -half], [0.0, 0.0, half]]))
        found.append((body.name, ends[0], ends[1]))
    return found


def _rope(books: Books, name: str) -> list[Opening]:
    """Gaps between a rope's segments and at its ends."""
    rope, tips, found = books.candidate.spec.entities[name].generator, _tips(books, name), []
    assert rope is not None
    links = [(_side(books, name, a[0]), _side(books, name, b[0]), b[1]) for a, b in itertools.pairwise(tips)]
    for end, (body, *points), at in ((rope.attach_start, tips[0], 0), (rope.attach_end, tips[-1], 1)):
        if end is not None:
            links.append((_side(books, None if end == "world" else end), _side(books, name, body), points[at]))
    for one, other, point in links:
        found.append(Opening(name, name, np.asarray(np.linalg.norm(one.carry(point) - other.carry(point), axis=1))))
    return found


def stored(books: Books) -> F64:
    """Energy in the springs of hinges, slides, balls and of a rope's bending [J], shape (F,)."""
    result = np.zeros(books.frames)
    for joint in books.candidate.spec.simulation.joints.values():
        if isinstance(joint, SpringJoint | WeldJoint) or joint.child not in books.row or joint.stiffness == 0:
            continue
        apart, parent, relative = _relative(books, joint)
        if isinstance(joint, HingeJoint):
            value = _turned(relative, _unit(joint.axis))
        elif isinstance(joint, SlideJoint):
            value = np.sum(apart * (parent @ _unit(joint.axis)), axis=1)
        else:
            value = angle_of(relative)
        result += 0.5 * joint.stiffness * value**2
    for name in books.entities:
        rope = books.candidate.spec.entities[name].generator
        if rope is None or rope.stiffness == 0:
            continue
        sides = [_side(books, name, b.name) for b in books.candidate.entity(name).bodies]
        pairs = list(itertools.pairwise(sides))
        if rope.attach_start is not None:
            pairs.append((_side(books, None if rope.attach_start == "world" else rope.attach_start), sides[0]))
        for one, other in pairs:
            result += 0.5 * rope.stiffness * angle_of(np.swapaxes(one.turn, 1, 2) @ other.turn) ** 2
    return result
