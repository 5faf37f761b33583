"""Lines of the register about states that the story starts with."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...worlds.errors import EvidenceError
from ...worlds.predicates.registry import is_invariant
from ..story.initial import INITIAL
from ..story.vacuity import from_start

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["initial_lines"]


def initial_lines(candidate: Candidate) -> list[dict[str, str]]:
    """Lines of the register: beats that tell of an initial state, which nothing brings about."""
    found = []
    for name, beat in candidate.spec.story.beats.items():
        if beat.causes or not is_invariant(beat.predicate):
            continue
        try:
            past = from_start(candidate, name)
        except EvidenceError:
            continue  # its row says so
        if past is not None:
            found.append({"what": f"beat {name!r} is so from frame 0 on: {beat.text}", "effect": INITIAL})
    return found
