"""Which engine moves what, and which instances step together or after one another (R27, R66)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from .problems import Problem, removed, replaced

if TYPE_CHECKING:
    from .spec import Coupling, WorldSpec

__all__ = ["bake_order", "cloth_of", "coupled_groups", "coupling_problems", "instance_for", "membership_problems", "soft_met"]

MEETS_ELASTIC = ("shell", "dem", "dfsph")
"""Engines whose matter meets elastic bodies as it meets rigid ones."""
MEETS_CLOTH = ("dem", "dfsph")
"""Engines whose matter meets cloth that a coupling brings to it."""


def instance_for(spec: WorldSpec, category: str) -> str:
    """Id of the first instance whose engine moves a category; of one that would have to be made, the category."""
    return next((n for n, i in spec.simulation.solvers.items() if category in i.moves), category)


def soft_met(spec: WorldSpec, name: str) -> tuple[str, ...]:
    """Deforming entities whose surfaces an instance meets, by name.

    All elastic bodies if its engine can (grains on a CPU, liquids as particles), and the cloth of instances that a coupling joins to it.
    """
    plan = spec.simulation
    if name not in plan.solvers or plan.solvers[name].engine not in MEETS_ELASTIC:
        return ()
    if name in plan.particles and getattr(plan.particles[name].settings, "device", "cpu") != "cpu":
        return ()
    members = {m for r in plan.rigid.values() for m in r.members if m in spec.entities}
    elastic = {m for m in members if spec.entities[m].physics.category == "elastic"}
    sheets = {m for c in cloth_of(spec, name) for m in plan.cloth[c].members if m in spec.entities}
    return tuple(sorted(elastic | sheets))


def cloth_of(spec: WorldSpec, name: str) -> tuple[str, ...]:
    """Cloth instances that a coupling makes boundaries of an instance of grains or of a particle liquid."""
    plan = spec.simulation
    if name not in plan.solvers or plan.solvers[name].engine not in MEETS_CLOTH:
        return ()
    pairs = [(c.source, c.target) for c in plan.couplings.values()]
    pairs += [(c.target, c.source) for c in plan.couplings.values() if c.direction == "two_way"]
    return tuple(sorted({source for source, target in pairs if target == name and source in plan.cloth}))


def membership_problems(spec: WorldSpec) -> list[Problem]:
    """Members that their instance's engine does not move."""
    found = []
    for name, instance in spec.simulation.solvers.items():
        for k, member in enumerate(instance.members):
            entity = spec.entities.get(member)
            if entity is not None and entity.physics.category not in instance.moves:
                place = f"/simulation/solvers/{name}/members/{k}"
                text = (
                    f"{member!r} is {entity.physics.category}, which engine {instance.engine!r} does not move; take it out. "
                    "Solids are boundaries of liquids, cloth and grains without being their members"
                )
                found.append(Problem(place, text, removed(place)))
    return found


def bake_order(spec: WorldSpec) -> tuple[str, ...]:
    """Declared order, then the rest so that sources come before their targets; what steps together stands together."""
    order = list(dict.fromkeys(s for s in spec.simulation.order if s in spec.simulation.solvers))
    rest = [s for s in spec.simulation.solvers if s not in order]
    rest.sort(key=lambda s: s not in spec.simulation.rigid)  # the others read the motion of bodies; equal ones keep their order
    before: dict[str, set[str]] = {}
    for coupling in spec.simulation.couplings.values():
        if coupling.direction == "one_way":
            before.setdefault(coupling.target, set()).add(coupling.source)
    while rest:
        ready = next((s for s in rest if not before.get(s, set()) & set(rest)), rest[0])
        rest.remove(ready)
        order.append(ready)
    groups = {name: group for group in coupled_groups(spec) for name in group}
    together = [sorted(groups.get(s, {s}), key=order.index) for s in order]
    return tuple(dict.fromkeys(name for group in together for name in group))


def coupling_problems(spec: WorldSpec) -> list[Problem]:
    """Couplings that no engine of this build carries out."""
    return [p for key, c in spec.simulation.couplings.items() for p in _coupling(spec, key, c)] + [*_orders(spec)]


def _coupling(spec: WorldSpec, key: str, coupling: Coupling) -> Iterator[Problem]:
    plan, place = spec.simulation, f"/simulation/couplings/{key}"
    if coupling.source not in plan.solvers or coupling.target not in plan.solvers:
        return  # the references row says so
    source, target = (plan.solvers[n].moves[0] for n in (coupling.source, coupling.target))
    if {source, target} & {"cloth"} and "rigid" not in (source, target):
        yield from _with_cloth(spec, key, coupling)
        return
    if (source == "rigid") == (target == "rigid"):
        pair = f"two {source} instances" if source == target else f"a {source} and a {target} instance"
        text = f"coupling {key!r} joins {pair}; this build couples a rigid one with one of another kind"
        yield Problem(place, text)
    elif coupling.direction == "one_way" and source != "rigid":
        text = (
            f"coupling {key!r}: one_way goes from the rigid to the {source} instance; swap source and target, or make it two_way"
        )
        yield Problem(f"{place}/direction", text, replaced(f"{place}/direction", "two_way"))
    wrong = sorted(set(coupling.variables) - {"motion", "wrench", "pressure"})
    if wrong:
        yield Problem(
            f"{place}/variables", f"coupling {key!r}: {', '.join(wrong)} is exchanged by no engine of this build; take it out"
        )
    wanted = {"motion"} | ({"wrench"} if coupling.direction == "two_way" else set())
    missing = sorted(wanted - {v.replace("pressure", "wrench") for v in coupling.variables})
    if missing:
        yield Problem(f"{place}/variables", f"coupling {key!r} is {coupling.direction}; it exchanges {', '.join(missing)} too")


def _with_cloth(spec: WorldSpec, key: str, coupling: Coupling) -> Iterator[Problem]:
    """Cloth as a boundary of grains or of a particle liquid."""
    plan, place = spec.simulation, f"/simulation/couplings/{key}"
    other = coupling.target if coupling.source in plan.cloth else coupling.source
    kind = "liquid" if other in plan.liquid else "grains"
    if plan.solvers[other].engine == "flip":
        where = f"/simulation/solvers/{other}/engine"
        text = f"coupling {key!r}: a grid does not resolve sheets; let {other!r} be of engine dfsph"
        yield Problem(where, text, replaced(where, "dfsph"))
        return
    if plan.solvers[other].engine not in MEETS_CLOTH or other in plan.cloth:
        text = (
            f"coupling {key!r} joins cloth and a {plan.solvers[other].engine} instance; this build couples cloth with rigid ones, "
            "with dem and with dfsph"
        )
        yield Problem(place, text, removed(place))
        return
    both = coupling.direction == "two_way"
    torn = [m for c in (coupling.source, coupling.target) if c in plan.cloth for m in plan.cloth[c].members if _tears(spec, m)]
    if torn:
        text = (
            f"coupling {key!r}: {torn[0]!r} may tear, and {kind} know the triangles of its start only; take its tear strength out"
        )
        yield Problem(place, text, removed(place))
    if not both and coupling.source not in plan.cloth:
        yield Problem(place, f"coupling {key!r}: one_way goes from the cloth to the {kind}; swap source and target")
    for group in coupled_groups(spec):
        if both and coupling.target in group and not group & set(plan.rigid):
            text = (
                f"coupling {key!r}: cloth and {kind} push each other beside a rigid instance; couple {coupling.source!r} two_way with "
                "one too, or make it one_way from the cloth"
            )
            yield Problem(f"{place}/direction", text, replaced(f"{place}/direction", "one_way"))
        elif not both and coupling.target in group:
            text = (
                f"coupling {key!r}: {coupling.target!r} steps together with a rigid instance and cannot read a cache of "
                f"{coupling.source!r}; make it two_way"
            )
            yield Problem(f"{place}/direction", text, replaced(f"{place}/direction", "two_way"))
    wanted = {"motion", "wrench"} if both else {"motion"}
    if set(coupling.variables) != wanted:
        text = f"coupling {key!r} is {coupling.direction} with cloth; it exchanges {' and '.join(sorted(wanted))}"
        yield Problem(f"{place}/variables", text, replaced(f"{place}/variables", sorted(wanted)))


def _tears(spec: WorldSpec, name: str) -> bool:
    entity = spec.entities.get(name)
    return entity is not None and entity.physics.category == "cloth" and entity.physics.tear is not None


def _orders(spec: WorldSpec) -> Iterator[Problem]:
    plan = spec.simulation
    first = [s for s in plan.order if s in plan.solvers]
    for k, name in enumerate(first):
        read = () if name in plan.rigid else (*plan.rigid, *cloth_of(spec, name))
        late = [r for r in first[k + 1 :] if r in read and not _share_group(spec, r, name)]
        if late:
            yield Problem(
                "/simulation/order", f"the instance {name!r} comes before {late[0]!r}, whose motion it reads; put it after"
            )
    for group in coupled_groups(spec):
        if sum(n in plan.rigid for n in group) > 1:
            yield Problem(
                "/simulation/couplings",
                f"instances {sorted(group)} are coupled two-way; one rigid instance per group is possible",
            )


def _share_group(spec: WorldSpec, a: str, b: str) -> bool:
    return any({a, b} <= g for g in coupled_groups(spec))


def coupled_groups(spec: WorldSpec) -> list[frozenset[str]]:
    """Sets of instances that step together because of two-way couplings."""
    groups: list[frozenset[str]] = []
    for coupling in spec.simulation.couplings.values():
        pair = {coupling.source, coupling.target} & set(spec.simulation.solvers)
        if coupling.direction == "two_way" and len(pair) == 2:
            met = [g for g in groups if g & pair]
            groups = [g for g in groups if not g & pair] + [frozenset(pair).union(*met)]
    return groups
