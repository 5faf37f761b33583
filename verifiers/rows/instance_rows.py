"""Rows of the claims that watches make about one instance, from frame to frame."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from ...worlds.requirements import RowId
from .answers import row_of
from .corrections import bake_again as baked_again
from .verdicts import answered

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Check, Row
    from .findings import Finding
    from .questions import Question

__all__ = ["baked_again", "instance_answer", "instance_row"]


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


def instance_row(
    candidate: Candidate,
    solver: str,
    name: str,
    claim: Question | str,
    found: Finding,
    *,
    check: Check = "category",
    family: str | None = None,
) -> Row:
    """The row of one claim about an instance of liquid, grains or the like.

    Args:
        candidate: what is judged.
        solver: the instance.
        name: of the claim.
        claim: the question, or what it claims where there is none yet.
        found: the verdict.
        check: that the row belongs to.
        family: before the name in the row's id; default the category and a colon.
    """
    if not isinstance(claim, str):
        return instance_answer(candidate, claim, solver, found, members=True)
    instance = candidate.spec.simulation.solvers[solver]
    category = instance.moves[0]
    family = f"{category}:" if family is None else family
    if found.status == "fail" and found.frame is None:
        found = replace(found, frame=0)
    return answered(
        candidate,
        RowId(f"{check}:{family}{name}", solver),
        claim,
        found,
        entities=instance.members,
        evidence={"solver": solver, "category": category},
        extra=candidate.spec.simulation.limits.model_dump(mode="json"),
    )
