"""Whom an event or a negation is told of, against the body that stands before its verb (R131, R155).

In English the subject stands before its verb, in the same clause (Quirk, R. et al. (1985), A Comprehensive Grammar of the English Language, 10.9);
behind `and`, a comma or a relative pronoun it may be any body of the sentence that was named before; of `it` and `they`, also across
sentences, see `pronouns.py`. What is told has to name a body that may be its subject, or, of an active verb, the one that stands behind it: `a ball knocks over a vase` may be told of the vase,
`the block does not fall` not of the ball. It is sure of rigid bodies and verbs that the lexicon knows; of matter that bodies hold or make,
as a kettle its steam, nothing is said.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import regex

from .categories.registry import shape_of
from .claim_targets import Span, named_in
from .postures import upright_said
from .predicates import entities_of
from .prompts.lexicon import known_kinds, verb_kinds
from .pronouns import HELPERS, antecedents_of, pronoun_before
from .roles import (
    JOINS,
    PREPOSITIONS,
    STOP,
    TURNS,
    Misplaced,
    bodies_of,
    says_touch,
    sentence_end,
    surroundings,
    verb_of,
    words_in,
)

if TYPE_CHECKING:
    from .pronouns import Antecedents
    from .spec import WorldSpec

__all__ = ["misplaced_subjects"]

_WHICH = regex.compile(rf"\s*,?\s+(?:which|who|that)(?:\s+(?:{HELPERS}))*\s*$", regex.IGNORECASE)
_OF = regex.compile(r"\bof\s+(?:the|an?|its|his|her|their|two|three|\w+en)?\s*$", regex.IGNORECASE)


def misplaced_subjects(spec: WorldSpec, spans: Sequence[Span], language: str | None) -> Iterator[Misplaced]:
    """Events, negations and postures that are told of other bodies than those which their words are about.

    Args:
        spec: the specification.
        spans: of its prompt, in order.
        language: code of its language; only English is looked at.
    """
    if language != "en":
        return
    for index, span in enumerate(spans):
        if span.claim is None or spec.claims[span.claim].waived is not None:
            continue
        if span.type not in ("event", "negation") and upright_said(spec.claims[span.claim], language) is None:
            continue
        told = _told(spec, span.claim)
        said = pronoun_before(spec.prompt, span.start)
        found = antecedents_of(spec, spans, *said) if said is not None else None
        if found is not None and not found.sure and told & found.earlier:
            continue  # which of them it means is the agent's reading
        subject = (
            _relative(spec, spans, index)
            or _subject(spec, spans, index)
            or (_taken_up(found) if found is not None else frozenset())
        )
        if not told or not subject or told & subject or not _solid(spec, told | subject):
            continue
        place = surroundings(spec, spans, index)
        turned = bool(TURNS["en"] & {*place.between, *words_in(span.text)})
        if told & place.next and not turned:
            continue
        kinds = verb_kinds(verb_of(spec.prompt, span))
        names, others = (", ".join(repr(n) for n in sorted(group)[:3]) for group in (subject, told))
        quote = spec.claims[span.claim].quote
        text = f"{quote!r} is told of {others}, and its words are about {names}: name a beat or requirement about {names}, or what {others} is in the words"
        known = bool(kinds and kinds & known_kinds()) or says_touch(spec.prompt, span)
        yield Misplaced(span.claim, text, sure=known)


def _relative(spec: WorldSpec, spans: Sequence[Span], index: int) -> frozenset[str]:
    """Bodies of the thing right before a relative pronoun that leads in an event: `a block, which does not topple`; empty elsewhere.

    Behind `of` either noun may be meant (Quirk et al. 1985, 17.9).
    """
    found = _WHICH.search(spec.prompt, 0, spans[index].start)
    place = next((k for k in range(index) if found is not None and spans[k].end == found.start()), None)
    if place is None or spans[place].claim is None or spans[place].type not in ("thing", "count"):
        return frozenset()
    return frozenset() if _OF.search(spec.prompt, 0, spans[place].start) else bodies_of(spec, str(spans[place].claim))


def _taken_up(found: Antecedents) -> frozenset[str]:
    """Bodies that a pronoun can only mean, of things that the sentence before names."""
    return found.nouns[0][1] if found.sure else frozenset()


def _told(spec: WorldSpec, claim: str) -> frozenset[str]:
    """Bodies of the predicates that a claim names."""
    story = spec.story
    asked = [story.beats[n].predicate for n in named_in(spec, claim, "story/beats") if n in story.beats]
    asked += [story.requirements[n].predicate for n in named_in(spec, claim, "story/requirements") if n in story.requirements]
    return frozenset(n for predicate in asked for n in entities_of(predicate) if n in spec.entities)


def _solid(spec: WorldSpec, names: frozenset[str]) -> bool:
    return all(shape_of(spec.entities[n]) == "solid" for n in names)


def _subject(spec: WorldSpec, spans: Sequence[Span], index: int) -> frozenset[str]:
    """Bodies that the words before an event may be about; empty where its sentence names none before it."""
    items = _sentence_before(spec, spans, index)
    things = [k for k, (kind, _) in enumerate(items) if kind == "thing"]
    if not things:
        return frozenset()
    nearest = things[0]
    # What stands behind another verb is its object, unless a new clause has begun.
    earlier = next((k for k in range(nearest + 1, len(items)) if items[k][0] == "event"), len(items))
    joins = [kind for kind, _ in items[nearest + 1 : earlier]].count("join")
    if joins == 1 and earlier < len(items) and all(kind == "words" for kind, _ in items[:nearest]):
        return items[nearest][1]
    return frozenset().union(*(items[k][1] for k in things))


def _sentence_before(spec: WorldSpec, spans: Sequence[Span], index: int) -> list[tuple[str, frozenset[str]]]:
    """Words and bodies before an event in its sentence, the nearest first: `words`, words that `join` clauses, `event`, `thing` with its bodies.

    Things behind a preposition and descriptions count as words.
    """
    found: list[tuple[str, frozenset[str]]] = []
    for k in range(index - 1, -1, -1):
        span = spans[k]
        if span.claim is None:
            text = sentence_end(span.text)
            found.append(("join" if JOINS & set(words_in(text)) or STOP.search(text) else "words", frozenset()))
            if text != span.text:
                break
        elif span.type in ("event", "negation"):
            found.append(("event", frozenset()))
        else:
            thing = span.type in ("thing", "count") and not _led_in(spans, k)
            own = bodies_of(spec, span.claim) if thing else frozenset()
            found.append(("thing" if own else "words", own))
    return found


def _led_in(spans: Sequence[Span], index: int) -> bool:
    """True where a preposition stands before a thing, descriptions of it aside."""
    for span in reversed([s for s in spans[:index] if not s.text.isspace()]):
        if span.claim is None:
            return bool(PREPOSITIONS & set(words_in(sentence_end(span.text))))
        if span.type not in ("property", "count", "look"):
            return span.type == "place"
    return False
