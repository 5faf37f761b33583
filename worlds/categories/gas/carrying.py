"""Bodies, cloth and particles that a gas carries: which, what it does not meet therefore, and what the audit asks of them (R66)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ...extents import initial_box
from ...fields import acting_on, field_drivers
from ...instances import bodies_read, carriers_of, coupled_groups, felt_by, waits_for_itself
from ...problems import Problem, removed, replaced
from ..loose import ROUNDED, domain_box, told_box
from .burning import flammable_parts
from .facts import dusts_of
from .steam_facts import steams_of

if TYPE_CHECKING:
    from ...spec import Coupling, WorldSpec

__all__ = ["carried_instances", "carried_members", "carries", "coupling_problems", "unmet", "without_carried"]


def carried_instances(spec: WorldSpec, name: str) -> tuple[str, ...]:
    """Instances whose members a gas carries, by name."""
    return tuple(n for n in spec.simulation.solvers if name in carriers_of(spec, n))


def carries(spec: WorldSpec, name: str) -> bool:
    """True if a gas carries anything."""
    return bool(carried_instances(spec, name))


def carried_members(spec: WorldSpec, name: str) -> dict[str, tuple[str, ...]]:
    """Entities that a gas carries, by instance: members that move and feel what moves about them."""
    return {
        other: tuple(
            m
            for m in spec.simulation.solvers[other].members
            if m in spec.entities and spec.entities[m].motion == "dynamic" and spec.entities[m].physics.feels_fields
        )
        for other in carried_instances(spec, name)
    }


def unmet(spec: WorldSpec, name: str) -> frozenset[str]:
    """Bodies that move and do not stand in a gas's way: of rigid instances whose motion it does not read."""
    plan, read = spec.simulation, bodies_read(spec, name)
    known = {m for r in read for m in plan.rigid[r].members}
    unread = {m for r, i in plan.rigid.items() if r not in read for m in i.members} - known
    return frozenset(m for m in unread if m in spec.entities and spec.entities[m].motion != "static")


def without_carried(spec: WorldSpec, name: str) -> WorldSpec:
    """The specification as a gas meets it: without the bodies that do not stand in its way."""
    gone = unmet(spec, name)
    if not gone:
        return spec
    return spec.model_copy(update={"entities": {k: e for k, e in spec.entities.items() if k not in gone}})


def coupling_problems(spec: WorldSpec, key: str, coupling: Coupling) -> Iterator[Problem]:
    """Problems of a coupling by which a gas carries the members of another instance."""
    plan, place = spec.simulation, f"/simulation/couplings/{key}"
    source, target = coupling.source, coupling.target
    kind = plan.solvers[target].moves[0]
    felt = [m for m in plan.solvers[target].members if m in spec.entities and spec.entities[m].physics.feels_fields]
    if kind not in ("rigid", "cloth", "particles"):  # category names are those of `moves`
        text = f"coupling {key!r}: the gas of {source!r} cannot carry {kind}; it carries rigid bodies, cloth and particles: take it out"
        yield Problem(place, text, removed(place))
        return
    if set(coupling.variables) != {"wrench"}:
        text = f"coupling {key!r} lets the gas of {source!r} carry {target!r}; it exchanges wrench alone"
        yield Problem(f"{place}/variables", text, replaced(f"{place}/variables", ["wrench"]))
    if not any(spec.entities[m].motion == "dynamic" for m in felt):
        text = f"coupling {key!r}: no member of {target!r} is dynamic, so that the gas of {source!r} moves nothing; make one dynamic, or take it out"
        yield Problem(place, text, removed(place))
    if coupling.direction == "two_way":
        yield from _felt(spec, key, coupling)
    yield from _both_ways(spec, key, coupling)
    yield from _watched(spec, key, coupling)
    yield from _burn(spec, key, coupling)
    yield from _two_airs(spec, key, coupling)


def _felt(spec: WorldSpec, key: str, coupling: Coupling) -> Iterator[Problem]:
    """Problems of what steps together with the gas that feels it, and cannot in this build."""
    plan, place = spec.simulation, f"/simulation/couplings/{key}"
    source, target = coupling.source, coupling.target
    one_way = replaced(f"{place}/direction", "one_way")
    if plan.gas[source].settings.follows:
        text = f"coupling {key!r}: the gas of {source!r} is solved in a part of its box that follows it, and feels nothing there; make the coupling one_way, or set follows to false"
        yield Problem(f"{place}/direction", text, one_way)
    elastic = [m for m in plan.solvers[target].members if m in spec.entities and spec.entities[m].physics.shape == "deforming"]
    if target in plan.rigid and elastic:
        text = f"coupling {key!r}: the gas of {source!r} does not feel {elastic[0]!r}, which deforms; make the coupling one_way, or put {elastic[0]!r} into an instance of its own"
        yield Problem(f"{place}/direction", text, one_way)
    yield from _wide(spec, key, coupling)
    group = next(g for g in coupled_groups(spec) if source in g)
    gases = sorted(g for g in group if felt_by(spec, g))
    if gases[1:] and source == gases[1]:
        text = f"coupling {key!r}: gases {gases[0]!r} and {source!r} feel what moves together; one gas per group is possible: make the coupling one_way"
        yield Problem(f"{place}/direction", text, one_way)
    rigid = next((r for r in sorted(group) if r in plan.rigid), None)
    joined = [{c.source, c.target} for c in plan.couplings.values() if c.direction == "two_way"]
    if rigid is not None and target != rigid and {rigid, target} not in joined:
        text = (
            f"coupling {key!r}: {target!r} and {rigid!r} move at the same time as the gas of {source!r}, and do not push each other; couple {rigid!r} "
            f"and {target!r} two_way, or make the coupling one_way"
        )
        yield Problem(f"{place}/direction", text, one_way)


def _wide(spec: WorldSpec, key: str, coupling: Coupling) -> Iterator[Problem]:
    """Bodies with lift that are wider than the cells of a gas that feels them: their own downwash would turn their flow a second time."""
    place, gas = f"/simulation/couplings/{key}", spec.simulation.gas[coupling.source]
    for name in spec.simulation.solvers[coupling.target].members:
        entity, held = spec.entities.get(name), spec.entities.get(gas.members[0])
        if entity is None or held is None or not entity.physics.lifted:
            continue
        wide, cell = max(entity.dimensions.size), held.physics.flow_cell
        if wide > (1.0 + ROUNDED) * cell:
            text = (
                f"coupling {key!r}: {name!r} declares lift, is {wide:.3g} m long, and the gas that feels it has cells of {cell:g} m, at least as wide as it they have to be: what "
                "it turns of the gas would turn its own flow once more. Make the coupling one_way, or the cells as wide"
            )
            yield Problem(f"{place}/direction", text, replaced(f"{place}/direction", "one_way"))


def _both_ways(spec: WorldSpec, key: str, coupling: Coupling) -> Iterator[Problem]:
    """Instances that would have to be baked before themselves."""
    for other, back in spec.simulation.couplings.items():
        if (back.source, back.target) == (coupling.target, coupling.source):
            text = (
                f"couplings {key!r} and {other!r} let {coupling.target!r} move the gas of {coupling.source!r} and be moved by it, and one of them is "
                f"baked first; keep {key!r} where the gas carries it, or {other!r} where it stirs the gas, and put what does the other into an "
                "instance of its own"
            )
            yield Problem(f"/simulation/couplings/{other}", text, removed(f"/simulation/couplings/{other}"))
            return
    circle = waits_for_itself(spec)
    if coupling.source in circle and coupling.target in circle:
        text = (
            f"{' waits for '.join(map(repr, (*circle, circle[0])))}: each reads what the next one has done. Take coupling {key!r} away, or put what "
            f"{coupling.source!r} reads (what raises dust, boils or burns in it) into an instance that it does not carry"
        )
        yield Problem(f"/simulation/couplings/{key}", text, removed(f"/simulation/couplings/{key}"))


def _watched(spec: WorldSpec, key: str, coupling: Coupling) -> Iterator[Problem]:
    """Bodies that raise dust or boil steam of the gas that carries them: it would have to know first how they move."""
    members, source = set(spec.simulation.solvers[coupling.target].members), coupling.source
    named = {n: d.bodies for n, d in dusts_of(spec, source).items()} | {n: d.hot for n, d in steams_of(spec, source).items()}
    for name, bodies in named.items():
        both = sorted(members & set(bodies))
        if both:
            text = (
                f"driver {name!r} makes gas of {source!r} by how {both[0]!r} moves, and coupling {key!r} lets that gas carry it: one would have to be baked "
                f"before the other. Take the coupling away, or put {both[0]!r} into an instance that the gas does not carry"
            )
            yield Problem(f"/simulation/couplings/{key}", text, removed(f"/simulation/couplings/{key}"))


def _burn(spec: WorldSpec, key: str, coupling: Coupling) -> Iterator[Problem]:
    """Bodies that would burn in the gas that carries them: it would have to know first how they move."""
    if coupling.target not in spec.simulation.rigid:
        return
    both = sorted(flammable_parts(spec, coupling.source).keys() & set(spec.simulation.solvers[coupling.target].members))
    moving = [n for n in both if spec.entities[n].motion != "static"]
    if moving:
        text = (
            f"coupling {key!r}: {moving[0]!r} may burn in the gas of {coupling.source!r}, which carries it and so is baked before it moves; take flammable "
            f"out of its material, or put it into an instance that the gas does not carry"
        )
        yield Problem(f"/simulation/couplings/{key}", text)


def _two_airs(spec: WorldSpec, key: str, coupling: Coupling) -> Iterator[Problem]:
    """Moving air that acts on what a gas carries and not on that gas: in its box nothing feels it."""
    plan = spec.simulation
    gas, carried = set(plan.solvers[coupling.source].members), set(plan.solvers[coupling.target].members)
    box = domain_box(plan.gas[coupling.source])
    for name, driver in field_drivers(spec).items():
        if driver.field.kind in ("attraction", "drag") or driver.region is not None:
            continue
        felt = set(acting_on(spec, driver))
        inside = [m for m in sorted(felt & carried) if (b := initial_box(spec.entities[m])) is None or _meets(b, box)]
        if inside and not felt & gas:
            text = (
                f"field {name!r} moves the air about {inside[0]!r} and not the gas of {coupling.source!r}, which carries it (coupling {key!r}): within the box "
                f"{told_box(*box)} it feels that gas alone. Let the field act on {sorted(gas)[0]!r} too, or not on {inside[0]!r}"
            )
            yield Problem(f"/simulation/drivers/{name}/entities", text)


def _meets(one: tuple[np.ndarray, np.ndarray], two: tuple[np.ndarray, np.ndarray]) -> bool:
    return bool((one[0] <= two[1]).all() and (two[0] <= one[1]).all())
