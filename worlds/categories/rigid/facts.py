"""Facts of rigid bodies that the specification alone tells: numbers of bodies and of steps (R27, R61)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..fracture.facts import piece_count

if TYPE_CHECKING:
    from ...spec import Entity, WorldSpec

__all__ = ["body_count", "rerun_seconds", "rigid_counts", "rigid_seconds"]

BODY_STEPS = 4.0e4
"""Steps of bodies a second that the engine makes on a core with two others beside it, contacts included: a usual rate. Own measurement."""


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


def rigid_seconds(spec: WorldSpec) -> float | None:
    """Seconds that the rigid instances of a world will take by a usual rate; None without any that moves."""
    return rigid_counts(spec)["body_steps"] / BODY_STEPS or None


def rerun_seconds(spec: WorldSpec) -> float:
    """Seconds of the world that counterfactual and robustness checks and runs without untold drivers simulate again, at the production step."""
    plan, beats = spec.simulation, spec.story.beats
    frames = 0.0
    for name, beat in beats.items():
        effects = [e for e in beats.values() if name in e.causes]
        if effects:  # once per cause, from a checkpoint before it to the last of its effects
            frames += max(0, max(e.frames[1] for e in effects) - beat.frames[0]) + plan.fps
    owners = {beat.owner for beat in beats.values()}
    silent = [d for n, d in plan.drivers.items() if n not in owners and not (d.kind == "field" and d.field.kind == "drag")]
    if silent and beats:  # once without those that no beat owns, from the first of them on
        frames += max(0.0, max(b.frames[1] for b in beats.values()) - min(d.begins for d in silent) * plan.fps) + plan.fps
    for item in spec.story.robustness.values():
        last = max((beats[b].frames[1] for b in item.beats if b in beats), default=0)
        runs = item.samples if item.kind == "perturbed" else item.factor
        frames += runs * (last + plan.lead * plan.fps)
    return frames / plan.fps
