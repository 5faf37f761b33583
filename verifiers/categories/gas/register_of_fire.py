"""Lines of the approximation register about what burns beside a gas: solids that stand or move, and cloth (R68)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ....worlds.categories.gas.burning import burning_sheets, flammable_parts
from ....worlds.errors import EvidenceError
from .frames import box_of

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.spec import Entity, WorldSpec

__all__ = ["burning_lines", "lost_lines"]


def burning_lines(spec: WorldSpec, name: str) -> list[tuple[str, str]]:
    """Simplification and effect of each line about what may burn in the box of an instance."""
    burning = sorted(flammable_parts(spec, name))
    idle = sorted(k for k, e in spec.entities.items() if k not in burning and _flammable(spec, e))
    found = []
    if idle:
        what = f"{_listed(idle)} of a flammable material does not burn"
        effect = (
            "only rigid solids in one piece burn, and cloth that a coupling joins to a gas, in the box of a gas with their fuel"
        )
        found.append((what, effect))
    if not burning:
        return found
    sheets = sorted(burning_sheets(spec, name).intersection(burning))
    solids, told = [n for n in burning if n not in sheets], _listed(burning)
    if solids:
        found += [
            (f"{_listed(solids)} keeps its shape and strength while it burns", "nothing shrinks or falls apart; its mass is told apart, and its pieces turn black"),
            (f"heat goes straight into {_listed(solids)} from each piece of its surface", "none goes along it or through to another face"),
        ]  # fmt: skip
    if sheets:
        found += [
            (f"{_listed(sheets)} is as hot inside as at both its faces, and no heat goes along it", "it ignites evenly through its thickness; fire spreads on it by flames alone"),
            (f"the gas of {name!r} passes through {_listed(sheets)} as if it were not there", "flames and smoke are not held back by the cloth before it has burnt away"),
            (f"what is burnt of {_listed(sheets)} is drawn as a hole and goes on moving as cloth", "nothing falls down, curls or tears along the hole"),
        ]  # fmt: skip
    return [
        *found,
        (f"flames shine on {told} through whatever stands between", "no shadow shields it from their heat"),
        (
            f"gas warms {told} as still air does (natural convection)",
            "a strong wind, or its own motion, would warm or cool it faster",
        ),
        (f"what cannot burn takes no heat in {name!r}", "walls and floor neither warm nor cool the flames"),
    ]


def lost_lines(candidate: Candidate) -> list[dict[str, str]]:
    """Line about each entity that moves and burns: its motion does not feel the mass that it loses, with how much that is."""
    found = []
    for name in candidate.spec.simulation.gas:
        moving = {k: p for k, p in flammable_parts(candidate.spec, name).items() if candidate.spec.entities[k].motion != "static"}
        for entity in sorted(moving):
            what = f"the motion of {entity!r} does not feel that it burns in {name!r}"
            found.append(
                {"what": what, "effect": f"omitted reaction: its weight and strength stay; {_lost(candidate, name, entity)}"}
            )
    return found


def _lost(candidate: Candidate, name: str, entity: str) -> str:
    """Sentence about the mass that an entity lost, as recorded."""
    if name not in candidate.gas_caches:
        return "how much mass it loses is known after a probe"
    try:
        surfaces = box_of(candidate, name).surfaces
    except EvidenceError as error:
        return f"how much mass it loses is not known: {error}"
    if surfaces is None:
        return "it loses none"
    lost, mass = float(surfaces.lost(entity)[-1]), sum(p.mass for p in surfaces.parts if p.entity == entity)
    return f"it loses {lost:.3g} kg of {mass:.3g} kg by the last frame, {lost / mass:.1%} of its mass"


def _flammable(spec: WorldSpec, entity: Entity) -> bool:
    names = {entity.material, *(p.material for p in entity.parts.values())}
    return any(n is not None and n in spec.materials and spec.materials[n].flammable is not None for n in names)


def _listed(names: list[str]) -> str:
    return ", ".join(repr(n) for n in names)
