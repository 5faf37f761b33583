"""Rows of the requirements matrix (R82-R85)."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

__all__ = [
    "Attempt",
    "Check",
    "Correction",
    "Group",
    "Outcome",
    "Row",
    "RowClass",
    "Status",
    "fail_closed",
    "outcome_of",
]

Status = Literal["pass", "fail", "unverified", "not_applicable"]
Group = Literal["spatial", "physical", "temporal", "observational", "delivery"]
Check = Literal[
    "audit",
    "terrain",
    "scale",
    "interpenetration",
    "support",
    "navigability",
    "relations",
    "causal",
    "category",
    "numerical",
    "contact",
    "beat",
    "claim",
    "robustness",
    "shots",
    "review",
    "delivery",
]
RowClass = Literal["scene", "solver", "shot", "story", "text"]


class Correction(BaseModel):
    """A remedy for a failing row (R69-R75): the most likely cause and the one parameter group to change."""

    model_config = ConfigDict(frozen=True)

    cause: str
    edit_class: RowClass
    """R111/R112: a scene failure needs a scene edit, a solver failure a solver edit."""
    group: str
    """Causal parameter group to change (see `worlds/groups.py`)."""
    action: str
    """One sentence with numbers: what to change, by how much."""
    pointers: tuple[str, ...] = ()
    """JSON pointers of the fields to look at first."""
    patch: tuple[dict[str, Any], ...] = ()
    """A suggested RFC 6902 patch, where the numbers determine one."""
    skill: str = ""
    """`skill://` resource that explains it."""
    because: str = ""
    """Evidence of this row that speaks for the cause, or against it."""
    tried: str = ""
    """Effects of past edits of this group on this row, newest first."""


class Row(BaseModel):
    """One requirement with its verdict and the evidence for it."""

    model_config = ConfigDict(frozen=True, allow_inf_nan=False)

    id: str
    question: str = ""
    """Its id without the subject: `support:rope` of `support:rope:lamp`. Empty in rows of earlier builds."""
    subject: tuple[str, ...] = ()
    """Whom it is asked about: entities, instances, beats, shots or relations, as the id names them."""
    check: Check
    group: Group
    predicate: str
    """The requirement, in words and symbols."""
    mandatory: bool = True
    status: Status
    artifact: str = ""
    """The inspected artifact: relative path of a cache, `world.json`, a built mesh."""
    frames: tuple[int, int] | None = None
    measured: float | None = None
    bound: float | None = None
    comparison: Literal["<=", ">=", "==", "in", ""] = ""
    """Comparison that measured must satisfy with bound."""
    unit: str = ""
    entities: tuple[str, ...] = ()
    """Entities concerned, the first failing one first."""
    first_failing_entity: str | None = None
    first_failing_frame: int | None = None
    corrections: tuple[Correction, ...] = ()
    """Ranked, the most likely first."""
    evidence: dict[str, Any] = Field(default_factory=dict)
    recipe: str = ""
    """Hash of everything the verdict was derived from; differs from the current one when stale."""


class Outcome(BaseModel):
    """Result of one judgement of a row, as an attempt at repair remembers it."""

    model_config = ConfigDict(frozen=True)

    status: Status
    measured: float | None = None
    bound: float | None = None
    unit: str = ""
    entity: str | None = None
    frame: int | None = None


class Attempt(BaseModel):
    """One edit after a failure, as seen from one row: what was changed and what the row measured before and after."""

    model_config = ConfigDict(frozen=True)

    revision: int
    group: str
    """Causal parameter group that was changed."""
    hypothesis: str
    changes: tuple[tuple[str, Any, Any], ...] = ()
    """(JSON pointer, old value, new value) of what was changed; values that are no plain numbers or words are None."""
    test: str | None = None
    """The test of it: `audit`, `static`, or the freeze of a probe; `undone` where it was taken back untested; None while nothing has."""
    before: Outcome | None = None
    after: Outcome | None = None
    """None where the test did not judge this row."""


def outcome_of(row: Row) -> Outcome:
    """Result of a row's judgement; a row that an edit made stale counts as before the edit."""
    status = row.evidence.get("was", row.status) if row.status == "unverified" else row.status
    return Outcome(
        status=status,
        measured=row.measured,
        bound=row.bound,
        unit=row.unit,
        entity=row.first_failing_entity,
        frame=row.first_failing_frame,
    )


def fail_closed(row: Row) -> Row:
    """A pass without an inspected artifact is `unverified` (R31)."""
    if row.status == "pass" and not row.artifact:
        return row.model_copy(update={"status": "unverified"})
    return row
