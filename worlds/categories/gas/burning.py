"""Solids that burn in the box of a gas: standing, moving and made of cloth, and what the audit asks of them (R100)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from ...extents import initial_box
from ...instances import cloth_of
from ...problems import Problem
from ..loose import domain_box
from .facts import gas_of

if TYPE_CHECKING:
    from ...spec import Entity, WorldSpec
    from .models import Flammable

__all__ = ["burnable", "burning_problems", "burning_sheets", "flammable_parts"]

LEAST_CHAR = 0.02
"""Own choice: share of a burning sheet's mass that stays at least; what has no mass left has no temperature."""
LEAST_GASIFICATION = 1.25
"""Own choice: heat of gasification of a sheet over the heat that warms it to its ignition, which is part of it (Tewarson 2002)."""


def flammable_parts(spec: WorldSpec, name: str) -> dict[str, dict[str, Flammable]]:
    """Parts that burn in the box of an instance, by entity and part, in the order of their names: those of a material with the fuel of its gas.

    Of rigid entities in one piece those that stand in the box and all that move; of cloth what a coupling joins to the instance.
    """
    held = gas_of(spec, name)
    found: dict[str, dict[str, Flammable]] = {}
    if held is None or held[2].fuel is None:
        return found
    sheets = burning_sheets(spec, name)
    for key, entity in sorted(spec.entities.items()):
        if not (key in sheets or (burnable(entity) and (entity.motion != "static" or _reaches(spec, name, entity)))):
            continue
        for part, own in sorted(entity.parts.items()):
            kind = _kind(spec, own.material or entity.material)
            if kind is not None and kind.fuel == held[2].fuel:
                found.setdefault(key, {})[part] = kind
    return found


def _kind(spec: WorldSpec, material: str | None) -> Flammable | None:
    return spec.materials[material].flammable if material in spec.materials else None


def burnable(entity: Entity) -> bool:
    """True of rigid entities in one piece."""
    return entity.physics.category == "rigid" and entity.breakable is None and entity.generator is None


def burning_sheets(spec: WorldSpec, name: str) -> frozenset[str]:
    """Cloth whose motion an instance of gas reads, by a coupling."""
    cloth = spec.simulation.cloth
    return frozenset(m for c in cloth_of(spec, name) for m in cloth[c].members if m in spec.entities)


def _reaches(spec: WorldSpec, name: str, entity: Entity, *, unknown: bool = False) -> bool:
    """True if an entity is in the box of an instance at frame 0; `unknown` of one whose shape does not tell."""
    (low, high), box = domain_box(spec.simulation.gas[name]), initial_box(entity)
    return unknown if box is None else not ((box[0] > high).any() or (box[1] < low).any())


def burning_problems(spec: WorldSpec, name: str) -> Iterator[Problem]:
    """Problems of what burns in the box of an instance: cloth that no coupling joins to it, sheets that nothing would be left of."""
    held = gas_of(spec, name)
    if held is None or held[2].fuel is None:
        return
    joined = burning_sheets(spec, name)
    ambient = spec.simulation.gas[name].settings.ambient_temperature
    for cloth, instance in spec.simulation.cloth.items():
        for member in instance.members:
            entity = spec.entities.get(member)
            kind = None if entity is None else _kind(spec, entity.material)
            if entity is None or kind is None or kind.fuel != held[2].fuel:
                continue
            if member in joined:
                yield from _sheet(entity, kind, ambient)
            elif _reaches(spec, name, entity, unknown=True):
                text = (
                    f"the cloth {member!r} may burn and hangs in the box of the gas {name!r}, which does not know how it moves: add a one_way "
                    f"coupling from {cloth!r} to {name!r}, so that the gas is baked after it, or take flammable out of its material"
                )
                value = {"source": cloth, "target": name, "direction": "one_way", "variables": ["motion"]}
                add = {"op": "add", "path": f"/simulation/couplings/{cloth}-{name}", "value": value}
                yield Problem("/simulation/couplings", text, add)
    yield from _twice(spec, name)


def _sheet(entity: Entity, kind: Flammable, ambient: float) -> Iterator[Problem]:
    place = f"/materials/{entity.material}/flammable"
    if kind.char < LEAST_CHAR:
        yield Problem(
            f"{place}/char",
            f"nothing would stay of burnt cloth of {entity.material!r}: char is {kind.char:g}; at least {LEAST_CHAR:g} stays as ash",
            {"op": "add", "path": f"{place}/char", "value": LEAST_CHAR},
        )
    least = LEAST_GASIFICATION * kind.heat_capacity * (kind.ignition - ambient)
    if kind.gasification < least:
        yield Problem(
            f"{place}/gasification",
            f"cloth of {entity.material!r} needs {kind.gasification:.3g} J/kg to become gas, and {least:.3g} J/kg at least: warming it to "
            f"{kind.ignition:g} K is part of that",
            {"op": "add", "path": f"{place}/gasification", "value": float(f"{1.05 * least:.2g}")},
        )


def _twice(spec: WorldSpec, name: str) -> Iterator[Problem]:
    """Entities that move and would burn in two gases, each of which would take all of their mass."""
    names = list(spec.simulation.gas)
    for other in names[: names.index(name)]:
        both = {k for k in flammable_parts(spec, other) if spec.entities[k].motion != "static"} & flammable_parts(
            spec, name
        ).keys()
        for entity in sorted(both):
            text = (
                f"{entity!r} moves and may burn in the gases of {other!r} and {name!r}, whose books would both count its mass; give one of them "
                "another fuel, or make them one gas"
            )
            yield Problem(f"/simulation/solvers/{name}/members", text)
