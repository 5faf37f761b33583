"""Which language a prompt is written in, and which of its words cannot be filler.

A language is told by its script and by its function words, sentence by sentence; letters that are common in one language help where
function words are few. A text in two languages, or in none that is known, is of none. Numbers, negations and words of order are held only
in a language whose lists are reviewed.
"""

from __future__ import annotations

import itertools
from bisect import bisect_left, bisect_right
from collections import Counter
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Literal

import regex

from .function_words import FUNCTION_WORDS
from .held_lists import (
    ALONE,
    ASIDES,
    FREE,
    HAN_HELD,
    INFINITIVES,
    KEPT_FROM,
    NADA_OF,
    NEGATIONS,
    ONLY_WITH,
    ORDERS,
    UNLESS_BEFORE,
    UNLESS_BEHIND,
)
from .held_numbers import han_numbers, number_spans
from .numbers import hedge_spans
from .unit_articles import article_amounts
from .units import APOSTROPHES, Unit, boundaries, folded, units_of
from .wordnet import known

__all__ = ["REVIEWED", "Held", "HeldKind", "function_words", "held_words", "language_of"]

HeldKind = Literal["number", "negation", "order"]

REVIEWED = ("en", "de", "fr", "es", "it", "pt", "nl", "ru", "zh", "ja")
"""Languages whose negations and words of order are listed."""
LATIN = ("en", "de", "fr", "es", "it", "pt", "nl")
ENOUGH = 0.14
"""Least score for each word of a sentence, where a word of one language alone scores 1; own choice: every seventh word."""
AHEAD = 1.25
"""Least ratio of the best language to the next; own choice."""
HINT = 0.3
"""Score of a word whose letters are of one language alone; own choice: three such weigh one function word."""
MANY = 6
"""Words from which on two different listed ones are asked for; own choice: one may be a chance."""
SAME = 0.8
"""Least share of the clear words that the language of a whole text has; below, the text is mixed. Own choice."""
FOREIGN = 0.1
"""Share of words with letters of no listed language from which on a sentence is in another; own choice: names stay below."""

HINTS = {
    "en": r"ing$|ght|^wh|^th|sh|oo|ck(?:s|ed|ing)?$|[^aeiou]ly$|[^aeiou]ed$|ea|ow",
    "de": r"sch|ungen?$|[äöüß]|cht|^ge.+t$|eit(?:en)?$|tz|pf|[^aeiou]en$|ein",
    "nl": r"ij|aa|uu|oe|sch|tjes?$|gt$|ui|[^aeiou]en$|cht|oo|ee",
    "fr": r"eau|eux$|[èêçùœ]|ment$|oi|ille|ais$|aient$|que$|ées?$|ou",
    "es": r"ñ|ción$|[áíóú]|ando$|iendo$|ad[oa]s?$|ll|ez$|ue|[aeo]s$",
    "it": r"zion|gli|cch|tt|zz|an?no$|on?o$|ando$|endo$|at[oa]$|ch[ie]|[àèìòù]$|gg",
    "pt": r"[ãõ]|ção$|nh|lh|ç|[aei]ndo$|ad[oa]s?$|[^aeiou]m$|[aeo]s$|ê|eir|ei",
}
"""Letters that are common in a language and rare in most of the others."""

_HINTS = {language: regex.compile(pattern) for language, pattern in HINTS.items()}
_SENTENCE = regex.compile(r"(?<=[.!?…;।؟])\s+|(?<=[。！？；])\s*|\n+")
_FOREIGN_LATIN = regex.compile(r"(?V1)[\p{Latin}--[a-zàáâãäåæçèéêëìíîïñòóôõöœùúûüßÿ]]")
_SCRIPTS = {
    name: regex.compile(rf"(?V1)\p{{Script={name}}}")
    for name in ("Latin", "Cyrillic", "Han", "Hiragana", "Katakana", "Arabic", "Devanagari")
}
_NOT_RUSSIAN = regex.compile("[іїєґўђјљњћџѓќѕәғқңөұүһ]|ъ(?![еёюя])")
_NOT_ARABIC = regex.compile("[پچژگکیےٹڈڑں]")
_LETTER = regex.compile(r"\p{L}")
_JOINED = regex.compile(r"[\s\-'’‘ʼʹ＇`´′]*")


@dataclass(frozen=True, slots=True)
class Held:
    """Words that cannot be filler; offsets are those of the prompt."""

    start: int
    end: int
    kind: HeldKind


def function_words(language: str) -> frozenset[str]:
    """Words of a language that only bind others, folded; none where the language is not listed."""
    return FUNCTION_WORDS.get(language, frozenset())


@lru_cache(maxsize=16)
def language_of(text: str) -> str | None:
    """The language of a text (`en de fr es it pt nl ru zh ja`, also `ar hi`), or none where it is mixed or unknown."""
    clear: Counter[str] = Counter()
    for sentence in _SENTENCE.split(text):
        words = [folded(unit.text.translate(APOSTROPHES)) for unit in units_of(sentence) if _LETTER.search(unit.text)]
        language = _language(sentence, words)
        if language:
            clear[language] += len(words)
    words = [folded(unit.text.translate(APOSTROPHES)) for unit in units_of(text) if _LETTER.search(unit.text)]
    if clear:
        language, words_of_it = clear.most_common(1)[0]
        found = language if words_of_it >= SAME * clear.total() else None
    else:
        found = _language(text, words)
    if found == "en" or (found is not None and any(word in _listed(found) - _listed("en") for word in words if found in LATIN)):
        return found
    return "en" if found in (None, *LATIN) and _all_english(words) else found


def _all_english(words: list[str]) -> bool:
    """True where all words that say something are English ones, as in prompts too short for function words to tell."""
    own = [word for word in words if word not in _listed("en") and len(word) > 2]
    return len(own) > 1 and any(word in _listed("en") for word in words) and all(map(known, own))


def _language(sentence: str, words: list[str]) -> str | None:
    """The language of one sentence by its script and words."""
    counts = {name: len(pattern.findall(sentence)) for name, pattern in _SCRIPTS.items()}
    counts["Kana"] = counts.pop("Hiragana") + counts.pop("Katakana")
    if counts["Kana"] and counts["Kana"] + counts["Han"] >= counts["Latin"]:
        return "ja"
    script = max(counts, key=lambda name: counts[name])
    if not counts[script]:
        return None
    if script == "Latin":
        return _latin(words)
    known = {"Cyrillic": ("ru", _NOT_RUSSIAN), "Arabic": ("ar", _NOT_ARABIC), "Devanagari": ("hi", None), "Han": ("zh", None)}
    language, foreign = known[script]
    if foreign is not None and foreign.search(sentence.casefold()):
        return None
    hits = any(word in FUNCTION_WORDS[language] or word[:1] in "وبلف" for word in words)
    return language if hits or language == "zh" else None


def _latin(words: list[str]) -> str | None:
    if sum(1 for word in words if _FOREIGN_LATIN.search(word)) > FOREIGN * len(words):
        return None
    scores = dict.fromkeys(LATIN, 0.0)
    hits: dict[str, set[str]] = {language: set() for language in LATIN}
    for word in words:
        listed = [language for language in LATIN if word in _listed(language)]
        hinted = [] if listed else [language for language in LATIN if _HINTS[language].search(word)]
        for language in listed:
            scores[language] += 1 / len(listed)
            hits[language].add(word)
        for language in hinted:
            scores[language] += HINT / len(hinted)
    best, second = sorted(scores, key=lambda language: -scores[language])[:2]
    wanted = 1 if len(words) < MANY else 2
    enough = len(hits[best]) >= wanted and scores[best] >= ENOUGH * len(words) and scores[best] >= AHEAD * scores[second]
    return best if enough else None


@cache
def _listed(language: str) -> frozenset[str]:
    """Function words, negations and words of order that are one word."""
    more = (*NEGATIONS[language], *ORDERS[language])
    return FUNCTION_WORDS[language] | {word for word in more if " " not in word}


def held_words(text: str, language: str | None) -> tuple[Held, ...]:
    """Numbers, negations and words of order of a text, in order and disjoint; none in a language without reviewed lists."""
    if language not in REVIEWED:
        return ()
    found = _han_held(text, language) if language in HAN_HELD else _spaced_held(text, language)
    aside = [
        match.span() for match in regex.finditer(ASIDES.get(language, r"(?!)"), text.translate(APOSTROPHES), regex.IGNORECASE)
    ]
    # `no more than` gives the most of a quantity; the number behind it is held.
    bounds = hedge_spans(text)
    meant = [
        held
        for held in found
        if not any(start <= held.start < end for start, end in aside)
        and not (held.kind == "negation" and any(start <= held.start and held.end <= end for start, end in bounds))
    ]
    return tuple(sorted(meant, key=lambda held: held.start))


def _han_held(text: str, language: str) -> list[Held]:
    found: list[Held] = []
    for kind, (words, other) in HAN_HELD[language].items():
        passed = {at for match in regex.finditer(other, text) for at in range(*match.span())}
        spans = [match.span() for match in regex.finditer(words, text) if match.start() not in passed]
        found += [Held(start, end, "negation" if kind == "negation" else "order") for start, end in spans]
    taken = {at for held in found for at in range(held.start, held.end)}
    edges = sorted(boundaries(text))
    numbers = [(start, end) for start, end in han_numbers(text, language) if start not in taken]
    whole = {
        (edges[bisect_right(edges, start) - 1], edges[bisect_left(edges, end)]) for start, end in numbers
    }  # `3kg` is one unit
    return found + [Held(start, end, "number") for start, end in whole]


@cache
def _phrases(language: str) -> dict[tuple[str, ...], HeldKind | Literal["free"]]:
    """Entries as folded units."""
    found: dict[tuple[str, ...], HeldKind | Literal["free"]] = {}
    kinds: tuple[tuple[HeldKind | Literal["free"], dict[str, tuple[str, ...]]], ...] = (
        ("order", ORDERS),
        ("negation", NEGATIONS),
        ("free", FREE),
    )
    for kind, lists in kinds:
        for entry in lists.get(language, ()):
            # An elided word or contraction is a unit only beside another: `n'` of `n'a`, `n't` of `isn't`.
            found[(entry,) if entry in ("n'", "n't", "nessun'") else tuple(folded(unit.text) for unit in units_of(entry))] = kind
    return found


def _spaced_held(text: str, language: str) -> list[Held]:
    units, phrases = units_of(text), _phrases(language)
    words = [folded(unit.text.translate(APOSTROPHES)) for unit in units]
    longest = max(map(len, phrases))
    found: list[Held] = []
    at = 0
    while at < len(units):
        for count in range(min(longest, len(units) - at), 0, -1):
            kind = phrases.get(tuple(words[at : at + count]))
            if kind and _adjacent(text, units[at : at + count]) and _meant(text, units, words, (at, at + count), language):
                if kind != "free":
                    found.append(Held(units[at].start, units[at + count - 1].end, kind))
                at += count
                break
        else:
            at += 1
    plain = text.translate(APOSTROPHES)
    kept = [m.span("held") for m in regex.finditer(KEPT_FROM.get(language, r"(?!)(?P<held>)"), plain, regex.IGNORECASE)]
    found += [Held(*span, "negation") for span in kept if not any(h.start < span[1] and span[0] < h.end for h in found)]
    taken = {held.start for held in found}
    numbers = number_spans(text, units, words, language)
    found += [Held(start, end, kind) for start, end, kind in numbers if not any(start <= at < end for at in taken)]
    amounts = [Held(*span, "number") for span in article_amounts(plain, language)]
    return found + [a for a in amounts if not any(h.start < a.end and a.start < h.end for h in found)]


def _adjacent(text: str, units: tuple[Unit, ...]) -> bool:
    return all(_JOINED.fullmatch(text, a.end, b.start) for a, b in itertools.pairwise(units))


def _meant(text: str, units: tuple[Unit, ...], words: list[str], span: tuple[int, int], language: str) -> bool:
    """True where words that are negation or order only now and then are it here."""
    first, last = span
    word = " ".join(words[first:last])
    behind = words[first - 1] if first and _adjacent(text, units[first - 1 : first + 1]) else None
    after = words[last] if last < len(words) and _adjacent(text, units[last - 1 : last + 1]) else None
    if behind in UNLESS_BEHIND.get(language, {}).get(word, ()) or after in UNLESS_BEFORE.get(language, {}).get(word, ()):
        return False
    if word in ALONE.get(language, ()) and after is not None:
        return False
    form = INFINITIVES.get(language, {}).get(word)
    if form is not None and not regex.match(form, after or ""):
        return False
    if language == "de" and word == "ehe" and units[first].text != "ehe":  # the noun
        return False
    if language == "nl" and word == "dan" and behind is not None and len(behind) > 4 and behind.endswith("er"):  # than
        return False
    where, others = ONLY_WITH.get(language, {}).get(word, (None, ()))
    if where == "before":
        return after in others
    begin = text.rfind(".", 0, units[first].start)
    if where == "anywhere":
        near = [other for unit, other in zip(units, words, strict=True) if unit.start > begin]
        return any(other in near for other in others)
    if where == "earlier":
        near = [words[k] for k in range(first) if units[k].start > begin]
        return any(other in near for other in others) or after in NADA_OF
    return True
