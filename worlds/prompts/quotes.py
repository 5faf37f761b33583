"""Where the words of a quote stand in a prompt: the n-th occurrence, compared after NFC, with offsets of the prompt as it is.

Normal forms change the length of a text, so a span is carried over at the edges of grapheme clusters.
"""

from __future__ import annotations

import unicodedata
from difflib import SequenceMatcher
from functools import lru_cache
from itertools import accumulate

import regex

from ..errors import InputError
from .units import boundaries, folded, unit_at, units_of

__all__ = ["Alignment", "cut_word", "first_difference", "nth_of", "occurrence"]

AROUND = 20
"""Characters shown on either side of a difference; own choice: about three words."""
LIKENESS = 0.6
"""Least ratio of `difflib` at which a text is offered in place of a quote that is not there; the cutoff of `difflib` itself."""

_CLUSTER = regex.compile(r"(?V1)\X")


class Alignment:
    """A text beside its NFC form, with the offsets at which one can be carried over to the other."""

    def __init__(self, text: str) -> None:
        self.normal = unicodedata.normalize("NFC", text)
        self._to_normal: dict[int, int] | None = None
        self._to_text: dict[int, int] | None = None
        if self.normal != text:
            ends, pieces = zip(
                *((m.end(), unicodedata.normalize("NFC", m.group())) for m in _CLUSTER.finditer(text)), strict=True
            )
            normal_ends = tuple(accumulate(map(len, pieces)))
            if "".join(pieces) != self.normal:  # two clusters became one: the text is compared as it is
                self.normal = text
                return
            self._to_normal = {0: 0, **dict(zip(ends, normal_ends, strict=True))}
            self._to_text = {normal: offset for offset, normal in self._to_normal.items()}

    def to_normal(self, offset: int) -> int | None:
        """The offset in the NFC form, or none within a cluster."""
        return offset if self._to_normal is None else self._to_normal.get(offset)

    def to_text(self, offset: int) -> int | None:
        """The offset in the text as it is, or none within a cluster."""
        return offset if self._to_text is None else self._to_text.get(offset)


@lru_cache(maxsize=16)
def _aligned(text: str) -> Alignment:
    return Alignment(text)


@lru_cache(maxsize=256)
def _spans(prompt: str, quote: str) -> dict[int, int]:
    """Start and end in the prompt of all occurrences of the quote, in order; they may overlap."""
    aligned, wanted = _aligned(prompt), unicodedata.normalize("NFC", quote)
    found: dict[int, int] = {}
    at = aligned.normal.find(wanted)
    while wanted and at >= 0:
        start, end = aligned.to_text(at), aligned.to_text(at + len(wanted))
        if start is not None and end is not None:
            found[start] = end
        at = aligned.normal.find(wanted, at + 1)
    return found


@lru_cache(maxsize=256)
def _places(prompt: str, quote: str) -> dict[int, int]:
    return {start: nth for nth, start in enumerate(_spans(prompt, quote), 1)}


def nth_of(prompt: str, start: int, end: int) -> int:
    """Which occurrence of its own text a span of the prompt is, from 1."""
    return _places(prompt, prompt[start:end])[start]


def occurrence(prompt: str, quote: str, nth: int = 1) -> tuple[int, int]:
    """Start and end of the n-th occurrence of a quote in the prompt.

    Raises:
        InputError: the quote does not occur, or not as often, or this occurrence cuts a word in two.
    """
    spans = list(_spans(prompt, quote).items())
    if not spans:
        near = nearest(prompt, quote)
        raise InputError(
            f"{quote!r} is not in the prompt"
            + (f"; nearest is {near!r}. Quote the prompt letter by letter" if near else ". Quote words of the prompt")
        )
    whole = [k for k, span in enumerate(spans, 1) if cut_word(prompt, *span) is None]
    if not 1 <= nth <= len(spans):
        raise InputError(f"{quote!r} occurs {_times(len(spans))} in the prompt, nth is {nth}: give {_choice(whole or [1])}")
    start, end = spans[nth - 1]
    word = cut_word(prompt, start, end)
    if word is not None:
        other = f"give nth {_choice(whole)}, or " if whole else ""
        raise InputError(f"occurrence {nth} of {quote!r} cuts {word!r} in two: {other}quote whole words")
    return start, end


def cut_word(prompt: str, start: int, end: int) -> str | None:
    """The word that a span of the prompt cuts in two, or none."""
    for offset in (start, end):
        if offset not in boundaries(prompt):
            unit = unit_at(prompt, offset)
            return unit.text if unit else prompt[max(0, offset - 1) : offset + 1]
    return None


def _times(count: int) -> str:
    return {1: "once", 2: "twice"}.get(count, f"{count} times")


def _choice(numbers: list[int]) -> str:
    return str(numbers[0]) if len(numbers) == 1 else f"{', '.join(map(str, numbers[:-1]))} or {numbers[-1]}"


def nearest(prompt: str, quote: str) -> str | None:
    """The words of the prompt that are most like a quote, or none that is like it."""
    units, count = units_of(prompt), max(1, len(units_of(quote)))
    matcher = SequenceMatcher(None, "", folded(quote), autojunk=False)
    best, ratio = None, LIKENESS
    for first in range(len(units)):
        for last in range(max(first, first + count - 2), min(len(units), first + count + 1)):
            piece = prompt[units[first].start : units[last].end]
            matcher.set_seq1(folded(piece))
            if matcher.real_quick_ratio() > ratio and matcher.quick_ratio() > ratio and matcher.ratio() > ratio:
                best, ratio = piece, matcher.ratio()
    return best


def first_difference(given: str, prompt: str) -> str:
    """Both texts around the first place where they differ after NFC, for an error."""
    given, prompt = (unicodedata.normalize("NFC", text) for text in (given, prompt))
    at = next((k for k, (a, b) in enumerate(zip(given, prompt, strict=False)) if a != b), min(len(given), len(prompt)))
    return f"at character {at} the marks give {_around(given, at)}, the prompt says {_around(prompt, at)}"


def _around(text: str, at: int) -> str:
    first, last = max(0, at - AROUND), min(len(text), at + AROUND)
    shown = f"{'…' if first else ''}{text[first:last]}{'…' if last < len(text) else ''}"
    return f"{shown!a} (written out)" if not shown.isprintable() else repr(shown)
