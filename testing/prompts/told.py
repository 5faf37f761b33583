"""Honest prompts told by worlds: whether there are beats and requirements about their own things that every rule of words takes (R2, R131).

Worlds are boxes, one for each thing that somebody marked, as many as are counted. What events, negations and orders are told of is looked for among
them; rules that look at substance, place and motion are not asked.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from itertools import permutations
from typing import Any

from ...worlds.amounts import miscounted
from ...worlds.audits.claims import claim_problems
from ...worlds.audits.orders import order_problems
from ...worlds.claims import reading_of
from ...worlds.contradicted_words import contradicted_words
from ...worlds.definites import misread_definites
from ...worlds.denials import misdenied
from ...worlds.hedged import hedged_events
from ...worlds.patch import parse_spec
from ...worlds.prompts.amount_words import amount_phrases
from ...worlds.prompts.lexicon import verb_kinds
from ...worlds.prompts.numbers import number_in
from ...worlds.pronouns import misread_pronouns
from ...worlds.roles import misplaced_roles
from ...worlds.row_words import misnamed_rows
from ...worlds.spec import WorldSpec
from ...worlds.subjects import misplaced_subjects
from . import Marked, placed

__all__ = ["refusals", "refused_words", "untaken"]

PAIRS = ("hits", "pushes", "pulls", "lifts", "lowers", "throws")
KINDS = ("falls", "rolls", "slides", "tips", "rises", "stops", "breaks", "cracks", *PAIRS)
UNASKED = "told of in no beat here"
MOST = 40
"""A prompt that counts more things is told of so many."""


def _box(place: int) -> dict[str, Any]:
    part = {"shape": {"kind": "box", "size": [0.1, 0.1, 0.1]}}
    pose = {"position": [0.3 * place, 0, 1]}
    own = {"role": "thing", "motion": "dynamic", "material": "m", "pose": pose}
    return {**own, "dimensions": {"size": [0.1, 0.1, 0.1]}, "parts": {"b": part}}


def _nth(text: str, start: int, end: int) -> int:
    quote, at, nth = text[start:end], -1, 0
    while at < start:
        at, nth = text.index(quote, at + 1), nth + 1
    return nth


class _Told:
    """An honest prompt with boxes for its things, and what its other spans could be told of."""

    def __init__(self, prompt: Marked) -> None:
        self.prompt, self.spans = prompt, sorted(placed(prompt))
        self.things = [k for k, (_, _, kind) in enumerate(self.spans) if kind == "thing"]
        self.first = {k: self._again(k) for k in self.things}
        """The first thing of the same words, for what stands behind `the`; else the thing itself."""
        self.bodies: dict[int, list[str]] = {}
        for k in self.things:
            self.bodies[k] = self.bodies.get(self.first[k]) or [f"e{k}_{n}" for n in range(self._many(k))]

    def _again(self, thing: int) -> int:
        before = self.prompt.text[: self.spans[thing][0]].split()[-1:]
        if not before or before[0].casefold() not in ("the", "this", "that"):
            return thing
        return next((k for k in self.things if k < thing and self.quote(k).casefold() == self.quote(thing).casefold()), thing)

    def _many(self, thing: int) -> int:
        """Number of a thing: that of the count before it, or of its own words."""
        before = [k for k in range(thing) if self.spans[k][2] in ("count", "thing")]
        words = [self.quote(thing)]
        if before and self.spans[before[-1]][2] == "count":
            words.append(self.quote(before[-1]))
        numbers = [n for w in words if (n := number_in(w, self.prompt.language)) is not None and n == int(n)]
        known = amount_phrases(self.prompt.language)
        numbers += [known[key].least for w in words if (key := tuple(w.lower().split())) in known]
        return int(min(MOST, max([1, *numbers])))

    def quote(self, span: int) -> str:
        """Words of a span."""
        start, end, _ = self.spans[span]
        return self.prompt.text[start:end]

    def near(self, span: int) -> list[list[str]]:
        """Bodies of the things, those before a span first, the nearest of them first."""
        before, behind = [k for k in self.things if k < span], [k for k in self.things if k > span]
        return [self.bodies[k] for k in [*reversed(before), *behind]]

    def meant(self, span: int) -> frozenset[str]:
        """Kinds of the English verbs of an event, or of a negation and the rest of its sentence."""
        start, end, kind = self.spans[span]
        if self.prompt.language != "en":
            return frozenset()
        rest = self.prompt.text[start:].split(".")[0] if kind == "negation" else self.prompt.text[start:end]
        return frozenset(k for word in rest.split() for k in verb_kinds(word.strip(",;:!?")) or ())

    def choices(self, span: int) -> Iterator[list[dict[str, Any]]]:
        """Predicates that an event or a negation may be told by, the likeliest first."""
        for kind in sorted(KINDS, key=lambda k: k not in self.meant(span)):
            for bodies in self.near(span):
                if kind not in PAIRS:
                    yield [{"kind": kind, "entity": b} for b in bodies]
                    continue
                others = [o[0] for o in self.near(span) if o[0] not in bodies]
                yield from ([{"kind": kind, "entity": b, "other": other} for b in bodies] for other in others)
        yield from ([{"kind": "displacement", "entity": b, "min": 0.002} for b in bodies] for bodies in self.near(span))

    def world(self, chosen: Mapping[int, list[dict[str, Any]]], orders: Mapping[int, tuple[int, int]]) -> WorldSpec:
        """The world with predicates of its events and negations, and pairs of events of its orders, by number of the span."""
        beats: dict[str, Any] = {}
        denied: dict[str, Any] = {}
        claims: dict[str, Any] = {}
        for k, (start, end, kind) in enumerate(self.spans):
            claim: dict[str, Any] = {"quote": self.quote(k), "nth": _nth(self.prompt.text, start, end), "type": kind}
            by: list[str] = []
            if kind == "thing":
                by = [f"/entities/{n}" for n in self.bodies[k]]
                claim |= {"same_as": f"c{self.first[k]}"} if self.first[k] != k else {}
            elif kind == "event" and k in chosen:
                for n, predicate in enumerate(chosen[k]):
                    told = {"text": "it", "owner": "rigid", "subject": predicate["entity"], "frames": [0, 8]}
                    beats[f"b{k}_{n}"] = {**told, "predicate": predicate}
                    by.append(f"/story/beats/b{k}_{n}")
            elif kind == "negation" and k in chosen:
                for n, predicate in enumerate(chosen[k]):
                    denied[f"r{k}_{n}"] = {"text": "never", "predicate": predicate, "never": True}
                    by.append(f"/story/requirements/r{k}_{n}")
            elif k in orders:
                by = [f"/story/beats/b{at}_0" for at in orders[k]]
            claims[f"c{k}"] = claim | ({"by": by} if by else {"waived": UNASKED})
        entities = {n: _box(i) for i, n in enumerate(dict.fromkeys(n for own in self.bodies.values() for n in own))}
        return parse_spec(
            {
                "spec_version": "2",
                "title": "honest",
                "prompt": self.prompt.text,
                "claims": claims,
                "entities": entities,
                "materials": {"m": {"density": 600, "substance": "wood"}},
                "story": {"beats": beats, "requirements": denied},
                "simulation": {"frames": 9, "solvers": {"rigid": {"engine": "mujoco", "members": list(entities)}}},
            }
        )


def untaken(prompt: Marked) -> list[str]:
    """Numbers, negations and words of order that no span of a prompt takes up, or one that does not judge them; quotes that are not in it."""
    claims = {f"c{k}": {**span._asdict(), "by": ["/entities/x"]} for k, span in enumerate(prompt.spans)}
    spec = parse_spec(
        {"spec_version": "2", "title": "honest", "prompt": prompt.text, "claims": claims, "simulation": {"frames": 9}}
    )
    texts = [p.text for p in claim_problems(spec) if "word" in p.text]
    return [text for _, text in reading_of(spec).problems] + [
        text for text in texts if "no claim takes it up" in text or "does not judge" in text
    ]


def refused_words(spec: WorldSpec) -> dict[str, str]:
    """Claims that a rule of words refuses, with the first reason."""
    found: dict[str, str] = {}
    reading = reading_of(spec)
    for rule in (
        misplaced_roles,
        misplaced_subjects,
        misread_pronouns,
        misread_definites,
        misnamed_rows,
        hedged_events,
        miscounted,
        contradicted_words,
    ):
        for problem in rule(spec, reading.spans, reading.language):
            if problem.sure:
                found.setdefault(problem.claim, problem.text)
    for claim, text, sure in misdenied(spec, reading.spans, reading.language):
        if sure:
            found.setdefault(claim, text)
    for fault in order_problems(spec, reading):
        found.setdefault(fault.pointer.split("/")[2], fault.text)
    return found


@cache
def refusals(prompt: Marked) -> dict[str, str]:
    """Claims of a prompt that a rule of words refuses whatever its events, negations and orders are told of, with the first reason."""
    told = _Told(prompt)
    kinds = [kind for _, _, kind in told.spans]
    chosen = {k: next(told.choices(k)) for k, kind in enumerate(kinds) if kind in ("event", "negation") and told.things}
    for k in [k for k in chosen if f"c{k}" in refused_words(told.world(chosen, {}))]:
        for choice in told.choices(k):
            chosen[k] = choice
            if f"c{k}" not in refused_words(told.world(chosen, {})):
                break
    events = [k for k in chosen if kinds[k] == "event"]
    orders: dict[int, tuple[int, int]] = {}
    for k in [k for k, kind in enumerate(kinds) if kind == "order"]:
        for a, b in sorted(permutations(events, 2), key=lambda pair: abs(pair[0] - k) + abs(pair[1] - k)):
            orders[k] = (a, b)
            if f"c{k}" not in refused_words(told.world(chosen, orders)):
                break
    return refused_words(told.world(chosen, orders))
