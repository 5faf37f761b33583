"""Counts of how often something happens: `twice`, `three times`, `dreimal`, `deux fois` (R131, R155).

Such a claim names as many beats of one kind of event of the same bodies, each with frames of its own, or a number that counts turns. That it
happens neither less nor more often is measured in `verifiers/claims/repeats.py`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import pairwise

from ..claim_targets import named_in
from ..predicates import entities_of
from ..predicates.events import event_atoms
from ..problems import Problem
from ..repeats import times_of
from ..spec import Beat, Claim, WorldSpec

__all__ = ["repeat_beats", "repeat_problems"]

_TURNS = ("spins", "rolls", "swings", "flutters")
"""Kinds whose own measure counts turns or swings."""


def repeat_beats(spec: WorldSpec, name: str) -> dict[str, Beat]:
    """Beats that a claim names, in the order of their frames."""
    named = [n for n in named_in(spec, name, "story/beats") if n in spec.story.beats]
    return {n: spec.story.beats[n] for n in sorted(named, key=lambda n: spec.story.beats[n].frames)}


def repeat_problems(spec: WorldSpec, name: str, claim: Claim, leaves: Mapping[str, float | None]) -> Iterator[Problem]:
    """Problems of one claim of how often something happens."""
    times, beats, place = times_of(spec, name) or 0.0, repeat_beats(spec, name), f"/claims/{name}/by"
    if any(_turns(spec, p, value, times) for p, value in leaves.items()):
        return
    if len(beats) != times:
        text = f"{claim.quote!r} counts how often something happens, by names {len(beats)} beats: name {times:g} beats of it, one after another, "
        yield Problem(place, text + "each with frames of its own")
        return
    told = {n: {(str(getattr(a, "kind", "")), entities_of(a)) for a in event_atoms(b.predicate)} for n, b in beats.items()}
    first = next(iter(told))
    other = next((n for n in told if told[n] != told[first] or not told[n]), None)
    if other is not None:
        yield Problem(
            place,
            f"{claim.quote!r} counts one event, and {first!r} and {other!r} are of different kinds or bodies: tell the same of the same",
        )
    for (a, one), (b, two) in pairwise(beats.items()):
        if two.frames[0] <= one.frames[1]:
            text = f"{claim.quote!r}: {b!r} begins at frame {two.frames[0]}, before {a!r} ends at {one.frames[1]}: both may be the same event; part their frames"
            yield Problem(f"/story/beats/{b}/frames", text)


def _turns(spec: WorldSpec, pointer: str, value: float | None, times: float) -> bool:
    """True where a number of the story asks for so many turns of a body."""
    keys = pointer.strip("/").split("/")
    if keys[:2] != ["story", "beats"] or len(keys) < 5 or keys[2] not in spec.story.beats or value is None:
        return False
    kinds = {str(getattr(a, "kind", "")) for a in event_atoms(spec.story.beats[keys[2]].predicate)}
    per = 2 * math.pi if kinds & {"spins", "rolls"} else 1.0
    return bool(kinds & set(_TURNS)) and value >= times * per * (1 - 1e-3)
