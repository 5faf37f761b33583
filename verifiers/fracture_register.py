"""Lines of the approximation register about bodies that break (R68)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..worlds.fracture import crumble_of

if TYPE_CHECKING:
    from ..worlds.candidate import Candidate

__all__ = ["fracture_lines"]


def fracture_lines(candidate: Candidate) -> list[dict[str, str]]:
    """What is simplified about the breakable entities."""
    found = []
    for name, entity in candidate.spec.entities.items():
        if entity.breakable is None:
            continue
        pattern, bond = entity.breakable.pattern.kind, entity.breakable.bond
        pieces = len(candidate.built[name].bodies) if name in candidate.built else 0
        found += [
            {
                "what": f"{name!r} is cut beforehand into {pieces} pieces ({pattern})",
                "effect": "it breaks along their faces only; pieces themselves never break",
            },
            {
                "what": f"bonded pieces of {name!r} are one rigid body; stresses are those of equilibrium, blows spread over "
                f"{bond.contact_time:g} s with the inertia of the pieces",
                "effect": "no waves; what is bonded to the world takes up momentum without moving; a body on an authored path does "
                "not meet it until it breaks",
            },
            {
                "what": f"energy that breaks bonds of {name!r} is recorded and not taken from the motion",
                "effect": "pieces fly a little too fast; an inelastic blow loses far more",
            },
        ]
        if name in candidate.built:
            found.append(
                {
                    "what": f"faces of {name!r} crumble over {crumble_of(entity.breakable, candidate.built[name]):.2g} m",
                    "effect": "broken pieces may lie that deep in one another; the dust has no mass of its own",
                }
            )
    return found
