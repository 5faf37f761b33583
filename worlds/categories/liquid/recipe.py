"""Recipes of liquids: frames that no change near their domain touches are taken over from an earlier bake (R115)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...canonical import digest_of
from ...extents import initial_box
from ...instances import coupled_groups, soft_met
from ..loose import domain_box, loose_slice
from .facts import spacing_of

if TYPE_CHECKING:
    from ...spec import WorldSpec

__all__ = ["DOMAIN_MARGIN", "liquid_recipes"]

DOMAIN_MARGIN = 4.0
"""Solids up to so many spacings outside a liquid's domain count as reaching into it."""


def _reaching(spec: WorldSpec, name: str) -> list[str]:
    """Solids that may meet a liquid's domain, by the boxes of their shapes; what moves, or has no known box, may."""
    low, high = domain_box(spec.simulation.liquid[name])
    margin = DOMAIN_MARGIN * spacing_of(spec, name)
    found = []
    for key, entity in spec.entities.items():
        if entity.physics.shape != "solid":
            continue
        box = initial_box(entity) if entity.motion == "static" else None
        if box is None or ((box[1] >= low - margin).all() and (box[0] <= high + margin).all()):
            found.append(key)
    return found


def liquid_recipes(spec: WorldSpec, motion: str) -> dict[str, str]:
    """Recipe of the frames of each liquid instance, by `liquid:<instance>`.

    With two-way couplings, or bodies that move, everything that moves decides: it is then `motion`.
    """
    found = {}
    for name in spec.simulation.liquid:
        solids = _reaching(spec, name)
        still = all(spec.entities[s].motion == "static" for s in solids)
        alone = still and not any(name in group for group in coupled_groups(spec)) and not soft_met(spec, name)
        found[f"liquid:{name}"] = digest_of(loose_slice(spec, name, solids), spec.simulation.frames) if alone else motion
    return found
