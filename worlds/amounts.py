"""Words for how many, `a trio of`, `several`, `both`, against what the claims beside them name (R2, R131, R155).

A number is claimed as a count; these words stand in no table of numbers. Where one is left in filler, or inside a claim of a thing, the things that it is said of are
as many: exactly so for `pair` and `trio`, no fewer for `several` and `dozens`. Loose matter, land and what breaks into pieces are as many as one likes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import regex

from .claim_targets import Span, named_in, targets_of
from .prompts.amount_words import BOTH, COLLECTIVE, MULTIPLE, OF_ONE, Amount, amount_phrases
from .prompts.numbers import number_in
from .prompts.units import APOSTROPHES, folded, units_of

if TYPE_CHECKING:
    from .spec import WorldSpec

__all__ = ["Miscounted", "miscounted"]

NEAR = 4
"""Own choice: words of filler between an amount and the things that it is said of."""
_STOP = regex.compile(
    r"(?i)[.;:!?…()\n]|[—–]|,\s*(?:the|an?|and|or|that|which|der|die|das|eine?|le|la|les|une?|el|los|las|una|il|lo|gli|os?|as|uma|de|het|een)\b"
)
_AND = regex.compile(r"(?i)\s*,?\s*(?:and|und|et|y|e|en|и)\b[^.;:!?]*")
_SENTENCE = regex.compile(r"[.!?…\n。！？]")
_UNSPACED = ("zh", "ja")
_TIMES = frozenset(
    """times time seconds second minutes minute hours hours metres meters degrees ways mal male sekunden minuten fois secondes minutes veces segundos
    volte secondi vezes segundos keer seconden раз секунд минут""".split()  # noqa: SIM905
)
"""Words behind an amount that make it one of repeats or of a duration."""


class Miscounted(NamedTuple):
    """A word for how many, and a claim that names another number of things."""

    claim: str
    text: str
    sure: bool
    """False where the word may say something else: the verdict warns."""


class _Word(NamedTuple):
    text: str
    end: int
    span: int
    amount: Amount


def miscounted(spec: WorldSpec, spans: Sequence[Span], language: str | None) -> Iterator[Miscounted]:
    """Claims of things, and counts, that name fewer than the words before them say, or another number than an exact one."""
    for found in _words(spans, language):
        at = _said_of(spec, spans, found)
        if at is not None:
            problem = _against(spec, spans[at], found, language)
            if problem is not None:
                yield problem
    yield from _both(spec, spans, language)
    yield from _warned(spec, spans, language)


def _words(spans: Sequence[Span], language: str | None) -> Iterator[_Word]:
    """Amounts in filler and in claims of things, properties and counts, the longest first and disjoint."""
    known = amount_phrases(language)
    longest = max(map(len, known), default=0)
    for index, span in enumerate(spans):
        if span.claim is not None and span.type not in ("thing", "property", "count"):
            continue
        if language in _UNSPACED:
            hits = sorted((span.text.find(w[0]), -len(w[0]), w) for w in known if w[0] in span.text)
            for start, _, word in hits[:1]:
                yield _Word(word[0], span.start + start + len(word[0]), index, known[word])
            continue
        units, at = units_of(span.text), 0
        words = [folded(u.text.translate(APOSTROPHES)) for u in units]
        while at < len(words):
            size = next((n for n in range(min(longest, len(words) - at), 0, -1) if tuple(words[at : at + n]) in known), 0)
            if size:
                end = units[at + size - 1].end
                yield _Word(span.text[units[at].start : end], span.start + end, index, known[tuple(words[at : at + size])])
            at += max(1, size)


def _said_of(spec: WorldSpec, spans: Sequence[Span], found: _Word) -> int | None:
    """Index of the claim of a thing or count that an amount is said of; None where it is of none, or judged as a count already."""
    held = spans[found.span]
    if held.type in ("thing", "count"):
        return found.span if spec.claims[str(held.claim)].waived is None else None
    between = 0
    for index in range(found.span, len(spans)):
        span = spans[index]
        text = span.text if index > found.span else span.text[found.end - span.start :]
        if span.claim is None or index == found.span:
            words = [folded(u.text) for u in units_of(text)]
            between += len(words)
            if _STOP.search(text) or between > NEAR or (words and words[0] in _TIMES):
                return None
        elif span.type == "thing":
            return index if spec.claims[span.claim].waived is None else None
        elif span.type not in ("property", "look", "count"):
            return None
    return None


def _against(spec: WorldSpec, span: Span, found: _Word, language: str | None) -> Miscounted | None:
    claim = spec.claims[str(span.claim)]
    if claim.type == "count" and number_in(claim.quote, language) is not None:
        return None  # held to its number by itself
    things = [p for p in targets_of(spec.claims, str(span.claim)) if p.startswith(("/entities/", "/terrains/"))]
    nouns = [folded(u.text) for u in units_of(span.text)]
    one = bool(set(nouns) & OF_ONE.get(language or "", frozenset())) and found.amount.exact
    if not things or one or any(_is_many(spec, p) for p in things):
        return None
    pieces = sum(_parts(spec, p) for p in things)
    if found.amount.least <= (len(things) if len(things) > 1 else pieces) and (
        not found.amount.exact or len(things) in (1, found.amount.least)
    ):
        return None
    said = f"{found.amount.least}" if found.amount.exact else f"at least {found.amount.least}"
    names = ", ".join(p.split("/")[2] for p in things[:4])
    text = f"{found.text!r} says {said}, and {claim.quote!r} names {len(things)} ({names}): name as many separate bodies, and claim {found.text!r} as their count"
    return Miscounted(str(span.claim), text, True)


def _is_many(spec: WorldSpec, pointer: str) -> bool:
    """True of what may be any number of pieces: land, loose matter, a generator's or a breakable thing."""
    keys = pointer.strip("/").split("/")
    entity = spec.entities.get(keys[1]) if keys[0] == "entities" else None
    return entity is None or entity.physics.shape == "loose" or entity.generator is not None or entity.breakable is not None


def _parts(spec: WorldSpec, pointer: str) -> int:
    keys = pointer.strip("/").split("/")
    return max(1, len(spec.entities[keys[1]].parts)) if len(keys) == 2 else 1


def _both(spec: WorldSpec, spans: Sequence[Span], language: str | None) -> Iterator[Miscounted]:
    """`Both`, where the prompt names no two things by the end of the sentence."""
    known = BOTH.get(language or "", frozenset())
    for span in spans if known else ():
        if span.claim is not None and span.type not in ("thing", "event", "property", "count"):
            continue
        word = next((u for u in units_of(span.text) if folded(u.text) in known), None)
        if word is None:
            continue
        stop = _SENTENCE.search(spec.prompt, span.start + word.end)
        end = len(spec.prompt) if stop is None else stop.start()
        told = [s for s in spans if s.start < end and s.claim is not None and s.type in ("thing", "count", "place")]
        bodies = {
            p
            for s in told
            for p in targets_of(spec.claims, str(s.claim))
            if p.startswith(("/entities/", "/terrains/", "/graph/"))
        }
        if len(bodies) < 2 and not any(_is_many(spec, p) for p in bodies if p.startswith("/entities/")):
            named = told[0].claim if told else span.claim
            if named is not None:
                text = f"{word.text!r} says 2, and the claims up to the end of its sentence name {len(bodies)}: name two separate bodies"
                yield Miscounted(named, text, True)
        behind = _next_thing(spec, spans, span, span.start + word.end)
        if behind is not None and len(bodies) >= 2:
            names = {p for p in targets_of(spec.claims, str(behind.claim)) if p.startswith("/entities/")}
            after = [s for s in spans if s.start >= behind.end and s.end <= end and s.type == "thing"]
            joined = [s for s in after if _AND.fullmatch(spec.prompt, behind.end, s.start)]
            if len(names) == 1 and not joined and not any(_is_many(spec, p) or _parts(spec, p) > 1 for p in names):
                text = (
                    f"{word.text!r} says 2, and {behind.text!r} behind it names 1 ({next(iter(names)).split('/')[2]}): name both"
                )
                yield Miscounted(str(behind.claim), text, True)


def _next_thing(spec: WorldSpec, spans: Sequence[Span], held: Span, end: int) -> Span | None:
    """The claim of a thing right behind a word, with nothing but properties and `of the` between."""
    if held.type == "thing":
        return held
    at = next(k for k, s in enumerate(spans) if s.start == held.start)
    if len(units_of(spec.prompt[end : held.end])) > 2:
        return None
    for span in spans[at + 1 :]:
        if span.type == "thing":
            return span if spec.claims[str(span.claim)].waived is None else None
        if (span.claim is None and span.text.strip()) or span.type not in ("property", ""):
            return None
    return None


def _warned(spec: WorldSpec, spans: Sequence[Span], language: str | None) -> Iterator[Miscounted]:
    """`A triple block`, `a crowd of blocks`, where one solid body of one part stands for them."""
    for held, of in ((MULTIPLE, False), (COLLECTIVE, True)):
        known = held.get(language or "", frozenset())
        for index, span in enumerate(spans):
            if span.claim is not None and span.type not in ("thing", "property"):
                continue
            units = units_of(span.text)
            words = [folded(u.text) for u in units]
            for k, word in enumerate(words):
                if word not in known or (of and words[k + 1 : k + 2] != ["of"]):
                    continue
                at = _said_of(spec, spans, _Word(word, span.start + units[k].end, index, Amount(2, exact=False)))
                bodies = named_in(spec, str(spans[at].claim), "entities") if at is not None else []
                if (
                    at is not None
                    and len(bodies) == 1
                    and _parts(spec, f"/entities/{bodies[0]}") == 1
                    and not _is_many(spec, f"/entities/{bodies[0]}")
                ):
                    text = f"{word!r} says more than one, and {spans[at].text!r} names one body of one part ({bodies[0]})"
                    yield Miscounted(str(spans[at].claim), text, False)
