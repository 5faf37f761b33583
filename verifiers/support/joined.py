"""Judges whether joints, springs, rope ends and `fastened` relations reach what they join, on the visible surfaces (R92, R154).

Whatever turns about a point needs that point at both bodies; a hinge has it anywhere on its axis. A weld or a slide has no
such point: it joins what touches. What is joined with the world needs the body alone here; `support/anchored.py` asks what is
drawn at the other side.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...geometry import contains, distance_to_surface
from ...worlds.arrays import F64, RigidPose, compose, pose_of
from ...worlds.spec import Fastened, HingeJoint, Rope, SlideJoint, SpringJoint, WeldJoint
from ..rows.answers import row_of, rows_of
from ..rows.corrections import correction, move_by, pointer, set_value
from ..rows.findings import Finding
from ..scene.bounds import ROUNDING
from ..scene.interpenetration import correction_order
from ..scene.surfaces import MANY_PARTS
from .bounds import LEFT
from .questions import FASTENED, JOINT, ROPE

if TYPE_CHECKING:
    from ...worlds.requirements import Correction, Row
    from ...worlds.spec import Joint
    from ..scene.surfaces import Surfaces

__all__ = ["End", "Missed", "joined_rows", "missed", "on_axis", "reach_of", "touch", "way_to"]

PLACES = 400
"""Places along the axis of a hinge that are tried at most."""
AHEAD = 1e-6
"""[1] Own choice: by so much of the bound a place has to be nearer for others not to be tried; rounding is a millionth of that."""


class End(NamedTuple):
    """One end of what joins: an entity, and the place at which it must be reached."""

    entity: str
    point: F64
    """[m]"""
    where: tuple[str | int, ...]
    """Steps of the pointer to that place."""


class Missed(NamedTuple):
    """Distance of an end from the surface of its entity."""

    end: End
    distance: float
    """[m], 0 inside"""
    nearest: F64
    """Point of the surface [m]."""


class _Declared(NamedTuple):
    """Parts of an entity as declared: places of joints are given there, before any preroll."""

    poses: list[RigidPose]
    inverses: list[RigidPose]
    low: F64
    """Corners of their boxes [m], shapes (parts, 3)."""
    high: F64


def way_to(surfaces: Surfaces, entity: str, points: F64) -> tuple[float, F64, F64]:
    """Least distance of some points from the visible surface of an entity as declared [m], 0 inside; that point and its nearest one.

    Args:
        surfaces: of the candidate.
        entity: whose surface.
        points: [m], shape (n, 3).
    """
    declared = _declared(surfaces, entity)
    beyond = _beyond(declared, points)
    solids = [surfaces.shapes.solid(i, 0) for i in surfaces.parts_of[entity]]
    for k in np.flatnonzero(beyond <= ROUNDING):
        inside = contains(solids[k], declared.inverses[k].apply(points))
        if inside.any():
            point = points[int(np.argmax(inside))]
            return 0.0, point, point
    best: tuple[float, int, F64, F64] = (np.inf, 0, points[0], points[0])
    for k in np.argsort(beyond, kind="stable").tolist():
        if beyond[k] > best[0] + ROUNDING:
            break
        distance, nearest = distance_to_surface(solids[k], declared.inverses[k].apply(points))
        at = int(np.argmin(distance))
        if (float(distance[at]), k) < best[:2]:  # of parts that are as near, the first
            best = (float(distance[at]), k, points[at], declared.poses[k].apply(nearest[at][None])[0])
    return best[0], best[2], best[3]


def _declared(surfaces: Surfaces, entity: str) -> _Declared:
    """Parts of an entity as declared, worked out once."""
    return surfaces.candidate.memo(("declared parts", entity), lambda: _made_declared(surfaces, entity))


def _made_declared(surfaces: Surfaces, entity: str) -> _Declared:
    candidate, rows = surfaces.candidate, surfaces.parts_of[entity]
    place = pose_of(candidate.spec.entities[entity].pose)
    names = [surfaces.parts[i].body for i in rows]
    bodies = {name: compose(place, candidate.body(entity, name).pose) for name in dict.fromkeys(names)}
    poses = [bodies[name] for name in names]
    corners = [pose.apply(surfaces.shapes.solid(i, 0).vertices) for i, pose in zip(rows, poses, strict=True)]
    low, high = np.array([c.min(axis=0) for c in corners]), np.array([c.max(axis=0) for c in corners])
    return _Declared(poses, [p.inverse() for p in poses], low, high)


def _beyond(declared: _Declared, points: F64) -> F64:
    """Least distance of some points from the box of each part [m], shape (parts,)."""
    away = np.maximum(np.maximum(declared.low[:, None] - points, points - declared.high[:, None]), 0.0)
    return np.asarray(np.linalg.norm(away, axis=2).min(axis=1))


def _distance(surfaces: Surfaces, entity: str, point: F64) -> float:
    """Distance of a point from the visible surface of an entity as declared [m], 0 inside: that of `way_to`, by compiled loops."""
    from ...geometry.point_kernels import to_triangles

    declared, rows = _declared(surfaces, entity), surfaces.parts_of[entity]
    beyond = _beyond(declared, point[None])
    solids = [surfaces.shapes.solid(i, 0) for i in rows]
    local = [None if far > ROUNDING else declared.inverses[k].apply(point[None]) for k, far in enumerate(beyond.tolist())]
    if any(at is not None and contains(solid, at)[0] for solid, at in zip(solids, local, strict=True)):
        return 0.0
    best = np.inf
    for k in np.argsort(beyond, kind="stable").tolist():
        if beyond[k] > best + ROUNDING:
            break
        at = local[k] if local[k] is not None else declared.inverses[k].apply(point[None])
        best = min(best, to_triangles(at[0], solids[k].triangles))
    return float(best)


def missed(surfaces: Surfaces, end: End) -> Missed:
    """Distance of an end from the visible surface of its entity."""
    surfaces.require(end.entity)
    distance, _, nearest = way_to(surfaces, end.entity, end.point[None])
    return Missed(end, distance, nearest)


def joined_rows(surfaces: Surfaces) -> list[Row]:
    """Rows `support:joint:<joint>`, `support:rope:<entity>:<start|end>` and `support:fastened:<relation>`."""
    candidate = surfaces.candidate
    found: list[Row] = []
    for name, joint in candidate.spec.simulation.joints.items():
        bodies = tuple(e for e in (joint.child, joint.parent) if e is not None)
        found.append(row_of(candidate, JOINT, (name,), partial(_joint, surfaces, name, joint), entities=bodies))
    for name, entity in candidate.spec.entities.items():
        if isinstance(entity.generator, Rope):
            ends = partial(_rope, surfaces, name, entity.generator)
            found += rows_of(candidate, ROPE, (name,), ends, entities=(name,))
    for name, relation in candidate.spec.graph.relations.items():
        if isinstance(relation, Fastened) and {relation.a, relation.b} <= set(candidate.solids):
            judge = partial(_fastened, surfaces, relation)
            found.append(row_of(candidate, FASTENED, (name,), judge, entities=(relation.a, relation.b)))
    return found


# ---------------------------------------------------------------- joints


def reach_of(surfaces: Surfaces, *entities: str) -> float:
    """The largest distance of a place from a surface that it reaches [m]: the contact tolerance (S3) and a collision skin."""
    pair = (entities[0], entities[-1])
    skins = [s.settings.skin for s in surfaces.candidate.spec.simulation.rigid.values() if entities[0] in s.members]
    return surfaces.contact_gap(*pair) + max(skins, default=0.0)


def _joint(surfaces: Surfaces, name: str, joint: Joint) -> Finding:
    bodies = tuple(e for e in (joint.child, joint.parent) if e is not None)
    surfaces.require(*bodies)
    bound = reach_of(surfaces, *bodies)
    path = ("simulation", "joints", name)
    if isinstance(joint, SpringJoint):
        ends = [
            End(e, np.array(p, dtype=np.float64), (*path, f))
            for e, p, f in ((joint.child, joint.child_point, "child_point"), (joint.parent, joint.parent_point, "parent_point"))
            if e is not None
        ]
    else:
        place = np.array(joint.anchor, dtype=np.float64)
        if isinstance(joint, HingeJoint):
            place = on_axis(surfaces, bodies, place, np.array(joint.axis, dtype=np.float64), bound)
        ends = [End(e, place, (*path, "anchor")) for e in bodies]
    found = [missed(surfaces, end) for end in ends]
    worst = max(found, key=lambda m: m.distance)
    if isinstance(joint, WeldJoint | SlideJoint) and len(bodies) == 2 and worst.distance > bound and touch(surfaces, *bodies):
        worst = Missed(worst.end, 0.0, worst.nearest)
    what = f"{joint.kind} {name!r}"
    corrections = [] if worst.distance <= bound else list(_joint_corrections(surfaces, what, joint, worst))
    return _reach(what, worst, bound, bodies, tuple(corrections))


def touch(surfaces: Surfaces, a: str, b: str) -> bool:
    """True if two entities touch at frame 0, static ones included."""
    return surfaces.first.get((a, b), surfaces.first.get((b, a), np.inf)) <= surfaces.contact_gap(a, b)


def on_axis(surfaces: Surfaces, bodies: Sequence[str], anchor: F64, axis: F64, bound: float) -> F64:
    """The place on the axis of a hinge at which all its bodies are nearest [m]; one that reaches all of them, where there is any.

    Along the axis no distance changes faster than one goes, so that between two places it is no less than the mean of theirs less half
    their distance; the stretch that may still hold the least is halved first (Piyavskii 1972, doi:10.1016/0041-5553(72)90115-2).
    """
    axis = axis / np.linalg.norm(axis)

    surfaces.require(*bodies)
    many = len(surfaces.parts) >= MANY_PARTS

    def worst(at: float) -> float:
        place = anchor + at * axis
        return max(_distance(surfaces, b, place) if many else missed(surfaces, End(b, place, ())).distance for b in bodies)

    best = (worst(0.0), 0.0)
    # The ends tried below lie a bound before the first corner or behind the last of a body, and are no nearer to it than that.
    if best[0] < (1.0 - AHEAD) * bound:
        return np.asarray(anchor + best[1] * axis)
    spans = []
    for body in bodies:
        poses = zip(surfaces.parts_of[body], _declared(surfaces, body).poses, strict=True)
        corners = [pose.apply(surfaces.shapes.solid(i, 0).vertices) for i, pose in poses]
        along = (np.concatenate(corners) - anchor) @ axis
        spans.append((float(along.min()), float(along.max())))
    # Bodies that lie one after the other along the axis are nearest somewhere between them.
    low, high = sorted((max(s[0] for s in spans), min(s[1] for s in spans)))
    ends = [(worst(at), at) for at in (low - bound, high + bound)]
    waiting = [(_least(*ends), ends[0], ends[1])]
    for _ in range(PLACES):
        best = min(best, *ends)
        if best[0] <= bound or not waiting or waiting[0][0] > bound:
            break
        _, one, two = heapq.heappop(waiting)
        at = 0.5 * (one[1] + two[1])
        ends = [(worst(at), at)]
        for half in ((one, ends[0]), (ends[0], two)):
            heapq.heappush(waiting, (_least(*half), half[0], half[1]))
    return np.asarray(anchor + best[1] * axis)


def _least(one: tuple[float, float], two: tuple[float, float]) -> float:
    """The least that a distance can be between two places, each given as (distance there, place) [m]."""
    return 0.5 * (one[0] + two[0] - abs(two[1] - one[1]))


def _joint_corrections(surfaces: Surfaces, what: str, joint: Joint, worst: Missed) -> Iterator[Correction]:
    target, cause = worst.end.entity, f"{what} acts over a gap"
    place = [round(float(c), 5) for c in worst.nearest]
    path = pointer(*worst.end.where)
    if isinstance(joint, SpringJoint) or joint.parent is None:
        field = worst.end.where[-1]
        yield correction(
            cause,
            "joints",
            f"Move its {field} by {_text(worst.nearest - worst.end.point)} m to {place}, on the surface of {target!r}.",
            pointers=(path,),
            patch=set_value(path, place),
        )
    else:
        gap = surfaces.gap(joint.child, joint.parent, 0)
        meet = [round(float(c), 5) for c in gap.point_b]
        if gap.distance <= surfaces.contact_gap(joint.child, joint.parent):
            yield correction(
                f"the anchor of {what} is not where its bodies meet",
                "joints",
                f"Move its anchor by {_text(gap.point_b - worst.end.point)} m to {meet}, where {joint.child!r} meets {joint.parent!r}.",
                pointers=(path,),
                patch=set_value(path, meet),
            )
        else:
            way = (gap.point_b - gap.point_a) * (1.0 - LEFT / gap.distance)
            action = f"Move {joint.child!r} by {_text(way)} m, to {joint.parent!r}; then the anchor of {what} belongs at {meet}."
            yield move_by(surfaces.candidate, joint.child, way, cause, action)
    yield correction(
        "what joins them is not drawn",
        "shape",
        f"Give {target!r} a part (a rod, bracket, hub or eye) that reaches {[round(float(c), 5) for c in worst.end.point]}.",
        pointers=(pointer("entities", target, "parts"),),
    )


def _text(way: F64) -> str:
    return "(" + ", ".join(f"{c:+.5g}" for c in way) + ")"


def _reach(what: str, worst: Missed, bound: float, entities: tuple[str, ...], corrections: tuple[Correction, ...]) -> Finding:
    target, ok = worst.end.entity, worst.distance <= bound
    place = ", ".join(f"{c:.4g}" for c in worst.end.point)
    text = f"{what} reaches {' and '.join(map(repr, entities))}"
    if not ok:
        text = (
            f"{what} acts at ({place}), {worst.distance * 1e3:.4g} mm away from the surface of {target!r}, "
            f"at most {bound * 1e3:.4g} mm are allowed: it acts over a gap"
        )
    return Finding(
        "pass" if ok else "fail",
        text,
        worst.distance,
        bound,
        hints=corrections,
        evidence={"place": worst.end.point.tolist(), "nearest": worst.nearest.tolist()},
        entities=(target, *(e for e in entities if e != target)),
        frames=(0, 0),
        predicate=f"{what} reaches the visible surface of what it joins within {bound:g} m",
        extra=[worst.end.point.tolist(), bound],
    )


# ---------------------------------------------------------------- ropes and fastened things


def _rope(surfaces: Surfaces, name: str, rope: Rope) -> Iterator[Row]:
    start = pose_of(surfaces.candidate.spec.entities[name].pose)
    for side, index, to in (("start", 0, rope.attach_start), ("end", len(rope.points) - 1, rope.attach_end)):
        if to is None or to == "world":
            continue
        point = start.apply(np.array([rope.points[index]], dtype=np.float64))[0]
        worst = missed(surfaces, End(to, point, ("entities", name, "generator", "points", index)))
        # The end is round: its surface is a radius from its point.
        bound = reach_of(surfaces, name, to) + rope.radius
        what = f"the {side} of rope {name!r}"
        corrections: list[Correction] = []
        if worst.distance > bound:
            path, local = pointer(*worst.end.where), start.inverse().apply(worst.nearest[None])[0]
            corrections.append(
                correction(
                    f"{what} does not reach {to!r}",
                    "shape",
                    f"Move that point by {_text(worst.nearest - point)} m in the world, to the surface of {to!r}.",
                    pointers=(path,),
                    patch=set_value(path, [round(float(c), 5) for c in local]),
                )
            )
        yield row_of(surfaces.candidate, ROPE, (name, side), _reach(what, worst, bound, (to, name), tuple(corrections)))


def _fastened(surfaces: Surfaces, relation: Fastened) -> Finding:
    a, b = correction_order(surfaces, relation.a, relation.b)
    surfaces.require(a, b)
    gap, bound = surfaces.gap(a, b, 0), surfaces.contact_gap(a, b)
    ok = gap.distance <= bound
    corrections: list[Correction] = []
    text = f"{a!r} and {b!r} are fastened and touch"
    if not ok:
        way = (gap.point_b - gap.point_a) * (1.0 - LEFT / gap.distance)
        text = f"{a!r} and {b!r} are fastened {gap.distance * 1e3:.4g} mm apart, contact means at most {bound * 1e3:.4g} mm"
        corrections.append(
            move_by(
                surfaces.candidate,
                a,
                way,
                f"what fastens {a!r} to {b!r} acts over a gap",
                f"Move {a!r} by {_text(way)} m, or draw what joins them.",
            )
        )
    return Finding(
        "pass" if ok else "fail",
        text,
        gap.distance,
        bound,
        hints=tuple(corrections),
        evidence={"point_a": gap.point_a.tolist(), "point_b": gap.point_b.tolist()},
        entities=(a, b),
        frames=(0, 0),
        predicate=f"clearance({a}, {b}) <= {bound:g} m at frame 0, as they are fastened",
    )
