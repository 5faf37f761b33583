"""Words of property, place, time, weather, look and way that a rule judges, in the languages with reviewed lists (`data/descriptions.json`).

A word that is not there is printed as the agent's reading. What a word demands of a world stands in `verifiers/claims/described/`.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from functools import cache
from typing import Any, Literal, NamedTuple

from .languages import REVIEWED
from .tables import table
from .units import APOSTROPHES, folded, units_of

__all__ = ["Meaning", "WordKind", "anchors", "meanings", "terms"]

WordKind = Literal["colour", "form", "material", "place", "time", "weather", "look", "route"]
UNSPACED = ("zh", "ja")
"""Languages without blanks between words: there a word is found wherever its characters stand."""


class Meaning(NamedTuple):
    """A word of a quote, and what it means."""

    term: str
    """As `red`, `tall`, `under`, `dusk`: a key of the list."""
    word: str
    """As it stands in the quote."""


def terms(kind: WordKind) -> tuple[str, ...]:
    """All meanings of a kind."""
    return tuple(table("descriptions")["words"][kind])


def meanings(quote: str, language: str | None, kind: WordKind) -> tuple[Meaning, ...]:
    """Words of a kind in a quote, in order and disjoint, the longest first; none in a language without reviewed lists."""
    if language not in REVIEWED:
        return ()
    return tuple(_unspaced(quote, language, kind) if language in UNSPACED else _spaced(quote, language, kind))


def anchors() -> Mapping[str, Mapping[str, str]]:
    """Places of the eleven basic colour terms: names of the survey with sRGB values as `#e50000`."""
    found: dict[str, dict[str, str]] = table("colours")["anchors"]
    return found


def _spaced(quote: str, language: str, kind: WordKind) -> list[Meaning]:
    known = _forms(language, kind)
    units = units_of(quote)
    words = [folded(unit.text.translate(APOSTROPHES)) for unit in units]
    longest, at, found = max(map(len, known), default=0), 0, list[Meaning]()
    while at < len(words):
        for count in range(min(longest, len(words) - at), 0, -1):
            term = known.get(tuple(words[at : at + count]))
            if term is not None:
                found.append(Meaning(term, quote[units[at].start : units[at + count - 1].end]))
                at += count
                break
        else:
            at += 1
    return found


def _unspaced(quote: str, language: str, kind: WordKind) -> list[Meaning]:
    known = {"".join(words): term for words, term in _forms(language, kind).items()}
    text, at, found = folded(quote), 0, list[Meaning]()
    longest = max(map(len, known), default=0)
    while at < len(text):
        for count in range(min(longest, len(text) - at), 0, -1):
            term = known.get(text[at : at + count])
            if term is not None:
                found.append(Meaning(term, text[at : at + count]))
                at += count
                break
        else:
            at += 1
    return found


@cache
def _forms(language: str, kind: WordKind) -> Mapping[tuple[str, ...], str]:
    """Meaning of every form of every word of a language, as folded units."""
    data: dict[str, Any] = table("descriptions")
    found: dict[tuple[str, ...], str] = {}
    for term, of_language in data["words"][kind].items():
        for word in itertools.chain.from_iterable(_inflected(w, language, data) for w in of_language.get(language, ())):
            # An elided word is a unit only beside another: `d'` of `d'acier`.
            found.setdefault(tuple(folded(u.text.translate(APOSTROPHES)) for u in units_of(word)), term)
    return found


def _inflected(word: str, language: str, data: Mapping[str, Any]) -> list[str]:
    """Forms of a word: with each ending that its last sign stands for."""
    endings: list[str] = data["endings"].get(language, {}).get(word[-1], [])
    return [word[:-1] + ending for ending in endings] if endings else [word]
