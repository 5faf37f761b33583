"""Claims of order: what is said to come first does, and neither the reverse nor simultaneity is true of the motion (R131, R154).

Two events are in the order that is told where the later one comes true at least `ORDER_SEEN` and one frame after the earlier one. The reverse
is true as well where the later one

- comes true, or begins, before the earlier one does;
- happened already before the earlier one came true, or lasts since then, and no other beat of the story tells of that.

They are simultaneous where they come true, or begin, closer together than that. What a cause brings about may begin with it, as a box
slides while it is pushed. Two events come at the same time where they begin, or, of what has no beginning, come true, no more than `AT_ONCE`
and one frame apart. `until` says that one thing lasts up to another: it has to last for a while before, and no longer throughout.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

from ...worlds.drivers import behind
from ...worlds.orders import says_together
from ...worlds.predicates import Always, Until, atoms_of, describe_predicate, entities_of
from ...worlds.predicates.ordering import orderings_of
from ...worlds.prompts.languages import language_of
from ..predicates.evaluators import beat_times, evaluate
from ..predicates.events import EVENTS
from ..rows.corrections import correction
from ..rows.findings import Finding
from .bounds import AT_ONCE, ORDER_SEEN
from .naming import beats_of, requirements_of

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.predicates.ordering import Ordering
    from ...worlds.spec import SpecModel
    from ..predicates.outcome import Outcome

__all__ = ["order_of"]


class Side(NamedTuple):
    """One of two events in order."""

    name: str
    predicate: SpecModel
    frames: tuple[int, int]
    outcome: Outcome
    beat: str | None

    @property
    def first(self) -> int | None:
        """First true frame."""
        return self.outcome.first_true_frame

    @property
    def begins(self) -> int | None:
        """Frame at which the event begins that came true first, where its judge tells."""
        at = self.outcome.details.get("onset")
        return int(at) if at is not None and self.first is not None and at <= self.first else None


class Gap(NamedTuple):
    """Time between two events, and readings of their order that are true and are not the one told."""

    told: str
    seconds: float
    rivals: list[str]


def order_of(candidate: Candidate, name: str) -> Finding:
    """The finding about a claim of order."""
    spec = candidate.spec
    quote, beats, times = spec.claims[name].quote, beats_of(spec, name), beat_times(candidate)
    asked = {b: times.outcome(b) for b in beats}
    last = spec.simulation.frames - 1
    for r in requirements_of(spec, name):
        requirement = spec.story.requirements[r]
        asked[r] = evaluate(candidate, requirement.asked, requirement.frames or (0, last))
    open_ones = sorted((n for n, o in asked.items() if o.status != "pass"), key=lambda n: asked[n].status != "fail")
    if open_ones:
        said = f"{quote!r}: {open_ones[0]} does not hold: {asked[open_ones[0]].explanation}"
        return Finding("fail" if asked[open_ones[0]].status == "fail" else "unverified", said)
    if says_together(quote, language_of(spec.prompt)):
        return _at_once(candidate, name)
    gaps = [*_of_beats(candidate, beats), *_of_predicates(candidate, name)]
    least = _least(candidate)
    if not gaps:
        return Finding("unverified", f"{quote!r}: nothing that it names tells of an order")
    worst = min(gaps, key=lambda g: (not g.rivals, g.seconds))
    evidence = {
        "gaps_s": {g.told: g.seconds for g in gaps},
        "rivals": ["reversed", "simultaneous"],
        "true_rivals": [r for g in gaps for r in g.rivals],
    }
    if not worst.rivals:
        told = f"{quote!r}: {worst.told}; neither the reverse nor simultaneity is true"
        return Finding("pass", told, worst.seconds, least, evidence=evidence)
    said = f"{quote!r}: {worst.told}; {worst.rivals[0]}"
    action = "name the events in the order of the prompt, or change the motion so that they follow each other"
    hint = correction(said, "story", action, pointers=("/story/beats",))
    return Finding("fail", said, min(worst.seconds, 0.0), least, hints=(hint,), evidence=evidence)


def _least(candidate: Candidate) -> float:
    """Least time between two events in order [s]."""
    return max(ORDER_SEEN, 1.0 / candidate.spec.simulation.fps)


def _beat(candidate: Candidate, name: str) -> Side:
    beat = candidate.spec.story.beats[name]
    return Side(name, _inner(beat.predicate), beat.frames, beat_times(candidate).outcome(name), name)


def _inner(predicate: SpecModel) -> SpecModel:
    """The event of a predicate of order, without the order."""
    return _inner(predicate.predicate) if getattr(predicate, "kind", "") in ("before", "after", "within") else predicate  # type: ignore[attr-defined]


def _of_beats(candidate: Candidate, beats: list[str]) -> list[Gap]:
    return [_gap(candidate, _beat(candidate, a), _beat(candidate, b)) for a, b in pairwise(beats)]


def _of_predicates(candidate: Candidate, name: str) -> list[Gap]:
    """Gaps of the predicates of order in what a claim names."""
    spec = candidate.spec
    found = []
    for b in beats_of(spec, name):
        beat = spec.story.beats[b]
        found += [_ordered(candidate, p, b, beat.frames, b) for p in orderings_of(beat.predicate)]
    for r in requirements_of(spec, name):
        requirement = spec.story.requirements[r]
        frames = requirement.frames or (0, spec.simulation.frames - 1)
        if not requirement.never:
            found += [_ordered(candidate, p, r, frames, None) for p in orderings_of(requirement.predicate)]
    return found


def _ordered(candidate: Candidate, predicate: Ordering, name: str, frames: tuple[int, int], beat: str | None) -> Gap:
    if isinstance(predicate, Until):
        return _until(candidate, predicate, name, frames)
    inner = _inner(predicate.predicate)
    mine = Side(name, inner, frames, evaluate(candidate, inner, frames), beat)
    other = _beat(candidate, predicate.beat)
    return _gap(candidate, mine, other) if predicate.kind == "before" else _gap(candidate, other, mine)


def _at_once(candidate: Candidate, name: str) -> Finding:
    """The finding about a claim that the events that it names, or those of its predicates of order, come at the same time."""
    spec, fps = candidate.spec, candidate.spec.simulation.fps
    quote, beats = spec.claims[name].quote, beats_of(spec, name)
    sides = [_beat(candidate, b) for b in beats]
    last = spec.simulation.frames - 1
    for r in requirements_of(spec, name):
        frames = spec.story.requirements[r].frames or (0, last)
        for ordering in orderings_of(spec.story.requirements[r].predicate):
            if not isinstance(ordering, Until):
                inner = _inner(ordering.predicate)
                sides += [_beat(candidate, ordering.beat), Side(r, inner, frames, evaluate(candidate, inner, frames), None)]
    starts = {s.name: s.first if s.begins is None else s.begins for s in sides}
    known = {n: at for n, at in starts.items() if at is not None}
    if len(known) < max(2, len(starts)):
        return Finding(
            "unverified", f"{quote!r}: nothing tells when {', '.join(n for n in starts if n not in known) or 'two events'} begins"
        )
    early, late = min(known, key=lambda n: known[n]), max(known, key=lambda n: known[n])
    seconds, most = (known[late] - known[early]) / fps, AT_ONCE + 1.0 / fps
    said = f"{quote!r}: {early} begins at frame {known[early]}, {late} at frame {known[late]}"
    evidence = {"begin": known, "at_most_s": most}
    if seconds <= most * (1.0 + 1e-9):
        return Finding("pass", f"{said}: at the same time", seconds, most, evidence=evidence, comparison="<=")
    said = f"{said}, {seconds:.2g} s apart"
    action = f"let them begin at most {most:.2g} s apart"
    hint = correction(said, "story", action, pointers=("/story/beats",))
    return Finding("fail", said, seconds, most, hints=(hint,), evidence=evidence, comparison="<=")


def _gap(candidate: Candidate, earlier: Side, later: Side) -> Gap:
    """Time from the earlier event to the later one, and the rival orders that are true."""
    fps, least = candidate.spec.simulation.fps, _least(candidate)
    one, two = earlier.first, later.first
    told = f"{earlier.name} comes true at frame {one}, {later.name} at {two}"
    if one is None or two is None:
        return Gap(told, 0.0, [f"{(earlier if one is None else later).name} has no first true frame"])
    seconds = (two - one) / fps
    rivals = []
    if seconds <= -least:
        rivals.append(f"{later.name} before {earlier.name} is what is true")
    elif seconds < least * (1.0 - 1e-9):
        rivals.append("both at once is what is true")
    else:
        before = _already(candidate, later, one, two)
        if before is not None:
            rivals.append(f"{later.name} before {earlier.name} is true as well: {before}")
        start, end = earlier.begins, later.begins
        if start is not None and end is not None and not _brought_about(candidate, earlier, later):
            if end < start:
                rivals.append(f"{later.name} begins before {earlier.name}, at frames {end} and {start}")
            elif (end - start) / fps < least * (1.0 - 1e-9):
                rivals.append(f"both begin at once, at frame {start}")
    return Gap(told, seconds, rivals)


def _already(candidate: Candidate, later: Side, frame: int, comes: int) -> str | None:
    """Words on how the later event was true before a frame, where no other beat tells of that; None where it was not."""
    if frame < 1:
        return None
    outcome = evaluate(candidate, later.predicate, (0, frame - 1))
    if outcome.status != "pass":
        return None
    happens = any(getattr(a, "kind", "") in EVENTS for a in atoms_of(later.predicate))
    lasting = evaluate(candidate, later.predicate, (0, comes)).truth
    if not happens and lasting is not None and not lasting[frame - 1 :].all():
        return None  # A state that ended and comes back is new.
    times = beat_times(candidate)
    mine = _signature(later.predicate)
    for name, beat in candidate.spec.story.beats.items():
        first = times.first(name)
        if name != later.beat and first is not None and first < frame and _signature(_inner(beat.predicate)) & mine:
            return None
    return outcome.explanation


def _signature(predicate: SpecModel) -> set[tuple[object, ...]]:
    """Kinds of the atoms of a predicate with whom they are about."""
    return {(getattr(a, "kind", ""), frozenset(entities_of(a))) for a in atoms_of(predicate)}


def _brought_about(candidate: Candidate, earlier: Side, later: Side) -> bool:
    """True where the later event has the earlier one among its causes: both may begin together."""
    return earlier.beat is not None and later.beat is not None and earlier.beat in behind(candidate.spec, later.beat)[1:]


def _until(candidate: Candidate, predicate: Until, name: str, frames: tuple[int, int]) -> Gap:
    """Time for which something holds before its goal comes true, and whether it ends with that at all."""
    fps, goal = candidate.spec.simulation.fps, evaluate(candidate, predicate.goal, frames)
    hold, aim = describe_predicate(predicate.hold), describe_predicate(predicate.goal)
    told = f"{name}: {hold} holds until {aim} comes true at frame {goal.first_true_frame}"
    seconds = ((goal.first_true_frame or frames[0]) - frames[0]) / fps
    rivals = []
    if seconds < _least(candidate) * (1.0 - 1e-9):
        rivals.append("both at once is what is true")
    if frames[0] > 0 and evaluate(candidate, predicate.goal, (0, frames[0] - 1)).status == "pass":
        rivals.append(f"{aim} comes true before as well")
    if evaluate(candidate, Always(predicate=predicate.hold), frames).status == "pass":
        rivals.append(f"{hold} holds throughout, after {aim} too")
    return Gap(told, seconds, rivals)
