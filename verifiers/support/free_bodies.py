"""Support of free bodies that no relation covers: contact, joint, driver or launch at frame 0 (R154)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.arrays import F64, pose_of
from ...worlds.fields import fields_of
from ...worlds.spec import ElasticPhysics, ForceDriver, ReleaseDriver, RigidPhysics, SpringJoint
from ..ledgers import motion
from ..rows.corrections import correction, let_settle, move_by, pointer, set_value
from ..rows.findings import Finding
from ..scene.room import in_the_way
from .afloat import afloat
from .bounds import CARRIES, GRIP_TIME, LAUNCH_SPEED, LEFT
from .graph import beside, drop, gravity_direction
from .moved import spoken_of

if TYPE_CHECKING:
    from ...worlds.requirements import Correction
    from ...worlds.spec import WorldSpec
    from ..scene.surfaces import Surfaces
    from .graph import SupportGraph

__all__ = ["along_up", "derived", "placement", "size_of"]


def along_up(surfaces: Surfaces, distance: float) -> F64 | None:
    """A way of `distance` [m] against gravity, shape (3,); None without gravity."""
    direction = gravity_direction(surfaces)
    return None if direction is None else -distance * direction


def placement(surfaces: Surfaces, entity: str, offset: F64 | None, cause: str) -> Correction:
    """Correction that moves the entity by `offset` [m], or asks for a better place where no number determines it, or nothing has room there."""
    action = f"Place {entity!r} so that it rests on its support with a gap of {LEFT * 1e3:g} mm."
    if offset is not None:
        text = ", ".join(f"{c:+.5g}" for c in offset)
        action = f"Move {entity!r} by ({text}) m, which leaves a gap of {LEFT * 1e3:g} mm."
        if (other := in_the_way(surfaces, surfaces.parts_of[entity], offset)) is not None:
            action = f"{action[:-1]}; {other!r} is in the way there: move it first, or choose another place."
            offset = None
    return move_by(surfaces.candidate, entity, offset, cause, action)


def derived(graph: SupportGraph, entity: str) -> Finding:
    """Judge whether something holds a free body at frame 0: the question that no edit of the scene graph removes (R154)."""
    surfaces = graph.surfaces
    surfaces.require(entity)
    reason, evidence = _excuse(graph, entity)
    if entity in surfaces.broken and surfaces.broken[entity] == 0:
        reason = ""
    gap, declared = surfaces.candidate.spec.simulation.limits.contact_gap, _declared(surfaces, entity)
    if reason:
        return Finding("pass", f"{entity!r} {reason}", evidence=evidence, frames=(0, 0), extra=declared)
    fall = drop(surfaces, entity, 0) if entity not in surfaces.broken else None
    corrections: list[Correction] = list(_tighter(surfaces, entity))
    if fall is None:
        text = f"{entity!r} floats: nothing lies beneath it, no joint or driver holds it and it has no initial velocity"
    elif fall[0] <= gap:
        text = f"{entity!r} touches {fall[1]!r}, which nothing holds up either"
        if graph.grounded(fall[1])[0]:
            text = f"{entity!r} touches {fall[1]!r}, which does not hold it: contact and friction there cannot bear its weight"
            corrections += let_settle(surfaces.candidate, entity)
    else:
        text = f"{entity!r} floats {fall[0] * 1e3:.4g} mm above {fall[1]!r}; no joint or driver holds it"
        offset = along_up(surfaces, LEFT - fall[0])
        if not corrections:  # what hangs on a slack rope is not to be put down
            corrections.append(placement(surfaces, entity, offset, f"{entity!r} is placed above its support"))
    text += _no_excuse(surfaces, entity)
    sides = [] if entity in surfaces.broken else [n for n in beside(surfaces, entity, 0) if graph.grounded(n)[0]]
    if sides:
        text += f"; it touches {', '.join(map(repr, sides))} beside or above it, where neither friction nor a joint holds it"
    squeezed = graph.squeezed(entity, 0) if sides else []
    if squeezed:
        text += f"; {'; '.join(one.text() for one in squeezed[:2])}"
    held = correction(
        "it is meant to be dropped, thrown or hung",
        "drivers",
        f"Declare what holds {entity!r}: a joint; or a `release` driver, a force, a field or an initial velocity >= {LAUNCH_SPEED:g} m/s, "
        "and a beat that tells of its fall, flight or hovering. What is to hang in the air says `afloat` with the reason.",
        pointers=("/simulation/drivers", "/simulation/joints", pointer("entities", entity, "physics", "linear_velocity")),
    )
    # What hangs higher than it is large was put there on purpose more likely than by a slip.
    hangs = fall is not None and fall[0] > size_of(surfaces, entity)
    roped = any(c.group == "joints" for c in corrections)
    corrections = [held, *corrections] if hangs and not roped else [*corrections, held]
    return Finding(
        "fail",
        text,
        fall[0] if fall else None,
        gap,
        hints=tuple(corrections),
        evidence={"beneath": fall[1] if fall else None},
        entities=(entity,) if fall is None else (entity, fall[1]),
        frames=(0, 0),
        extra=declared,
    )


def _tighter(surfaces: Surfaces, entity: str) -> Iterator[Correction]:
    """Corrections that draw tight the slack ropes on which a body is to hang."""
    for name, joint in surfaces.candidate.spec.simulation.joints.items():
        if isinstance(joint, SpringJoint) and joint.rope and entity in (joint.parent, joint.child):
            way = float(np.linalg.norm(np.subtract(joint.parent_point, joint.child_point)))
            if joint.rest_length is not None and joint.rest_length > way > 0.0:
                place, length = pointer("simulation", "joints", name, "rest_length"), float(f"{way:.6g}")
                told = f"Draw rope {name!r} tight: a rest_length of {length:g} m instead of {joint.rest_length:g} m."
                cause = f"{entity!r} hangs on a slack rope"
                yield correction(cause, "joints", told, pointers=(place,), patch=set_value(place, length))


def size_of(surfaces: Surfaces, entity: str) -> float:
    """Diagonal of what the entity covers at frame 0 [m]."""
    return float(np.linalg.norm(np.ptp(surfaces.candidate.vertices(entity, 0), axis=0)))


def _excuse(graph: SupportGraph, entity: str) -> tuple[str, dict[str, Any]]:
    """Reason why the body is held, or meant to fall, at frame 0, with evidence; an empty text when there is none."""
    surfaces = graph.surfaces
    spec = surfaces.candidate.spec
    if gravity_direction(surfaces) is None:
        return "is in a world without gravity", {}
    said = spec.entities[entity].afloat
    if said is not None:
        return f"is said to float in the air: {said}", {"afloat": said}
    liquids = [n for n, frames in afloat(surfaces.candidate, entity).items() if frames[0]]
    if liquids:
        return f"lies in {liquids[0]!r}, which acts on it", {"liquids": liquids}
    released = [n for n, d in spec.simulation.drivers.items() if isinstance(d, ReleaseDriver) and d.entity == entity]
    told = spoken_of(spec, entity)
    if released and told:
        return f"is let go by driver {released[0]!r}", {"driver": released[0]}
    if bool(graph.grounded(entity)[0]) and not _slips_through(graph, entity):
        chain = graph.chain(entity, 0)
        return f"is held up through {' -> '.join(chain)}", {"chain": chain}
    weight = motion.entity_mass(surfaces.candidate, entity) * np.array(spec.simulation.gravity)
    for name, driver in spec.simulation.drivers.items():
        if told and isinstance(driver, ForceDriver) and driver.entity == entity and driver.start <= 0.0:
            share = -float(np.dot(driver.force, weight) / np.dot(weight, weight))
            if share >= CARRIES:
                return f"is carried by driver {name!r} with {share:.3g} of its weight", {"driver": name}
    fields = fields_of(spec, entity)
    if told and fields:
        center = np.array([pose_of(spec.entities[entity].pose).position])
        share = -float(np.dot(fields.acceleration(center, 0.0)[0], spec.simulation.gravity)) / float(
            np.dot(spec.simulation.gravity, spec.simulation.gravity)
        )
        if share >= CARRIES:
            return f"is carried by fields {', '.join(fields.names)} with {share:.3g} of its weight", {
                "fields": list(fields.names)
            }
    physics = spec.entities[entity].physics
    if isinstance(physics, RigidPhysics | ElasticPhysics):
        speed = float(np.linalg.norm(physics.linear_velocity))
        if speed >= LAUNCH_SPEED and told and not _dragged(surfaces, entity):
            return f"is launched with {speed:.4g} m/s", {"speed_m_s": speed}
    return "", {}


def _dragged(surfaces: Surfaces, entity: str) -> bool:
    """True where viscous drag at the start velocity is nearly the weight: the body hangs in it."""
    physics = surfaces.candidate.spec.entities[entity].physics
    if not isinstance(physics, RigidPhysics):
        return False
    weight = motion.entity_mass(surfaces.candidate, entity) * float(np.linalg.norm(surfaces.candidate.spec.simulation.gravity))
    return physics.linear_damping * float(np.linalg.norm(physics.linear_velocity)) >= CARRIES * weight


def _no_excuse(surfaces: Surfaces, entity: str) -> str:
    """Words about a release, a force, a field, a start velocity or a drag that does not explain a body in the air; empty where it has none of them."""
    spec: WorldSpec = surfaces.candidate.spec
    physics = spec.entities[entity].physics
    if spoken_of(spec, entity):
        if isinstance(physics, RigidPhysics) and _dragged(surfaces, entity):
            return f"; a drag of {physics.linear_damping:g} N s/m holds it up, which no air does"
        return ""
    for name, driver in spec.simulation.drivers.items():
        if isinstance(driver, ReleaseDriver) and driver.entity == entity:
            return f"; driver {name!r} lets it go at {driver.time:g} s, and no beat tells of it"
        if isinstance(driver, ForceDriver) and driver.entity == entity:
            return f"; driver {name!r} pushes it, and no beat tells of it"
    fields = fields_of(spec, entity)
    if fields:
        return f"; fields {', '.join(fields.names)} act on it, and no beat tells of it"
    if isinstance(physics, RigidPhysics | ElasticPhysics) and any(physics.linear_velocity):
        return "; it starts with a velocity, and no beat tells of it"
    return ""


def _slips_through(graph: SupportGraph, entity: str) -> bool:
    """True if a body that only friction from its sides could hold falls at once: rest was possible, but it is not pressed."""
    surfaces = graph.surfaces
    if not graph.gripped(entity)[0] or entity in surfaces.broken:
        return False
    plan = surfaces.candidate.spec.simulation
    last = min(surfaces.frames - 1, int(np.ceil(GRIP_TIME * plan.fps)))
    fallen = motion.centers(surfaces.candidate, entity)[[0, last]] @ np.array(plan.gravity) / np.linalg.norm(plan.gravity)
    return bool(fallen[1] - fallen[0] > plan.limits.support_drift)


def _declared(surfaces: Surfaces, entity: str) -> Any:
    """Parts of the specification on which the answer depends besides the geometry."""
    spec = surfaces.candidate.spec
    drivers = {
        n: d.model_dump(mode="json") for n, d in sorted(spec.simulation.drivers.items()) if getattr(d, "entity", None) == entity
    }
    joints = {n: j.model_dump(mode="json") for n, j in sorted(spec.simulation.joints.items()) if entity in (j.parent, j.child)}
    said = spec.entities[entity].afloat
    found: list[Any] = [spec.entities[entity].physics.model_dump(mode="json"), drivers, joints, list(spec.simulation.gravity)]
    found += [spoken_of(spec, entity)] if drivers or any(getattr(spec.entities[entity].physics, "linear_velocity", ())) else []
    return found if said is None else [*found, said]
