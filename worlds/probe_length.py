"""Length of a probe: a function of the specification alone, so that whoever judges knows which frames a probe leaves out (R76)."""

from __future__ import annotations

from .spec import WorldSpec

__all__ = ["probe_frames"]

SETTLING_SECONDS = 0.75
"""Simulated after the last beat's end, so that early settling can be seen [s]."""


def probe_frames(spec: WorldSpec) -> int:
    """Frames a probe of this world needs: through its last beat, and early settling.

    Rigid contact depends on its step, so a rigid probe keeps every production setting and shortens the interval only.
    """
    plan = spec.simulation
    last = max((b.frames[1] for b in spec.story.beats.values()), default=plan.frames - 1)
    return min(plan.frames, last + 1 + round(SETTLING_SECONDS * plan.fps))
