"""The judges of all categories of matter. A new category is a package beside these and a line here."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from ...worlds.errors import EvidenceError
from .cloth.judge import ClothJudge
from .elastic.judge import ElasticJudge
from .fracture.judge import FractureJudge
from .gas.judge import GasJudge
from .liquid.judge import LiquidJudge
from .particles.judge import ParticleJudge
from .rigid.judge import RigidJudge

if TYPE_CHECKING:
    from ...worlds.arrays import F64
    from ...worlds.candidate import Candidate
    from ...worlds.spec import WorldSpec
    from .judge import Judge

__all__ = ["JUDGES", "judge_of", "judge_of_instance", "judged", "judged_instances", "logged", "pressed"]

JUDGES: Mapping[str, Judge] = {
    judge.name: judge
    for judge in (
        RigidJudge(),
        ElasticJudge(),
        FractureJudge(),
        LiquidJudge(),
        ClothJudge(),
        ParticleJudge(),
        GasJudge(),
    )
}
"""All judges by category, in the order of their rows."""


def judge_of(spec: WorldSpec, entity: str) -> Judge:
    """The judge of an entity.

    Raises:
        EvidenceError: there is no such entity, or nothing judges its category.
    """
    if entity not in spec.entities:
        raise EvidenceError(f"entity {entity!r} is not in the specification")
    category = spec.entities[entity].physics.category
    if category not in JUDGES:
        raise EvidenceError(f"{entity!r} is {category}, which nothing judges; judged are {', '.join(JUDGES)}")
    return JUDGES[category]


def judged(spec: WorldSpec) -> dict[str, Judge]:
    """Judge of every entity, by name, but for those that nothing judges: of them the category check tells."""
    found = {name: JUDGES.get(entity.physics.category) for name, entity in spec.entities.items()}
    return {name: judge for name, judge in found.items() if judge is not None}


def judge_of_instance(spec: WorldSpec, solver: str) -> Judge:
    """The judge of what an instance moves first of all.

    Raises:
        EvidenceError: nothing judges it.
    """
    category = spec.simulation.solvers[solver].moves[0]
    if category not in JUDGES:
        raise EvidenceError(f"instance {solver!r} moves {category}, which nothing judges; judged are {', '.join(JUDGES)}")
    return JUDGES[category]


def judged_instances(spec: WorldSpec) -> Iterator[tuple[Judge, str]]:
    """Every judge with each of the instances that move its category.

    Raises:
        EvidenceError: nothing judges what an instance moves.
    """
    for solver in spec.simulation.solvers:
        judge_of_instance(spec, solver)
    return ((judge, solver) for judge in JUDGES.values() for solver in judge.instances(spec))


def logged(spec: WorldSpec, *entities: str) -> bool:
    """True if logs of contacts tell when entities touch."""
    return all(judge_of(spec, name).body for name in entities)


def pressed(candidate: Candidate, a: str, b: str) -> F64 | None:
    """Size of the impulse between two entities over each frame [N s], shape (frames,); None where logs of contacts tell.

    Raises:
        EvidenceError: neither logs nor records tell.
    """
    for entity, other in ((a, b), (b, a)):
        found = judge_of(candidate.spec, entity).pressed(candidate, entity, other)
        if found is not None:
            return found
    return None
