"""Rows of the claims that watches make about one instance, from frame to frame."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from ...worlds.requirements import RowId
from .corrections import bake_again as baked_again
from .verdicts import answered

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Check, Row
    from .findings import Finding

__all__ = ["baked_again", "instance_row"]


def instance_row(
    candidate: Candidate,
    solver: str,
    name: str,
    predicate: str,
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
        predicate: what it claims.
        found: the verdict.
        check: that the row belongs to.
        family: before the name in the row's id; default the category and a colon.
    """
    instance = candidate.spec.simulation.solvers[solver]
    category = instance.moves[0]
    family = f"{category}:" if family is None else family
    if found.status == "fail" and found.frame is None:
        found = replace(found, frame=0)
    return answered(
        candidate,
        RowId(f"{check}:{family}{name}", solver),
        predicate,
        found,
        entities=instance.members,
        evidence={"solver": solver, "category": category},
        extra=candidate.spec.simulation.limits.model_dump(mode="json"),
    )
