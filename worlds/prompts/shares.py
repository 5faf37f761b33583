"""Words behind a number that give it to each of two sides: `four doors on each side` are eight doors."""

from __future__ import annotations

import regex

__all__ = ["sides_behind"]

EACH_SIDE: dict[str, regex.Pattern[str]] = {
    "en": regex.compile(r"\b(?:on|at|along|to) (?:each|either) (?:side|end|hand|wall)\b"),
    "de": regex.compile(r"\b(?:auf|an) (?:jeder (?:seite|wand)|jedem ende)\b"),
}
"""By language. `on both sides` is left out: there the number may be the sum. Reviewed by hand."""
STOP = regex.compile(r"[.;:!?…,()\n]|[—–]")


def sides_behind(prompt: str, end: int, language: str | None) -> int:
    """Sides to each of which a number that ends at `end` is given, by the words behind it in its clause; 1 where none say so."""
    pattern = EACH_SIDE.get(language or "")
    stop = STOP.search(prompt, end)
    clause = prompt[end : stop.start() if stop else len(prompt)].casefold()
    return 2 if pattern is not None and pattern.search(clause) else 1
