"""Rows made of loose arguments, for checks that have no `Question` yet: each goes through `rows/answers.py`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.requirements import Correction, Group, Row, RowId, Status
from .answers import row_of
from .findings import Finding
from .questions import Comparison, Question

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["answered", "make_row"]


def _question(row_id: RowId, predicate: str, **more: Any) -> Question:
    def literal(text: str) -> str:
        return text.replace("{", "{{").replace("}", "}}")

    return Question(row_id.question, literal(predicate), order=literal(row_id), **more)


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
    """The row of a question that is not in the catalogue yet; see `row_of`, which replaces it."""
    failing = status == "fail" or (measured is not None and not np.isfinite(measured))
    found = Finding(
        status,
        explanation,
        measured,
        bound,
        unit,
        first_failing_entity if failing else None,
        first_failing_frame,
        tuple(corrections),
        dict(evidence or {}),
        comparison,
        tuple(entities),
        frames,
    )
    question = _question(row_id, predicate, mandatory=mandatory, matrix_group=group)
    return row_of(candidate, question, row_id.subject, found, extra=extra, recipe_entities=recipe_entities, artifact=artifact)


def answered(
    candidate: Candidate,
    row_id: RowId,
    predicate: str,
    found: Finding,
    *,
    entities: Iterable[str] = (),
    evidence: Mapping[str, Any] | None = None,
    extra: Any = None,
) -> Row:
    """The row of a finding whose question is not in the catalogue yet; see `row_of`, which replaces it."""
    found = replace(found, evidence={**(evidence or {}), **(found.evidence or {})})
    return row_of(candidate, _question(row_id, predicate, comparison="<="), row_id.subject, found, entities=entities, extra=extra)
