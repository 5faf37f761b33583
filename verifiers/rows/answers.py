"""The one place where a row is made: a question, its subject and a finding become a `Row`."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.ablation import ablation, switched_off
from ...worlds.errors import EvidenceError
from ...worlds.requirements import Row, fail_closed
from .findings import Finding, judged, lacking
from .seen import only_seen
from .telling import tell

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from .questions import Question

__all__ = ["guarded", "plain", "row_of", "rows_of"]


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


def _finite(value: float | None) -> float | None:
    return None if value is None or not np.isfinite(value) else float(value)


def row_of(
    candidate: Candidate,
    question: Question,
    subject: tuple[str, ...],
    found: Finding | Callable[[], Finding],
    *,
    entities: Iterable[str] = (),
    extra: Any = None,
    recipe_entities: Iterable[str] | None = None,
    artifact: str | None = None,
) -> Row:
    """The row that answers a question, strict about numbers: a pass whose measured value is not finite fails.

    Args:
        candidate: what was inspected.
        question: what is asked.
        subject: names of what it is asked about, as the row's id has them.
        found: the answer, or the judge that gives it: where that lacks evidence the row is `unverified`.
        entities: entities concerned, after those that the finding names.
        extra: what else of the specification the verdict depends on, unless the finding says.
        recipe_entities: entities that the verdict depends on; default those concerned.
        artifact: what was inspected; default the candidate's caches.
    """
    if not isinstance(found, Finding):
        tell(question.row_id(subject))
    found = _answer(question, found)
    frames = (0, candidate.last_frame) if found.frames is None else found.frames
    measured, bound = _finite(found.measured), _finite(found.bound)
    numbers = [n is not None for n in (found.measured, found.bound)]
    proof: dict[str, Any] = {"explanation": found.text, **plain(found.evidence or {})}
    if found.measured is not None and measured is None:
        found = replace(found, status="fail" if found.status == "pass" else found.status)
        proof["non_finite"] = str(found.measured)
    concerned = tuple(dict.fromkeys(n for n in (found.entity, *found.entities, *entities) if n))
    first = frames[0] if question.group == "spatial" and found.frame is None else found.frame
    row_id = question.row_id(subject)
    depends = [row_id, extra if found.extra is None else found.extra]
    row = Row(
        id=row_id,
        question=question.id,
        subject=subject,
        check=question.check,
        group=question.group,
        predicate=found.predicate or question.predicate.format(*subject),
        mandatory=question.mandatory,
        status=found.status,
        artifact=candidate.artifact if artifact is None else artifact,
        frames=frames,
        measured=measured,
        bound=bound,
        comparison=(found.comparison or question.comparison) if all(numbers) else "",
        unit=found.unit or (question.unit if any(numbers) else ""),
        entities=concerned,
        first_failing_entity=next(iter(concerned), None) if found.status == "fail" else None,
        first_failing_frame=first if found.status == "fail" else None,
        corrections=found.hints if found.status in ("fail", "unverified") else (),
        evidence=proof,
        recipe=candidate.recipe(question.check, concerned if recipe_entities is None else recipe_entities, depends),
    )
    return only_seen(candidate, fail_closed(row), found.needed) if found.needed else fail_closed(row)


def _answer(question: Question, found: Finding | Callable[[], Finding]) -> Finding:
    """The finding, from its judge where it is one; that nothing was judged where an evaluation leaves the check out."""
    if switched_off(question.check):
        return Finding("not_applicable", "not judged: switched off for an evaluation", evidence={"ablation": ablation()})
    return found if isinstance(found, Finding) else judged(found)


def rows_of(
    candidate: Candidate,
    question: Question,
    subject: tuple[str, ...],
    make: Callable[[], Iterable[Row]],
    *,
    entities: Iterable[str] = (),
) -> list[Row]:
    """The rows that `make` returns; one `unverified` row of the question where it lacks evidence."""
    try:
        return list(make())
    except EvidenceError as error:
        return [row_of(candidate, question, subject, lacking(error), entities=entities)]


def guarded(question: Question) -> Callable[[Callable[[Candidate], list[Row]]], Callable[[Candidate], list[Row]]]:
    """Decorator of a `check(candidate)`: evidence missing for the whole check gives one `unverified` row of the question."""

    def decorate(function: Callable[[Candidate], list[Row]]) -> Callable[[Candidate], list[Row]]:
        @functools.wraps(function)
        def run(candidate: Candidate) -> list[Row]:
            return rows_of(candidate, question, (), lambda: function(candidate))

        return run

    return decorate
