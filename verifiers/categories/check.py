"""Category-specific checks (R99-R104): rigid bodies in `categories/rigid/check.py`, elastic ones in `elastic.py`, liquids in `liquid.py`, cloth in `cloth.py`,
grains in `categories/particles/check.py`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...worlds.requirements import Row, RowId
from ..rows.verdicts import correction, make_row
from .cloth import check as cloth
from .elastic import check as elastic
from .fracture import check as fracture
from .liquid import check as liquid
from .particles import check as particles
from .rigid import check as rigid

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.spec import Entity, SolverInstance

__all__ = ["check"]


def _moves(instance: SolverInstance, entity: Entity | None) -> bool:
    return entity is not None and entity.physics.category in instance.moves


def check(candidate: Candidate) -> list[Row]:
    """Rows of every solver instance, and one per entity whose category nothing here can simulate."""
    rows: list[Row] = []
    for solver in candidate.spec.simulation.rigid:
        rows += [*rigid.check_instance(candidate, solver), *elastic.check_instance(candidate, solver)]
        rows += fracture.check_instance(candidate, solver)
    for solver in candidate.spec.simulation.liquid:
        rows += liquid.check_instance(candidate, solver)
    for solver in candidate.spec.simulation.cloth:
        rows += cloth.check_instance(candidate, solver)
    for solver in candidate.spec.simulation.particles:
        rows += particles.check_instance(candidate, solver)
    plan, entities = candidate.spec.simulation, candidate.spec.entities
    simulated = {m for s in plan.solvers.values() for m in s.members if _moves(s, entities.get(m))}
    for name, entity in candidate.spec.entities.items():
        category = entity.physics.category
        if category == "rigid" or name in simulated:
            continue
        missing = (
            "no instance simulates it" if category in ("cloth", "liquid", "particles") else "this build has no engine for it"
        )
        rows.append(
            make_row(
                candidate,
                RowId("category", name),
                predicate=f"{name} behaves as {category}",
                status="unverified",
                explanation=f"{name} is {category}, and {missing}, so there is nothing to inspect",
                entities=(name,),
                corrections=[
                    correction(
                        "no engine", "story", f"make {name} rigid, or leave it out", pointers=(f"/entities/{name}/physics",)
                    )
                ],
                evidence={"category": category, "pointers": [f"/entities/{name}/physics"]},
            )
        )
    return rows
