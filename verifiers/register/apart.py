"""Lines of the approximation register about matter that does not meet, and about what is exchanged both ways (R66-R68)."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

from ...worlds.categories.loose import domain_box

if TYPE_CHECKING:
    from ...worlds.arrays import F64
    from ...worlds.spec import WorldSpec

__all__ = ["apart_lines"]


def apart_lines(spec: WorldSpec) -> list[dict[str, str]]:
    """Pairs of instances whose matter passes through each other, but for cloth and elastic bodies; two-way couplings.

    Those of cloth and of elastic bodies stand in their own registers.
    """
    plan = spec.simulation
    found = []
    for a, b in combinations(plan.solvers, 2):
        if (a in plan.rigid) != (b in plan.rigid) or {a, b} & set(plan.cloth):
            continue
        if (_bodies_differ if a in plan.rigid else _domains_meet)(spec, a, b):
            kinds = ["bodies" if n in plan.rigid else plan.solvers[n].moves[0] for n in (a, b)]
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
                    "effect": "what is given is what is received; a body that lies on something gives way for the length of an exchange",
                }
            )
    return found


def _bodies_differ(spec: WorldSpec, a: str, b: str) -> bool:
    """Whether something that moves in one instance is unknown to the other."""
    members = [set(spec.simulation.rigid[n].members) & set(spec.entities) for n in (a, b)]
    return any(spec.entities[m].motion != "static" for m in members[0] ^ members[1]) and all(members)


def _domains_meet(spec: WorldSpec, a: str, b: str) -> bool:
    (low, high), (least, most) = _domain(spec, a), _domain(spec, b)
    return bool((low < most).all() and (least < high).all())


def _domain(spec: WorldSpec, name: str) -> tuple[F64, F64]:
    """Least and greatest corner of the domain of a liquid or of particles [m]."""
    plan = spec.simulation
    return domain_box(plan.liquid[name]) if name in plan.liquid else domain_box(plan.particles[name])
