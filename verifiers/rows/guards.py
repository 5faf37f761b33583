"""Guards of rows whose questions are not in the catalogue yet; `guarded` and `rows_of` of `rows/answers.py` replace them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from ...worlds.requirements import Check, Row, RowId
from . import answers
from .corrections import move_by, pointer
from .questions import Question
from .seen import only_seen

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["CheckFunction", "guarded", "guarded_rows", "only_seen", "pointer", "translation_patch"]

CheckFunction = Callable[["Candidate"], list[Row]]


def translation_patch(candidate: Candidate, entity: str, offset: Iterable[float]) -> tuple[dict[str, Any], ...]:
    """RFC 6902 patch that moves an entity by `offset` [m], rounded to 10 micrometres."""
    return move_by(candidate, entity, offset, "").patch


def guarded_rows(
    candidate: Candidate,
    make: Callable[[], Iterable[Row]],
    *,
    row_id: RowId,
    predicate: str,
    entities: Iterable[str] = (),
) -> list[Row]:
    """The rows that `make` returns; one `unverified` row named `row_id` where it lacks evidence."""
    question = Question(row_id.question, predicate, order=row_id)
    return answers.rows_of(candidate, question, row_id.subject, make, entities=entities)


def guarded(check: Check, predicate: str) -> Callable[[CheckFunction], CheckFunction]:
    """Decorate a `check(candidate)`: missing evidence that concerns the whole check gives `<check>:scene` unverified."""
    return answers.guarded(Question(f"{check}:scene", predicate))
