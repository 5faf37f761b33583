"""The row that answers a question about one instance."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from .answers import row_of

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Row
    from .findings import Finding
    from .questions import Question

__all__ = ["instance_answer"]


def instance_answer(candidate: Candidate, question: Question, solver: str, found: Finding, *, members: bool = False) -> Row:
    """The row that answers a question about one instance.

    Args:
        candidate: what is judged.
        question: its subject is the instance.
        solver: the instance.
        found: the verdict.
        members: whether it is about all members, first failing at frame 0 unless the finding says.
    """
    instance = candidate.spec.simulation.solvers[solver]
    if members and found.status == "fail" and found.frame is None:
        found = replace(found, frame=0)
    found = replace(found, evidence={"solver": solver, "category": instance.moves[0], **(found.evidence or {})})
    limits = candidate.spec.simulation.limits.model_dump(mode="json")
    return row_of(candidate, question, (solver,), found, entities=instance.members if members else (), extra=limits)
