"""How a verifier states its verdict: one row with numbers that are finite, an artifact and a recipe."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ...worlds.groups import GROUPS
from ...worlds.requirements import Check, Correction, Group, Row, RowClass, RowId, Status, fail_closed

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["EDIT_CLASS", "GROUP_OF", "Comparison", "correction", "make_row", "plain", "postponed", "requested_frames"]

EDIT_CLASS: Mapping[str, RowClass] = {name: group.edit_class for name, group in GROUPS.items()}
"""Class of an edit to each causal parameter group (R111, R112)."""


GROUP_OF: Mapping[Check, Group] = {
    **dict.fromkeys(("terrain", "scale", "interpenetration", "support", "navigability", "relations"), "spatial"),
    **dict.fromkeys(("category", "numerical", "contact"), "physical"),
    **dict.fromkeys(("beat", "causal", "robustness"), "temporal"),
    "shots": "observational",
    "delivery": "delivery",
}
"""Group of the matrix to which the rows of a check belong."""
Comparison = Literal["<=", ">=", "==", "in", ""]


def postponed(failing: str) -> str:
    """Why what takes further simulations was not judged: a row of the motion itself fails."""
    return f"not simulated while {failing} fails: most that mends it makes another motion; this row follows, and is judged once it passes"


def correction(
    cause: str, group: str, action: str, *, pointers: Iterable[str] = (), patch: Iterable[dict[str, Any]] = ()
) -> Correction:
    """A suggested edit; its class follows from the parameter group."""
    return Correction(
        cause=cause, edit_class=EDIT_CLASS[group], group=group, action=action, pointers=tuple(pointers), patch=tuple(patch)
    )


def plain(value: Any) -> Any:
    """The value as JSON-able data; numbers that are not finite become their name."""
    if isinstance(value, Mapping):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, list | tuple | set | frozenset):
        return [plain(v) for v in value]
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float) and not np.isfinite(value):
        return str(value)
    return value


def requested_frames(candidate: Candidate) -> tuple[int, int]:
    """First and last frame that the simulation plan asks for."""
    return 0, candidate.spec.simulation.frames - 1


def make_row(
    candidate: Candidate,
    row_id: RowId,
    *,
    predicate: str,
    status: Status,
    explanation: str,
    group: Group | None = None,
    frames: tuple[int, int] | None = None,
    measured: float | None = None,
    bound: float | None = None,
    comparison: Comparison = "",
    unit: str = "",
    entities: Iterable[str] = (),
    first_failing_entity: str | None = None,
    first_failing_frame: int | None = None,
    corrections: Iterable[Correction] = (),
    evidence: Mapping[str, Any] | None = None,
    mandatory: bool = True,
    recipe_entities: Iterable[str] | None = None,
    extra: Any = None,
    artifact: str | None = None,
) -> Row:
    """The one place where a row is made, strict about numbers: a pass whose measured value is not finite fails.

    Args:
        candidate: what was inspected.
        row_id: which question, of what.
        predicate: what is required, in words and symbols.
        status: the verdict.
        explanation: one sentence with numbers, kept as `evidence["explanation"]`.
        group: group of the matrix; default that of the check.
        frames: inspected frames, inclusive; default all that the candidate has.
        measured: measured value.
        bound: what it is compared with.
        comparison: how.
        unit: SI unit of both.
        entities: entities concerned; the first failing one is put first.
        first_failing_entity: default, where the row fails, the first of `entities`.
        first_failing_frame: default, where a spatial row fails, the first of `frames`.
        corrections: ranked; kept where the row is open.
        evidence: further JSON-able measurements; a value that is not finite is named in it.
        mandatory: whether acceptance needs it.
        recipe_entities: entities that the verdict depends on; default those concerned.
        extra: what else of the specification it depends on, for the recipe.
        artifact: what was inspected; default the candidate's caches.
    """
    check = row_id.check
    group = group or GROUP_OF[check]
    interval = (0, candidate.last_frame) if frames is None else frames
    proof: dict[str, Any] = {"explanation": explanation, **plain(evidence or {})}
    if measured is not None and not np.isfinite(measured):
        status = "fail" if status == "pass" else status
        proof["non_finite"] = str(measured)
    named = list(dict.fromkeys(entities))
    if status == "fail":
        first_failing_entity = first_failing_entity or next(iter(named), None)
        if first_failing_frame is None and group == "spatial":
            first_failing_frame = interval[0]
    else:
        first_failing_entity = first_failing_frame = None
    if first_failing_entity is not None:
        named = [first_failing_entity, *(n for n in named if n != first_failing_entity)]
    row = Row(
        id=str(row_id),
        question=row_id.question,
        subject=row_id.subject,
        check=check,
        group=group,
        predicate=predicate,
        mandatory=mandatory,
        status=status,
        artifact=candidate.artifact if artifact is None else artifact,
        frames=interval,
        measured=None if measured is None or not np.isfinite(measured) else float(measured),
        bound=None if bound is None or not np.isfinite(bound) else float(bound),
        comparison=comparison,
        unit=unit,
        entities=tuple(named),
        first_failing_entity=first_failing_entity,
        first_failing_frame=first_failing_frame,
        corrections=tuple(corrections) if status in ("fail", "unverified") else (),
        evidence=proof,
        recipe=candidate.recipe(check, named if recipe_entities is None else recipe_entities, [str(row_id), extra]),
    )
    return fail_closed(row)
