"""Who does an event to whom, by the order of the words of a clause, against the bodies of its predicate (R131, R155).

In a clause that has its subject before the verb and its object behind it, the thing before the words of an event does it to the thing
behind them. `by`, `from` and `of` between the event and what stands behind it turn that around. Quirk, R. et al. (1985), A Comprehensive
Grammar of the English Language, 10.9 (subject and object by position) and 3.63 (passive). It is sure in English, of a verb that the
lexicon knows to be of the kind that judges it and whose subject has no preposition of its own; else it is a warning.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import regex

from .claim_targets import Span, named_in
from .predicates import Contact, NoContact, atoms_of
from .predicates.events import PairEvent
from .prompts.lexicon import known_kinds, labelled, lemmas, verb_kinds
from .prompts.units import folded, units_of

if TYPE_CHECKING:
    from .spec import WorldSpec

__all__ = [
    "JOINS",
    "PREPOSITIONS",
    "SENTENCE",
    "STOP",
    "TURNS",
    "Misplaced",
    "Surroundings",
    "bodies_of",
    "misplaced_roles",
    "says_touch",
    "sentence_end",
    "surroundings",
    "verb_of",
    "words_in",
]

DOES = frozenset(("hits", "pushes", "pulls", "lifts", "lowers", "throws"))
"""Kinds of event that a subject does to an object; what jams or leans is told of either side."""
TURNS: dict[str, frozenset[str]] = {
    "en": frozenset(("by", "from", "of")),
    "de": frozenset(("von", "vom", "durch", "des", "der", "eines", "einer")),
    "fr": frozenset(("par", "de", "du", "des", "d'")),
    "es": frozenset(("por", "de", "del")),
    "it": frozenset(("da", "dal", "dalla", "dai", "dalle", "dallo", "dall'", "di", "del", "della")),
    "pt": frozenset(("por", "pelo", "pela", "pelos", "pelas", "de", "do", "da")),
    "nl": frozenset(("door", "van")),
}
"""By language with the subject before its verb in main clauses: words behind an event that make what follows its doer. Reviewed by hand."""
ONWARDS = frozenset(("against", "into", "onto", "on", "upon", "at"))
"""Prepositions behind `hits` and `pushes` that lead to what is hit."""
PREPOSITIONS = ONWARDS | frozenset(
    ["above", "across", "after", "along", "alongside", "around", "before", "behind", "below", "beneath", "beside", "between", "beyond", "by", "down", "for", "from", "in", "inside", "like", "near", "of", "off", "out", "outside", "over", "past", "round", "through", "to", "toward", "towards", "under", "underneath", "up", "via", "with", "within", "without"]
)  # fmt: skip
MUTUAL = frozenset(("collide", "collides", "collided", "meet", "meets", "met", "clash", "clashes", "clashed"))
"""Verbs that two do to each other, with both before them."""
JOINS = frozenset(
    ["and", "or", "but", "so", "nor", "yet", "as", "when", "while", "whenever", "where", "because", "if", "although", "though", "until", "till", "once", "then", "than", "since", "which", "that", "who", "whose", "whom", "it", "they", "he", "she", "this", "these", "those", "them", "him", "her", "and", "then", "und", "oder", "aber", "wenn", "als", "während", "weil", "dass", "et", "ou", "mais", "quand", "y", "o", "pero", "cuando", "e", "ma", "quando", "en", "of", "maar", "wanneer"]
) - {"of"}  # fmt: skip
"""Words between an event and a thing behind which the thing is another clause's, or that may stand for another body."""
STOP = regex.compile(r"[.;:!?…,()\n]|[—–]")
SENTENCE = regex.compile(r"[.!?…;\n]")


TOUCHES = frozenset(("touch", "graze", "brush", "meet", "hit", "strike", "bump", "scrape", "knock", "ram"))
"""English verbs that a touch of two bodies judges. Reviewed by hand."""


class Misplaced(NamedTuple):
    """An event whose predicate has its bodies in other places than the words."""

    claim: str
    text: str
    sure: bool
    """True where the rule decides it; else it is a warning."""


class Surroundings(NamedTuple):
    """Surroundings of the words of an event."""

    before: frozenset[str]
    """Bodies of its sentence that stand before it."""
    next: frozenset[str]
    """Bodies of the next thing behind it in its clause; empty where there is none."""
    between: tuple[str, ...]
    """Words between the two, folded."""
    plain: bool
    """True where nothing but an article or another description stands before the first thing of the sentence."""
    inverted: bool = False
    """True where the sentence begins with the place of its one thing before the words, as `Into a block rolls a ball`."""


def misplaced_roles(spec: WorldSpec, spans: Sequence[Span], language: str | None) -> Iterator[Misplaced]:
    """Events and negations told of the reverse of what the words say, or of a body that is not the one behind the verb.

    Args:
        spec: the specification.
        spans: of its prompt, in order.
        language: code of its language.
    """
    if language not in TURNS:
        return
    for index, span in enumerate(spans):
        if span.type not in ("event", "negation") or span.claim is None or spec.claims[span.claim].waived is not None:
            continue
        atoms = [a for a in _atoms(spec, span.claim) if isinstance(a, PairEvent) and a.kind in DOES]
        place = surroundings(spec, spans, index)
        if place.next:
            yield from _touched(spec, span, place, language)
        if not atoms or not place.next:
            continue
        mutual = MUTUAL & set(words_in(span.text)) and any({a.entity, a.other} <= place.before for a in atoms)
        if mutual and set(place.between) & (PREPOSITIONS - {"into", "against", "upon"}):
            continue  # `a block and a ball collide on a floor`: it is not the floor that is hit
        turned = bool(TURNS[language] & {*place.between, *words_in(span.text)}) or (language == "en" and place.inverted)
        kinds = verb_kinds(verb_of(spec.prompt, span)) if language == "en" else None
        known = [a for a in atoms if kinds is not None and a.kind in kinds & known_kinds()]
        clear = bool(known) and place.plain and not set(place.between) & (PREPOSITIONS - _led(known[0].kind))
        yield from _told(spec, span.claim, atoms, place, turned=turned, sure=clear)


def _touched(spec: WorldSpec, span: Span, place: Surroundings, language: str) -> Iterator[Misplaced]:
    """Touches of other bodies than the one behind their words: it is that one which is touched, or never is."""
    pairs = [{a.a, a.b} for a in _atoms(spec, str(span.claim)) if isinstance(a, Contact | NoContact)]
    if not pairs or any(pair & place.next or "each" in pair for pair in pairs):
        return
    quote, others = spec.claims[str(span.claim)].quote, sorted(pairs[0] - place.before or pairs[0])
    names = ", ".join(sorted(place.next)[:3])
    known = language == "en" and says_touch(spec.prompt, span)
    clear = place.plain and not set(place.between) & (PREPOSITIONS - ONWARDS - {"by"})
    text = f"{quote!r} is judged by a touch of {', '.join(others)}, and what stands behind it is {names}: name a touch of {names}"
    if (known and clear) or pairs[0] & place.before:
        yield Misplaced(str(span.claim), text, known and clear)


def _led(kind: str) -> frozenset[str]:
    return ONWARDS if kind in ("hits", "pushes") else frozenset()


def _told(
    spec: WorldSpec, name: str, atoms: Sequence[PairEvent], place: Surroundings, *, turned: bool, sure: bool
) -> Iterator[Misplaced]:
    quote = spec.claims[name].quote
    said = [(a.other, a.entity) if turned else (a.entity, a.other) for a in atoms]
    fits = [(first, second) for first, second in said if second in place.next or "each" in (first, second)]
    if fits:
        return
    first, second = said[0]
    atom = atoms[0]
    names = ", ".join(sorted(place.next)[:3])
    if first in place.next and second in place.before and first not in place.before:
        right = f"{second!r} to {first!r}" if not turned else f"{first!r} to {second!r}"
        text = f"{quote!r} is {atom.kind} of {atom.entity!r} to {atom.other!r}, and its words say the reverse: {right}; exchange entity and other"
        yield Misplaced(name, text, sure or (turned and _by_alone(place)))
    elif first in place.before:
        role = "does it" if turned else "it is done to"
        text = f"{quote!r} is {atom.kind} of {atom.entity!r} to {atom.other!r}, and what stands behind it is {names}: name who {role} there"
        yield Misplaced(name, text, sure and not turned and atom.kind != "throws")


def _by_alone(place: Surroundings) -> bool:
    return place.plain and "by" in place.between and not set(place.between) & (PREPOSITIONS - {"by"})


def _atoms(spec: WorldSpec, name: str) -> list[object]:
    story = spec.story
    asked = [story.beats[n].predicate for n in named_in(spec, name, "story/beats") if n in story.beats]
    asked += [story.requirements[n].predicate for n in named_in(spec, name, "story/requirements") if n in story.requirements]
    return [a for predicate in asked for a in atoms_of(predicate)]


def verb_of(prompt: str, span: Span) -> str:
    """The verb of an event, or of what a negation denies."""
    found = [w for w in labelled(prompt) if w.type == "event" and w.start < span.end and span.start < w.end]
    return prompt[found[-1].start : found[-1].end] if found else ""


def says_touch(prompt: str, span: Span) -> bool:
    """True where the English verb of an event, or of what a negation denies, is one that a touch judges."""
    verb = verb_of(prompt, span).split()[:1] or words_in(span.text)
    return any(TOUCHES & set(lemmas(w.casefold(), "v")) for w in verb)


def sentence_end(text: str) -> str:
    """Words of the last sentence of a text."""
    return SENTENCE.split(text)[-1]


def surroundings(spec: WorldSpec, spans: Sequence[Span], index: int) -> Surroundings:
    """Bodies and words about the words of an event."""
    before: set[str] = set()
    opening: list[str] = []
    things = 0
    for span in reversed(spans[:index]):
        if span.claim is None and SENTENCE.search(span.text):
            opening += words_in(sentence_end(span.text))
            break
        if span.claim is None:
            opening = words_in(span.text)
        elif span.type in ("thing", "count"):
            before |= bodies_of(spec, span.claim)
            things += 1
    between: list[str] = []
    for span in spans[index + 1 :]:
        if span.claim is None:
            between += words_in(span.text)
            if STOP.search(span.text) or JOINS & set(between):
                break
        elif span.type == "thing" and bodies_of(spec, span.claim):
            owner = spec.prompt[span.end : span.end + 2].translate({0x2019: "'"}) == "'s"
            if not owner:
                inverted = bool(ONWARDS & set(opening[:1])) and things == 1 and not between[:-1]
                plain = not PREPOSITIONS & set(opening)
                return Surroundings(frozenset(before), bodies_of(spec, span.claim), tuple(between), plain, inverted)
        elif span.type not in ("property", "count", "look"):
            break
    return Surroundings(frozenset(before), frozenset(), (), plain=False)


def bodies_of(spec: WorldSpec, name: str) -> frozenset[str]:
    """Entities that a claim names."""
    return frozenset(n for n in named_in(spec, name, "entities") if n in spec.entities)


def words_in(text: str) -> list[str]:
    """Words of a text, folded."""
    return [folded(u.text) for u in units_of(text)]
