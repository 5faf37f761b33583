"""Rows of the claims that watches make about one instance, from frame to frame."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .verdicts import correction, make_row

if TYPE_CHECKING:
    from ..worlds.candidate import Candidate
    from ..worlds.requirements import Check, Correction, Row
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
    failed = found.status == "fail"
    members = tuple(instance.members)
    named = tuple(dict.fromkeys(n for n in (found.entity, *members) if n))
    return make_row(
        candidate,
        f"{check}:{family}{name}:{solver}",
        check=check,
        group="physical",
        predicate=predicate,
        status=found.status,
        explanation=found.text,
        frames=(0, candidate.last_frame),
        measured=found.measured,
        bound=found.bound,
        comparison=found.comparison if found.measured is not None and found.bound is not None else "",
        unit=found.unit,
        entities=named,
        first_failing_entity=(found.entity or named[0]) if failed else None,
        first_failing_frame=(0 if found.frame is None else found.frame) if failed else None,
        corrections=found.hints,
        evidence={"solver": solver, "category": category, **(found.evidence or {})},
        extra=candidate.spec.simulation.limits.model_dump(mode="json"),
    )


def baked_again(cause: str = "the cache was edited or is of another run") -> Correction:
    """Bake again."""
    return correction(cause, "interval", "bake again; never edit cache files", pointers=("/simulation/frames",))
