"""Words before an event that make it one which does not happen, `almost hits`, `would fall`, by language. Reviewed by hand.

`HEDGED` are sure right before the words of an event; `DOUBTED` leave open whether it comes. Neither is held elsewhere: `almost 5 cm`, `I would like`,
`all but one` say nothing of an event.
"""

from __future__ import annotations

from collections.abc import Mapping

__all__ = ["BETWEEN_EVENT", "DOUBTED", "HEDGED", "TOO_TO"]


def _listed(words: str) -> tuple[str, ...]:
    return tuple(entry.strip() for line in words.splitlines() for entry in line.split(",") if entry.strip())


HEDGED: Mapping[str, tuple[str, ...]] = {
    "en": _listed(
        "almost, nearly, all but, very nearly, as good as, would, would have, should have, could have, on the verge of, on the point of, on the brink of"
    ),
    "de": _listed("fast, beinahe, nahezu, um ein haar, würde, würden"),
    "fr": _listed("faillit, faillirent, a failli, manque de, manqua de, est sur le point de"),
    "es": _listed("casi, por poco, está a punto de, estuvo a punto de"),
    "it": _listed("quasi, per poco, sta per, sul punto di"),
    "pt": _listed("quase, por pouco, está prestes a, está quase a"),
    "nl": _listed("bijna, haast, zou, zouden, op het punt te"),
    "ru": _listed("почти, чуть было, едва ли"),
    "zh": _listed("几乎, 差一点, 快要"),
    "ja": _listed("もう少しで, あやうく, 危うく"),
}
"""Behind these stands an event that has not happened."""
DOUBTED: Mapping[str, tuple[str, ...]] = {
    "en": _listed(
        "might, could, may, should, is about to, about to, tries to, attempts to, threatens to, pretends to, seems to, is supposed to, is meant to, hardly, barely, scarcely"
    ),
    "de": _listed("kaum, könnte, könnten, droht zu, scheint zu"),
    "fr": _listed("presque, à peine, semble, pourrait, menace de"),
    "es": _listed("apenas, podría, parece, amenaza con"),
    "it": _listed("appena, potrebbe, sembra, minaccia di"),
    "pt": _listed("mal, poderia, parece, ameaça"),
    "nl": _listed("nauwelijks, zou kunnen, dreigt te, lijkt te"),
    "ru": _listed("едва, мог бы, пытается"),
}
"""Behind these stands an event that may have happened, or be meant to: the verdict warns."""
BETWEEN_EVENT: Mapping[str, frozenset[str]] = {
    "en": frozenset(
        (
            "be",
            "been",
            "being",
            "get",
            "have",
            "also",
            "even",
            "then",
            "just",
            "at",
            "once",
            "to",
            "not",
            "again",
            "soon",
            "simply",
            "always",
            "only",
            "it",
            "is",
            "are",
        )
    ),
    "de": frozenset(("auch", "sogar", "noch", "wieder", "dann", "zu")),
    "fr": frozenset(("le", "la", "les", "l", "se", "s", "y", "être", "aussi", "même")),
    "es": frozenset(("se", "lo", "la", "también", "de")),
    "it": frozenset(("si", "lo", "la", "anche", "a")),
    "pt": frozenset(("se", "o", "a", "também")),
    "nl": frozenset(("ook", "zelfs", "nog", "weer", "te")),
    "ru": frozenset(("не", "бы", "даже", "и")),
}
"""Words that may stand between such a word and the event."""
TOO_TO = r"(?i)\btoo\s+(?:slow|slowly|weak|weakly|late|far|far away|faint|gentle|gently|feeble|light|lazy|small|short)(?:\s+for\s+(?:\p{L}+\s+){1,3}?)?\s*\bto(?:\s+(?:be|ever|even))?\s*$"
"""English words right before an event that say why it does not happen; other adjectives describe: `too heavy to lift`."""
