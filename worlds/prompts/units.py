"""Units of a prompt: the least spans of text that a claim can hold.

A unit is a word by the word boundaries of Unicode, without the punctuation and blanks around it. Three things differ:

- Where a script writes no blanks between words (Han, Kana, Thai, Lao, Khmer, Burmese and their kin) a unit is a grapheme cluster, so
  that no dictionary decides what can be claimed.
- French and Italian elided words (`l'`, `qu'`, `dell'`) and English contractions (`n't`, `'s`, `'ll`) are units of their own, so that
  `l'[enclume]` can be claimed, and the negation in `isn't`.
- No boundary lies within a grapheme cluster.

References:
    Unicode Standard Annex 29, Unicode Text Segmentation.
"""

from __future__ import annotations

import itertools
import unicodedata
from dataclasses import dataclass
from functools import lru_cache

import regex

__all__ = ["APOSTROPHES", "Unit", "boundaries", "counts", "folded", "letters", "unit_at", "units_of", "word_count"]

APOSTROPHES = str.maketrans(dict.fromkeys("’‘ʼʹ＇`´′", "'"))
"""Characters that people and keyboards write for an apostrophe, all read as one: `isn´t` denies as `isn't` does."""

SIGNS = frozenset("%‰‱&@#′″‴")
"""Characters that Unicode files under punctuation and that carry meaning of their own."""
CLUSTER_SCRIPTS = r"[\p{Han}\p{Hiragana}\p{Katakana}\p{Bopomofo}\p{Thai}\p{Lao}\p{Khmer}\p{Myanmar}\p{Tai_Le}\p{New_Tai_Lue}\p{Tai_Tham}\p{Yi}ーｰ]"
"""Scripts that write no blanks between words, and the mark of long vowels that the two Kana share."""

_WORD_BOUNDARY = regex.compile(r"(?V1w)\b")
_CLUSTER = regex.compile(r"(?V1)\X")
_WITHOUT_BLANKS = regex.compile(rf"(?V1){CLUSTER_SCRIPTS}")
_ELIDED = regex.compile(
    r"(?V1i)(?<![\p{L}\p{M}'])(?:[cdjlmnst]|qu|jusqu|lorsqu|puisqu|quoiqu|un|gl|"
    r"all|dall|dell|nell|sull|coll|quell|quest|bell|sant|senz|tutt|mezz|com|dov|cos|ch|anch)'(?=\p{L})"
)
"""Reviewed by hand: words of French, Italian, Catalan and Occitan that lose their vowel before another."""
_CONTRACTED = regex.compile(r"(?V1i)(?<=\p{L})(?:n't|'(?:s|ll|re|ve|d|m))(?![\p{L}\p{M}\p{N}'])")
"""English contractions, cut as the Penn Treebank cuts them."""


@dataclass(frozen=True, slots=True)
class Unit:
    """A word, or a grapheme cluster of a script without blanks; offsets are indices of the text."""

    start: int
    end: int
    text: str


@lru_cache(maxsize=4096)
def counts(character: str) -> bool:
    """True of a letter, mark, digit, symbol or private character; false of punctuation, blanks and control characters."""
    if unicodedata.normalize("NFKC", character) in SIGNS:
        return True
    category = unicodedata.category(character)
    return category[0] not in "PZ" and category not in ("Cc", "Cf")


def letters(text: str) -> int:
    """The number of letters, marks, digits and symbols of a text."""
    return sum(map(counts, text))


def folded(text: str) -> str:
    """The text for comparison: NFKC and without case."""
    return unicodedata.normalize("NFKC", unicodedata.normalize("NFKC", text).casefold())


@lru_cache(maxsize=16)
def boundaries(text: str) -> frozenset[int]:
    """Offsets at which a span may begin or end: between units, blanks and punctuation."""
    text = text.translate(APOSTROPHES)  # of the same length
    clusters = [match.span() for match in _CLUSTER.finditer(text)]
    allowed = {start for start, _ in clusters}
    cuts = {match.start() for match in _WORD_BOUNDARY.finditer(text)}
    cuts.update(match.end() for match in _ELIDED.finditer(text))
    cuts.update(match.start() for match in _CONTRACTED.finditer(text))
    for start, end in clusters:
        if text[start] == "_" or _WITHOUT_BLANKS.search(text, start, end):
            cuts.update((start, end))
    return frozenset(cuts & allowed | {0, len(text)})


@lru_cache(maxsize=16)
def units_of(text: str) -> tuple[Unit, ...]:
    """All units of a text, in order; every letter, mark, digit and symbol lies in exactly one."""
    cuts = sorted(boundaries(text))
    spans = ((start, end, text[start:end]) for start, end in itertools.pairwise(cuts))
    return tuple(Unit(start, end, piece) for start, end, piece in spans if any(map(counts, piece)))


def unit_at(text: str, offset: int) -> Unit | None:
    """The unit that a cut at this offset would divide, or none where a span may begin or end there."""
    return next((unit for unit in units_of(text) if unit.start < offset < unit.end), None)


def word_count(text: str) -> int:
    """The number of words; a cluster of a script without blanks counts half, rounded up."""
    units = units_of(text)
    clusters = sum(1 for unit in units if _WITHOUT_BLANKS.search(unit.text))
    return len(units) - clusters + (clusters + 1) // 2
