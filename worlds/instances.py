"""Instances of engines: their members, and which step together or after one another (R27, R66)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .problems import Problem, removed

if TYPE_CHECKING:
    from .spec import WorldSpec

__all__ = [
    "bake_order",
    "bodies_read",
    "carriers_of",
    "cloth_of",
    "coupled_groups",
    "felt_by",
    "instance_for",
    "membership_problems",
    "read_by",
    "soft_met",
    "waits_for_itself",
    "watched_by",
]


def instance_for(spec: WorldSpec, category: str) -> str:
    """Id of the first instance whose engine moves a category; of one that would have to be made, the category."""
    return next((n for n, i in spec.simulation.solvers.items() if category in i.moves), category)


def soft_met(spec: WorldSpec, name: str) -> tuple[str, ...]:
    """Deforming entities whose surfaces an instance meets, by name.

    All elastic bodies if its engine can (grains on a CPU, liquids as particles), and the cloth of instances that a coupling joins to it.
    """
    plan = spec.simulation
    if name not in plan.solvers or not plan.solvers[name].meets:
        return ()
    if name in plan.particles and getattr(plan.particles[name].settings, "device", "cpu") != "cpu":
        return ()
    members = {m for r in plan.rigid.values() for m in r.members if m in spec.entities}
    elastic = {m for m in members if spec.entities[m].physics.category in plan.solvers[name].meets}
    sheets = {m for c in cloth_of(spec, name) for m in plan.cloth[c].members if m in spec.entities}
    return tuple(sorted(elastic | sheets))


def cloth_of(spec: WorldSpec, name: str) -> tuple[str, ...]:
    """Cloth instances that a coupling makes boundaries of an instance of grains or of a particle liquid."""
    plan = spec.simulation
    met = plan.solvers[name].meets if name in plan.solvers else ()
    pairs = [(c.source, c.target) for c in plan.couplings.values()]
    both = [c for c in plan.couplings.values() if c.direction == "two_way" and c.source in plan.solvers]
    pairs += [(c.target, c.source) for c in both if not plan.solvers[c.source].carries]
    return tuple(sorted({source for source, target in pairs if target == name and _moves(spec, source) in met}))


def watched_by(spec: WorldSpec, name: str) -> tuple[str, ...]:
    """Instances without bodies whose motion drivers of an instance's members read, by name."""
    plan = spec.simulation
    members = plan.solvers[name].members if name in plan.solvers else []
    seen = {e for d in plan.drivers.values() if d.watched and getattr(d, "entity", None) in members for e in d.watched}
    return tuple(sorted(n for n, i in plan.solvers.items() if n not in plan.rigid and n != name and seen & set(i.members)))


def carriers_of(spec: WorldSpec, name: str) -> tuple[str, ...]:
    """Instances whose medium drags the members of an instance along, by name: sources of its couplings that can."""
    plan = spec.simulation
    found = {c.source for c in plan.couplings.values() if c.target == name and c.source in plan.solvers}
    return tuple(sorted(s for s in found if plan.solvers[s].carries))


def felt_by(spec: WorldSpec, name: str) -> tuple[str, ...]:
    """Instances that an instance carries and whose pull it feels, by name: targets of its two_way couplings where its medium can carry."""
    plan = spec.simulation
    if name not in plan.solvers or not plan.solvers[name].carries:
        return ()
    return tuple(
        sorted({c.target for c in plan.couplings.values() if c.source == name and c.direction == "two_way"} & set(plan.solvers))
    )


def bodies_read(spec: WorldSpec, name: str) -> tuple[str, ...]:
    """Rigid instances whose motion an instance of another kind reads: all, but one whose medium carries others reads none that any medium carries."""
    rigid = spec.simulation.rigid
    if not any(name in carriers_of(spec, other) for other in spec.simulation.solvers):
        return tuple(rigid)
    return tuple(r for r in rigid if not carriers_of(spec, r))


def read_by(spec: WorldSpec, name: str) -> tuple[str, ...]:
    """Instances whose caches an instance reads while it runs: media that carry it, and, without two-way coupling, bodies' motion, cloth's, and
    what its drivers watch."""
    carriers = carriers_of(spec, name)
    group = next((g for g in coupled_groups(spec) if name in g), frozenset())
    # What steps with bodies gets them from these; a gas, and what it carries without bodies, reads those beside it.
    told = group and not spec.simulation.solvers[name].carries and group & spec.simulation.rigid.keys()
    found = carriers
    if name not in spec.simulation.rigid and not told and (not group or any(felt_by(spec, g) for g in group)):
        found = (*bodies_read(spec, name), *cloth_of(spec, name), *watched_by(spec, name), *carriers)
    return tuple(n for n in dict.fromkeys(found) if n not in group)


def waits_for_itself(spec: WorldSpec) -> tuple[str, ...]:
    """Instances that read one another's caches in a circle, in its order; empty where there is none."""
    group = {name: g for g in coupled_groups(spec) for name in g}

    def needs(name: str) -> list[str]:
        own = group.get(name, {name})
        return [r for n in sorted(own) for r in read_by(spec, n) if r not in own]

    done: set[str] = set()

    def follow(name: str, path: tuple[str, ...]) -> tuple[str, ...]:
        if name in path:
            return path[path.index(name) :]
        if name in done:
            return ()
        found = next((p for other in needs(name) if (p := follow(other, (*path, name)))), ())
        done.add(name)
        return found

    return next((p for name in spec.simulation.solvers if (p := follow(name, ()))), ())


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


def _moves(spec: WorldSpec, name: str) -> str:
    """Category by which couplings know an instance; empty where there is none."""
    return spec.simulation.solvers[name].moves[0] if name in spec.simulation.solvers else ""


def bake_order(spec: WorldSpec) -> tuple[str, ...]:
    """Declared order, then the rest so that sources come before their targets; what steps together stands together."""
    order = list(dict.fromkeys(s for s in spec.simulation.order if s in spec.simulation.solvers))
    rest = [s for s in spec.simulation.solvers if s not in order]
    rest.sort(key=lambda s: s not in spec.simulation.rigid)  # the others read the motion of bodies; equal ones keep their order
    carried = any(carriers_of(spec, s) for s in spec.simulation.rigid)
    before: dict[str, set[str]] = {}
    for coupling in spec.simulation.couplings.values():
        if coupling.direction == "one_way":
            before.setdefault(coupling.target, set()).add(coupling.source)
    for name in rest:
        before.setdefault(name, set()).update(watched_by(spec, name))
        if carried and name not in spec.simulation.rigid:
            before[name].update(bodies_read(spec, name))
    while rest:
        ready = next((s for s in rest if not before.get(s, set()) & set(rest)), rest[0])
        rest.remove(ready)
        order.append(ready)
    groups = {name: group for group in coupled_groups(spec) for name in group}
    together = [sorted(groups.get(s, {s}), key=order.index) for s in order]
    return tuple(dict.fromkeys(name for group in together for name in group))


def coupled_groups(spec: WorldSpec) -> list[frozenset[str]]:
    """Sets of instances that step together because of two-way couplings."""
    groups: list[frozenset[str]] = []
    for coupling in spec.simulation.couplings.values():
        pair = {coupling.source, coupling.target} & set(spec.simulation.solvers)
        if coupling.direction == "two_way" and len(pair) == 2:
            met = [g for g in groups if g & pair]
            groups = [g for g in groups if not g & pair] + [frozenset(pair).union(*met)]
    return groups
