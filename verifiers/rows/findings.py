"""What a question about a subject came to, and the row that it becomes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...worlds.errors import EvidenceError
from ...worlds.requirements import Correction, Row, RowId, Status
from .verdicts import correction, make_row

if TYPE_CHECKING:
    from ...worlds.cache import Cache
    from ...worlds.candidate import Candidate
    from .verdicts import Comparison

__all__ = ["Finding", "again", "answered", "cache_of", "halve", "judged", "separate"]


@dataclass(frozen=True)
class Finding:
    """Status, sentence, numbers and corrections: what a judge found out about one question."""

    status: Status
    text: str
    measured: float | None = None
    bound: float | None = None
    unit: str = ""
    entity: str | None = None
    frame: int | None = None
    hints: tuple[Correction, ...] = ()
    evidence: dict[str, Any] | None = None
    comparison: Comparison = "<="
    entities: tuple[str, ...] = ()
    """All that were looked at."""


def judged(function: Callable[..., Finding], *given: Any) -> Finding:
    """What a judge finds in what it is given; `unverified` where it lacks evidence."""
    try:
        return function(*given)
    except EvidenceError as error:
        return Finding("unverified", str(error))


def cache_of(candidate: Candidate, solver: str) -> Cache:
    """The cache of an instance.

    Raises:
        EvidenceError: it has none yet.
    """
    cache = candidate.caches.get(solver)
    if cache is None:
        raise EvidenceError(f"instance {solver!r} has no cache yet; probe or bake it")
    return cache


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
    """The row of a question.

    Args:
        candidate: what is judged.
        row_id: the question, and of what it is asked.
        predicate: what is required.
        found: the answer.
        entities: concerned, after those that the answer names.
        evidence: put before the answer's own.
        extra: what else of the specification the answer depends on.
    """
    return make_row(
        candidate,
        row_id,
        predicate=predicate,
        status=found.status,
        explanation=found.text,
        measured=found.measured,
        bound=found.bound,
        comparison=found.comparison if found.measured is not None and found.bound is not None else "",
        unit=found.unit,
        entities=[n for n in (found.entity, *found.entities, *entities) if n],
        first_failing_entity=found.entity,
        first_failing_frame=found.frame,
        corrections=found.hints,
        evidence={**(evidence or {}), **(found.evidence or {})},
        extra=extra,
    )


def halve(candidate: Candidate, solver: str, cause: str) -> Correction:
    """Halve the step."""
    step = candidate.spec.simulation.rigid[solver].settings.step
    pointer = f"/simulation/solvers/{solver}/settings/step"
    patch = ({"op": "add", "path": pointer, "value": round(max(2e-5, step / 2), 9)},)
    return correction(cause, "step", f"halve the step from {step:g} s", pointers=(pointer,), patch=patch)


def separate(entity: str | None) -> Correction:
    """Take bodies apart that overlap at the start."""
    return correction(
        "colliders overlap at the start and push each other apart",
        "placement",
        f"separate {entity or 'the bodies'} from its neighbours at frame 0",
        pointers=(f"/entities/{entity}/pose",) if entity else (),
    )


def again(cause: str) -> Correction:
    """Bake again."""
    return correction(cause, "interval", "bake again", pointers=("/simulation/frames",))
