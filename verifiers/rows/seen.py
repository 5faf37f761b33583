"""What was not looked at may still fail: a row does not pass over frames that are not there."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Row

__all__ = ["last_claimed", "only_seen"]

_INTERVAL = re.compile(r"\bframes? \d+(?:\.\.| to )(\d+)")
"""How predicates name an interval; the last frame of it."""


def last_claimed(found: Row) -> int:
    """Last frame that a row speaks of, by its interval or in its words; -1 where it names none."""
    told = [int(end) for end in _INTERVAL.findall(found.predicate)]
    return max([-1 if found.frames is None else found.frames[1], *told])


def only_seen(candidate: Candidate, found: Row, needed: tuple[int, int] | None = None) -> Row:
    """The row, `unverified` where it passes over frames that are not there.

    A failure stays one. Rows about the shot plan alone (their artifact is `world.json`) have looked at all of it.

    Args:
        candidate: what was inspected.
        found: the verdict about it.
        needed: frames over which the requirement holds; default those that the row speaks of.
    """
    first, last = needed or ((found.frames or (0, 0))[0], last_claimed(found))
    planned = found.check == "shots" and found.artifact == "world.json"
    if found.status != "pass" or last <= candidate.last_frame or planned:
        return found
    text = f"frames {first}..{candidate.last_frame} of {first}..{last} seen: {found.evidence.get('explanation', found.predicate)}"
    evidence = {**found.evidence, "explanation": text, "seen": [first, candidate.last_frame]}
    return found.model_copy(update={"status": "unverified", "frames": (first, last), "evidence": evidence})
