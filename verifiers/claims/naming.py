"""Beats and requirements that a claim names."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...worlds.claims import named_in

if TYPE_CHECKING:
    from ...worlds.spec import WorldSpec

__all__ = ["beats_of", "requirements_of"]


def beats_of(spec: WorldSpec, claim: str) -> list[str]:
    """Ids of the beats that a claim names, in its order."""
    return [n for n in named_in(spec, claim, "story/beats") if n in spec.story.beats]


def requirements_of(spec: WorldSpec, claim: str) -> list[str]:
    """Ids of the requirements that a claim names, in its order."""
    return [n for n in named_in(spec, claim, "story/requirements") if n in spec.story.requirements]
