"""What cloth simplifies, for the approximation register."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from ..worlds.cloth import grids_of, touching_distance
from ..worlds.instances import cloth_of, coupled_groups

if TYPE_CHECKING:
    from ..worlds.spec import WorldSpec

__all__ = ["cloth_lines"]

LOST = 0.05 * (2 * math.pi) ** 2
"""Of a swing of 1 Hz per second and second of step: the theta rule at 0.55 takes 0.05 w^2 h."""


def cloth_lines(spec: WorldSpec) -> list[dict[str, str]]:
    """Lines of every cloth instance."""
    found: list[dict[str, str]] = []
    for name, instance in spec.simulation.cloth.items():
        for member in instance.members:
            found += _sheet(spec, member, instance.settings.margin)
        found.append(
            {
                "what": f"the air is not moved by {name!r}; it pushes each triangle by their relative velocity",
                "effect": "no wake, no lift of a whole sail or flag beyond what single faces feel",
            }
        )
        found.append(
            {
                "what": f"sheets of {name!r} that may meet something are damped, if by no more, by 1.5 % of what ends their fastest swing",
                "effect": "swings between neighbouring vertices fade within some tens of swings, slower ones in proportion less",
            }
        )
        found += _grains(spec, name)
        settings = instance.settings
        if settings.integrator == "implicit":
            found.append(
                {
                    "what": f"where {name!r} meets nothing its steps are {settings.max_step:.3g} s long",
                    "effect": f"a swing of 1 Hz loses {LOST * settings.max_step:.2%} of its amplitude in a second, of 5 Hz 25 times that",
                }
            )
            found.append(
                {
                    "what": f"where {name!r} touches something and moves slowly its steps are up to {settings.max_step:.3g} s long",
                    "effect": f"a swing of 1 Hz loses up to {10 * LOST * settings.max_step:.1%} of its amplitude in a second",
                }
            )
        coupled = {s for g in coupled_groups(spec) if name in g for s in g}
        for rigid, other in spec.simulation.rigid.items():
            if rigid not in coupled and any(spec.entities[m].motion == "dynamic" for m in other.members if m in spec.entities):
                found.append(
                    {
                        "what": f"the cloth {name!r} is pushed by bodies of {rigid!r} and does not push them",
                        "effect": "omitted reaction: nothing is caught, carried or held by it",
                    }
                )
    return found


def _grains(spec: WorldSpec, name: str) -> Iterator[dict[str, str]]:
    """How other matter meets it."""
    plan = spec.simulation
    for other, instance in plan.solvers.items():
        if other in plan.rigid or other == name:
            continue
        kind = instance.moves[0]
        if name not in cloth_of(spec, other):
            yield {
                "what": f"the {kind} of {other!r} and the cloth {name!r} do not meet",
                "effect": "omitted in both directions: they pass through each other",
            }
        elif kind == "liquid":
            yield {
                "what": f"the cloth {name!r} takes no room in the liquid of {other!r} and does not soak",
                "effect": "drops hang on it only by its surface; its weight stays that of dry cloth",
            }
        if name in cloth_of(spec, other) and not any({name, other} <= g for g in coupled_groups(spec)):
            yield {
                "what": f"the cloth {name!r} carries and pushes the {kind} of {other!r} and does not feel it",
                "effect": "omitted reaction: the cloth does not sag under it",
            }


def _sheet(spec: WorldSpec, member: str, margin: float | None) -> Iterator[dict[str, str]]:
    entity = spec.entities[member]
    physics = entity.physics
    if physics.category != "cloth":
        return
    shortest = min((edge for _, edge in grids_of(entity)), default=None)
    if shortest is not None:
        apart = touching_distance(physics.thickness, shortest, margin)
        yield {
            "what": f"layers of {member!r} touch at {apart:.3g} m, solids at half of it; its thickness is {physics.thickness:g} m",
            "effect": f"folds lie up to {max(apart - physics.thickness, 0.0):.3g} m too far apart and bend over no less than {shortest:.3g} m",
        }
    if not physics.self_collision:
        yield {"what": f"{member!r} does not meet itself", "effect": "its folds pass through each other"}
    if physics.tear is not None:
        yield {
            "what": f"{member!r} tears along the edges of its triangles, at the mean pull around a vertex",
            "effect": f"tears turn no finer than its triangles ({shortest or 0.0:.3g} m), and their two lips pass through each other",
        }
    for other in physics.ignores:
        yield {"what": f"{member!r} does not meet {other!r}", "effect": "it passes through it"}
