"""Spans of the prompt by its claims, and shares of what they cover (R155)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from .amounts import miscounted
from .claim_targets import Span, named_in, targets_of
from .contradicted_words import contradicted_words
from .crossings import crossing_warnings
from .deciding import deciding_warnings
from .decoys import decoy_warnings
from .definites import plural_warnings
from .denials import denied_verb, misdenied
from .described import DESCRIBING, judged_words
from .documents import kept_of_latest
from .errors import InputError
from .filler_words import filler_warnings, shared_beat_warnings
from .hedged import hedged_events
from .nouns import noun_of
from .orders import orders_said
from .place_things import place_warnings
from .predicates import atoms_of, entities_of
from .predicates.events import PairEvent, event_atoms
from .prompts import lexicon as words
from .prompts.languages import REVIEWED, Held, held_words, language_of
from .prompts.marks import occurrence
from .prompts.numbers import number_in, quantity_in
from .prompts.odd import odd_characters
from .prompts.units import boundaries, letters, units_of, word_count
from .pronouns import misread_pronouns, pronoun_readings
from .repeats import is_repeat
from .roles import misplaced_roles
from .row_words import misnamed_rows
from .spec import CLAIM_TYPES, Beat, Supports, WorldSpec
from .stillness import stillness_of, stillness_warnings
from .subjects import misplaced_subjects
from .substance_looks import look_warnings

__all__ = ["LONGEST", "Reading", "Span", "named_in", "prompt_record", "reading_of", "targets_of"]

_LONG, _SHORT = 8, 4
LONGEST: Mapping[str, int] = {t: _SHORT if t in ("thing", "count", "property", "order") else _LONG for t in CLAIM_TYPES}
"""Words of a claim by its type; what is beyond them is filler."""


SAME_SHARE = 0.5
"""Own choice: with more of its things and events said to be the same as others, the verdict warns. Pronouns seldom are half of the nouns."""


FEW = 6
"""Own choice: words below which a text that is in no known language may only be too short to tell; above, two listed words are asked for."""


@dataclass(frozen=True)
class Reading:
    """The whole prompt, cut into claims and filler."""

    spans: tuple[Span, ...]
    """In order; they cover every letter of the prompt."""
    problems: tuple[tuple[str, str], ...]
    """Claims whose quote is not in the prompt, or overlaps another: (claim, what is wrong)."""
    language: str | None
    """Code of a language with reviewed word lists; None where it is another or mixed."""
    held: tuple[Held, ...]
    """Numbers, negations and order words of the prompt."""
    warnings: tuple[str, ...]
    claimed: float
    """Share of the letters in claims that are judged."""
    filler: float
    waived: float


@kept_of_latest
def reading_of(spec: WorldSpec) -> Reading:
    """Cut the prompt of a specification by its claims."""
    prompt = spec.prompt
    problems: list[tuple[str, str]] = []
    taken: list[tuple[int, int, str]] = []
    for name, claim in spec.claims.items():
        try:
            start, end = occurrence(prompt, claim.quote, claim.nth)
        except InputError as error:
            problems.append((name, str(error)))
            continue
        whole = {start, end} <= boundaries(prompt)
        other = next((c for a, b, c in taken if a < end and start < b), None)
        if not whole:
            problems.append((name, f"the quote {claim.quote!r} cuts a word in two; quote whole words"))
        elif other is not None:
            problems.append(
                (name, f"the quote {claim.quote!r} overlaps that of claim {other!r}; every word belongs to one claim")
            )
        else:
            taken.append((start, end, name))
    language = language_of(prompt)
    held = held_words(prompt, language)
    spans = tuple(_cut(spec, sorted(taken), held))
    total = max(1, letters(prompt))
    share = {
        kind: sum(letters(s.text) for s in spans if _kind(spec, s) == kind) / total for kind in ("claimed", "filler", "waived")
    }
    return Reading(spans, tuple(problems), language, held, tuple(_warnings(spec, spans, language)), **share)


def _kind(spec: WorldSpec, span: Span) -> str:
    if span.claim is None:
        return "filler"
    return "waived" if spec.claims[span.claim].waived else "claimed"


def _cut(spec: WorldSpec, taken: list[tuple[int, int, str]], held: tuple[Held, ...]) -> Iterator[Span]:
    """Spans in order: claims up to the length of their type, filler between them. No held phrase is cut: it may have more words."""
    prompt, at = spec.prompt, 0
    units = units_of(prompt)
    for start, end, name in taken:
        kind = spec.claims[name].type
        last = end
        for unit in units:
            if start < unit.end <= end and word_count(prompt[start : unit.end]) <= LONGEST[kind]:
                last = unit.end
        if word_count(prompt[start:end]) <= LONGEST[kind]:
            last = end
        last = max([last, *(h.end for h in held if start <= h.start < last and h.end <= end)])
        if start > at:
            yield Span(at, start, prompt[at:start], None, "")
        yield Span(start, last, prompt[start:last], name, kind)
        at = last
    if at < len(prompt):
        yield Span(at, len(prompt), prompt[at:], None, "")


def _warnings(spec: WorldSpec, spans: tuple[Span, ...], language: str | None) -> Iterator[str]:
    for odd in odd_characters(spec.prompt):
        yield f"{odd.text!r} at character {odd.start}: {odd.why}"
    if language is None and 0 < word_count(spec.prompt) < FEW:
        yield f"the language is unknown, since {word_count(spec.prompt)} words are too few to tell it: numbers, negations and order words in filler were not looked for"
    elif language is None:
        yield "the language is none with reviewed word lists, or mixed: numbers, negations and order words in filler were not looked for"
    elif language not in REVIEWED:
        yield f"there are no reviewed word lists of the language {language!r}: numbers, negations and order words in filler were not looked for"
    told = [c for c in spec.claims.values() if c.type in ("thing", "event") and c.waived is None]
    alike = sum(c.same_as is not None for c in told)
    if alike > SAME_SHARE * len(told):
        yield f"{alike} of {len(told)} claims of things and events are said to be the same as another"
    yield from _idle(spec)
    yield from (m.text for m in misplaced_roles(spec, spans, language) if not m.sure)
    yield from (m.text for m in misplaced_subjects(spec, spans, language) if not m.sure)
    yield from (m.text for m in misread_pronouns(spec, spans, language) if not m.sure)
    yield from crossing_warnings(spec, spans, language)
    yield from plural_warnings(spec, spans, language)
    yield from filler_warnings(spec, spans, language)
    yield from shared_beat_warnings(spec)
    yield from (text for _, text, sure in misdenied(spec, spans, language) if not sure)
    yield from _one_way(spec)
    yield from stillness_warnings(spec, language)
    yield from decoy_warnings(spec)
    yield from look_warnings(spec)
    for readers in (misnamed_rows, hedged_events, miscounted, contradicted_words):
        yield from (m.text for m in readers(spec, spans, language) if not m.sure)
    yield from deciding_warnings(spec, spans, language)
    yield from place_warnings(spec, spans, language)
    readings = [
        words.Reading(s.start, s.end, s.type, _kinds(spec, s.claim))
        for s in spans
        if s.claim is not None and not spec.claims[s.claim].waived
    ]
    waived = [s for s in spans if s.claim is not None and spec.claims[s.claim].waived]
    for warned in words.warnings_for(readings, spec.prompt, language):
        if not any(s.start <= warned.start and warned.end <= s.end for s in waived):
            yield f"{warned.word!r} is marked as {warned.marked}: {warned.says}" if warned.word else warned.says


def _idle(spec: WorldSpec) -> Iterator[str]:
    """Bodies that can move and that nothing which a claim says of beats, requirements and relations of some frames is about, where events are told."""
    judged = [n for n, c in spec.claims.items() if c.waived is None]
    if not any(spec.claims[n].type == "event" for n in judged):
        return
    story = spec.story
    told = {e for n in judged for b in named_in(spec, n, "story/beats") if b in story.beats for e in _about(story.beats[b])}
    told |= {
        e
        for n in judged
        for r in named_in(spec, n, "story/requirements")
        if r in story.requirements
        for e in entities_of(story.requirements[r].predicate)
    }
    held = (spec.graph.relations.get(r) for n in judged for r in named_in(spec, n, "graph/relations"))
    told |= {e for r in held if isinstance(r, Supports) and r.frames is not None for e in (r.a, r.b)}
    for name in judged:
        claim = spec.claims[name]
        if claim.type != "thing" or claim.same_as is not None:
            continue
        bodies = [n for n in named_in(spec, name, "entities") if n in spec.entities and spec.entities[n].motion == "dynamic"]
        if bodies and not told & set(bodies):
            yield f"{claim.quote!r} can move, and nothing that is claimed to happen is about {', '.join(bodies[:3])}"


def _one_way(spec: WorldSpec) -> Iterator[str]:
    """Negations of what one body does to another that can do it too: the reverse is not denied."""
    for name, claim in spec.claims.items():
        if claim.type != "negation" or claim.waived is not None:
            continue
        keys = [r for r in named_in(spec, name, "story/requirements") if r in spec.story.requirements]
        denied = {
            (a.kind, a.entity, a.other)
            for r in keys
            for a in atoms_of(spec.story.requirements[r].predicate)
            if isinstance(a, PairEvent) and a.kind == "hits"
        }
        for kind, doer, other in sorted(denied):
            able = other in spec.entities and spec.entities[other].motion == "dynamic"
            if able and (kind, other, doer) not in denied:
                yield f"{claim.quote!r} denies that {doer} {kind} {other}, and not the reverse, which would look alike"


def _about(beat: Beat) -> tuple[str, ...]:
    return (beat.subject, *entities_of(beat.predicate))


def _kinds(spec: WorldSpec, name: str) -> list[str]:
    """Kinds of event of the beats and requirements that a claim names."""
    story = spec.story
    asked = [story.beats[n].predicate for n in named_in(spec, name, "story/beats") if n in story.beats]
    asked += [story.requirements[n].predicate for n in named_in(spec, name, "story/requirements") if n in story.requirements]
    return [str(getattr(a, "kind", "")) for predicate in asked for a in event_atoms(predicate)]


# ---------------------------------------------------------------- in words


def _nounless(spec: WorldSpec, spans: Sequence[Span], at: int, language: str | None) -> bool:
    """True where a count is a number alone, and no claim says which things the noun behind it means."""
    words = spans[at].text.split()
    return len(words) == 1 and not is_repeat(spec, str(spans[at].claim)) and noun_of(spec, spans, at, language) is None


def _only_read(spec: WorldSpec, spans: Sequence[Span], name: str, language: str | None) -> bool:
    """True if nothing but the agent's reading says that what a claim names is what its words say."""
    claim = spec.claims[name]
    if claim.waived is not None:
        return False
    at = next((k for k, s in enumerate(spans) if s.claim == name), None)
    if claim.type == "quantity":
        return quantity_in(claim.quote, language) is None
    if claim.type == "count":
        return number_in(claim.quote, language) is None or (at is not None and _nounless(spec, spans, at, language))
    if claim.type == "order":
        return at is not None and not orders_said(spec, spans, at, language)
    if claim.type == "negation":
        known = at is None or denied_verb(spec.prompt, spans, at, language) or stillness_of(spec.prompt, spans, at, language)
        return known is None
    return claim.type in DESCRIBING and not judged_words(spec, name)


def _words(text: str) -> str:
    """The text without punctuation and blanks around it."""
    units = units_of(text)
    return text[units[0].start : units[-1].end]


def prompt_record(spec: WorldSpec) -> dict[str, Any]:
    """Record of how the prompt is judged, for the acceptance: spans, shares, waivers and warnings, JSON-able."""
    found = reading_of(spec)
    spans = []
    for span in found.spans:
        told: dict[str, Any] = {"text": span.text}
        if span.claim is not None:
            claim = spec.claims[span.claim]
            told |= {"claim": span.claim, "type": claim.type, "by": targets_of(spec.claims, span.claim)}
            told |= {"waived": claim.waived} if claim.waived else {}
        spans.append(told)
    return {
        "spans": spans,
        "claimed": round(found.claimed, 4),
        "filler": round(found.filler, 4),
        "waived": round(found.waived, 4),
        "filler_texts": [_words(s.text) for s in found.spans if s.claim is None and letters(s.text)],
        "waivers": {
            spec.claims[s.claim].quote: spec.claims[s.claim].waived
            for s in found.spans
            if s.claim and spec.claims[s.claim].waived
        },
        "readings": pronoun_readings(spec, found.spans, found.language)
        | {
            spec.claims[s.claim].quote: targets_of(spec.claims, s.claim)
            for s in found.spans
            if s.claim and _only_read(spec, found.spans, s.claim, found.language)
        },
        "language": found.language,
        "warnings": list(found.warnings),
    }
