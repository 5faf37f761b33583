"""Spans and types that the server proposes for a new prompt: a start for whoever marks it, judged by nobody.

English words get the types of `lexicon.py`. In other languages with reviewed lists numbers, negations, words of order and those of properties, times,
weather and light that a rule judges are known, and words of grammar are left out; every other word is `unknown`, to be typed or left as filler.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple, cast

from .descriptions import UNSPACED, WordKind, meanings
from .languages import REVIEWED, function_words, held_words, language_of
from .lexicon import describes, is_stance, labelled
from .marks import Mark, MarkType, marked_text
from .numbers import number_in, quantity_in
from .units import Unit, folded, units_of, word_count

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

__all__ = ["Proposal", "proposal_text", "proposed"]

DESCRIBED: dict[WordKind, str] = {
    "colour": "property", "form": "property", "material": "property", "time": "time", "weather": "weather", "look": "look",
}  # fmt: skip
"""Type of claim that a word of a kind makes."""
LONGEST = 4
"""Words of a span."""
LONGEST_EVENT = 8
"""Words of an event or quantity."""
LONGEST_UNIT = 5
"""Text units that are looked at behind a number for its unit of measure: own choice; `kilometres per hour` has three, `立方厘米` four."""
_PLACE = re.compile(
    r"\b(under|beneath|underneath|above|beside|next to|between|behind|in front of|inside)(?= (?:the|an?|its|his|her|their|two|both)\b)",
    re.IGNORECASE,
)
"""Words of place that rows judge between two bodies at rest, where a thing follows; `on` and `in` stand by more verbs of motion than of place."""
_DEFINITE = re.compile(r"\bthe\s+$", re.IGNORECASE)


class Proposal(NamedTuple):
    """A span of a prompt and the type of claim that it is likely to make."""

    start: int
    end: int
    type: str
    """A type of claim, or `unknown`."""


def proposed(text: str) -> tuple[Proposal, ...]:
    """Spans that do not overlap, in order; what is in none is likely to be filler."""
    language = language_of(text)
    found = _english(text) if language == "en" else _elsewhere(text, language)
    made: list[Proposal] = []
    for proposal in sorted(found):
        if not made or proposal.start >= made[-1].end:
            made.append(_short(text, proposal))
    return tuple(made)


def proposal_text(prompt: str) -> str:
    """The prompt as marked text without targets: `A [steel](property) [ball](thing) [rolls off](event) the [table](thing).`

    A noun that stands once more behind `the` is proposed as the same thing: a definite noun phrase points back (Quirk et al. 1985, 5.30).
    """
    marks = []
    first: dict[str, str] = {}
    for start, end, kind in proposed(prompt):
        word = folded(prompt[start:end])
        again = kind == "thing" and word in first and _DEFINITE.search(prompt[:start]) is not None
        options = {"same_as": first[word]} if again else {}
        marks.append(Mark(start, end, prompt[start:end], cast("MarkType", kind), options=options))
        if kind == "thing":
            first.setdefault(word, prompt[start:end])
    return marked_text(prompt, marks)


def _english(text: str) -> Iterator[Proposal]:
    behind = 0
    for label in labelled(text):
        span = label.start, label.end
        lasts = label.type == "event" and (is_stance(text[slice(*span)]) or describes(text, *span))
        yield Proposal(label.start, label.end, "property" if lasts else label.type)
        word = _PLACE.search(text, behind, label.start)
        if word is not None and label.type == "thing":
            yield Proposal(*word.span(1), "place")
        behind = behind if label.type in ("property", "count", "quantity") else label.end


def _short(text: str, span: Proposal) -> Proposal:
    """The span as a claim may have it: its last words where it has too many, since the head of a compound is its last."""
    longest = LONGEST_EVENT if span.type in ("event", "quantity") else LONGEST
    starts = [unit.start for unit in units_of(text) if span.start <= unit.start < span.end]
    return span._replace(start=next(start for start in starts if word_count(text[start : span.end]) <= longest))


def _elsewhere(text: str, language: str | None) -> Iterator[Proposal]:
    held = held_words(text, language)
    found = [Proposal(word.start, word.end, word.kind) for word in held if word.kind != "number"]
    found += _numbers(text, [(word.start, word.end) for word in held if word.kind == "number"], language)
    grammar = function_words(language or "")
    found += _described(text, found, language)
    yield from found
    rest = [unit for unit in units_of(text) if not any(span.start < unit.end and unit.start < span.end for span in found)]
    yield from _unknown(text, [unit for unit in rest if folded(unit.text).replace("’", "'") not in grammar])


def _described(text: str, found: Sequence[Proposal], language: str | None) -> list[Proposal]:
    """Words that a rule of properties, times, weather or looks judges, where nothing stands yet.

    In languages without blanks those of colour and form alone: a sign for a material is part of many nouns.
    """
    made, units = list(found), units_of(text)
    begins, ends = {unit.start for unit in units}, {unit.end for unit in units}
    plain = folded(text) if language in UNSPACED else text
    for kind, type_ in DESCRIBED.items():
        if language in UNSPACED and kind not in ("colour", "form"):
            continue
        at = 0
        for meaning in meanings(text, language, kind):
            places = (m.start() for m in re.finditer(re.escape(meaning.word), plain[at:]))
            start = next((at + p for p in places if at + p in begins and at + p + len(meaning.word) in ends), -1)
            if start < 0:
                continue
            at = end = start + len(meaning.word)
            if not any(span.start < end and start < span.end for span in made):
                made.append(Proposal(start, end, type_))
    return made[len(found) :]


def _numbers(text: str, held: Sequence[tuple[int, int]], language: str | None) -> Iterator[Proposal]:
    """Counts, and quantities where a unit of measure stands behind a number; of a language without reviewed lists those that all languages share."""
    units = units_of(text)
    spans = held
    if language not in REVIEWED:
        spans = [(unit.start, unit.end) for unit in units if number_in(unit.text, language) is not None]
    stops = [start for start, _ in [*spans, (len(text), len(text))]][1:]
    for (start, end), stop in zip(spans, stops, strict=True):
        found, last = None, end
        for unit in [unit for unit in units if end <= unit.start < stop][:LONGEST_UNIT]:
            quantity = quantity_in(text[start : unit.end], language)
            if found is not None and (quantity is None or quantity == found):
                break
            if quantity is not None:
                found, last = quantity, unit.end
        yield Proposal(start, last, "count" if found is None else "quantity")


def _unknown(text: str, units: Sequence[Unit]) -> Iterator[Proposal]:
    """Each word by itself; clusters of a script without blanks in runs of at most four words."""
    start, end = -1, -1
    for unit in units:
        if start >= 0 and (unit.start > end or _is_word(unit) or word_count(text[start : unit.end]) > LONGEST):
            yield Proposal(start, end, "unknown")
            start = -1
        if start < 0:
            start = unit.start
        end = unit.end
    if start >= 0:
        yield Proposal(start, end, "unknown")


def _is_word(unit: Unit) -> bool:
    """False of a cluster of a script without blanks, two of which count as one word."""
    return word_count(f"{unit.text} {unit.text}") != 1
