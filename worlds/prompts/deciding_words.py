"""Words that decide by themselves what a sentence says, and that no type of claim judges: by language and by what they do. Reviewed by hand."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

__all__ = ["ARTICLES", "DECIDING", "NOT_ALL", "DecidingKind"]

DecidingKind = Literal["nearly", "another", "all", "only", "having", "exactly", "direction"]


def _listed(words: str) -> tuple[str, ...]:
    return tuple(entry.strip() for line in words.splitlines() for entry in line.split(",") if entry.strip())


DECIDING: Mapping[str, Mapping[DecidingKind, tuple[str, ...]]] = {
    "en": {
        "nearly": _listed("nearly, almost, just about, all but"),
        "another": _listed("another, yet another, one more"),
        "all": _listed("every, each, all, all of, every one of, each of"),
        "only": _listed("only, solely, nothing but"),
        "having": _listed("having, after having"),
        "exactly": _listed("exactly, precisely"),
        "direction": _listed("""to the left, to the right, leftwards, rightwards, leftward, rightward, left to right, right to left, forwards, backwards, forward
            backward, sideways, clockwise, anticlockwise, counterclockwise, northwards, southwards, eastwards, westwards, northward, southward, eastward
            westward, to the north, to the south, to the east, to the west"""),
    },
    "de": {
        "nearly": _listed("beinahe, nahezu, fast, um ein haar"),
        "another": _listed("""ein anderer, eine andere, ein anderes, einen anderen, einem anderen, einer anderen, ein weiterer, eine weitere, ein weiteres
            einen weiteren, noch ein, noch eine, noch einen"""),
        "all": _listed("jeder, jede, jedes, jeden, jedem, alle, allen, sämtliche"),
        "only": _listed("nur, lediglich, ausschließlich"),
        "exactly": _listed("genau, exakt"),
        "direction": _listed("""nach links, nach rechts, von links nach rechts, von rechts nach links, vorwärts, rückwärts, seitwärts, im uhrzeigersinn
            gegen den uhrzeigersinn, nach norden, nach süden, nach osten, nach westen, nordwärts, südwärts, ostwärts, westwärts"""),
    },
}  # fmt: skip
NOT_ALL: Mapping[str, frozenset[str]] = {
    "en": frozenset(("at", "after", "of", "first", "above", "not")),
    "de": frozenset(("vor", "nicht")),
}
"""Words right before which `all` and `only` mean something else: `at all`, `after all`, `not only`."""
ARTICLES: Mapping[str, frozenset[str]] = {
    "en": frozenset(
        ["the", "a", "an", "of", "its", "their", "his", "her", "this", "that", "these", "those", "other", "single", "one"]
    ),
    "de": frozenset(
        [
            "der",
            "die",
            "das",
            "den",
            "dem",
            "des",
            "ein",
            "eine",
            "einen",
            "einem",
            "einer",
            "sein",
            "seine",
            "ihre",
            "dieser",
            "diese",
            "dieses",
            "von",
        ]
    ),
}
"""Words that may stand between such a word and the thing that it is said of."""
