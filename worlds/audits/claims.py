"""Claims of the prompt against what their types ask for (R2, R131, R155): what each must name, so that its words are judged.

Statically: pointers lead to what the type asks for, counted bodies are as many, numbers are those that are quoted. What is measured in
the motion and the pictures is asked in `verifiers/claims`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from ..amounts import miscounted
from ..claim_targets import JUDGED_BY, Span, may_judge
from ..claims import Reading, named_in, reading_of
from ..contradicted_words import contradicted_words
from ..definites import misread_definites
from ..denials import misdenied
from ..documents import document_of
from ..errors import InputError
from ..hedged import hedged_events
from ..postures import posture_problems
from ..predicates.events import EVENT_KINDS, event_atoms
from ..predicates.ordering import orderings_of
from ..predicates.registry import is_invariant
from ..problems import Problem
from ..prompts.languages import Held
from ..prompts.marks import occurrence
from ..prompts.numbers import number_in, ordinal_in
from ..pronouns import misread_pronouns
from ..references import kinds_of, resolves
from ..roles import SENTENCE, misplaced_roles
from ..row_words import misnamed_rows
from ..spec import Beat, Claim, Connects, Requirement, WorldSpec
from ..subjects import misplaced_subjects
from .acted_on import acted_on_problems
from .contradictions import contradiction_problems
from .counts import count_problems
from .leaves import leaf_at, value_at
from .matter_words import matter_problems
from .negations import negation_problems
from .nouns import noun_problems
from .orders import order_problems
from .properties import described_problems, substance_problems
from .quantities import quantity_problems
from .sharing import sharing_problems
from .unclaimed import unclaimed_problems

__all__ = ["claim_problems"]

WAIVED_SHARE = 0.2
"""Own choice: with more of its letters waived, a world is not the prompt's any more."""
_BEATS, _REQUIREMENTS = "story/beats", "story/requirements"
_ENTITY = re.compile(r"/entities/([^/]+)(?:/parts/[^/]+)?")
_ASKED = re.compile(r"/story/(beats|requirements)/([^/]+)")
_SHOWN = 20
"""Claims that a problem names."""
_ORDERED = frozenset({"before", "after", "until", "within"})


def claim_problems(spec: WorldSpec) -> list[Problem]:
    """Claims that are not in the prompt, name nothing that is judged, or less than their type asks for; and words that no claim takes up."""
    reading, document = reading_of(spec), document_of(spec)
    found = [Problem(f"/claims/{name}/quote", text) for name, text in reading.problems]
    for name, claim in spec.claims.items():
        found += _claim(spec, document, name, claim)
    found += [
        *acted_on_problems(spec, reading),
        *sharing_problems(spec, reading),
        *noun_problems(spec, reading),
        *described_problems(spec, reading),
        *order_problems(spec, reading),
    ]
    told = [
        *misplaced_roles(spec, reading.spans, reading.language),
        *misplaced_subjects(spec, reading.spans, reading.language),
        *misread_pronouns(spec, reading.spans, reading.language),
        *misread_definites(spec, reading.spans, reading.language),
    ]
    found += [Problem(f"/claims/{m.claim}/by", m.text) for m in told if m.sure]
    for readers in (misnamed_rows, hedged_events, miscounted, contradicted_words):
        words = readers(spec, reading.spans, reading.language)
        found += [Problem(f"/claims/{m.claim}/by", m.text) for m in words if m.sure]
    denied = misdenied(spec, reading.spans, reading.language)
    found += [Problem(f"/claims/{claim}/by", text) for claim, text, sure in denied if sure]
    return [*found, *contradiction_problems(spec), *unclaimed_problems(spec), *_whole(spec, reading)]


def _claim(spec: WorldSpec, document: Any, name: str, claim: Claim) -> Iterator[Problem]:
    place = f"/claims/{name}"
    if claim.same_as is not None:
        other = spec.claims.get(claim.same_as)
        if other is None or other.same_as is not None or other.type != claim.type or claim.same_as == name:
            alone = sorted(k for k, c in spec.claims.items() if k != name and c.type == claim.type and c.same_as is None)
            text = (
                f"same_as {claim.same_as!r} must be another claim of type {claim.type} that stands for itself; it takes a claim's id, made of "
                f"the words that it quotes: {', '.join(alone[:_SHOWN]) or 'there is none yet'}"
            )
            yield Problem(f"{place}/same_as", text)
        elif not set(claim.by) <= set(other.by):
            more = sorted(set(claim.by) - set(other.by))
            yield Problem(
                f"{place}/by",
                f"{claim.quote!r} is same_as {claim.same_as!r}, which does not name {more[0]}: name some of the same, or nothing",
            )
    if claim.waived is not None:
        return
    for index, pointer in enumerate(claim.by):
        at = f"{place}/by/{index}"
        if not resolves(document, pointer):
            yield Problem(at, f"pointer {pointer!r} leads nowhere; name what is in the specification")
        elif not may_judge(claim.type, pointer):
            allowed = ", ".join(f"/{root}" for root in JUDGED_BY[claim.type])
            yield Problem(at, f"a claim of type {claim.type} is judged by {allowed}, not by {pointer!r}")
    yield from _optional(spec, name, claim)
    yield from (Problem(f"{place}/by", text) for text in posture_problems(spec, name, claim))
    yield from _DUTIES.get(claim.type, _nothing)(spec, document, name, claim)


def _optional(spec: WorldSpec, name: str, claim: Claim) -> Iterator[Problem]:
    """A claim whose words no mandatory beat or requirement judges, though it names nothing else."""
    story: Mapping[str, Mapping[str, Beat | Requirement]] = {"beats": spec.story.beats, "requirements": spec.story.requirements}
    named = [m.groups() for p in claim.by if (m := _ASKED.match(p))]
    asked = {n: story[group][n] for group, n in named if n in story[group]}
    if asked and len(named) == len(claim.by) and claim.type != "event" and not any(a.mandatory for a in asked.values()):
        text = f"{claim.quote!r} is judged by what is optional alone ({', '.join(asked)}); make one of it mandatory"
        yield Problem(f"/claims/{name}/by", text)


def _nothing(spec: WorldSpec, document: Any, name: str, claim: Claim) -> Iterator[Problem]:
    yield from ()


# ---------------------------------------------------------------- things and counts


def _thing(spec: WorldSpec, document: Any, name: str, claim: Claim) -> Iterator[Problem]:
    for index, pointer in enumerate(claim.by):
        if pointer.startswith("/entities/") and not _ENTITY.fullmatch(pointer):
            text = f"a thing is an entity or a part of one, as /entities/<id> or /entities/<id>/parts/<part>, not {pointer!r}"
            yield Problem(f"/claims/{name}/by/{index}", text)
    yield from matter_problems(spec, name)


def _count(spec: WorldSpec, document: Any, name: str, claim: Claim) -> Iterator[Problem]:
    # Counts are whole numbers in the specification; a length that happens to be 3 counts nothing.
    whole = {p: leaf_at(document, p) for p in claim.by if isinstance(value_at(document, p), int)}
    yield from count_problems(spec, name, claim, whole)


# ---------------------------------------------------------------- properties


def _property(spec: WorldSpec, document: Any, name: str, claim: Claim) -> Iterator[Problem]:
    yield from substance_problems(spec, name)


# ---------------------------------------------------------------- events, order, negation, ways


def _event(spec: WorldSpec, document: Any, name: str, claim: Claim) -> Iterator[Problem]:
    beats = {n: spec.story.beats[n] for n in named_in(spec, name, _BEATS) if n in spec.story.beats}
    good = [n for n, b in beats.items() if b.mandatory and b.observe and _happens(b)]
    if beats and not good:
        why = "; ".join(f"{n} {_lacks(b)}" for n, b in list(beats.items())[:3])
        kinds = ", ".join(sorted(EVENT_KINDS))
        yield Problem(
            f"/claims/{name}/by",
            f"{claim.quote!r} is an event: name a beat that is mandatory, observed and tells of one ({why}); "
            f"how something is and stays is no event: mark it as property, by the same beat; kinds of event are {kinds}",
        )

    known = {e for o, c in spec.claims.items() if c.type in ("thing", "count") for e in named_in(spec, o, "entities")}
    for key, beat in beats.items():
        subject = spec.entities.get(beat.subject)
        # What rains or is poured may have no word of its own.
        if subject is not None and beat.subject not in known and subject.physics.shape != "loose":
            text = f"{claim.quote!r} is told of {beat.subject!r}, which no claim of a thing names: claim the words of it, or name a beat of what is claimed"
            yield Problem(f"/claims/{name}/by/{claim.by.index(f'/{_BEATS}/{key}')}", text)


def _happens(beat: Beat) -> bool:
    return not is_invariant(beat.predicate) and bool(event_atoms(beat.predicate))


def _lacks(beat: Beat) -> str:
    if not beat.mandatory:
        return "is optional"
    if not beat.observe:
        return "need not be seen"
    return f"asks {beat.predicate.kind}, which is no kind of event"


def _order(spec: WorldSpec, document: Any, name: str, claim: Claim) -> Iterator[Problem]:
    beats = [n for n in named_in(spec, name, _BEATS) if n in spec.story.beats]
    asked: list[Beat | Requirement] = [spec.story.beats[n] for n in beats]
    asked += [spec.story.requirements[n] for n in named_in(spec, name, _REQUIREMENTS) if n in spec.story.requirements]
    for key in named_in(spec, name, _REQUIREMENTS):
        requirement = spec.story.requirements.get(key)
        if requirement is not None and requirement.never and kinds_of(requirement.predicate) & _ORDERED:
            text = f"{key!r} must never be in an order, which both at once meets too; give the order that holds, without never"
            yield Problem(f"/story/requirements/{key}/never", text)
    if len(beats) < 2 and not any(orderings_of(a.predicate) for a in asked):
        text = (
            f"{claim.quote!r} is an order: name two beats, the first first, or one requirement of {', '.join(sorted(_ORDERED))}"
        )
        yield Problem(f"/claims/{name}/by", text)


def _negation(spec: WorldSpec, document: Any, name: str, claim: Claim) -> Iterator[Problem]:
    yield from negation_problems(spec, name, claim)


def _route(spec: WorldSpec, document: Any, name: str, claim: Claim) -> Iterator[Problem]:
    for key in named_in(spec, name, "graph/relations"):
        relation = spec.graph.relations.get(key)
        if relation is not None and not isinstance(relation, Connects):
            text = f"{claim.quote!r} is a way: {key!r} is {relation.kind}; name a `connects` relation, a region on it, or a beat of the motion along it"
            yield Problem(f"/claims/{name}/by", text)
    known = _named_by(spec, claim)
    for key in named_in(spec, name, _BEATS):
        body = spec.story.beats[key].subject if key in spec.story.beats else ""
        if known and body in spec.entities and body not in known and spec.entities[body].physics.shape != "loose":
            text = f"{claim.quote!r} is a way that {body!r} goes by {key!r}, and no claim of a thing up to the end of its sentence names that: name a beat of what goes there"
            yield Problem(f"/claims/{name}/by", text)


def _named_by(spec: WorldSpec, claim: Claim) -> frozenset[str]:
    """Bodies of the things that the prompt has named by the end of the sentence of a claim; none where the claim is not in it."""
    quoted = {n: _start(spec, c) for n, c in spec.claims.items() if c.type in ("thing", "count")}
    start = _start(spec, claim)
    if start is None:
        return frozenset()
    end = next((m.end() for m in SENTENCE.finditer(spec.prompt, start)), len(spec.prompt))
    told = (n for n, at in quoted.items() if at is not None and at < end)
    return frozenset(b for n in told for b in named_in(spec, n, "entities"))


def _start(spec: WorldSpec, claim: Claim) -> int | None:
    try:
        return occurrence(spec.prompt, claim.quote, claim.nth)[0]
    except InputError:
        return None


_DUTIES = {
    "thing": _thing,
    "count": _count,
    "quantity": quantity_problems,
    "property": _property,
    "event": _event,
    "order": _order,
    "negation": _negation,
    "route": _route,
}


# ---------------------------------------------------------------- the prompt as a whole


def _whole(spec: WorldSpec, reading: Reading) -> Iterator[Problem]:
    if not any(c.type == "thing" and c.waived is None for c in spec.claims.values()):
        text = "no claim says which words of the prompt are things of this world; mark them: edit_spec(claims='A [ball](thing ball) ...')"
        yield Problem("/claims", text)
    for held in reading.held:
        yield from _held(spec, reading, held)
    if reading.waived > WAIVED_SHARE:
        text = f"{reading.waived:.0%} of the prompt's letters are waived, at most {WAIVED_SHARE:.0%} may be: the world is incomplete; claim more of them"
        yield Problem("/claims", text)


def _held(spec: WorldSpec, reading: Reading, held: Held) -> Iterator[Problem]:
    """A number, negation or order word that no claim takes up, or one whose type does not judge it."""
    word = spec.prompt[held.start : held.end]
    span = next((s for s in reading.spans if s.start <= held.start and held.end <= s.end), None)
    if span is None or span.claim is None:
        text = f"{word!r} at character {held.start} is a {held.kind} word and no claim takes it up: mark it as {_type_for(spec, held)}"
        yield Problem("/claims", text)
        return
    claim = spec.claims[span.claim]
    if held.kind == "negation" and claim.waived is not None and _denies_outside(spec, reading, span, word):
        text = f"{word!r} is waived without what it denies, which then counts as said: mark both as one span, [{word} ...](negation NAME), or waive both as one"
        yield Problem(f"/claims/{span.claim}/waived", text)
        return
    lost = claim.type != "negation" if held.kind == "negation" else claim.type in _NUMBERLESS and held.kind == "number"
    # A single thing, or a part of one, as `at one leg`, is what such a claim names anyhow.
    lost = lost and not (
        held.kind == "number" and number_in(word, reading.language) == 1 and len(set(named_in(spec, span.claim, "entities"))) < 2
    )
    if lost and claim.waived is None and not (held.kind == "number" and ordinal_in(word, reading.language) is not None):
        text = f"{word!r} of {claim.quote!r} is a {held.kind} word, which a claim of type {claim.type} does not judge: mark it as {_type_for(spec, held)}"
        yield Problem(f"/claims/{span.claim}/type", text)


def _denies_outside(spec: WorldSpec, reading: Reading, span: Span, word: str) -> bool:
    """True where an event that is claimed to happen stands right beside a waived span that holds a negation, or later in the sentence of one alone."""
    events = [s for s in reading.spans if s.claim is not None and s.type == "event" and spec.claims[s.claim].waived is None]
    gaps = {s: spec.prompt[span.end : s.start] for s in events if s.start >= span.end}
    if any(not gap.strip() for gap in gaps.values()):
        return True
    if span.text.strip() != word:
        return False
    beside = any(s.end <= span.start and not spec.prompt[s.end : span.start].strip() for s in events)
    return beside or any(SENTENCE.search(gap) is None for gap in gaps.values())


def _type_for(spec: WorldSpec, held: Held) -> str:
    """Types that a held word may be marked as."""
    if held.kind == "number" and (":" in spec.prompt[held.start : held.end] or _CLOCK.match(spec.prompt, held.end)):
        return "time, with the words of the clock, by the sun of /look"
    return _TYPE_OF[held.kind]


_CLOCK = re.compile(r"\s*(?:[ap]\.?\s?m\b|o['’]clock\b|uhr\b|uur\b)", re.IGNORECASE)
"""Words behind a number that make it a time of day."""
_TYPE_OF = {"number": "count or quantity", "negation": "negation", "order": "order"}
_NUMBERLESS = frozenset({"thing", "property", "event", "look"})
