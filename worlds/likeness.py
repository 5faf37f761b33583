"""Likeness of two prompts: the share of words or letters that is the same, however they are written."""

from __future__ import annotations

import re
import unicodedata
from difflib import SequenceMatcher

__all__ = ["ALIKE", "likeness"]

ALIKE = 0.8
"""Own choice: least share of equal words of prompts that ask for the same; one word of five changed."""
ALIKE_LETTERS = 0.92
"""Own choice: least share of equal letters; a letter or two exchanged for look-alikes of another script."""
MAX_WORDS = 2000
"""Words that are compared; the sequence matcher takes time of their square at worst."""
MAX_LETTERS = 600
"""Letters that are compared, for the same reason."""
_UNSEEN = re.compile("[\u034f\u115f\u1160\u17b4\u17b5\u180b-\u180f\u2800\u3164\uffa0\ufe00-\ufe0f\U000e0100-\U000e01ef]")
"""Letters and marks that show nothing, beside format characters (Unicode, Default_Ignorable_Code_Point; U+2800 is blank)."""
_WORDS = re.compile(r"[぀-ヿ㐀-䶿一-鿿가-힯฀-๿]|[^\W_]+")
"""A word, or one letter of a script that writes none between spaces."""


def _words(prompt: str) -> list[str]:
    """Words without case, marks of punctuation, invisible letters and forms of compatibility (NFKC)."""
    text = unicodedata.normalize("NFKC", _UNSEEN.sub("", prompt)).casefold()
    return _WORDS.findall("".join(c for c in text if unicodedata.category(c) != "Cf"))[:MAX_WORDS]


def likeness(a: str, b: str) -> float:
    """Share of two prompts that is the same, 1 for prompts that differ in case, blanks, punctuation or invisible letters alone.

    Returns: the share of equal words in order, or that of equal letters where words differ by look-alike letters; 0 below
    `ALIKE` and `ALIKE_LETTERS`, where they ask for different things.
    """
    one, other = _words(a), _words(b)
    if one == other:
        return 1.0
    words = SequenceMatcher(None, one, other, autojunk=False).ratio()
    if words >= ALIKE:
        return words
    first, second = (" ".join(listed)[:MAX_LETTERS] for listed in (one, other))
    letters = SequenceMatcher(None, first, second, autojunk=False)
    share = letters.ratio() if letters.quick_ratio() >= ALIKE_LETTERS else 0.0
    return share if share >= ALIKE_LETTERS else 0.0
