"""Rows of the requirements matrix (R82-R85)."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

__all__ = ["Check", "Correction", "Group", "Row", "RowClass", "Status", "fail_closed"]

Status = Literal["pass", "fail", "unverified", "not_applicable"]
Group = Literal["spatial", "physical", "temporal", "observational", "delivery"]
Check = Literal[
    "audit",
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
    "shots",
    "delivery",
]
RowClass = Literal["scene", "solver", "shot", "story", "text"]


class Correction(BaseModel):
    """What to do about a failing row (R69-R75): the most likely cause and the one parameter group to change."""

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


class Row(BaseModel):
    """One requirement with its verdict and the evidence for it."""

    model_config = ConfigDict(frozen=True, allow_inf_nan=False)

    id: str
    check: Check
    group: Group
    predicate: str
    """What is required, in words and symbols."""
    mandatory: bool = True
    status: Status
    artifact: str = ""
    """What was inspected: relative path of a cache, `world.json`, a built mesh."""
    frames: tuple[int, int] | None = None
    measured: float | None = None
    bound: float | None = None
    comparison: Literal["<=", ">=", "==", "in", ""] = ""
    """How measured must compare with bound."""
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


def fail_closed(row: Row) -> Row:
    """A pass without an inspected artifact is `unverified` (R31)."""
    if row.status == "pass" and not row.artifact:
        return row.model_copy(update={"status": "unverified"})
    return row
