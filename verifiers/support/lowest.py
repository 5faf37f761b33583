"""Lines of the approximation register: static things that count as the ground because they reach lowest, with nothing below them (R68, R154)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...worlds.quoting import listed
from ..scene.surfaces import surfaces_of
from .graph import gravity_direction
from .held import Held
from .landed import Ground

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["ground_lines"]

NAMED = 4
"""Things that the line names."""


def ground_lines(candidate: Candidate) -> list[dict[str, str]]:
    """The line about what counts as the ground; none of a world with a landscape, or without static things or gravity."""
    if candidate.spec.terrains:
        return []
    surfaces = surfaces_of(candidate)
    held = Held(surfaces, Ground(surfaces))
    if not held.names or gravity_direction(surfaces) is None:
        return []
    lowest = dict.fromkeys(surfaces.parts[i].entity for i in sorted(held.foundation))
    verbs = "reaches lowest and counts" if len(lowest) == 1 else "reach lowest and count"
    return [
        {
            "what": f"{listed([repr(n) for n in lowest], NAMED)} {verbs} as the ground",
            "effect": "nothing is asked to hold that up",
        }
    ]
