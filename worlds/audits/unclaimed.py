"""Bodies that no claim speaks of satisfy nothing: what a claim is judged by is told of bodies that have a span of the prompt (R2, R156)."""

from __future__ import annotations

from collections.abc import Iterator

from ..bound_fields import spoken_of
from ..claims import named_in
from ..decoys import SPEAK
from ..predicates import atoms_of, entities_of
from ..predicates.events import PairEvent
from ..problems import Problem
from ..spec import Beat, Requirement, WorldSpec

__all__ = ["unclaimed_problems"]

_HELD = {"story/beats": "beat", "story/requirements": "requirement"}


def unclaimed_problems(spec: WorldSpec) -> Iterator[Problem]:
    """Claims whose beats or requirements come true by bodies that no claim names.

    Still ground may have no word of its own where a body only touches it: a ball lands on a floor that the prompt does not name. What is
    acted upon has one, and what is denied is denied of bodies of the prompt; matter without a shape, as rain, may have none.
    """
    known = spoken_of(spec, types=SPEAK)
    for name, claim in spec.claims.items():
        if claim.waived is not None:
            continue
        for group, noun in _HELD.items():
            for key in named_in(spec, name, group):
                item = (spec.story.beats if group == "story/beats" else spec.story.requirements).get(key)
                if item is None:
                    continue
                # The subject of an event has a duty of its own.
                spoken = {*known, item.subject} if claim.type == "event" and isinstance(item, Beat) else known
                left = _unclaimed(spec, item, spoken, still=claim.type != "negation")
                if left:
                    text = (
                        f"{claim.quote!r} is judged by {noun} {key!r}, which is told of {left[0]!r}, a body that no claim names: it satisfies "
                        "nothing; tell it of what is claimed, or claim the words of it as a thing"
                    )
                    yield Problem(f"/claims/{name}/by", text)


def _unclaimed(spec: WorldSpec, item: Beat | Requirement, known: set[str], *, still: bool) -> list[str]:
    """Bodies of a beat or requirement that no claim names.

    Args:
        spec: that it is of.
        item: the beat or requirement.
        known: bodies that claims name.
        still: what never moves and is not acted upon needs no claim.
    """
    acted = {atom.other for atom in atoms_of(item.predicate) if isinstance(atom, PairEvent)}
    named = [n for n in entities_of(item.predicate) if n in spec.entities and n not in known]
    return [
        n
        for n in named
        if spec.entities[n].physics.shape != "loose" and not (still and spec.entities[n].motion == "static" and n not in acted)
    ]
