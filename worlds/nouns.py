"""The noun that a number stands before, in languages whose numbers do: between the two may stand properties, and words that describe."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import regex

from .prompts.held_numbers import COUNTERS
from .prompts.languages import function_words
from .prompts.lexicon import labelled
from .prompts.units import folded, units_of

if TYPE_CHECKING:
    from .claim_targets import Span
    from .spec import WorldSpec

__all__ = ["Noun", "noun_of"]

BEFORE_NOUNS = ("en", "de", "fr", "es", "it", "pt", "nl", "ru", "zh")
"""Languages in which a number stands before its noun."""
LINKS = frozenset(
    [
        "of",
        "de",
        "d'",
        "du",
        "des",
        "di",
        "del",
        "della",
        "von",
        "vom",
        "aus",
        "van",
        "из",
        "the",
        "these",
        "those",
        "der",
        "den",
        "dem",
        "les",
        "los",
        "las",
        "i",
        "gli",
        "os",
        "as",
    ]
)
"""Words between a number and its noun that lead on to it: `two litres of milk`, `three of the blocks`. Reviewed by hand."""
OF = frozenset(["of", "de", "d'", "di", "von", "van", "из"])
HOLDERS = "罐盆杯瓶箱桶盘碗袋壶"
"""Chinese measure words that hold what stands behind them: `一罐蜂蜜` is one jar."""
DESCRIBING = 3
"""Own choice: words that describe between a number and its noun in English; elsewhere one, since nothing tells verbs from adjectives."""
_END = regex.compile(r"[.;:!?…()\n。；：！？—–]")


class Noun(NamedTuple):
    """The claim of a thing that a number belongs to."""

    claim: str
    near: bool
    """True where nothing but properties and `of` stand between."""


def noun_of(spec: WorldSpec, spans: Sequence[Span], index: int, language: str | None) -> Noun | None:
    """The claim of a thing that the number of a span stands before; None where there is none, or where it cannot be told.

    Args:
        spec: the specification.
        spans: of its prompt, in order.
        index: of the span of the number among them.
        language: code of the language of the prompt.
    """
    if language not in BEFORE_NOUNS or (language == "zh" and spans[index].text[-1:] in HOLDERS):
        return None
    near, described = True, 0
    for span in spans[index + 1 :]:
        if span.claim is None:
            if _END.search(span.text):
                return None
            words = _content(span, language, counts=spans[index].type == "count")
            if words is None or (not words and "," in span.text) or (language == "en" and _told(spec.prompt, span)):
                return None
            near, described = near and not words, described + words
            if described > (DESCRIBING if language == "en" else 2 if language == "zh" else 1):
                return None
        elif span.type == "thing":
            return Noun(span.claim, near)
        elif span.type not in ("property", "look") or spec.claims[span.claim].waived is not None:
            return None
    return None


def _content(span: Span, language: str, *, counts: bool) -> int | None:
    """Number of words that describe; None where one leads elsewhere, as from `one` of `one of honey` to what the one holds."""
    words = [folded(u.text) for u in units_of(span.text)]
    bind = function_words(language) - LINKS - set(COUNTERS.get(language, ""))
    holds = counts and bool(OF & set(words)) and not (LINKS - OF) & set(words)
    return None if holds or bind & set(words) else sum(w not in LINKS for w in words)


def _told(prompt: str, span: Span) -> bool:
    """True where words of filler are things or events themselves."""
    return any(span.start <= w.start and w.end <= span.end and w.type in ("thing", "event") for w in labelled(prompt))
