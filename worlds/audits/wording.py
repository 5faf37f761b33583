"""Words of a clause of the prompt and what they ask for: events, ways, numbers, names (R155). English word lists.

They are heuristics that err towards asking: `static_because` of a clause is the recorded way out.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from ..predicate_base import Tells
from ..predicates.registry import PREDICATES

__all__ = [
    "EVENTS",
    "TRANSITIVE",
    "event_words",
    "goals_in",
    "has_pronoun",
    "lasting_words",
    "names_in",
    "numbers_in",
    "objects_in",
    "piece_words",
    "telling",
    "walks",
    "way_words",
]

EVENTS: Mapping[str, Tells | None] = {
    **dict.fromkeys(("collapse", "crumble", "drop", "fall", "tip", "topple", "tumble"), "falls"),
    **dict.fromkeys(("fly", "roll", "slide", "slip", "swing", "throw"), "flies"),
    **dict.fromkeys(("bounce", "collide", "crash", "hit", "knock", "push", "smash", "strike"), "blows"),
    **dict.fromkeys(("crack", "shatter", "splinter"), "cracks"),
    **dict.fromkeys(("rip", "tear"), "tears"),
    **dict.fromkeys(("flap", "flutter"), "flaps"),
    **dict.fromkeys(
        ("break", "burst", "drip", "explode", "flood", "leak", "overflow", "pour", "slosh", "snap", "spill", "splash", "float")
    ),
}
"""Verbs that tell an event, and the family of predicates that can tell it; None: any kind of event."""
TRANSITIVE = frozenset({"hit", "knock", "push", "smash", "strike", "throw"})
"""Of these, those by which one thing does something to another."""
_FORMS = {
    "break": "broke|broken", "fall": "fell|fallen", "fly": "flies|flew|flown", "hit": "hits|hit", "slide": "slid", "strike": "struck",
    "tear": "tore|torn", "rip": "ripped", "flap": "flapped", "snap": "snapped", "swing": "swung", "drip": "dripped", "spill": "spilt|spilled", "throw": "threw|thrown", "drop": "dropped", "slip": "slipped", "tip": "tipped",
}  # fmt: skip
_NOUNS = re.compile(
    r"\b(?:a|an|the|some|two|three|several|of|its|his|her|their|no|each|every|playground|rain|water)\s+$", re.IGNORECASE
)
"""Words before such a word when it is a noun ("a slide", "drops of water")."""
_WAYS = re.compile(r"\b(?:walks?|walkable|walking|route|doorway|corridor|stairs|staircase|passage|passageway)\b", re.IGNORECASE)
_WALKS = re.compile(
    r"\b(?:walks?|walkable|walking|stairs|staircase|person|people|man|men|woman|women|someone|anyone|one can|visitors?)\b",
    re.IGNORECASE,
)
_LASTING = re.compile(
    r"\b(?:stays?|remains?|keeps? (?:standing|upright|still|its)|never|without (?:falling|spilling|breaking))\b",
    re.IGNORECASE,
)
_PIECES = re.compile(
    r"\b(?:shatter(?:s|ed)?|splinter(?:s|ed)?|(?:in|into|to) (?:(?!two\b)[a-z]+ )?(?:bits|fragments|pieces|rubble|shards|splinters))\b",
    re.IGNORECASE,
)
_GOAL = re.compile(r"\b(?:into|onto|on to)\b", re.IGNORECASE)
_PRONOUN = re.compile(r"\b(?:it|they|them|this|that|these|those|one|everything|something)\b", re.IGNORECASE)
_WORD = re.compile(r"[a-z]{3,}")
_FUNCTION_WORDS = frozenset(
    [
        "the",
        "and",
        "its",
        "his",
        "her",
        "their",
        "our",
        "for",
        "with",
        "from",
        "into",
        "onto",
        "over",
        "under",
        "out",
        "off",
        "not",
        "all",
        "any",
        "each",
        "every",
        "both",
        "then",
        "than",
        "that",
        "this",
        "these",
        "those",
        "one",
        "two",
        "three",
        "four",
        "five",
        "six",
        "seven",
        "eight",
        "nine",
        "ten",
        "first",
        "second",
        "third",
        "last",
        "next",
        "other",
        "another",
        "some",
        "row",
        "stack",
        "pile",
        "line",
        "piece",
        "number",
        "set",
        "small",
        "large",
        "big",
        "tall",
        "short",
        "long",
        "thin",
        "thick",
        "heavy",
        "light",
        "red",
        "green",
        "blue",
        "white",
        "black",
        "yellow",
        "wooden",
        "steel",
        "glass",
        "metal",
        "stone",
    ]
)
"""Words that name nothing by themselves."""
_BEYOND = re.compile(
    r"\b(?:against|and|at|before|behind|beside|by|from|in|into|next|off|on|onto|so|through|to|towards?|under|until|while|with)\b",
    re.IGNORECASE,
)
"""Words that end the object of a verb."""
_COUNTS = ("two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve", "thirteen", "fourteen", "fifteen",
           "sixteen", "seventeen", "eighteen", "nineteen", "twenty")  # fmt: skip
_UNIT = r"(?:[cmk]?m|[mk]?g|kilos?|[cmk]?l|m?s|min|h|hz|n|j|w|pa|k|rad|deg|degrees?|percent|times|tons?|tonnes?|gram(?:me)?s?|kilogram(?:me)?s?|lit(?:er|re)s?|(?:centi|milli|kilo)?met(?:er|re)s?|inch(?:es)?|f(?:oo|ee)t|seconds?|minutes?|hours?|days?|years?)"
_NUMBER = re.compile(
    rf"(?<![.\d])\b({'|'.join(_COUNTS)}|[1-9]\d{{0,3}})\s+(?!{_UNIT}\b)((?:[a-z]+[ -]){{0,2}}[a-z]+)", re.IGNORECASE
)
"""A number and up to three words that it may count; a number of units counts nothing."""


def _verb(word: str) -> str:
    stem = word[:-1] if word.endswith("e") else word
    plural = f"{word}es" if word.endswith(("s", "sh", "ch")) else f"{word}s"
    return f"{plural}|{stem}ed|{word}|{_FORMS[word]}" if word in _FORMS else f"{plural}|{stem}ed|{word}"


_EVENT = re.compile("|".join(rf"(?P<{w}>\b(?:{_verb(w)})\b)" for w in EVENTS), re.IGNORECASE)


def telling(verb: str) -> frozenset[str] | None:
    """Kinds of predicates that can tell a verb of `EVENTS`; None: any kind of event."""
    family = EVENTS[verb]
    return None if family is None else frozenset(kind for kind, info in PREDICATES.items() if family in info.tells)


def event_words(text: str) -> dict[str, str]:
    """Words of a clause that tell an event: the verb by the word as it stands there."""
    return {m.group().lower(): str(m.lastgroup) for m in _EVENT.finditer(text) if not _NOUNS.search(text[: m.start()])}


def objects_in(text: str) -> tuple[str, ...]:
    """Words of what a transitive verb acts on, singular: from the verb to the next preposition or conjunction."""
    found: list[str] = []
    for m in _EVENT.finditer(text):
        if m.lastgroup in TRANSITIVE and not _NOUNS.search(text[: m.start()]):
            found += names_in(_BEYOND.split(text[m.end() :], maxsplit=1)[0])
    return tuple(dict.fromkeys(found))


def goals_in(text: str) -> tuple[tuple[str, ...], ...]:
    """Where an event of the clause leads: the words, singular, before which `into` or `onto` stands after the first such verb."""
    verb = next((m for m in _EVENT.finditer(text) if not _NOUNS.search(text[: m.start()])), None)
    if verb is None:
        return ()
    phrases = (re.split(r"[,:]", text[m.end() :])[0] for m in _GOAL.finditer(text, verb.end()))
    return tuple(names_in(_BEYOND.split(phrase, maxsplit=1)[0]) for phrase in phrases)


def piece_words(text: str) -> tuple[str, ...]:
    """Words of a clause that tell of something in pieces."""
    return tuple(m.group().lower() for m in _PIECES.finditer(text))


def way_words(text: str) -> tuple[str, ...]:
    """Words of a clause that tell of a way to go."""
    return tuple(m.group().lower() for m in _WAYS.finditer(text))


def walks(text: str) -> bool:
    """Whether people take the way that a clause tells of."""
    return bool(_WALKS.search(text))


def lasting_words(text: str) -> tuple[str, ...]:
    """Words of a clause that tell of something that lasts."""
    return tuple(m.group().lower() for m in _LASTING.finditer(text))


def has_pronoun(text: str) -> bool:
    """Whether a clause speaks of something without naming it."""
    return bool(_PRONOUN.search(text))


def names_in(text: str) -> tuple[str, ...]:
    """Words of a text that may name something, singular, in order of appearance."""
    found = (w for w in _WORD.findall(text.replace("_", " ").lower()) if w not in _FUNCTION_WORDS)
    return tuple(dict.fromkeys(_singular(w) for w in found))


def numbers_in(text: str) -> tuple[tuple[int, tuple[str, ...]], ...]:
    """Numbers of a clause, each with the words after it that it may count, singular."""
    found = []
    for m in _NUMBER.finditer(text):
        word = m.group(1).lower()
        number = _COUNTS.index(word) + 2 if word in _COUNTS else int(word)
        found.append((number, names_in(m.group(2))))
    return tuple(found)


def _singular(word: str) -> str:
    for ending in ("oes", "ches", "shes", "xes", "sses"):
        if word.endswith(ending):
            return word[:-2]
    return word if word.endswith("ss") else word.removesuffix("s")
