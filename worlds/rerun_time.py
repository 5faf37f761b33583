"""Time of a world that checks of causes and of robustness simulate again."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .spec import WorldSpec

__all__ = ["rerun_seconds"]


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
