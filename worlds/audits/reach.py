"""Joints and rope ends that act over a gap, as far as boxes, spheres, cylinders and capsules tell before anything is built."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ..arrays import F64, pose_of
from ..extents import initial_box
from ..problems import Problem, replaced
from ..shapes import Shape
from ..spec import BallJoint, Box, Capsule, Cylinder, HingeJoint, Rope, SlideJoint, Sphere, SpringJoint, WeldJoint, WorldSpec

__all__ = ["held_at_points", "reach_problems"]

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


def _apart(spec: WorldSpec, a: str, b: str) -> bool:
    """True if two entities can neither touch nor meet at one place of a joint, by the boxes that hold them."""
    boxes = initial_box(spec.entities[a]), initial_box(spec.entities[b])
    if boxes[0] is None or boxes[1] is None:
        return False
    gap = np.maximum(boxes[0][0] - boxes[1][1], boxes[1][0] - boxes[0][1])
    return bool(gap.max() > 2.0 * _allowed(spec))


def _anchors(spec: WorldSpec) -> Iterator[tuple[str, str, F64, str, float]]:
    """Joints and rope ends at a fixed point of space: name, entity they hold, point [m], its pointer, further tolerance [m]."""
    for name, joint in spec.simulation.joints.items():
        if joint.parent is None:
            field = "parent_point" if isinstance(joint, SpringJoint) else "anchor"
            point = np.array(joint.parent_point if isinstance(joint, SpringJoint) else joint.anchor, dtype=np.float64)
            yield f"{joint.kind} {name!r}", joint.child, point, f"/simulation/joints/{name}/{field}", 0.0
    for name, entity in spec.entities.items():
        rope = entity.generator
        if isinstance(rope, Rope):
            for side, index, to in (("start", 0, rope.attach_start), ("end", len(rope.points) - 1, rope.attach_end)):
                if to == "world":
                    point = pose_of(entity.pose).apply(np.array([rope.points[index]], dtype=np.float64))[0]
                    yield f"the {side} of rope {name!r}", name, point, f"/entities/{name}/generator/points/{index}", rope.radius


def held_at_points(spec: WorldSpec) -> frozenset[str]:
    """Entities that a joint, spring, rope end, pin or bonded side holds at points of space."""
    pinned = {
        name
        for name, entity in spec.entities.items()
        if any(pin.to is None for pin in getattr(entity.physics, "pins", {}).values())
        or (entity.breakable is not None and entity.breakable.fixed)
    }
    return frozenset(entity for _, entity, *_ in _anchors(spec)) | pinned


def _from_nothing(spec: WorldSpec) -> Iterator[Problem]:
    """Joints and rope ends at a point of space at which surely nothing stands that never moves, and that `afloat` does not explain."""
    if spec.terrains:
        return
    for what, entity, point, place, more in _anchors(spec):
        if entity not in spec.entities or spec.entities[entity].afloat is not None:
            continue
        joint = spec.simulation.joints.get(place.split("/")[3]) if place.startswith("/simulation") else None
        near: list[tuple[float, str]] = []
        for name, other in spec.entities.items():
            if other.motion == "dynamic":
                continue
            missed = _miss(spec, name, point)
            distance = 0.0 if missed is None else missed[0] - more
            if isinstance(joint, HingeJoint) and not _apart(spec, entity, name):
                axis = np.array(joint.axis, dtype=np.float64)
                distance = min(distance, _beside_axis(spec, name, point, axis / max(float(np.linalg.norm(axis)), 1e-12)))
            if isinstance(joint, WeldJoint | SlideJoint) and not _apart(spec, entity, name):
                distance = 0.0
            near.append((distance, name))
        best = min(near, default=None)
        if best is not None and best[0] <= _allowed(spec):
            continue
        nearest = "nothing in this world never moves" if best is None else f"{best[1]!r} is nearest, {best[0]:.4g} m away"
        at = ", ".join(f"{c:.4g}" for c in point)
        yield Problem(
            place,
            f"{what} holds {entity!r} at ({at}), and nothing that never moves is within {_allowed(spec) + more:.4g} m of it ({nearest}): add "
            f"a static hook, post or beam that reaches it and let it end there, or say `afloat` of {entity!r} with the reason",
        )


def reach_problems(spec: WorldSpec) -> list[Problem]:
    """Joints, springs and rope ends that do not reach what they name, or hang on nothing; rows judge what only built surfaces tell."""
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
    return [*found, *_from_nothing(spec)]
