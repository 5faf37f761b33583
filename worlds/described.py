"""Words of a claim that a row judges, and the bodies that words of size compare with (R131, R155).

A word of size alone says nothing of a body: small is what is smaller than others of its kind. Kennedy, C. (2007), Vagueness and grammar,
Linguistics and Philosophy 30(1): the standard of such an adjective is that of its comparison class.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from .claim_targets import named_in
from .poses import pose_said
from .prompts.descriptions import WordKind, meanings
from .prompts.languages import language_of
from .prompts.units import folded, units_of
from .spec import ClaimType, WorldSpec

__all__ = ["DESCRIBING", "Word", "alike", "coloured_bodies", "judged_words", "same_noun"]

DESCRIBING: Mapping[ClaimType, tuple[WordKind, ...]] = {
    "property": ("colour", "form", "material"),
    "place": ("place",),
    "time": ("time",),
    "weather": ("weather",),
    "look": ("look",),
    "route": ("route",),
}
"""Types of claims whose words are judged by lists, and the lists of each."""
RELATIVE = frozenset(("small", "big", "short", "thick", "heavy", "light"))
"""Words of form that only a comparison decides."""
OF_LAND = frozenset(("steep", "level", "flat"))
"""Words of form that a landscape can have."""
SAME_START = 3
"""Own choice: letters from which on two words that differ in their end alone, by two letters at most, are one: `ball` and `balls`."""
ENDING = 2


class Word(NamedTuple):
    """A word of a claim that a row judges."""

    kind: WordKind
    term: str
    text: str


def judged_words(spec: WorldSpec, name: str) -> tuple[Word, ...]:
    """Words of a claim that a rule exists for; none where nothing but the agent's reading says what they mean."""
    claim = spec.claims[name]
    if claim.waived is not None:
        return ()
    language = language_of(spec.prompt)
    found = [
        Word(kind, m.term, m.word)
        for kind in DESCRIBING.get(claim.type, ())
        for m in meanings(claim.quote, language, kind)
        if m.term != "-" and _has_rule(spec, name, kind, m.term)
    ]
    posed = pose_said(spec, name)
    if posed is not None:
        found.append(Word("place", posed.pose, posed.word))
    return () if any(w.term == "past" for w in found) else tuple(found)


def coloured_bodies(spec: WorldSpec) -> dict[str, list[str]]:
    """Bodies of each claim that says a colour: those that it names, or that are made of a material that it names."""
    found = {}
    for name in spec.claims:
        if any(w.kind == "colour" for w in judged_words(spec, name)):
            made = set(named_in(spec, name, "materials"))
            bodies = [n for n in named_in(spec, name, "entities") if n in spec.entities]
            found[name] = bodies or [
                n for n, e in spec.entities.items() if made & {e.material, *(p.material for p in e.parts.values())}
            ]
    return {name: bodies for name, bodies in found.items() if bodies}


def _has_rule(spec: WorldSpec, name: str, kind: WordKind, term: str) -> bool:
    bodies = [n for n in named_in(spec, name, "entities") if n in spec.entities]
    if kind == "colour":
        return bool(bodies or named_in(spec, name, "materials"))
    if kind == "form":
        relative = term in RELATIVE or (term == "alike" and len(bodies) < 2)
        return bool(alike(spec, name, term) if relative else bodies or (term in OF_LAND and named_in(spec, name, "terrains")))
    return True


def alike(spec: WorldSpec, name: str, term: str) -> list[str]:
    """Bodies of the same noun as those that a claim names, of which no claim says the same word.

    Two spans name one kind of thing where their last words are one, but for their ending.
    """
    own = set(named_in(spec, name, "entities"))
    things = {
        c: named_in(spec, c, "entities") for c, q in spec.claims.items() if q.type in ("thing", "count") and q.waived is None
    }
    nouns = [_noun(spec.claims[c].quote) for c, bodies in things.items() if spec.claims[c].type == "thing" and own & set(bodies)]
    same = {b for c, bodies in things.items() if any(_one(_noun(spec.claims[c].quote), n) for n in nouns) for b in bodies}
    said = {b for c in _saying(spec, term) for b in named_in(spec, c, "entities")}
    return [b for b in spec.entities if b in same - own - said]


def _saying(spec: WorldSpec, term: str) -> Iterable[str]:
    """Claims of property that say a word of form."""
    language = language_of(spec.prompt)
    for name, claim in spec.claims.items():
        if claim.type == "property" and any(m.term == term for m in meanings(claim.quote, language, "form")):
            yield name


def same_noun(quote: str, other: str) -> bool:
    """True where two quotes of things end with the same word, but for its ending."""
    return _one(_noun(quote), _noun(other))


def _noun(quote: str) -> str:
    units = units_of(quote)
    return folded(units[-1].text) if units else ""


def _one(a: str, b: str) -> bool:
    short, long = sorted((a, b), key=len)
    return a == b or (len(short) >= SAME_START and long.startswith(short[:-1]) and len(long) - len(short) <= ENDING)
