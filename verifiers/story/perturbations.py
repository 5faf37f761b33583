"""Worlds whose start differs a little from the specified one: draws by name, so that equal seeds give equal worlds.

Positions move level and turns go about the vertical, so that what stands on something still does. What a joint, spring
or rope holds keeps its place: its anchor is given in world coordinates. Bodies that a shift makes overlap are pushed apart
by the engine before frame 0, as it opens their skins; where that diverges, the sample counts as failed.
"""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.arrays import F64, RigidPose, compose, pose_of
from ...worlds.built import BuiltEntity
from ...worlds.spec import Pose, RigidPhysics

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.spec import Entity, Perturbed, WorldSpec

__all__ = ["fixed_places", "perturbed"]


def fixed_places(spec: WorldSpec) -> frozenset[str]:
    """Entities that joints, springs or ropes hold in place."""
    held: set[str | None] = set()
    for joint in spec.simulation.joints.values():
        held |= {joint.parent, joint.child}
    for name, entity in spec.entities.items():
        if entity.generator is not None:
            held |= {name, entity.generator.attach_start, entity.generator.attach_end}
    return frozenset(n for n in held if n in spec.entities)


def _stream(seed: int, *names: object) -> np.random.Generator:
    """The random numbers of one quantity of one sample; they depend on nothing but these names."""
    text = "/".join(str(n) for n in (seed, *names))
    return np.random.default_rng(int.from_bytes(hashlib.sha256(text.encode()).digest()[:16], "big"))


def perturbed(
    candidate: Candidate, name: str, item: Perturbed, sample: int
) -> tuple[WorldSpec, dict[str, BuiltEntity], dict[str, dict[str, Any]]]:
    """One sample: specification, built entities, and what was drawn per entity, material or contact pair."""
    spec = candidate.spec
    chosen = item.entities or [n for n, e in spec.entities.items() if e.motion == "dynamic"]
    still = fixed_places(spec)
    entities, built, drawn = dict(spec.entities), dict(candidate.built), dict[str, dict[str, Any]]()
    for entity in dict.fromkeys(chosen):
        if entities[entity].motion != "dynamic":
            continue
        rng = _stream(item.seed, name, sample, "entity", entity)
        # Every quantity is drawn, asked for or not, so that one amount does not change the others' draws.
        radius, heading, turn, speed, density = rng.uniform(-1.0, 1.0, 5).tolist()
        told: dict[str, Any] = {}
        if entity not in still and (item.position or item.angle):
            shift = item.position * np.sqrt(abs(radius)) * _level(spec, np.pi * heading)
            pose = _moved(spec, entities[entity], candidate.built[entity], shift, item.angle * turn)
            entities[entity] = entities[entity].model_copy(update={"pose": pose})
            told |= {"shift_m": shift.round(6).tolist(), "turn_rad": round(item.angle * turn, 6)}
        physics = entities[entity].physics
        if item.speed and isinstance(physics, RigidPhysics) and any((*physics.linear_velocity, *physics.angular_velocity)):
            factor = 1.0 + item.speed * speed
            scaled = {f: tuple(factor * v for v in getattr(physics, f)) for f in ("linear_velocity", "angular_velocity")}
            entities[entity] = entities[entity].model_copy(update={"physics": physics.model_copy(update=scaled)})
            told["speed"] = round(factor, 6)
        if item.density:
            factor = 1.0 + item.density * density
            bodies = tuple(dataclasses.replace(b, mass=b.mass * factor, inertia=b.inertia * factor) for b in built[entity].bodies)
            built[entity] = dataclasses.replace(built[entity], bodies=bodies)
            told["mass"] = round(factor, 6)
        if told:
            drawn[entity] = told
    changes: dict[str, Any] = {"entities": entities}
    if item.friction or item.restitution:
        changes["materials"] = _surfaces(spec.materials, name, item, sample, "material", drawn)
        pairs = _surfaces(spec.simulation.contacts, name, item, sample, "contact", drawn)
        changes["simulation"] = spec.simulation.model_copy(update={"contacts": pairs})
    return spec.model_copy(update=changes), built, drawn


def _surfaces(
    known: Mapping[str, Any], name: str, item: Perturbed, sample: int, kind: str, drawn: dict[str, dict[str, Any]]
) -> dict[str, Any]:
    """Materials or contact pairs with other friction and restitution, where they have their own."""
    found = {}
    for key, matter in known.items():
        friction, restitution = _stream(item.seed, name, sample, kind, key).uniform(-1.0, 1.0, 2).tolist()
        changes: dict[str, float] = {}
        if item.friction and matter.friction is not None:
            share = 1.0 + item.friction * friction
            changes |= {f: share * v for f in ("friction", "static_friction") if (v := getattr(matter, f)) is not None}
        if item.restitution and matter.restitution is not None:
            changes["restitution"] = float(np.clip(matter.restitution + item.restitution * restitution, 0.0, 1.0))
        found[key] = matter.model_copy(update=changes)
        if changes:
            drawn[f"{kind} {key}"] = {k: round(v, 6) for k, v in changes.items()}
    return found


def _up(spec: WorldSpec) -> F64:
    gravity = np.array(spec.simulation.gravity, dtype=np.float64)
    size = float(np.linalg.norm(gravity))
    return -gravity / size if size > 0 else np.array([0.0, 0.0, 1.0])


def _level(spec: WorldSpec, heading: float) -> F64:
    """Unit vector across the vertical, shape (3,)."""
    up = _up(spec)
    first = np.cross(up, np.eye(3)[int(np.argmin(np.abs(up)))])
    first /= np.linalg.norm(first)
    level: F64 = np.cos(heading) * first + np.sin(heading) * np.cross(up, first)
    return level


def _moved(spec: WorldSpec, entity: Entity, built: BuiltEntity, shift: F64, turn: float) -> Pose:
    """The entity's pose after a turn [rad] about the vertical through its centre of mass, and a shift [m]."""
    pose = pose_of(entity.pose)
    body = built.bodies[0]
    center = compose(pose, body.pose).apply(body.center[None])[0]
    rotation = RigidPose(np.zeros(3), np.array([np.cos(turn / 2), *(np.sin(turn / 2) * _up(spec))]))
    placed = compose(RigidPose(center + shift, rotation.quaternion), RigidPose(pose.position - center, pose.quaternion))
    return Pose(position=tuple(placed.position.tolist()), quaternion=tuple(placed.quaternion.tolist()))
