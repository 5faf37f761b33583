"""Joints and rope ends that act over a gap, as far as boxes, spheres, cylinders and capsules tell before anything is built."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ..arrays import F64, pose_of
from ..problems import Problem, replaced
from ..shapes import Shape
from ..spec import BallJoint, Box, Capsule, Cylinder, HingeJoint, Rope, Sphere, SpringJoint, WorldSpec

__all__ = ["reach_problems"]

FACETS = 0.01
"""[m] A visible surface is made of facets, and the check of it takes them into account by at most this."""


def _nearest(shape: Shape, point: F64) -> F64 | None:
    """The point of a solid that is nearest to a point, both in its own frame [m], shape (3,); None for other shapes."""
    if isinstance(shape, Box):
        half = 0.5 * np.array(shape.size)
        return np.clip(point, -half, half)
    if isinstance(shape, Sphere | Capsule):
        half_length = 0.0 if isinstance(shape, Sphere) else 0.5 * shape.length
        core = np.array([0.0, 0.0, min(max(float(point[2]), -half_length), half_length)])
        away = point - core
        length = float(np.linalg.norm(away))
        return point if length <= shape.radius else core + away * shape.radius / length
    if isinstance(shape, Cylinder):
        aside = math.hypot(float(point[0]), float(point[1]))
        share = 1.0 if aside <= shape.radius else shape.radius / aside
        height = min(max(float(point[2]), -0.5 * shape.height), 0.5 * shape.height)
        return np.array([point[0] * share, point[1] * share, height])
    return None


def _miss(spec: WorldSpec, entity: str, point: F64) -> tuple[float, F64] | None:
    """Distance of a point from an entity, 0 inside, and its nearest point [m]; None where a shape does not tell."""
    contract = spec.entities[entity]
    outer, best = pose_of(contract.pose), (math.inf, point)
    for part in contract.parts.values():
        inner = pose_of(part.pose)
        found = _nearest(part.shape, inner.inverse().apply(outer.inverse().apply(point[None]))[0])
        if found is None:
            return None
        place = outer.apply(inner.apply(found[None]))[0]
        best = min(best, (float(np.linalg.norm(place - point)), place), key=lambda item: item[0])
    return best if contract.parts else None


def _allowed(spec: WorldSpec) -> float:
    """Distance within which a place counts as reached here [m]: no less than the check of the built surfaces allows."""
    skins = max((2.0 * s.settings.skin for s in spec.simulation.rigid.values()), default=0.0)
    return max(spec.simulation.limits.contact_gap, skins, FACETS) + 0.5 * skins


def _ends(spec: WorldSpec) -> Iterator[tuple[str, str, F64, str, float]]:
    """Ends of joints and ropes: name of the joint, entity to reach, place [m], its pointer, and further tolerance [m]."""
    for name, joint in spec.simulation.joints.items():
        place = f"/simulation/joints/{name}"
        if isinstance(joint, SpringJoint):
            yield f"spring {name!r}", joint.child, np.array(joint.child_point, dtype=np.float64), f"{place}/child_point", 0.0
            if joint.parent is not None:
                yield (
                    f"spring {name!r}",
                    joint.parent,
                    np.array(joint.parent_point, dtype=np.float64),
                    f"{place}/parent_point",
                    0.0,
                )
        elif isinstance(joint, BallJoint | HingeJoint):
            for body in (joint.child, joint.parent):
                if body is not None:
                    yield f"{joint.kind} {name!r}", body, np.array(joint.anchor, dtype=np.float64), f"{place}/anchor", 0.0
    for name, entity in spec.entities.items():
        rope = entity.generator
        if isinstance(rope, Rope):
            for side, index, to in (("start", 0, rope.attach_start), ("end", len(rope.points) - 1, rope.attach_end)):
                if to is not None and to != "world":
                    point = pose_of(entity.pose).apply(np.array([rope.points[index]], dtype=np.float64))[0]
                    yield f"the {side} of rope {name!r}", to, point, f"/entities/{name}/generator/points/{index}", rope.radius


def _beside_axis(spec: WorldSpec, entity: str, anchor: F64, axis: F64) -> float:
    """Least distance at which any part of an entity can be from a line [m], by spheres about its parts."""
    outer, best = pose_of(spec.entities[entity].pose), math.inf
    for part in spec.entities[entity].parts.values():
        middle = outer.apply(pose_of(part.pose).position[None])[0] - anchor
        aside = float(np.linalg.norm(middle - (middle @ axis) * axis))
        shape = part.shape
        if isinstance(shape, Box):
            radius = 0.5 * math.hypot(*shape.size)
        elif isinstance(shape, Cylinder):
            radius = math.hypot(shape.radius, 0.5 * shape.height)
        elif isinstance(shape, Sphere | Capsule):
            radius = shape.radius + (0.5 * shape.length if isinstance(shape, Capsule) else 0.0)
        else:
            return 0.0
        best = min(best, aside - radius)
    return best


def reach_problems(spec: WorldSpec) -> list[Problem]:
    """Joints, springs and rope ends that do not reach what they name. What only built surfaces tell is judged by rows."""
    allowed, found = _allowed(spec), []
    for what, entity, point, place, more in _ends(spec):
        if entity not in spec.entities:
            continue
        missed = _miss(spec, entity, point)
        if missed is None or missed[0] <= allowed + more:
            continue
        joint = spec.simulation.joints.get(place.split("/")[3]) if place.startswith("/simulation") else None
        if isinstance(joint, HingeJoint):
            axis = np.array(joint.axis, dtype=np.float64)
            # Anywhere on its axis will do.
            if _beside_axis(spec, entity, point, axis / max(float(np.linalg.norm(axis)), 1e-12)) <= allowed:
                continue
        offset = ", ".join(f"{c:+.4g}" for c in missed[1] - point)
        text = (
            f"{what} acts {missed[0]:.4g} m away from {entity!r}, at most {allowed + more:.4g} m is allowed: it would act over a gap; "
            f"move the place by ({offset}) m, or give {entity!r} a part that reaches it"
        )
        value = [round(float(c), 5) for c in missed[1]]
        alone = place.startswith("/simulation") and (isinstance(joint, SpringJoint) or getattr(joint, "parent", None) is None)
        found.append(Problem(place, text, replaced(place, value) if alone else None))
    return found
