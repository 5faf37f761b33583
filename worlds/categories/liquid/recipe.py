"""Recipes of liquids: frames that no change near their domain touches are taken over from an earlier bake (R115)."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from ...canonical import digest_of
from ...extents import initial_box
from ...fields import acting_on, field_drivers
from ...instances import coupled_groups, soft_met
from ...slices import MOTION_VERSION, geometry_slice, physical_materials
from ..loose import domain_box
from .facts import spacing_of

if TYPE_CHECKING:
    from ...spec import WorldSpec

__all__ = ["DOMAIN_MARGIN", "liquid_recipes", "liquid_slice"]

DOMAIN_MARGIN = 4.0
"""Solids up to so many spacings outside a liquid's domain count as reaching into it."""


def liquid_slice(spec: WorldSpec, name: str, meeting: Iterable[str]) -> dict[str, Any]:
    """Everything that decides the motion of a liquid that is pushed by bodies and does not push them.

    Args:
        spec: the specification.
        name: the instance.
        meeting: solids that reach into its domain; the paths of moving ones are content, not specification.
    """
    plan = spec.simulation
    instance = plan.liquid[name]
    members = [m for m in instance.members if m in spec.entities]
    used = {spec.entities[m].material for m in members}
    return {
        "spec_version": MOTION_VERSION,
        "instance": instance.model_dump(mode="json"),
        "members": {
            m: [geometry_slice(spec, m), spec.entities[m].model_dump(mode="json", include={"pose", "physics"})] for m in members
        },
        "materials": physical_materials({k: spec.materials[k] for k in sorted(used) if k in spec.materials}),
        "solids": {
            m: [geometry_slice(spec, m), spec.entities[m].pose.model_dump(mode="json"), spec.entities[m].motion]
            for m in sorted(meeting)
        },
        "drivers": {
            k: d.model_dump(mode="json")
            for k, d in plan.drivers.items()
            if d.kind in ("inflow", "outflow", "waves") and d.entity in members
        }
        | {k: d.model_dump(mode="json") for k, d in field_drivers(spec).items() if set(members) & set(acting_on(spec, d))},
        "clock": [plan.fps, plan.preroll, list(plan.gravity), plan.seed],
    }


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
        found[f"liquid:{name}"] = digest_of(liquid_slice(spec, name, solids), spec.simulation.frames) if alone else motion
    return found
