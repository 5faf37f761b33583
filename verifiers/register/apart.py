"""Lines of the approximation register about matter that does not meet, and about what is exchanged both ways (R66-R68)."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

from ...worlds.arrays import F64
from ..categories.registry import judge_of_instance

if TYPE_CHECKING:
    from ...worlds.spec import WorldSpec

__all__ = ["apart_lines"]

Box = tuple[F64, F64]
"""Least and greatest corner [m]."""


def apart_lines(spec: WorldSpec) -> list[dict[str, str]]:
    """Pairs of instances whose matter passes through each other, but for those that have lines of their own; two-way couplings."""
    plan = spec.simulation
    found = []
    for a, b in combinations(plan.solvers, 2):
        judges = [judge_of_instance(spec, n) for n in (a, b)]
        domains = [judge.domain(plan.solvers[n]) for judge, n in zip(judges, (a, b), strict=True)]
        apart = [judge.body or domain is not None for judge, domain in zip(judges, domains, strict=True)]
        if not all(apart) or judges[0].body != judges[1].body:
            continue
        if _bodies_differ(spec, a, b) if judges[0].body else _meet(*domains):
            kinds = ["bodies" if judge.body else judge.name for judge in judges]
            found.append(
                {
                    "what": f"the {kinds[0]} of {a!r} and the {kinds[1]} of {b!r} do not meet",
                    "effect": "omitted in both directions: they pass through each other",
                }
            )
    for name, coupling in plan.couplings.items():
        if coupling.direction == "two_way":
            found.append(
                {
                    "what": f"two-way coupling {name!r} in exchanges: between two of them each side takes the other as going on as it did",
                    "effect": "what is given is what is received; a push that opens or closes contacts of a body is answered from the next exchange on",
                }
            )
    return found


def _bodies_differ(spec: WorldSpec, a: str, b: str) -> bool:
    """True if something that moves in one instance is unknown to the other."""
    members = [set(spec.simulation.rigid[n].members) & set(spec.entities) for n in (a, b)]
    return any(spec.entities[m].motion != "static" for m in members[0] ^ members[1]) and all(members)


def _meet(one: Box | None, other: Box | None) -> bool:
    """True if two domains overlap."""
    return one is not None and other is not None and bool((one[0] < other[1]).all() and (other[0] < one[1]).all())
