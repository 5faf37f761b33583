"""Facts of rigid bodies that the specification alone tells: numbers of bodies and of steps (R27, R61)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...rerun_time import rerun_seconds
from ..fracture.facts import piece_count

if TYPE_CHECKING:
    from ...spec import Entity, WorldSpec

__all__ = ["body_count", "collision_pieces", "rigid_counts", "rigid_seconds"]

BODY_STEPS = 5.0e4
"""Steps of bodies a second that the engine makes on a core with two others beside it, contacts included: a usual rate. Own measurement."""
PIECES = 6.0
"""Pieces of a body whose contacts take as long as its step. Own measurement, of a cart of 19 bodies with 60 pieces each."""


def body_count(entity: Entity) -> int:
    """Bodies that an entity becomes: one, its pieces, or the segments of its rope."""
    if entity.breakable is not None:
        return piece_count(entity)
    return 1 if entity.generator is None else entity.generator.segments


def rigid_counts(spec: WorldSpec) -> dict[str, float]:
    """Steps and body steps that the rigid instances of a specification take, by name of the cap."""
    plan = spec.simulation
    seconds = plan.lead + (plan.frames - 1) / plan.fps
    moving = {name: body_count(entity) for name, entity in spec.entities.items() if entity.motion != "static"}
    body_seconds = sum(sum(moving.get(m, 0) for m in solver.members) / solver.settings.step for solver in plan.rigid.values())
    return {
        "steps": sum(seconds / solver.settings.step for solver in plan.rigid.values()),
        "body_steps": seconds * body_seconds,
        "rerun_body_steps": rerun_seconds(spec) * body_seconds,
    }


def collision_pieces(entity: Entity) -> int:
    """Convex pieces that a body of an entity has about: one a part, and one a segment of what is turned about an axis."""
    if entity.breakable is not None or entity.generator is not None:
        return 1
    shapes = [p.shape for p in entity.parts.values() if p.collides]
    return max(1, sum(s.segments if s.kind == "revolution" else 1 for s in shapes))


def rigid_seconds(spec: WorldSpec) -> float | None:
    """Seconds that the rigid instances of a world will take by a usual rate, more where bodies have many pieces; None without any that moves."""
    plan = spec.simulation
    seconds, work = plan.lead + (plan.frames - 1) / plan.fps, 0.0
    for solver in plan.rigid.values():
        moving = [e for m in solver.members if (e := spec.entities.get(m)) is not None and e.motion != "static"]
        work += sum(body_count(e) * (1 + collision_pieces(e) / PIECES) for e in moving) * seconds / solver.settings.step
    return work / BODY_STEPS or None
