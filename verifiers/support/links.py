"""Joints, springs and rope ends as support: between whom, and at which frames they can bear weight."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64, compose, pose_of
from ...worlds.spec import DetachDriver, MotorDriver, Rope, SlideJoint, SpringJoint
from ..ledgers import motion
from ..scene.bounds import SUPPORT_SLOPE

if TYPE_CHECKING:
    from ..scene.surfaces import Surfaces

__all__ = ["Link", "links_of", "path_of"]


class Link(NamedTuple):
    """A joint, spring or rope end between two entities (None: the world), and when it holds, shape (frames,)."""

    name: str
    a: str | None
    b: str
    holds: NDArray[np.bool_]


def links_of(surfaces: Surfaces) -> tuple[Link, ...]:
    """Every joint, rope end and pin. A `detach` driver ends one after its time."""
    spec = surfaces.candidate.spec
    frames = np.arange(surfaces.frames) / spec.simulation.fps
    opened = {d.joint: d.time for d in spec.simulation.drivers.values() if isinstance(d, DetachDriver)}
    found = []
    for name, joint in spec.simulation.joints.items():
        holds = frames <= opened.get(name, math.inf)
        if isinstance(joint, SpringJoint) and joint.rope:
            holds = holds & _taut(surfaces, joint)
        elif isinstance(joint, SlideJoint):
            holds = holds & _borne(surfaces, name, joint, frames)
        found.append(Link(name, joint.parent, joint.child, holds))
    return (*found, *_rope_ends(surfaces), *_pins(surfaces))


def _rope_ends(surfaces: Surfaces) -> Iterator[Link]:
    always = np.ones(surfaces.frames, dtype=bool)
    for name, entity in surfaces.candidate.spec.entities.items():
        if isinstance(entity.generator, Rope):
            for end in (entity.generator.attach_start, entity.generator.attach_end):
                if end is not None:
                    yield Link(name, None if end == "world" else end, name, always)


def _pins(surfaces: Surfaces) -> Iterator[Link]:
    """Links by pins that hold vertices of deforming bodies."""
    always = np.ones(surfaces.frames, dtype=bool)
    for name, entity in surfaces.candidate.spec.entities.items():
        for key, pin in getattr(entity.physics, "pins", {}).items():
            yield Link(f"{name}:{key}", pin.to, name, always)


def _taut(surfaces: Surfaces, joint: SpringJoint) -> NDArray[np.bool_]:
    """At which frames a spring that only pulls is as long as its rest length, less the contact tolerance (S3)."""
    start, end = np.array(joint.parent_point, dtype=np.float64), np.array(joint.child_point, dtype=np.float64)
    rest = float(np.linalg.norm(end - start)) if joint.rest_length is None else joint.rest_length
    ends = [path_of(surfaces, owner, point) for owner, point in ((joint.parent, start), (joint.child, end))]
    with np.errstate(invalid="ignore", over="ignore"):
        length = np.linalg.norm(ends[1] - ends[0], axis=1)
        return np.asarray(length >= rest - surfaces.candidate.spec.simulation.limits.contact_gap)


def path_of(surfaces: Surfaces, entity: str | None, point: F64) -> F64:
    """Path of a point fixed to an entity's first body [m], shape (frames, 3); `point` is its place in the specification."""
    if entity is None or surfaces.is_static(entity):
        return np.repeat(point[None], surfaces.frames, 0)
    surfaces.require(entity)
    candidate = surfaces.candidate
    body = candidate.entity(entity).bodies[0]
    local = compose(pose_of(candidate.spec.entities[entity].pose), body.pose).inverse().apply(point[None])[0]
    return motion.carried(*surfaces.track(entity, body.name), local)


def _borne(surfaces: Surfaces, name: str, joint: SlideJoint, time: F64) -> NDArray[np.bool_]:
    """At which frames a slide can bear its child's weight: along an upright axis only by spring, friction, motor or stop."""
    plan = surfaces.candidate.spec.simulation
    gravity, axis = np.array(plan.gravity, dtype=np.float64), np.array(joint.axis, dtype=np.float64)
    strength = float(np.linalg.norm(gravity))
    steep = float(axis @ gravity) / (float(np.linalg.norm(axis)) * strength) if strength > 1e-12 else 0.0
    always = np.ones(len(time), dtype=bool)
    weight = motion.entity_mass(surfaces.candidate, joint.child) * strength * abs(steep)
    if math.sqrt(max(0.0, 1.0 - steep * steep)) >= SUPPORT_SLOPE or joint.stiffness > 0.0 or joint.friction >= weight:
        return always
    holds = ~always
    for driver in plan.drivers.values():
        if isinstance(driver, MotorDriver) and driver.joint == name and driver.max_effort >= weight:
            holds |= (time >= driver.start) & (time < driver.end)
    if joint.range is not None:
        gap, place = plan.limits.contact_gap, _coordinate(surfaces, name)
        holds |= place >= joint.range[1] - gap if steep > 0.0 else place <= joint.range[0] + gap
    return holds


def _coordinate(surfaces: Surfaces, name: str) -> F64:
    """Coordinate of a joint [m], shape (frames,); 0 where nothing was simulated."""
    for cache in surfaces.candidate.rigid_caches.values():
        if name in cache.index.joints:
            column: F64 = cache.series("joint")[: surfaces.frames, cache.index.joints.index(name)]
            return column
    return np.zeros(surfaces.frames)
