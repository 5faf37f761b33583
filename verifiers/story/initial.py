"""States that the story starts with: told as such, and named as a cause by no beat (R156)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..rows.corrections import correction
from ..rows.findings import Finding

if TYPE_CHECKING:
    from ...worlds.spec import WorldSpec

__all__ = ["INITIAL", "initial_state"]

INITIAL = "an initial state, which nothing brings about"
"""Words for a lasting state without causes that is so from frame 0 on."""


def initial_state(beat_id: str, last: int, spec: WorldSpec) -> Finding:
    """The finding of a lasting state without causes that is so from frame 0 on: a state that the story starts with is no cause of anything.

    Args:
        beat_id: the beat that tells of it.
        last: the frame up to which it was looked at.
        spec: the specification.
    """
    beats = spec.story.beats
    effects = [n for n, beat in beats.items() if beat_id in beat.causes]
    so = f"is so at every frame up to {last}" if last else "is so at frame 0"
    if not effects:
        return Finding("pass", f"{so}, without causes: {INITIAL}", evidence={"initial": True})
    named = ", ".join(effects)
    return Finding(
        "fail",
        f"{so}, without causes: {INITIAL}, so it brings nothing about either; {named} {'names' if len(effects) == 1 else 'name'} it as a cause",
        entity=beats[beat_id].subject,
        frame=0,
        hints=(
            correction(
                "a state that the story starts with is named as a cause",
                "story",
                f"take {beat_id} out of the causes of {named}, and name the event that starts it: a release, a push, a body that arrives",
                pointers=tuple(f"/story/beats/{n}/causes" for n in effects),
            ),
        ),
        evidence={"initial": True, "effects": effects},
    )
