"""The liquid that a predicate names, and the outcome of one that names something else: painted water meets nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ....worlds.errors import EvidenceError
from ...predicates.outcome import Outcome
from .frames import liquid_of

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ...predicates.scope import Scope
    from .frames import Liquid

__all__ = ["liquid_or_none", "painted"]


def liquid_or_none(candidate: Candidate, entity: str) -> tuple[Liquid, int] | str:
    """The instance that moves a liquid and its index among the members, or why there is none."""
    known = candidate.spec.entities.get(entity)
    if known is None:
        raise EvidenceError(f"entity {entity!r} is not in the specification")
    solver = next((n for n, s in candidate.spec.simulation.liquid.items() if entity in s.members), None)
    if known.physics.category != "liquid" or solver is None:
        kind = "a solid" if known.physics.category == "rigid" else known.physics.category
        said = "no engine moves it" if known.physics.category == "liquid" else f"it is {kind}"
        return f"{entity!r} is no evidence of a liquid: {said}; make it liquid and a member of a dfsph or flip instance"
    liquid = liquid_of(candidate, solver)
    return liquid, liquid.members.index(entity)


def painted(scope: Scope, unit: str, entity: str, text: str) -> Outcome:
    """A predicate about a liquid that is none: it fails."""
    return Outcome(
        "fail",
        scope.frames,
        unit,
        text,
        first_failing_entity=entity,
        first_failing_frame=scope.frames[0],
        failing=(entity,),
        details={"painted": True},
    )
