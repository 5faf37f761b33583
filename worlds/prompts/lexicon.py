"""The English cross-check of a prompt: which words tell of events, things and properties, and what the marks of a reader leave out.

It warns and refuses nothing.
"""

from __future__ import annotations

import re
from functools import lru_cache
from itertools import groupby, pairwise
from typing import TYPE_CHECKING, NamedTuple

from . import english
from .languages import language_of
from .parts import Word, words_of
from .wordnet import known_kinds, lemmas, type_shares, verb_kinds, votes

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

__all__ = [
    "Labelled",
    "Reading",
    "Warned",
    "describes",
    "events_in",
    "is_stance",
    "kinds_meant",
    "known_kinds",
    "labelled",
    "lemmas",
    "type_shares",
    "verb_kinds",
    "warnings_for",
]

CLOSED, NUMBER, EVENT, NOUN, GUESS, UNKNOWN = 0.99, 0.95, 0.9, 0.8, 0.6, 0.5
"""Confidence by the rule that decided. Own choice; the order is that of the errors measured per rule."""

STANDS_FOR: dict[str, frozenset[str]] = {
    "torn": frozenset(("tears",)),
    "broken": frozenset(("breaks", "cracks")),
    "breach": frozenset(("breaks",)),
    "contact": frozenset(("hits", "lands", "pushes", "pulls", "rests_against", "bounces", "jams")),
    "splash_height": frozenset(("splashes",)),
    "heat_release": frozenset(("burns",)),
    "goes_out": frozenset(("stops", "crosses")),
    "gas_arrives": frozenset(("flows", "spreads", "drifts", "fills", "rises")),
    "liquid_arrives": frozenset(("flows", "pours", "fills", "overflows", "leaks", "splashes", "spreads")),
    "liquid_flux_through": frozenset(("flows", "pours", "overflows", "leaks")),
}
"""Predicates that judge an event of some kinds of the lexicon without being one of them."""


CLAUSE = 6
"""Own choice: words after a verb that are looked at for what it is with them ("sets the old wooden barn on fire")."""


_PARTICIPLE = re.compile(r"[a-z]+e[dn]", re.IGNORECASE)
_PARTICLE = re.compile(r"\s+(over|off|down|away|out)\b", re.IGNORECASE)


class Labelled(NamedTuple):
    """A word of a prompt, or some that belong together, and the type of claim that it is likely to make."""

    start: int
    end: int
    type: str
    """A type of claim, or `unknown`: a word that the lexicon does not have."""
    confidence: float
    why: str


@lru_cache(maxsize=16)
def labelled(text: str) -> tuple[Labelled, ...]:
    """Words of an English prompt that say something about the world, with their likely types; words of asking and of grammar are left out."""
    words = words_of(text)
    _join(words)
    made = []
    for _, group in groupby(words, key=lambda word: word.run):
        found = _with_particle(_labelled(list(group)), text)
        if found.type != "filler":
            made.append(found)
    return tuple(made)


def is_stance(quote: str) -> bool:
    """True of a verb that says how something is, not what happens, alone or with a preposition of place (`hangs in`); not of `sits down`."""
    verb, *behind = quote.casefold().split()
    return not english.STANCES.isdisjoint(lemmas(verb, "v")) and set(behind) <= english.RESTING


def describes(text: str, start: int, end: int) -> bool:
    """True of a past participle behind its noun that no kind of event judges: `a barrow heaped with gravel`, not `is heaped` nor `a barrow rolled off`."""
    quote = text[start:end]
    if not _PARTICIPLE.fullmatch(quote) or verb_kinds(quote):
        return False
    before = words_of(text[:start])
    return bool(before) and before[-1].of("n") > 0 and text[before[-1].end : start].isspace()


def _with_particle(found: Labelled, text: str) -> Labelled:
    """A label; an event where what looks like a noun is a verb with its particle, as in `a book on a desk tips over`."""
    behind = _PARTICLE.match(text, found.end)
    word = text[found.start : found.end].casefold()
    if (
        found.type not in ("thing", "place")
        or behind is None
        or not word.endswith("s")
        or not verb_kinds(f"{word} {behind.group(1)}")
    ):
        return found
    return Labelled(found.start, behind.end(), "event", EVENT, "verb with a particle")


def _join(words: list[Word]) -> None:
    """Words of a compound noun, or bound by a hyphen, are of one run; materials and adjectives before a noun stay by themselves."""
    for before, word in pairwise(words):
        if word.fresh:
            continue
        compound = (
            before.part == "m"
            and word.part in ("n", "m")
            and _type(before)[0] in ("thing", "event")
            and _type(word)[0] == "thing"
        )
        if word.joined or compound:
            word.run = before.run


def _labelled(run: list[Word]) -> Labelled:
    kind, confidence, why = _type(run[-1] if run[-1].part != "p" else run[0])
    if run[-1].joined and run[-1].part in ("m", "a"):
        kind = "property"
    return Labelled(run[0].start, run[-1].end, kind, confidence, why)


def _type(word: Word) -> tuple[str, float, str]:
    """Type, confidence and reason of one word."""
    if word.part == "c":
        return word.label, NUMBER if word.label in ("count", "quantity") else CLOSED, "closed class"
    if word.part == "v":
        found = votes(word.text, "v")
        if not found:
            return "event", UNKNOWN, "form of a verb that the lexicon does not have"
        moves = found.get("event", 0) + found.get("weather", 0) >= found.get("state", 0)
        return "event", EVENT if moves else GUESS, "verb of change or motion" if moves else "verb of state"
    if word.part == "u":
        return "unknown", UNKNOWN, "not in the lexicon"
    if word.part == "r":
        return "filler", GUESS, "adverb"
    if word.part == "a" or not word.of("n"):
        return "property", NOUN, "adjective"
    if word.part == "m" and (word.of("a") >= word.of("n") or word.ends_as_verb in ("ed", "ing")):
        return "property", NOUN, "modifier"
    return _noun(word)


def _noun(word: Word) -> tuple[str, float, str]:
    found = votes(word.text, "n")
    solid = found.get("thing", 0) + found.get("material", 0)
    if word.part == "m" and word.text in english.MATERIALS:
        return "property", NOUN, "material"
    order = {
        "thing": solid,
        "event": found.get("event", 0),
        "place": found.get("place", 0),
        "time": found.get("time", 0),
        "property": found.get("property", 0),
        "filler": found.get("notion", 0) + found.get("quantity", 0),
    }
    best = max(order, key=lambda kind: order[kind])
    return best, NOUN if order[best] * 2 > sum(order.values()) else GUESS, "noun"


class Reading(NamedTuple):
    """A claim as far as words tell of it: its span, its type, and the kinds of event that judge it."""

    start: int
    end: int
    type: str
    kinds: Collection[str] = ()
    """Kinds of event that judge it; empty where none does, or where that is not to be looked at."""


class Warned(NamedTuple):
    """An objection of the lexicon to a reading. It stands in the acceptance and refuses nothing."""

    start: int
    end: int
    word: str
    marked: str
    """Type of the claim that holds the word, `filler` where none does, or the kinds of event that judge it."""
    says: str


def warnings_for(readings: Sequence[Reading], text: str, language: str | None) -> tuple[Warned, ...]:
    """Events and things that no claim speaks of, and kinds of event that do not fit their verb, in the order of the text.

    Args:
        readings: the claims, in any order.
        text: the prompt.
        language: code of its language; none where it is unknown. Only English is looked at, and the one warning of others says so.
    """
    if language != "en":
        known = "its language is unknown" if language is None else f"there is no lexicon of the language {language!r}"
        return (
            Warned(
                0,
                len(text),
                "",
                "",
                f"{known}: whether its words tell of events and things that no claim speaks of was not looked at",
            ),
        )
    found = [*_left_out(readings, text), *_misfits(readings, text)]
    return tuple(sorted(found))


def _left_out(readings: Sequence[Reading], text: str) -> Iterator[Warned]:
    """Verbs of change or motion, and things, that are filler; such verbs that are only marked as things."""
    for word in labelled(text):
        over = {reading.type for reading in readings if reading.start < word.end and word.start < reading.end}
        quote = text[word.start : word.end]
        posture = "place" in over and bool(english.POSTURES & set(lemmas(quote.split()[0], "v")))
        told = posture or (over == {"property"} and describes(text, word.start, word.end))
        if word.type == "event" and word.confidence >= EVENT and over <= {"thing", "place", "property"} and not told:
            yield Warned(
                word.start,
                word.end,
                quote,
                ", ".join(sorted(over)) or "filler",
                "a verb of change or motion, and no claim of an event takes it up: claim it with a beat, or look whether it says nothing of the world",
            )
        elif word.type == "thing" and word.confidence >= NOUN and not over:
            yield Warned(
                word.start,
                word.end,
                quote,
                "filler",
                "a noun for a thing, and no claim takes it up: claim it with an entity, or look whether it says nothing of the world",
            )


def _misfits(readings: Sequence[Reading], text: str) -> Iterator[Warned]:
    """Events whose verb is of other kinds than those that judge them, or of none that is known."""
    for reading in readings:
        if reading.type != "event" or not reading.kinds:
            continue
        quote = text[reading.start : reading.end]
        verb = _verb_of(reading, text)
        kinds = verb_kinds(verb, _after(reading, verb, text)) if verb else None
        judged = "an event judged as " + ", ".join(sorted(reading.kinds))
        if kinds is None:
            yield Warned(
                reading.start,
                reading.end,
                verb or quote,
                judged,
                "the lexicon has no kind of event for this verb: look whether that is what it says",
            )
        elif not kinds & kinds_meant(reading.kinds):
            others = ", ".join(sorted(kinds))
            says = f"the verb tells of {others}: name a beat of such a kind, or look whether it says what is judged"
            yield Warned(reading.start, reading.end, verb, judged, says)


def events_in(text: str) -> Iterator[tuple[str, frozenset[str]]]:
    """Verbs of change or motion of an English text in their order, each with the kinds of event that fit it; none where no kind is known."""
    for word in labelled(text) if language_of(text) == "en" else ():
        if word.type == "event":
            quote = text[word.start : word.end]
            yield quote, verb_kinds(quote, _after(Reading(word.start, word.end, "event"), quote, text)) or frozenset()


def kinds_meant(kinds: Collection[str]) -> frozenset[str]:
    """Kinds of the lexicon that predicates judge; all of them where one is not known to it, such as a plugin's."""
    known = known_kinds()
    if any(kind not in known and kind not in STANDS_FOR for kind in kinds):
        return known
    return frozenset().union(*(STANDS_FOR.get(kind, {kind}) for kind in kinds))


def _after(reading: Reading, verb: str, text: str) -> list[str]:
    """Words of the clause that follow a verb, at most `CLAUSE`."""
    start = max(text.find(verb, reading.start), reading.start) + len(verb)
    rest = text[start:]
    ends = [k for k in (rest.find(mark) for mark in ",;:.!?") if k >= 0]
    return [word.text for word in words_of(rest[: min(ends, default=len(rest))])][:CLAUSE]


def _verb_of(reading: Reading, text: str) -> str:
    """The verb of an event with its particle; its first word that is one where the labels find none, or nothing."""
    for word in labelled(text):
        if word.type == "event" and word.start < reading.end and reading.start < word.end:
            return text[word.start : word.end]
    words = [word for word in words_of(text) if reading.start <= word.start < reading.end]
    # `stops rolling` has an auxiliary, `the ball stops` a verb of its own.
    own = next((word.text for word in words if word.of("v") and word.part != "c"), "")
    return own or next((word.text for word in words if verb_kinds(word.text)), "")
