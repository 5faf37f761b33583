"""Words for how many that no table of numbers has, by language: exact ones, and the least that an indefinite one says. Reviewed by hand.

The least of indefinite words is own choice: what a reader would still call so. `Several` is more than two in English dictionaries, its relatives
elsewhere more than one; `dozens`, `hundreds` are two of them; `many` begins where one glance no longer counts, at five.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import NamedTuple

from .units import folded, units_of

__all__ = ["BOTH", "COLLECTIVE", "MULTIPLE", "OF_ONE", "Amount", "amount_phrases"]


class Amount(NamedTuple):
    """The number that a word says."""

    least: int
    exact: bool


_EXACT: Mapping[str, Mapping[int, str]] = {
    "en": {
        2: "pair, pair of, couple of, duo, duo of, brace of",
        3: "trio, trio of, threesome",
        4: "quartet, quartet of, foursome",
        5: "quintet",
        6: "sextet",
        8: "octet",
        20: "a score of",
        40: "two score",
    },
    "de": {2: "duo", 3: "trio", 4: "quartett", 5: "quintett"},
    "fr": {2: "une paire de, une paire d', duo", 3: "trio", 4: "quatuor"},
    "es": {2: "un par de, una pareja de, dúo", 3: "trío", 4: "cuarteto"},
    "it": {2: "un paio di, una coppia di, duo", 3: "trio, terzetto", 4: "quartetto"},
    "pt": {2: "um par de, duo", 3: "trio", 4: "quarteto"},
    "nl": {2: "duo", 3: "trio, drietal", 4: "kwartet, viertal"},
    "ru": {3: "трио", 4: "квартет"},
    "zh": {2: "一对, 一双"},
    "ja": {2: "一対の"},
}
_LEAST: Mapping[str, Mapping[int, str]] = {
    "en": {
        2: "a few, multiple, various",
        3: "several, a handful of, handful of, a number of, a bunch of",
        5: "many, numerous, lots of, plenty of, countless, innumerable, loads of",
        11: "umpteen",
        24: "dozens of, dozens",
        40: "scores of",
        200: "hundreds of, hundreds",
        2000: "thousands of, thousands",
    },
    "de": {
        2: "ein paar, einige, einigen, mehrere, mehreren, mehrerer",
        3: "etliche, etlichen, eine handvoll",
        5: "viele, vielen, zahlreiche, zahlreichen, unzählige, jede menge",
        11: "zig",
        24: "dutzende, dutzenden",
        200: "hunderte, hunderten",
        2000: "tausende, tausenden",
    },
    "fr": {
        2: "plusieurs, quelques",
        3: "une poignée de, une poignée d'",
        5: "de nombreux, de nombreuses, beaucoup de, beaucoup d'",
        20: "des dizaines de, des dizaines d'",
        24: "des douzaines de",
        200: "des centaines de",
        2000: "des milliers de",
    },
    "es": {
        2: "varios, varias, algunos, algunas, unos cuantos, unas cuantas",
        3: "un puñado de",
        5: "muchos, muchas, numerosos, numerosas",
        20: "decenas de",
        24: "docenas de",
        200: "cientos de, centenares de",
        2000: "miles de",
    },
    "it": {
        2: "alcuni, alcune",
        3: "parecchi, parecchie, una manciata di",
        5: "molti, molte, numerosi, numerose",
        20: "decine di",
        24: "dozzine di",
        200: "centinaia di",
        2000: "migliaia di",
    },
    "pt": {
        2: "vários, várias, alguns, algumas",
        3: "um punhado de",
        5: "muitos, muitas, numerosos, numerosas",
        20: "dezenas de",
        24: "dúzias de",
        200: "centenas de",
        2000: "milhares de",
    },
    "nl": {
        2: "een paar, enkele, meerdere, enige",
        3: "verscheidene, een handvol",
        5: "vele, talrijke, tal van",
        20: "tientallen",
        24: "dozijnen",
        200: "honderden",
        2000: "duizenden",
    },
    "ru": {
        2: "пара, пару, несколько",
        3: "горстка, горстку",
        5: "много, множество, многочисленные",
        20: "десятки",
        24: "дюжины",
        200: "сотни",
        2000: "тысячи",
    },
    "zh": {
        2: "几个, 若干, 多个, 几块, 几只",
        3: "好几个, 好几",
        5: "许多, 很多, 众多",
        20: "数十, 几十",
        200: "数百, 几百, 成百",
        2000: "数千, 几千",
    },
    "ja": {
        2: "複数の, いくつかの, 数個の",
        3: "いくつもの",
        5: "たくさんの, 多くの, 多数の",
        20: "数十",
        200: "数百",
        2000: "数千",
    },
}
BOTH: Mapping[str, frozenset[str]] = {
    "en": frozenset(("both",)),
    "de": frozenset(("beide", "beiden", "beider")),
    "es": frozenset(("ambos", "ambas")),
    "it": frozenset(("entrambi", "entrambe")),
    "pt": frozenset(("ambos", "ambas")),
    "nl": frozenset(("beide",)),
    "ru": frozenset(("оба", "обе", "обоих", "обеих")),
}
"""Words for two that were named already, or are named behind."""
MULTIPLE: Mapping[str, frozenset[str]] = {"en": frozenset(("triple", "treble", "quadruple"))}
"""Words that may be of a thing or of what it is like, `a triple jump`: the verdict warns."""
COLLECTIVE: Mapping[str, frozenset[str]] = {
    "en": frozenset(
        ("crowd", "swarm", "flock", "herd", "horde", "host", "army", "row", "stack", "pile", "heap", "bunch", "group", "set")
    )
}
"""Words for many at once that may be one body, `a stack of hay`: the verdict warns where one solid body of one part stands for them."""
OF_ONE: Mapping[str, frozenset[str]] = {
    "en": frozenset(("scissors", "shears", "trousers", "tongs", "pliers", "pincers", "tweezers", "glasses", "spectacles", "goggles", "binoculars", "jeans", "shorts", "pants", "tights",
                     "leggings", "headphones", "compasses", "scales", "bellows", "pyjamas", "pajamas", "overalls", "clippers", "nippers", "callipers", "calipers", "forceps", "knickers")),
    "fr": frozenset(("ciseaux", "lunettes", "tenailles", "pinces", "jumelles")),
    "es": frozenset(("tijeras", "gafas", "pantalones", "pinzas", "tenazas", "alicates", "prismáticos")),
    "it": frozenset(("forbici", "occhiali", "pantaloni", "pinze", "tenaglie", "mutande")),
    "pt": frozenset(("óculos", "calças", "tesouras", "binóculos")),
}  # fmt: skip
"""Nouns of which a pair is one thing."""


@cache
def amount_phrases(language: str | None) -> Mapping[tuple[str, ...], Amount]:
    """Amounts by their words, folded as units; of an elided word that is a unit of its own too."""
    found: dict[tuple[str, ...], Amount] = {}
    for exact, lists in ((True, _EXACT), (False, _LEAST)):
        for number, phrases in lists.get(language or "", {}).items():
            for phrase in phrases.split(","):
                key = (phrase.strip(),) if language in ("zh", "ja") else tuple(folded(u.text) for u in units_of(phrase.strip()))
                found[key] = Amount(number, exact)
    return found
