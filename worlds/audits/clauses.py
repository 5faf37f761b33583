"""The server's own segmentation of a prompt into clauses (R155). The agent maps them; it does not choose them."""

from __future__ import annotations

import re

__all__ = ["clauses_of"]

_SENTENCE = re.compile(r"(?<=[.!?])\s+|\n+|;\s*")
_CLAUSE = re.compile(r",\s+and\s+|,\s+then\s+|,\s+while\s+|\s+and then\s+|,\s+")
_MIN_WORDS = 3


def clauses_of(prompt: str) -> dict[str, str]:
    """Clauses of a prompt by id `c1`, `c2`, ... in reading order.

    Sentences end at . ! ? ; or a line break; clauses at commas, with pieces of fewer than three words (list items,
    adjectives) kept with their neighbour.
    """
    found: list[str] = []
    for sentence in _SENTENCE.split(prompt.strip()):
        pieces: list[str] = []
        for piece in _CLAUSE.split(sentence.strip().rstrip(".!?")):
            text = piece.strip()
            if not text:
                continue
            if pieces and (len(text.split()) < _MIN_WORDS or len(pieces[-1].split()) < _MIN_WORDS):
                pieces[-1] = f"{pieces[-1]}, {text}"
            else:
                pieces.append(text)
        found += pieces
    return {f"c{i}": text for i, text in enumerate(found, start=1)}
