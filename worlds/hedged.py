"""Events before which a word says that they do not happen: `almost [hits]`, `would [fall]`, `too slow to [reach]` (R2, R131, R155)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from typing import TYPE_CHECKING, NamedTuple

import regex

from .prompts.hedge_words import BETWEEN_EVENT, DOUBTED, HEDGED, TOO_TO
from .prompts.units import APOSTROPHES, Unit, folded, units_of

if TYPE_CHECKING:
    from .claim_targets import Span
    from .spec import WorldSpec

__all__ = ["Hedged", "hedged_events"]

_STOP = regex.compile(r"[.,;:!?…()\n]|[—–]")
_SENTENCE = regex.compile(r"[.!?…\n]")
_WOULD = frozenset(("would", "würde", "würden", "zou", "zouden"))
_ASKED = regex.compile(
    r"(?i)\b(?:how|what|which|if|when|whether|imagine|suppose|see|wonder|like|wie|was|wenn|ob|falls|hoe|wat|als|of)\b"
)
"""Words of a request or a condition before a `would`."""
_UNSPACED = ("zh", "ja")


class Hedged(NamedTuple):
    """A claim of an event that its words deny."""

    claim: str
    text: str
    sure: bool
    """False where the words leave open whether it happens: the verdict warns."""


@cache
def _phrases(language: str) -> dict[tuple[str, ...], bool]:
    """Phrases as folded units, and whether what they hedge surely does not happen."""
    lists = ((DOUBTED, False), (HEDGED, True))
    return {tuple(folded(u.text) for u in units_of(p)): sure for held, sure in lists for p in held.get(language, ())}


def hedged_events(spec: WorldSpec, spans: Sequence[Span], language: str | None) -> Iterator[Hedged]:
    """Claims of events with a word right before them, or in them, that says they do not happen."""
    for index, span in enumerate(spans):
        if span.claim is None or span.type != "event" or spec.claims[span.claim].waived is not None:
            continue
        found = _inside(span.text, language or "")
        before = spans[index - 1] if index else None
        if found is None and before is not None and before.claim is None:
            found = _before(before.text, language or "")
        if found is None:
            continue
        word, sure = found
        if sure and not _supposed(spec.prompt, span.start, word):
            text = f"{word!r} before {span.text!r} says that it does not happen, and the claim is of an event: mark the two as a negation, by a requirement "
            yield Hedged(span.claim, f"{text}with never: true, and what it comes close to as a place or a quantity", True)
        else:
            yield Hedged(
                span.claim, f"{word!r} before {span.text!r} leaves open whether it happens, and the world has it happen", False
            )


def _supposed(prompt: str, start: int, word: str) -> bool:
    """True of a `would` in a request that asks how something would go, or under a condition: it is to be shown."""
    begin = max((m.end() for m in _SENTENCE.finditer(prompt, 0, start)), default=0)
    return folded(word) in _WOULD and bool(_ASKED.search(prompt, begin, start))


def _inside(text: str, language: str) -> tuple[str, bool] | None:
    """A hedge within the words of an event, which says what it is of: `almost hits`."""
    if language in _UNSPACED:
        return next(((w, True) for w in HEDGED[language] if text.startswith(w)), None)
    units = units_of(text)
    return next(
        (
            (word, sure)
            for at in range(len(units))
            for word, sure, size in _at(text, units, at, language)
            if at + size < len(units)
        ),
        None,
    )


def _before(text: str, language: str) -> tuple[str, bool] | None:
    """A hedge at the end of the filler before an event."""
    clause = text[max((m.end() for m in _STOP.finditer(text)), default=0) :]
    if language in _UNSPACED:
        return next(((w, True) for w in HEDGED[language] if clause.endswith(w)), None)
    if language == "en" and (match := regex.search(TOO_TO, clause.rstrip())):
        return match.group().strip(), True
    units = units_of(clause)
    loose = BETWEEN_EVENT.get(language, frozenset())
    for at in range(len(units) - 1, -1, -1):
        for word, sure, size in _at(clause, units, at, language):
            if all(folded(u.text) in loose or folded(u.text).endswith("ly") for u in units[at + size :]):
                return word, sure
    return None


def _at(text: str, units: Sequence[Unit], at: int, language: str) -> Iterator[tuple[str, bool, int]]:
    """The longest phrase that begins at a unit: its words, whether it is sure, how many units it has."""
    known = _phrases(language)
    words = [folded(u.text.translate(APOSTROPHES)) for u in units[at : at + max(map(len, known), default=0)]]
    for size in range(len(words), 0, -1):
        sure = known.get(tuple(words[:size]))
        if sure is not None:
            yield text[units[at].start : units[at + size - 1].end], sure, size
            return
