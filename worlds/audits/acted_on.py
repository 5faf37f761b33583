"""Events that something does to a body: they have causes (R28, R155).

Language has no part in it, only the order of words: who a clause has not named before the words of its event is acted on. What knocks over
bottles is named before them; bottles that fall by themselves are.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from ..claims import Reading, named_in
from ..predicates import entities_of
from ..problems import Problem
from ..spec import WorldSpec

__all__ = ["acted_on_problems"]

_CLAUSE_END = re.compile(r"[.,;:!?…،؛؟。，、；：！？\n]")


def acted_on_problems(spec: WorldSpec, reading: Reading) -> list[Problem]:
    """Beats of what an event is done to that name no causes.

    Args:
        spec: the specification.
        reading: of its prompt.
    """
    found: list[Problem] = []
    before: list[str] = []
    for span in reading.spans:
        if span.claim is None:
            before = [] if _CLAUSE_END.search(span.text) else before
        elif span.type in ("thing", "count"):
            entities = named_in(spec, span.claim, "entities")
            before += [n for n in entities if n in spec.entities and spec.entities[n].motion != "static"]
        elif span.type == "event" and before and spec.claims[span.claim].waived is None:
            found += _uncaused(spec, span.claim, before)
    return found


def _uncaused(spec: WorldSpec, name: str, before: list[str]) -> Iterator[Problem]:
    quote = spec.claims[name].quote
    for key in named_in(spec, name, "story/beats"):
        beat = spec.story.beats.get(key)
        if beat is None or beat.causes or {beat.subject, *entities_of(beat.predicate)} & set(before):
            continue
        text = f"{quote!r} is told of {beat.subject!r}, which stands behind it: {', '.join(dict.fromkeys(before))} does it, but beat {key!r} names no "
        text += "causes; say what brings it about, or give a kind of event in which `entity` does it to `other`"
        yield Problem(f"/story/beats/{key}/causes", text)
