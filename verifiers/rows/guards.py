"""What the spatial checks share in writing rows: strictness about numbers, and the guard for missing evidence."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from ...worlds.errors import EvidenceError
from ...worlds.requirements import Check, Row, RowId
from .verdicts import make_row

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = [
    "CheckFunction",
    "guarded",
    "guarded_rows",
    "last_claimed",
    "only_seen",
    "pointer",
    "translation_patch",
]

CheckFunction = Callable[["Candidate"], list[Row]]


_INTERVAL = re.compile(r"\bframes? \d+(?:\.\.| to )(\d+)")
"""How predicates name an interval; the last frame of it."""


def pointer(*steps: str | int) -> str:
    """JSON pointer (RFC 6901) of the steps."""
    return "".join("/" + str(s).replace("~", "~0").replace("/", "~1") for s in steps)


def translation_patch(candidate: Candidate, entity: str, offset: Iterable[float]) -> tuple[dict[str, Any], ...]:
    """RFC 6902 patch that moves an entity by `offset` [m], rounded to 10 micrometres."""
    pose = candidate.spec.entities[entity].pose
    position = [round(float(a) + float(b), 5) for a, b in zip(pose.position, offset, strict=True)]
    value = pose.model_copy(update={"position": tuple(position)}).model_dump(mode="json", exclude_none=True)
    # `add` also holds where world.json leaves the default pose out.
    return ({"op": "add", "path": pointer("entities", entity, "pose"), "value": value},)


def last_claimed(found: Row) -> int:
    """Last frame that a row speaks of, by its interval or in its words; -1 where it names none."""
    told = [int(end) for end in _INTERVAL.findall(found.predicate)]
    return max([-1 if found.frames is None else found.frames[1], *told])


def only_seen(candidate: Candidate, found: Row, wanted: tuple[int, int] | None = None) -> Row:
    """The row, `unverified` where it passes over frames that are not there: what was not looked at may still fail.

    A failure stays one. Rows about the shot plan alone (their artifact is `world.json`) have looked at all of it.

    Args:
        candidate: what was inspected.
        found: the verdict about it.
        wanted: frames over which the requirement holds; default those that the row speaks of.
    """
    first, last = wanted or ((found.frames or (0, 0))[0], last_claimed(found))
    planned = found.check == "shots" and found.artifact == "world.json"
    if found.status != "pass" or last <= candidate.last_frame or planned:
        return found
    text = f"frames {first}..{candidate.last_frame} of {first}..{last} seen: {found.evidence.get('explanation', found.predicate)}"
    evidence = {**found.evidence, "explanation": text, "seen": [first, candidate.last_frame]}
    return found.model_copy(update={"status": "unverified", "frames": (first, last), "evidence": evidence})


def guarded_rows(
    candidate: Candidate,
    make: Callable[[], Iterable[Row]],
    *,
    row_id: RowId,
    predicate: str,
    entities: Iterable[str] = (),
) -> list[Row]:
    """The rows that `make` returns; one `unverified` row named `row_id` where it lacks evidence.

    Only `EvidenceError` is caught: any other exception is an error of the check itself and must surface.
    """
    try:
        return list(make())
    except EvidenceError as error:
        return [
            make_row(
                candidate,
                row_id,
                predicate=predicate,
                status="unverified",
                explanation=f"no evidence: {error}",
                entities=entities,
                evidence={"missing": str(error)},
            )
        ]


def guarded(check: Check, predicate: str) -> Callable[[CheckFunction], CheckFunction]:
    """Decorate a `check(candidate)`: missing evidence that concerns the whole check gives `<check>:scene` unverified."""

    def decorate(function: CheckFunction) -> CheckFunction:
        @functools.wraps(function)
        def run(candidate: Candidate) -> list[Row]:
            return guarded_rows(candidate, lambda: function(candidate), row_id=RowId(f"{check}:scene"), predicate=predicate)

        return run

    return decorate
