"""Row of the audit about couplings and the order of instances: what the engines of this build exchange (R66)."""

from __future__ import annotations

from collections.abc import Iterator

from ..categories.registry import CATEGORIES
from ..instances import coupled_groups, read_by
from ..problems import Problem, replaced
from ..spec import Coupling, WorldSpec

__all__ = ["coupling_problems"]


def coupling_problems(spec: WorldSpec) -> list[Problem]:
    """Couplings that no engine of this build carries out."""
    return [p for key, c in spec.simulation.couplings.items() for p in _coupling(spec, key, c)] + [*_orders(spec)]


def _coupling(spec: WorldSpec, key: str, coupling: Coupling) -> Iterator[Problem]:
    plan, place = spec.simulation, f"/simulation/couplings/{key}"
    if coupling.source not in plan.solvers or coupling.target not in plan.solvers:
        return  # the references row says so
    source, target = (plan.solvers[n].moves[0] for n in (coupling.source, coupling.target))
    if plan.solvers[coupling.source].carries and (carrying := CATEGORIES[source].coupling) is not None:
        yield from carrying(spec, key, coupling)
        return
    own = next((c for k in (source, target) if (c := CATEGORIES[k].coupling) is not None), None)
    if own is not None and "rigid" not in (source, target):
        yield from own(spec, key, coupling)
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


def _orders(spec: WorldSpec) -> Iterator[Problem]:
    plan = spec.simulation
    first = [s for s in plan.order if s in plan.solvers]
    for k, name in enumerate(first):
        read = read_by(spec, name)
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
