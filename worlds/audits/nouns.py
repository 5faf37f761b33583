"""The noun that a number stands before: a count is one of what the noun names, and `2 m` before `beam` is a number of the beam (R131, R155).

A count whose noun no claim of a thing takes up is printed as the agent's reading. See `worlds/nouns.py`.
"""

from __future__ import annotations

from collections.abc import Iterator

from ..claim_targets import named_in, targets_of
from ..claims import Reading
from ..nouns import Noun, noun_of
from ..predicates import entities_of
from ..problems import Problem
from ..repeats import is_repeat
from ..spec import WorldSpec
from .counts import counted_of, countings_of

__all__ = ["noun_problems"]


def noun_problems(spec: WorldSpec, reading: Reading) -> Iterator[Problem]:
    """Counts of other bodies than their noun names, and quantities right before a noun that are numbers of something else."""
    for index, span in enumerate(reading.spans):
        if span.claim is None or span.type not in ("count", "quantity") or spec.claims[span.claim].waived is not None:
            continue
        if span.type == "count" and is_repeat(spec, span.claim):
            continue
        noun = noun_of(spec, reading.spans, index, reading.language)
        if noun is None or spec.claims[noun.claim].waived is not None:
            continue
        found = _counts(spec, span.claim, noun) if span.type == "count" else _measures(spec, span.claim, noun)
        if found:
            quote, thing = spec.claims[span.claim].quote, spec.claims[noun.claim].quote
            named = ", ".join(_short(p) for p in targets_of(spec.claims, noun.claim)[:4])
            said = "counts" if span.type == "count" else "is judged by a number of"
            text = f"{quote!r} stands before {thing!r} ({named}) and {said} {', '.join(found[:3])}: name what {thing!r} names, or claim the words of the other as a thing"
            yield Problem(f"/claims/{span.claim}/by", text)


def _short(pointer: str) -> str:
    return pointer.removeprefix("/entities/")


def _counts(spec: WorldSpec, name: str, noun: Noun) -> list[str]:
    """Units that a count names and its noun does not."""
    counted, named = counted_of(spec, name), targets_of(spec.claims, noun.claim)
    bodies = {p.split("/")[2] for p in named if p.startswith("/entities/")}
    left = [u for u in counted.units if u not in named and not any(u.startswith(f"{p}/") for p in named)]
    for group, key in counted.stories:
        told = getattr(spec.story, group.split("/")[1]).get(key)
        if told is not None:
            left += [n for c in countings_of(told.predicate) for n in c.entities if n not in bodies]
    return [_short(u) for u in left] if bodies else []


def _measures(spec: WorldSpec, name: str, noun: Noun) -> list[str]:
    """Bodies that a quantity right before a noun is of, where the noun names none of them."""
    bodies = set(named_in(spec, noun.claim, "entities"))
    if not noun.near or not bodies:
        return []
    found: list[str] = []
    for pointer in targets_of(spec.claims, name):
        keys = pointer.strip("/").split("/")
        own: set[str] = set()
        if keys[0] == "entities":
            own = {keys[1]}
        elif keys[0] == "materials":
            own = {n for n, e in spec.entities.items() if keys[1] in (e.material, *(p.material for p in e.parts.values()))}
        elif keys[0] == "story" and len(keys) > 2:
            told = getattr(spec.story, keys[1], {}).get(keys[2])
            own = set(entities_of(told.predicate)) if told is not None else set()
        if own and not own & bodies:
            found += sorted(own & spec.entities.keys())
    return found
