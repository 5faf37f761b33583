"""The category and the numerical check: what the judges of all categories find in every instance (R99-R106)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...worlds.categories.registry import shape_of
from ..rows.answers import row_of
from ..rows.corrections import correction
from ..rows.findings import Finding
from ..scene.settled import settled_rows
from .questions import SIMULATED
from .registry import JUDGES, judged_instances

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Row
    from ...worlds.spec import Entity, SolverInstance

__all__ = ["check", "check_declared", "check_numerical", "declared_questions"]


def _moves(instance: SolverInstance, entity: Entity | None) -> bool:
    return entity is not None and entity.physics.category in instance.moves


def check(candidate: Candidate) -> list[Row]:
    """Rows of every solver instance, and one per entity that none moves although its category asks for one."""
    rows = [r for judge, solver in judged_instances(candidate.spec) for r in judge.category_rows(candidate, solver)]
    plan, entities = candidate.spec.simulation, candidate.spec.entities
    simulated = {m for s in plan.solvers.values() for m in s.members if _moves(s, entities.get(m))}
    for name, entity in entities.items():
        category = entity.physics.category
        if shape_of(entity) == "solid" or name in simulated:
            continue
        place = f"/entities/{name}/physics"
        text = f"{name} is {category}, and no instance simulates it, so there is nothing to inspect"
        hint = correction("no engine", "story", f"make {name} rigid, or leave it out", pointers=(place,))
        evidence = {"category": category, "pointers": [place]}
        words = f"{name} behaves as {category}"
        found = Finding("unverified", text, hints=(hint,), evidence=evidence, predicate=words)
        rows.append(row_of(candidate, SIMULATED, (name,), found, entities=(name,)))
    return rows


def declared_questions() -> frozenset[str]:
    """Ids of the questions that `check_declared` answers."""
    return frozenset(question.id for judge in JUDGES.values() for question in judge.declared)


def check_declared(candidate: Candidate) -> list[Row]:
    """Rows of every solver instance that need no motion: what fails there fails before minutes of it."""
    return [r for judge, solver in judged_instances(candidate.spec) for r in judge.declared_rows(candidate, solver)]


def check_numerical(candidate: Candidate) -> list[Row]:
    """Rows of every solver instance; all `unverified` for an instance without a cache."""
    rows = [r for judge, solver in judged_instances(candidate.spec) for r in judge.numerical_rows(candidate, solver)]
    return rows + settled_rows(candidate)
