"""Claims that cannot all be true: what one of them says another denies (R131, R155).

- an event, and a negation of it of the same entity: a negation holds over all frames;
- an order, and its reverse, over any number of claims; or one that the frames of the beats leave no room for;
- different numbers of the same bodies; different quantities of the same field;
- words of materials that exclude each other, of the same part.

Only what the specification shows is told here; what the motion shows is told by its rows.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations, pairwise

from ..claims import named_in, targets_of
from ..orders import says_together
from ..predicates.denying import certain, denying, implies
from ..problems import Problem
from ..prompts.languages import language_of
from ..quantities import quantity_said
from ..references import cycle_in
from ..spec import Claim, WorldSpec
from .counts import counted_of
from .properties import allowed_substances
from .steps import steps_of

__all__ = ["contradiction_problems"]

_BEATS, _REQUIREMENTS = "story/beats", "story/requirements"


def contradiction_problems(spec: WorldSpec) -> Iterator[Problem]:
    """Every two claims, or chain of them, that contradict each other."""
    yield from _denied(spec)
    yield from _orders(spec)
    yield from _numbers(spec)
    yield from _quantities(spec)
    yield from _substances(spec)


def _claims(spec: WorldSpec, *types: str) -> list[tuple[str, Claim]]:
    return [(n, c) for n, c in spec.claims.items() if c.type in types and c.waived is None]


# ---------------------------------------------------------------- events and their negations


def _denied(spec: WorldSpec) -> Iterator[Problem]:
    """Events that a claim tells and a negation denies."""
    denials = [
        (claim, atom)
        for name, claim in _claims(spec, "negation")
        for r in named_in(spec, name, _REQUIREMENTS)
        if r in spec.story.requirements and spec.story.requirements[r].never
        for atom in denying(spec.story.requirements[r].predicate)
    ]
    for name, claim in _claims(spec, "event"):
        for b in named_in(spec, name, _BEATS):
            beat = spec.story.beats.get(b)
            for atom in certain(beat.predicate) if beat is not None else ():
                for denial, never in denials:
                    if implies(atom, never):
                        text = f"{claim.quote!r} says by {b!r} what {denial.quote!r} denies: {getattr(atom, 'kind', '')} of the same; one of the two is not what the words mean"
                        yield Problem(f"/claims/{name}/by", text)


# ---------------------------------------------------------------- orders


def _orders(spec: WorldSpec) -> Iterator[Problem]:
    language = language_of(spec.prompt)
    told = [name for name, claim in _claims(spec, "order") if not says_together(claim.quote, language)]
    steps = [step for name in told for step in steps_of(spec, name)]
    edges: dict[str, list[str]] = {}
    for step in steps:
        edges.setdefault(step.earlier, []).append(step.later)
        edges.setdefault(step.later, [])
    cycle = cycle_in(edges)
    if cycle:
        pairs = list(pairwise(cycle))
        names = dict.fromkeys(s.claim for s in steps if (s.earlier, s.later) in pairs)
        quotes = " and ".join(repr(spec.claims[n].quote) for n in names)
        yield Problem(
            f"/claims/{next(iter(names))}/by",
            f"{quotes} put the same events in orders that exclude each other: {' before '.join(cycle)}",
        )
    beats = spec.story.beats
    for step in steps:
        one, two = beats.get(step.earlier), beats.get(step.later)
        if one is not None and two is not None and two.frames[1] <= one.frames[0]:
            text = f"{spec.claims[step.claim].quote!r} wants {step.earlier} before {step.later}, whose frames {list(two.frames)} end before its own {list(one.frames)} begin"
            yield Problem(f"/claims/{step.claim}/by", text)


# ---------------------------------------------------------------- numbers and materials


def _numbers(spec: WorldSpec) -> Iterator[Problem]:
    """Counts of the same bodies, or of the same beat, that say different numbers."""
    counts = [(n, counted_of(spec, n)) for n, _ in _claims(spec, "count")]
    for (a, one), (b, two) in combinations(counts, 2):
        same = (set(one.units) == set(two.units) and one.units) or set(one.stories) & set(two.stories)
        if same and None not in (one.number, two.number) and one.number != two.number:
            text = f"{spec.claims[a].quote!r} and {spec.claims[b].quote!r} count the same and are different numbers: {one.number:g} and {two.number:g}"
            yield Problem(f"/claims/{b}/by", text)


def _quantities(spec: WorldSpec) -> Iterator[Problem]:
    """Quantities of the same field that no number meets."""
    told = []
    for name, _ in _claims(spec, "quantity"):
        found = quantity_said(spec, name)
        if found is not None:
            told.append((name, found, set(targets_of(spec.claims, name))))
    for (a, one, here), (b, two, there) in combinations(told, 2):
        if here & there and (one.dimension != two.dimension or max(one.low, two.low) > min(one.high, two.high)):
            text = f"{spec.claims[a].quote!r} and {spec.claims[b].quote!r} are both {min(here & there)}, and no number is both"
            yield Problem(f"/claims/{b}/by", text)


def _substances(spec: WorldSpec) -> Iterator[Problem]:
    """Words of materials of the same pointer that exclude each other."""
    told = [
        (name, word, set(substances), set(targets_of(spec.claims, name)))
        for name, claim in _claims(spec, "property")
        for word, substances in allowed_substances(claim.quote, language_of(spec.prompt))
    ]
    for (a, word, one, here), (b, other, two, there) in combinations(told, 2):
        if here & there and not one & two:
            text = f"{word!r} of {spec.claims[a].quote!r} and {other!r} of {spec.claims[b].quote!r} are both said of {min(here & there)}, and no material is both"
            yield Problem(f"/claims/{b}/by", text)
