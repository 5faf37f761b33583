"""Nouns that point back: `the wooden block` after `a wooden block` is that block, and what a plural does all of it does (R131, R155).

English. A definite noun phrase whose words were used before with an indefinite article takes up the same thing (Quirk, R. et al. (1985), A
Comprehensive Grammar of the English Language, 5.30). It is sure where just one thing was introduced with those words.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import regex

from .claim_targets import Span, named_in
from .predicates import entities_of
from .roles import Misplaced, bodies_of

if TYPE_CHECKING:
    from .spec import WorldSpec

__all__ = ["misread_definites", "plural_warnings"]

_PHRASE = regex.compile(r"\b(an?|another|one|the|this|that)\s+((?:[\p{L}'’-]+\s+){0,3})$", regex.IGNORECASE)
"""An article and up to three words between it and a noun."""
NEW, OLD = frozenset({"a", "an", "one", "another"}), frozenset({"the", "this", "that"})


def misread_definites(spec: WorldSpec, spans: Sequence[Span], language: str | None) -> Iterator[Misplaced]:
    """Things marked behind `the` that are other bodies than the only thing that the same words introduced.

    Args:
        spec: the specification.
        spans: of its prompt, in order.
        language: code of its language; only English is looked at.
    """
    known: dict[str, list[frozenset[str]]] = {}
    for span in spans if language == "en" else ():
        if span.claim is None or span.type != "thing" or spec.claims[span.claim].waived is not None:
            continue
        found = _PHRASE.search(spec.prompt, 0, span.start)
        own = bodies_of(spec, span.claim)
        if found is None or not own:
            continue
        words = " ".join(f"{found.group(2)}{span.text}".casefold().split())
        if found.group(1).casefold() in NEW:
            known.setdefault(words, []).append(own)
        elif len(known.get(words, ())) == 1 and not own & known[words][0]:
            names, meant = (", ".join(repr(n) for n in sorted(group)[:3]) for group in (own, known[words][0]))
            text = f"'the {words}' is marked as {names}, and the only {words!r} named before is {meant}: mark it as that, with same_as"
            yield Misplaced(span.claim, text, sure=True)


def plural_warnings(spec: WorldSpec, spans: Sequence[Span], language: str | None) -> Iterator[str]:
    """Events of which a plural noun is the subject, and that are told of some of its bodies alone.

    Args:
        spec: the specification.
        spans: of its prompt, in order.
        language: code of its language; only English is looked at.
    """
    story = spec.story.beats
    for place, event in enumerate(spans) if language == "en" else ():
        thing = _right_before(spans, place) if event.claim is not None and event.type == "event" else None
        if thing is None or not thing.text.strip().casefold().endswith("s"):
            continue
        bodies = bodies_of(spec, str(thing.claim))
        beats = [story[b] for b in named_in(spec, str(event.claim), "story/beats") if b in story]
        told = {n for beat in beats for n in (beat.subject, *entities_of(beat.predicate))}
        left = bodies - told
        if len(bodies) > 1 and told & bodies and left:
            yield (
                f"{event.text.strip()!r} is told of {', '.join(map(repr, sorted(told & bodies)[:3]))} and not of {', '.join(map(repr, sorted(left)[:3]))}, "
                f"of {thing.text.strip()!r}"
            )


def _right_before(spans: Sequence[Span], place: int) -> Span | None:
    """The thing that stands right before an event, or two words before it at most, such as adverbs and helpers; None elsewhere."""
    before = place - 1
    if before > 0 and spans[before].claim is None and regex.fullmatch(r"\s*(?:[\p{L}'’-]+\s+){0,2}", spans[before].text):
        before -= 1
    return spans[before] if before >= 0 and spans[before].claim is not None and spans[before].type == "thing" else None
