"""Which channels the instances of a specification write: what each is a writer of, by its engine and members."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .categories.cloth.facts import tears
from .categories.liquid.facts import declares_heat
from .fields import fields_of
from .instances import coupled_groups

if TYPE_CHECKING:
    from .channels import Writer
    from .spec import WorldSpec

__all__ = ["writers_of"]


def writers_of(spec: WorldSpec, name: str) -> frozenset[Writer]:
    """The writers that an instance is."""
    plan = spec.simulation
    members = [m for m in plan.solvers[name].members if m in spec.entities]
    categories = {spec.entities[m].physics.category for m in members}
    blown = {spec.entities[m].physics.category for m in members if fields_of(spec, m)}
    rigid, coupled = name in plan.rigid, any(name in group for group in coupled_groups(spec))
    elastic = rigid and "elastic" in categories
    holds: dict[Writer, bool] = {
        "rigid": rigid,
        "rigid coupled": rigid and coupled,
        "rigid blown": rigid and "rigid" in blown,
        "fracture": rigid and any(spec.entities[m].breakable is not None for m in members),
        "elastic": elastic,
        "elastic coupled": elastic and coupled,
        "elastic blown": elastic and "elastic" in blown,
        "liquid": name in plan.liquid,
        "liquid heat": name in plan.liquid and declares_heat(spec, name),
        "cloth": name in plan.cloth,
        "tearing": name in plan.cloth and any(tears(spec, m) for m in members),
        "particles": name in plan.particles,
    }
    return frozenset(writer for writer, is_one in holds.items() if is_one)
