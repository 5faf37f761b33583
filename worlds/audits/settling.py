"""Audit of `simulation.settle`: what is to come to rest before frame 0 can, and with the matter that carries it."""

from __future__ import annotations

from ..instances import coupled_groups
from ..problems import Problem, removed, replaced
from ..settled import settling, unsettled
from ..spec import WorldSpec

__all__ = ["settle_problems"]

PLACE = "/simulation/settle"


def settle_problems(spec: WorldSpec) -> list[Problem]:
    """Listed entities that cannot settle, matter of which a part settles, and matter that is held while bodies settle in it."""
    plan, settle = spec.simulation, spec.simulation.settle
    if settle is None:
        return []
    problems = []
    if plan.preroll > 0:
        text = "settle takes the place of preroll: all that settles rests at frame 0, the rest is as declared; take preroll away"
        problems.append(Problem("/simulation/preroll", text, replaced("/simulation/preroll", 0.0)))
    for k, name in enumerate(settle.entities):
        why = unsettled(spec, name) if name in spec.entities else ""
        if why:
            place = f"{PLACE}/entities/{k}"
            problems.append(
                Problem(place, f"{name!r} cannot settle: {why}; take it out of the list, or change that", removed(place))
            )
    listed = frozenset(settling(spec))
    if not listed and not problems:
        text = "nothing settles: no entity is dynamic, starts without speed and is held by no release; take settle away"
        problems.append(Problem(PLACE, text, removed(PLACE)))
    for name, instance in plan.solvers.items():
        able = [m for m in instance.members if m in spec.entities and not unsettled(spec, m)]
        lacking = [m for m in instance.members if m in spec.entities and m not in listed]
        if name in plan.rigid or not able or not lacking:
            continue
        group = next((g for g in coupled_groups(spec) if name in g), frozenset({name}))
        moved = [m for n in group for m in plan.solvers[n].members if m in listed]
        if moved:
            problems.append(
                Problem(
                    f"{PLACE}/entities",
                    f"{name!r} is held as a whole while {moved[0]!r} settles in it or with it, since {lacking[0]!r} does not settle; list all of "
                    f"{sorted(instance.members)}, or none of what it carries",
                    {"op": "add", "path": f"{PLACE}/entities/-", "value": lacking[0]}
                    if not unsettled(spec, lacking[0])
                    else None,
                )
            )
    return problems
