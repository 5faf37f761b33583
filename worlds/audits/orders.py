"""Claims of order against the events whose words stand beside theirs (R131, R155)."""

from __future__ import annotations

from collections.abc import Iterator

from ..claim_targets import named_in
from ..claims import Reading
from ..orders import Ordered, orders_said
from ..predicates import Until, atoms_of, entities_of
from ..predicates.ordering import orderings_of
from ..problems import Problem
from ..spec import SpecModel, WorldSpec
from .steps import Step, steps_of

__all__ = ["order_problems"]

_BEATS = "story/beats"


def order_problems(spec: WorldSpec, reading: Reading) -> Iterator[Problem]:
    """Orders of other events than those beside their words, or the other way round."""
    for index, span in enumerate(reading.spans):
        if span.type != "order" or span.claim is None or spec.claims[span.claim].waived is not None:
            continue
        said = orders_said(spec, reading.spans, index, reading.language)
        steps = list(steps_of(spec, span.claim))
        if not said or not (steps or _untils(spec, span.claim)) or any(_meets(spec, span.claim, s, steps) for s in said):
            continue
        if said[0].together:
            yield Problem(f"/claims/{span.claim}/by", _apart(spec, span.claim, said))
            continue
        quote, earlier, later = spec.claims[span.claim].quote, said[0].earlier, said[0].later
        first, second = (" or ".join(repr(spec.claims[n].quote) for n in names[:3]) for names in (earlier, later))
        names = [_beats(spec, n) for n in (earlier, later)]
        told = " and ".join(f"{s.earlier} before {s.later}" for s in steps[:2]) or "another end"
        reverse = any(_meets(spec, span.claim, Ordered(later, earlier), [s]) for s in steps)
        text = f"{quote!r} says that {first} comes before {second}, and the claim names {told}"
        text += ", the reverse: exchange the two" if reverse else ": name the beats of these words, the first first"
        if all(names):
            text += f", as (order {names[0][0]} {names[1][0]})"
        yield Problem(f"/claims/{span.claim}/by", text)


def _apart(spec: WorldSpec, name: str, said: list[Ordered]) -> str:
    """Words on a claim of two events at once that names others than those beside its words."""
    quotes = list(dict.fromkeys(spec.claims[n].quote for one in said for n in one.earlier))
    beats = _beats(spec, (*said[0].earlier, *said[0].later))
    text = f"{spec.claims[name].quote!r} says that two of {', '.join(map(repr, quotes[:4]))} come at once, and the claim names others: name their beats"
    return text + (f", as (order {' '.join(beats[:2])})" if len(beats) > 1 else "")


def _beats(spec: WorldSpec, claims: tuple[str, ...]) -> list[str]:
    return [b for n in claims for b in named_in(spec, n, _BEATS) if b in spec.story.beats]


def _meets(spec: WorldSpec, name: str, said: Ordered, steps: list[Step]) -> bool:
    earlier, later = _beats(spec, said.earlier), _beats(spec, said.later)
    if any(_is_one(spec, s.earlier, s.first, earlier) and _is_one(spec, s.later, s.second, later) for s in steps):
        return True
    return any(_alike(u.goal, spec.story.beats[b].predicate) for u in _untils(spec, name) for b in later)


def _is_one(spec: WorldSpec, beat: str, predicate: SpecModel | None, beats: list[str]) -> bool:
    """True where a side of an order is one of some beats, or tells the same of the same."""
    return beat in beats or (predicate is not None and any(_alike(predicate, spec.story.beats[b].predicate) for b in beats))


def _untils(spec: WorldSpec, name: str) -> list[Until]:
    asked = [spec.story.beats[b].predicate for b in named_in(spec, name, _BEATS) if b in spec.story.beats]
    asked += [
        spec.story.requirements[r].predicate for r in named_in(spec, name, "story/requirements") if r in spec.story.requirements
    ]
    return [o for predicate in asked for o in orderings_of(predicate) if isinstance(o, Until)]


def _alike(one: SpecModel, other: SpecModel) -> bool:
    """True where two predicates ask for a kind in common of the same bodies."""
    return bool(_signature(one) & _signature(other))


def _signature(predicate: SpecModel) -> set[tuple[object, ...]]:
    return {(getattr(a, "kind", ""), entities_of(a)) for a in atoms_of(predicate)}
