"""The packed English lexicon: lemmas, claim types and kinds of event, from WordNet 3.0 (`packaging/lexicon.py` makes it, `data/LICENSE-wordnet.txt`)."""

from __future__ import annotations

import gzip
import re
from collections import defaultdict
from functools import cache, lru_cache
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NamedTuple

from .english import KINDS
from .english import SHARES as REVIEWED

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

__all__ = ["Part", "header", "irregular", "known", "known_kinds", "lemmas", "particle_verb", "type_shares", "verb_kinds", "votes"]

Part = Literal["n", "v", "a", "r"]
"""Part of speech: noun, verb, adjective, adverb."""
DATA = Path(__file__).parent / "data" / "lexicon.txt.gz"
TYPES = {
    "T": "thing",
    "M": "material",
    "E": "event",
    "S": "state",
    "P": "property",
    "L": "place",
    "Q": "quantity",
    "D": "time",
    "W": "weather",
    "A": "manner",
    "N": "notion",
}
"""By the letters of the data: `state` stands for verbs of no change or motion, `notion` for nouns of nothing that is seen."""
ENDINGS: dict[Part, tuple[tuple[str, str], ...]] = {
    "n": (("ches", "ch"), ("shes", "sh"), ("ses", "s"), ("xes", "x"), ("zes", "z"), ("ies", "y"), ("men", "man"), ("s", "")),
    "v": (("ies", "y"), ("es", "e"), ("es", ""), ("s", ""), ("ied", "y"), ("ed", "e"), ("ed", ""), ("ing", "e"), ("ing", "")),
    "a": (("est", "e"), ("est", ""), ("er", "e"), ("er", "")),
    "r": (),
}
"""Detachment of endings as WordNet's own `morphy` does it."""
REMEMBERED = 1 << 14
"""Words whose votes are kept; own choice: those of some hundred prompts."""
LONGEST_COMPOUND = 30
"""Letters of a word that is taken for two nouns; own choice."""
_SHARE = re.compile(r"([nvar])([A-Z])([0-9a-f])")


class _Data(NamedTuple):
    header: Mapping[str, str]
    types: Mapping[str, str]
    forms: Mapping[tuple[str, str], tuple[str, ...]]
    kinds: Mapping[str, frozenset[str]]


@cache
def _data() -> _Data:
    head, *sections = gzip.decompress(DATA.read_bytes()).decode("ascii").split("\n[")
    lines = {name: rest.splitlines()[1:] for name, _, rest in (section.partition("]") for section in sections)}
    forms: dict[tuple[str, str], tuple[str, ...]] = {}
    for form, part, lemma in (line.split() for line in lines["forms"]):
        forms[form, part] = (*forms.get((form, part), ()), lemma)
    types = dict(line.split(" ") for line in lines["types"])
    kinds = {lemma: frozenset(found) for lemma, *found in (line.split() for line in lines["kinds"])}
    facts = {key: value for key, _, value in (line.rpartition(" ") for line in head.splitlines())}
    return _Data({**facts, "source": _source(head)}, {**types, **REVIEWED}, forms, {**kinds, **KINDS})


def _source(head: str) -> str:
    (found,) = (line.removeprefix("source ") for line in head.splitlines() if line.startswith("source "))
    return found


def header() -> Mapping[str, str]:
    """Origin of the data: `source`, and `sha256 NAME` of every input."""
    return _data().header


def irregular(word: str, part: Part) -> bool:
    """True of an irregular form: fell, torn, spun, mice."""
    return word not in REVIEWED and (word, part) in _data().forms


def known(word: str) -> bool:
    """True of a word that is in the lexicon in some form."""
    return any(lemmas(word, part) for part in ENDINGS)


def lemmas(word: str, part: Part | None = None) -> tuple[str, ...]:
    """Lemmas that a word may be a form of, as one part of speech or as any; irregular forms first."""
    folded = word.casefold().replace(" ", "_")
    if folded in REVIEWED:
        return (folded,) if part is None or _cut(folded, part) else ()
    found: dict[str, None] = {}
    for each in ENDINGS if part is None else (part,):
        found.update(dict.fromkeys(lemma for lemma in _candidates(folded, each) if _cut(lemma, each)))
    return tuple(found)


def _candidates(word: str, part: Part) -> list[str]:
    head, _, particle = word.partition("_")
    tail = f"_{particle}" if particle else ""
    regular = [head[: -len(end)] + new for end, new in ENDINGS[part] if head.endswith(end) and len(head) > len(end) + 1]
    doubled = [stem[:-1] for stem in regular if part in "va" and len(stem) > 3 and stem[-1] == stem[-2]]
    whole = (
        (*regular, head) if part == "n" and head.endswith("s") else (head, *regular)
    )  # cards are more than one card, not a game
    return [f"{stem}{tail}" for stem in (*_data().forms.get((head, part), ()), *whole, *doubled)]


@lru_cache(maxsize=REMEMBERED)
def _cut(lemma: str, part: Part) -> Mapping[str, int]:
    """Shares of one part of speech, by letter, in fifteenths of the whole lemma."""
    return {letter: int(share, 16) for of, letter, share in _SHARE.findall(_data().types.get(lemma, "")) if of == part}


def _tail(word: str) -> str:
    """The second noun of a word that is two and not in the lexicon itself, as in bedsheet; empty where it is none or known."""
    if len(word) > LONGEST_COMPOUND or any(lemmas(word, part) for part in ("v", "a", "r")):
        return ""
    cuts = range(3, len(word) - 2)
    return next((word[k:] for k in cuts if _cut(word[:k], "n") and lemmas(word[k:], "n")), "")


@lru_cache(maxsize=REMEMBERED)
def votes(word: str, part: Part) -> Mapping[str, float]:
    """Votes for each type, as one part of speech: fifteenths of the likeliest lemma, `{}` where it cannot be that part."""
    found = lemmas(word, part)
    if part == "n":
        found = (found or lemmas(_tail(word), "n"))[:1]
    best = max((_cut(lemma, part) for lemma in found), key=lambda cut: sum(cut.values()), default={})
    return {TYPES[letter]: share for letter, share in best.items()}


def type_shares(word: str) -> Mapping[str, float]:
    """Share of each claim type in all that a word may mean, as any part of speech; they sum to 1, or nothing is known of the word."""
    found: dict[str, float] = defaultdict(float)
    for part in ENDINGS:
        for kind, share in votes(word, part).items():
            found[kind] += share
    whole = sum(found.values())
    return {kind: share / whole for kind, share in found.items()}


def particle_verb(verb: str, particle: str) -> bool:
    """True where a verb, in any form, and a particle are one verb: fell over, goes out."""
    return bool(lemmas(f"{verb} {particle}", "v"))


@cache
def known_kinds() -> frozenset[str]:
    """All kinds of event that the lexicon has seeds for."""
    return frozenset().union(*_data().kinds.values())


def verb_kinds(verb: str, after: Sequence[str] = ()) -> frozenset[str] | None:
    """Kinds of event that fit a verb, in any form and with a particle or without; none where no kind is known for it.

    Args:
        verb: the verb, and its particle.
        after: words that follow: two of them side by side, or one, may make it another verb ("catches fire", "sets the barn on fire").
    """
    head, *rest = verb.casefold().split() or [""]
    later = [word.casefold() for word in after]
    texts = [head, *(f"{head}_{word}" for word in (*rest, *later)), *(f"{head}_{a}_{b}" for a, b in pairwise((*rest, *later)))]
    found = [_data().kinds[lemma] for text in texts for lemma in _candidates(text, "v") if lemma in _data().kinds]
    return frozenset().union(*found) if found else None
