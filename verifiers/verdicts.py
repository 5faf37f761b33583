"""How a verifier states its verdict: one row with numbers that are finite, an artifact and a recipe."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ..worlds.groups import GROUPS
from ..worlds.requirements import Check, Correction, Group, Row, RowClass, Status, fail_closed

if TYPE_CHECKING:
    from ..worlds.candidate import Candidate

__all__ = ["EDIT_CLASS", "correction", "make_row", "plain", "postponed", "requested_frames"]

EDIT_CLASS: Mapping[str, RowClass] = {name: group.edit_class for name, group in GROUPS.items()}
"""Class of an edit to each causal parameter group (R111, R112)."""


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
    row_id: str,
    *,
    check: Check,
    group: Group,
    predicate: str,
    status: Status,
    explanation: str,
    frames: tuple[int, int] | None = None,
    measured: float | None = None,
    bound: float | None = None,
    comparison: Literal["<=", ">=", "==", "in", ""] = "",
    unit: str = "",
    entities: Sequence[str] = (),
    first_failing_entity: str | None = None,
    first_failing_frame: int | None = None,
    corrections: Iterable[Correction] = (),
    evidence: Mapping[str, Any] | None = None,
    mandatory: bool = True,
    recipe_entities: Iterable[str] | None = None,
    extra: Any = None,
    artifact: str | None = None,
) -> Row:
    """A row with its sentence under `evidence["explanation"]`, the first failing entity first."""
    named = list(dict.fromkeys(entities))
    if first_failing_entity is not None:
        named = [first_failing_entity, *(n for n in named if n != first_failing_entity)]
    row = Row(
        id=row_id,
        check=check,
        group=group,
        predicate=predicate,
        mandatory=mandatory,
        status=status,
        artifact=candidate.artifact if artifact is None else artifact,
        frames=frames,
        measured=None if measured is None or not np.isfinite(measured) else float(measured),
        bound=None if bound is None or not np.isfinite(bound) else float(bound),
        comparison=comparison,
        unit=unit,
        entities=tuple(named),
        first_failing_entity=first_failing_entity,
        first_failing_frame=first_failing_frame,
        corrections=tuple(corrections) if status == "fail" else (),
        evidence={"explanation": explanation, **plain(evidence or {})},
        recipe=candidate.recipe(check, named if recipe_entities is None else recipe_entities, [row_id, extra]),
    )
    return fail_closed(row)
