"""Steps of the orders that claims tell: one event before another."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

from ..claim_targets import named_in
from ..predicates import After, Before, Within
from ..predicates.ordering import orderings_of
from ..spec import SpecModel, WorldSpec

__all__ = ["Step", "steps_of"]


class Step(NamedTuple):
    """One event before another, by a claim."""

    earlier: str
    """A beat, or `requirement <id>` where no beat tells that event."""
    later: str
    claim: str
    first: SpecModel | None = None
    """Predicate of the earlier event where a requirement tells it."""
    second: SpecModel | None = None


def steps_of(spec: WorldSpec, name: str) -> Iterator[Step]:
    """Steps that a claim of order names: by two beats, or by a predicate of order."""
    beats, requirements = spec.story.beats, spec.story.requirements
    named = [b for b in named_in(spec, name, "story/beats") if b in beats]
    yield from (Step(a, b, name) for a, b in pairwise(named))
    told: list[tuple[str, SpecModel]] = [(b, beats[b].predicate) for b in named]
    for r in named_in(spec, name, "story/requirements"):
        if r in requirements and not requirements[r].never:
            told.append((_beat_of(spec, requirements[r].predicate) or f"requirement {r}", requirements[r].predicate))
    for own, predicate in told:
        for ordering in orderings_of(predicate):
            if isinstance(ordering, Before):
                yield Step(own, ordering.beat, name, first=ordering.predicate)
            elif isinstance(ordering, After | Within):
                yield Step(ordering.beat, own, name, second=ordering.predicate)


def _beat_of(spec: WorldSpec, predicate: SpecModel) -> str | None:
    """The beat that tells the event of a requirement of order."""
    inner = getattr(predicate, "predicate", None)
    return next((n for n, b in spec.story.beats.items() if b.predicate == inner), None)
