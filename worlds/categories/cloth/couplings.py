"""Couplings of cloth to instances that are not rigid: cloth as a boundary of grains or of a particle liquid (R63, R66)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from ...instances import coupled_groups
from ...problems import Problem, removed, replaced
from .facts import tears

if TYPE_CHECKING:
    from ...spec import Coupling, WorldSpec

__all__ = ["coupling_problems"]


def coupling_problems(spec: WorldSpec, key: str, coupling: Coupling) -> Iterator[Problem]:
    """Cloth as a boundary of grains or of a particle liquid."""
    plan, place = spec.simulation, f"/simulation/couplings/{key}"
    other = coupling.target if coupling.source in plan.cloth else coupling.source
    burns = other in plan.gas
    kind = "gas" if burns else "liquid" if other in plan.liquid else "grains"
    if plan.solvers[other].engine == "flip":
        where = f"/simulation/solvers/{other}/engine"
        text = f"coupling {key!r}: a grid does not resolve sheets; let {other!r} be of engine dfsph"
        yield Problem(where, text, replaced(where, "dfsph"))
        return
    if "cloth" not in plan.solvers[other].meets or other in plan.cloth:
        text = (
            f"coupling {key!r} joins cloth and a {plan.solvers[other].engine} instance; this build couples cloth with rigid ones, "
            "with dem, with dfsph and, to burn, with gas"
        )
        yield Problem(place, text, removed(place))
        return
    both = coupling.direction == "two_way"
    torn = [m for c in (coupling.source, coupling.target) if c in plan.cloth for m in plan.cloth[c].members if tears(spec, m)]
    if torn and not burns:  # Pieces of surface that burn keep to their triangles, which tears leave whole.
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
