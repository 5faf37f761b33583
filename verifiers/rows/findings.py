"""Finding: what a judge found out about one question, before it becomes a row."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...worlds.errors import EvidenceError
from ...worlds.requirements import Correction, Status

if TYPE_CHECKING:
    from ...worlds.cache import Cache
    from ...worlds.candidate import Candidate
    from .questions import Comparison

__all__ = ["Finding", "cache_of", "judged", "lacking"]


@dataclass(frozen=True)
class Finding:
    """Status, sentence, numbers and corrections that answer a question about a subject."""

    status: Status
    text: str
    """One sentence with numbers."""
    measured: float | None = None
    bound: float | None = None
    """Number that `measured` is compared with."""
    unit: str = ""
    """SI unit of both; empty takes that of the question."""
    entity: str | None = None
    """First failing entity; default, where it fails, the first of those concerned."""
    frame: int | None = None
    """First failing frame; default, where a spatial question fails, the first of `frames`."""
    hints: tuple[Correction, ...] = ()
    """Corrections, the most likely first; kept where the row is open."""
    evidence: dict[str, Any] | None = None
    """Further JSON-able measurements; a value that is not finite is named in it."""
    comparison: Comparison | None = None
    """Comparison of `measured` with `bound`; None takes that of the question."""
    entities: tuple[str, ...] = ()
    """All that were looked at."""
    frames: tuple[int, int] | None = None
    """Inspected frames, inclusive; None for all that the candidate has."""
    needed: tuple[int, int] | None = None
    """Frames over which the requirement holds, where that is more than those inspected."""
    predicate: str = ""
    """The requirement with the numbers of this case; empty takes the words of the question."""
    extra: Any = None
    """Whatever else of the specification the answer depends on, for the recipe."""


def lacking(error: EvidenceError | str) -> Finding:
    """The finding of a judge that lacks evidence."""
    return Finding("unverified", f"no evidence: {error}", evidence={"missing": str(error)})


def judged(function: Callable[..., Finding], *given: Any) -> Finding:
    """The finding of a judge; `unverified` where it lacks evidence. Every other error is one of the judge and surfaces."""
    try:
        return function(*given)
    except EvidenceError as error:
        return lacking(error)


def cache_of(candidate: Candidate, solver: str) -> Cache:
    """The cache of an instance.

    Raises:
        EvidenceError: it has none yet.
    """
    cache = candidate.caches.get(solver)
    if cache is None:
        raise EvidenceError(f"instance {solver!r} has no cache yet; probe or bake it")
    return cache
