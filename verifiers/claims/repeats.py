"""Counts of how often something happens, against the motion: each of its beats comes true, and it happens no more often (R131, R154).

The rival n - 1 is a beat that does not come true, n + 1 one more of its kind in the frames that no beat of the claim takes up.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

from ...worlds.audits.repeats import repeat_beats
from ...worlds.repeats import times_of
from ..predicates.evaluators import beat_times, evaluate
from ..rows.corrections import correction
from ..rows.findings import Finding

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["repeats_of"]


def repeats_of(candidate: Candidate, name: str) -> Finding:
    """The finding about a claim of how often something happens."""
    spec, beats, times = candidate.spec, repeat_beats(candidate.spec, name), beat_times(candidate)
    asked, quote = float(times_of(spec, name) or 0), spec.claims[name].quote
    outcomes = {b: times.outcome(b) for b in beats}
    unknown = next((b for b, o in outcomes.items() if o.status == "unverified"), None)
    last = spec.simulation.frames - 1
    if unknown is not None:
        return Finding(
            "unverified",
            f"{quote!r}: whether {unknown} comes true is not known: {outcomes[unknown].explanation}",
            frames=(0, last),
        )
    came = [b for b, o in outcomes.items() if o.status == "pass"]
    free = _between([beat.frames for beat in beats.values()], last)
    more = [] if len(came) < asked else [f for f in free if any(_again(candidate, b, f) for b in beats)]
    found = len(came) + len(more)
    text = f"{quote!r}: {', '.join(f'{b} at frame {outcomes[b].first_true_frame}' for b in came)} came true"
    text += f", and once more in frames {more[0][0]}..{more[0][1]}" if more else ""
    text += "".join(f"; {b} did not" for b in beats if b not in came)
    evidence = {"rivals": [f"{asked - 1:g}", f"{asked + 1:g}"], "beats": {b: o.first_true_frame for b, o in outcomes.items()}}
    if found == asked:
        return Finding("pass", text, float(found), asked, evidence=evidence)
    hint = correction(
        text, "story", "change the motion so that it happens as often as the words say", pointers=(f"/claims/{name}/by",)
    )
    return Finding("fail", text, float(found), asked, hints=(hint,), evidence=evidence)


def _between(taken: list[tuple[int, int]], last: int) -> list[tuple[int, int]]:
    """Frames before, between and behind intervals in order."""
    edges = [(-1, -1), *taken, (last + 1, last + 1)]
    found = [(a[1] + 1, b[0] - 1) for a, b in pairwise(edges)]
    return [(first, end) for first, end in found if end > first]


def _again(candidate: Candidate, beat: str, frames: tuple[int, int]) -> bool:
    return evaluate(candidate, candidate.spec.story.beats[beat].predicate, frames).status == "pass"
