"""Questions of the check `delivery` and of acceptance."""

from __future__ import annotations

from collections.abc import Mapping
from typing import get_args

from ...worlds.requirements import Check
from ..rows.questions import GROUP_OF, Question

__all__ = ["CACHE", "COMPLETE", "DIGESTS", "FREEZE", "INDEPENDENT", "NEEDED", "QUESTIONS", "REPLAY", "UNJUDGED"]

COMPLETE = Question(
    "delivery:complete",
    "the cache of {0} holds all requested frames",
    "frames in the cache",
    "frame",
    "==",
    "simulation.frames",
    ("solver",),
)
DIGESTS = Question(
    "delivery:digests",
    "every frame of {0} has the content recorded when it was baked",
    "whether a frame differs",
    "1",
    "<=",
    "0",
    ("solver",),
)
INDEPENDENT = Question(
    "delivery:independent", "the world folder holds everything it refers to", "links out of the folder", "1", "<=", "0"
)
CACHE = Question(
    "delivery:cache",
    "the frames on disk have the content that the ledger recorded when they were baked",
    "whether the digest of all frames differs",
    "1",
    "<=",
    "0",
)
REPLAY = Question(
    "delivery:replay",
    "the start and randomly chosen checkpoint intervals, simulated again, give the cached bytes",
    "intervals that do not, now or in an earlier replay of this cache",
    "1",
    "<=",
    "0",
)
FREEZE = Question(
    "delivery:freeze",
    "settings, geometry, solver source and engine versions hash to the recorded freeze",
    "whether the hash differs",
    "1",
    "<=",
    "0",
)
NEEDED: frozenset[Check] = frozenset(get_args(Check)) - {"terrain", "relations", "robustness", "claim", "review"}
"""Checks that must have judged something (R119): all but those of what a world need not have, a reader among them."""
UNJUDGED: Mapping[Check, Question] = {
    check: Question(f"{check}:none", f"{check} has judged at least one requirement", matrix_group=GROUP_OF.get(check, "spatial"))
    for check in sorted(NEEDED)
}
"""Questions whether a check has found anything to judge; a row only where it has not."""

QUESTIONS = (COMPLETE, DIGESTS, INDEPENDENT, CACHE, REPLAY, FREEZE, *UNJUDGED.values())
