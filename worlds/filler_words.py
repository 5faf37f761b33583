"""Words in filler that say where or how something happens, and events that share a beat: told in the verdict, since nothing judges them (R2, R155)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

from .claim_targets import Span, named_in
from .prompts.descriptions import meanings
from .prompts.parts import words_of

if TYPE_CHECKING:
    from .spec import WorldSpec

__all__ = ["filler_warnings", "shared_beat_warnings"]

PLACES = frozenset({"under", "beside", "between", "behind", "front", "edge"})
"""Words of place that say where one thing is to another; `on`, `in` and `over` stand behind most verbs of motion."""
NAMED = ("thing", "count", "property")
"""Types of what such a word leads in."""
HOW = frozenset(
    {"again", "uphill", "downhill", "backwards", "backward", "forwards", "upwards", "downwards", "sideways", "fast", "hard", "together", "forever"}
)  # fmt: skip
"""Adverbs of manner, direction and repetition that do not end in -ly."""
NOT_HOW = frozenset({"only", "nearly", "exactly", "hardly", "barely", "really", "actually", "simply", "finally"})
"""Adverbs that `deciding.py` and `hedged.py` read, or that say nothing of a motion."""
SHOWN = 6


def filler_warnings(spec: WorldSpec, spans: Sequence[Span], language: str | None) -> Iterator[str]:
    """Words of place before a claimed thing, in the languages with reviewed lists, and English adverbs that no claim takes up.

    Args:
        spec: the specification.
        spans: of its prompt, in order.
        language: code of its language.
    """
    for before, behind in pairwise(spans):
        if before.claim is None and behind.claim is not None and behind.type in NAMED:
            last = [m for m in meanings(before.text, language, "place") if m.term in PLACES][-1:]
            if last:
                yield f"{last[0].word!r} before {behind.text.strip()!r} says where something is, and no claim takes it up: mark it as place, with what judges it"
    if language != "en":
        return
    filler = [(s.start, s.end) for s in spans if s.claim is None]
    adverbs = [
        spec.prompt[w.start : w.end]
        for w in words_of(spec.prompt)
        if (w.text in HOW or (w.part == "r" and w.text.endswith("ly") and w.text not in NOT_HOW))
        and any(a <= w.start and w.end <= b for a, b in filler)
    ]
    if adverbs:
        words = ", ".join(repr(word) for word in dict.fromkeys(adverbs[:SHOWN]))
        yield f"no claim takes up {words}: nothing judges how, how often or which way it happens"


def shared_beat_warnings(spec: WorldSpec) -> Iterator[str]:
    """Events that are judged by the same beats, though no claim says that they are one."""
    known: dict[frozenset[str], list[str]] = {}
    for name, claim in spec.claims.items():
        if claim.type == "event" and claim.waived is None and claim.same_as is None:
            beats = frozenset(named_in(spec, name, "story/beats"))
            if beats:
                known.setdefault(beats, []).append(claim.quote)
    for beats, quotes in known.items():
        if len(quotes) > 1:
            told = ", ".join(repr(q) for q in quotes[:SHOWN])
            yield f"{told} are judged by one beat, {min(beats)!r}: give each event a beat of its own, or same_as where the words tell of one"
