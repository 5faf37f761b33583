"""Was a beat true before its interval begins? Then nothing that its interval shows brings it about (R156).

Looked at are all frames from 0 up to the beat's first one, and by kind of predicate:

- An **event** (`EVENTS`: contact, reaches, crosses, breaks ...) has happened before when it began at an earlier frame. One that the
  scene starts with is a state: a ball that lies on the floor at frame 0, is thrown up and lands again has landed once.
  An earlier occurrence may belong to another beat of the same kind about the same entities, which this one names among its causes or
  comes `after`: the second bounce is the second when the first has a beat of its own.
- A **lasting state** (a level, a place, a speed, rest) was there before when it is true at the frame before the interval and stays so
  up to the frame that decides. What ended and comes back within the interval is new.
- What **adds up** over the interval (`SUMS`: what breaks, flows through, presses) is measured over earlier spans of the same length.

A lasting state without causes may be so from frame 0 on: the row and the register say that it is an initial state, and no beat may name it as
its cause.

A combination was true before when its members were: all of `and`, one of `or`, enough of `count`.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...worlds.candidate import Candidate
from ...worlds.drivers import behind
from ...worlds.errors import EvidenceError
from ...worlds.predicates import Contact, Count, Separation, atoms_of, describe_predicate, entities_of
from ...worlds.predicates.events import EVENT_KINDS
from ...worlds.predicates.registry import PREDICATES, is_invariant
from ...worlds.references import references
from ..predicates.combine import substitute
from ..predicates.evaluators import beat_times, evaluate
from ..predicates.outcome import Outcome, Truth
from ..rows.answers import row_of
from ..rows.corrections import correction
from ..rows.findings import Finding, lacking
from ..scene.surfaces import surfaces_of
from .bounds import FLICKER
from .initial import initial_state
from .offers import offered
from .questions import VACUOUS

if TYPE_CHECKING:
    from ...worlds.requirements import Correction, Row
    from ...worlds.spec import Beat, SpecModel, WorldSpec

__all__ = ["EVENTS", "SUMS", "Past", "check_vacuity", "from_start"]

EVENTS = frozenset({*EVENT_KINDS, "reaches", "debris"} - {"splash_height"})
"""Kinds that happen; all other atoms are states. Arrival at a place is news here, and the height of a splash one that lasts."""
SUMS = frozenset(
    {"broken", "torn", "flutters", "liquid_flux_through"} | {kind for kind, info in PREDICATES.items() if info.adds_up}
)
"""Kinds that an interval as a whole makes true, by what adds up in it."""
LATCHED = frozenset({"crosses", "liquid_arrives", "gas_arrives"})
"""Kinds whose truth within a span stays once it came."""


class Past(NamedTuple):
    """When a predicate was true before the interval."""

    first: int
    last: int
    told: str
    """Sentence about what was measured then."""
    event: bool
    """True if it happened, where else it lasted."""


class _Past:
    """Looks at what was before the interval of one beat."""

    def __init__(self, candidate: Candidate, beat_id: str) -> None:
        self.candidate, self.beat_id = candidate, beat_id
        self.beat = candidate.spec.story.beats[beat_id]
        self.owned: set[str] = set()

    def of(self, predicate: SpecModel, frames: tuple[int, int], reach: tuple[int, int]) -> Past | None:
        """Truth of a predicate before `frames`, with a beginning within `reach`; None where there was none.

        Raises:
            EvidenceError: it cannot be judged.
        """
        kind = str(getattr(predicate, "kind", ""))
        if kind in ("and", "or"):
            found = [self.of(p, frames, reach) for p in predicate.of]  # type: ignore[attr-defined]
            known = [p for p in found if p is not None]
            if not known or (kind == "and" and len(known) < len(found)):
                return None
            return max(known, key=lambda p: p.first) if kind == "and" else min(known, key=lambda p: p.first)
        if isinstance(predicate, Count) and predicate.min is not None:
            return self._count(predicate, frames, reach)
        if kind == "eventually":
            return self.of(predicate.predicate, predicate.frames or frames, reach)  # type: ignore[attr-defined]
        if kind == "until":
            return self.of(predicate.goal, frames, reach)  # type: ignore[attr-defined]
        if kind in ("before", "after", "within"):
            return self._ordered(predicate, kind, frames, reach)
        if kind in EVENTS and getattr(predicate, "when", "eventually") == "eventually":
            for occurrence in self._occurrences(predicate, frames, reach):
                if not self._belongs(predicate, occurrence):
                    return occurrence
            if kind in SUMS or kind == "crosses":
                return None
        return self._held(predicate, frames)

    def _count(self, predicate: Count, frames: tuple[int, int], reach: tuple[int, int]) -> Past | None:
        need = max(1, math.ceil(predicate.min or 0))
        found = [self.of(substitute(predicate.predicate, n), frames, reach) for n in predicate.entities]
        known = sorted((p for p in found if p is not None), key=lambda p: p.first)
        return known[need - 1] if len(known) >= need else None

    def _ordered(self, predicate: SpecModel, kind: str, frames: tuple[int, int], reach: tuple[int, int]) -> Past | None:
        """The past of a predicate that counts only before or after another beat: truth on the other side of that beat is none."""
        other = beat_times(self.candidate).first(predicate.beat)  # type: ignore[attr-defined]
        if other is None:
            return None
        low, high = reach
        if kind == "before":
            high = min(high, other - 1)
        else:
            low = max(low, other + (kind == "after"))
            high = min(high, other + predicate.frames) if kind == "within" else high  # type: ignore[attr-defined]
        return self.of(predicate.predicate, frames, (low, high))  # type: ignore[attr-defined]

    def from_start(self) -> Past | None:
        """Truth from frame 0 on of a beat whose interval begins there, or that asks for a lasting state with causes."""
        predicate, frames = self.beat.predicate, self.beat.frames
        start = self._judge(predicate, (0, 0))
        true = start.status == "pass" or (start.truth is not None and bool(start.truth[0]))
        if not true and not (getattr(predicate, "min_impulse", 1.0) == 0.0 and self._touch_at_start(predicate)):
            return None
        outcome = evaluate(self.candidate, predicate, frames)
        if outcome.status == "unverified" and frames[0] > 0:
            raise EvidenceError(outcome.explanation)
        end = _decisive(predicate, outcome) or 0
        span = evaluate(self.candidate, predicate, (0, end))
        unbroken = span.status == "pass" if span.truth is None else bool(span.truth[1:].all())
        return Past(0, end, start.explanation, False) if unbroken else None

    # ---------------------------------------------------------------- events

    def _occurrences(self, predicate: SpecModel, frames: tuple[int, int], reach: tuple[int, int]) -> list[Past]:
        """When an event happened before the interval, in order."""
        kind, last = str(getattr(predicate, "kind", "")), frames[0] - 1
        if last < 0:
            return []
        whole = kind in SUMS or kind == "crosses"
        found = []
        for first, end in self._spans(predicate, frames) if whole else self._runs(predicate, last):
            # What adds up in a long touch counts as far as it would in the interval.
            outcome = self._judge(predicate, (first, min(end, first + frames[1] - frames[0])))
            at = outcome.first_true_frame
            if outcome.status == "pass" and at is not None and reach[0] <= at <= reach[1]:
                found.append(Past(at if whole else first, end, outcome.explanation, True))
        return found

    def _spans(self, predicate: SpecModel, frames: tuple[int, int]) -> list[tuple[int, int]]:
        """Earlier spans of the interval's length that overlap by half; of crossings, from each to the next."""
        last = frames[0] - 1
        if getattr(predicate, "kind", "") == "crosses":
            spans, start = [], 0
            while start <= last:
                at = self._judge(predicate, (start, last)).first_true_frame
                if at is None:
                    break
                spans.append((start, at))
                start = at + 1
            return spans
        length = min(frames[1] - frames[0] + 1, frames[0])
        starts = {*range(0, frames[0] - length + 1, max(1, length // 2)), frames[0] - length}
        return [(s, s + length - 1) for s in sorted(starts)]

    def _runs(self, predicate: SpecModel, last: int) -> list[tuple[int, int]]:
        """Spans up to a frame at which the event lasts and which the scene does not start with."""
        truth = self._truth(predicate, last)
        if truth is None:
            return []
        runs: list[list[int]] = []
        for frame in np.flatnonzero(truth).tolist():
            if runs and frame - runs[-1][1] <= 1 + FLICKER:
                runs[-1][1] = frame
            else:
                runs.append([frame, frame])
        started = self._touch_at_start(predicate)
        return [(a, b) for a, b in runs if a > (1 if started else 0)]

    def _touch_at_start(self, predicate: SpecModel) -> bool:
        """True if two entities of a contact touch at frame 0, which no log of contacts tells."""
        if not isinstance(predicate, Contact):
            return False
        try:
            gap = surfaces_of(self.candidate).contact_gap(predicate.a, predicate.b)
            apart = evaluate(self.candidate, Separation(a=predicate.a, b=predicate.b, max=gap), (0, 0))
        except (EvidenceError, KeyError):
            return False  # matter without surfaces of its own
        return apart.status == "pass"

    def _belongs(self, predicate: SpecModel, occurrence: Past) -> bool:
        """True if another beat that this one names owns an occurrence; each owns one."""
        beats, named = self.candidate.spec.story.beats, behind(self.candidate.spec, self.beat_id)[1:]
        named += [v for _, v, target in _mentioned(self.beat) if target == "beat"]
        mine = _signature(predicate)
        for name in dict.fromkeys(named):
            if name in self.owned or name not in beats or name == self.beat_id:
                continue
            if not any(_signature(a) == mine for a in atoms_of(beats[name].predicate)):
                continue
            first = beat_times(self.candidate).first(name)
            if first is not None and occurrence.first <= first <= occurrence.last:
                self.owned.add(name)
                return True
        return False

    # ---------------------------------------------------------------- states

    def _held(self, predicate: SpecModel, frames: tuple[int, int]) -> Past | None:
        """The unbroken truth that reaches from before the interval to the frame that decides."""
        before = frames[0] - 1
        if before < 0:
            return None
        here = self._judge(predicate, (before, before))
        touches = before == 0 and self._touch_at_start(predicate)
        true = here.status == "pass" if here.truth is None else bool(here.truth[0])
        if not (true or touches):
            return None
        least = float(getattr(predicate, "min_impulse", 0.0))
        outcome = self._judge(predicate, frames)
        end = _decisive(predicate, outcome)
        found = self._truth(predicate, before if end is None else end)
        if found is None:
            return Past(before, before, here.explanation, False)
        truth = found.copy()
        truth[0] |= touches
        broken = np.flatnonzero(~truth)
        first = int(broken[-1]) + 1 if len(broken) else 0
        if first > before:
            return None
        if least > 0.0:
            # A touch that lasts is pressed by weight: it was as asked if a span of the same length gave as much.
            length = frames[1] - frames[0] + 1
            pressed = self._judge(predicate, (max(first, frames[0] - length), before))
            return Past(first, before, pressed.explanation, False) if pressed.status == "pass" else None
        return Past(first, before, self._judge(predicate, (first, first)).explanation, False)

    def _truth(self, predicate: SpecModel, last: int) -> Truth | None:
        """Truth at every frame from 0 to `last` by itself; None where only an interval has one."""
        if getattr(predicate, "kind", "") not in LATCHED:
            return self._judge(predicate, (0, last)).truth
        return np.array([self._judge(predicate, (k, k)).status == "pass" for k in range(last + 1)])

    def _judge(self, predicate: SpecModel, frames: tuple[int, int]) -> Outcome:
        outcome = evaluate(self.candidate, predicate, frames)
        if outcome.status == "unverified":
            raise EvidenceError(outcome.explanation)
        return outcome


def _mentioned(beat: Beat) -> list[tuple[str, str, str]]:
    return [(pointer, value, target) for pointer, target, value in references(beat.predicate, "")]


def _signature(atom: SpecModel) -> tuple[object, ...]:
    """Kind, entities and place of an event, which are the same whatever its bounds."""
    where = [getattr(atom, n, None) for n in ("region", "target", "point", "normal")]
    return (getattr(atom, "kind", ""), frozenset(entities_of(atom)), *where)


def _decisive(predicate: SpecModel, outcome: Outcome) -> int | None:
    """The frame at which an outcome is decided: the last of what is asked for at the end, else the first true one."""
    if any(getattr(a, "when", "") == "end" or getattr(a, "kind", "") == "topples" for a in atoms_of(predicate)):
        return outcome.frames[1]
    return outcome.frames[0] if is_invariant(predicate) else outcome.first_true_frame


def from_start(candidate: Candidate, beat_id: str) -> Past | None:
    """Truth of a lasting state from frame 0 up to the interval of its beat; None where it comes later.

    Raises:
        EvidenceError: it cannot be judged.
    """
    return _Past(candidate, beat_id).from_start()


def check_vacuity(candidate: Candidate, beat_id: str) -> list[Row]:
    """Row `beat:vacuous:<id>`."""
    beat = candidate.spec.story.beats[beat_id]
    lasting = is_invariant(beat.predicate)
    looks, past = _Past(candidate, beat_id), None
    try:
        if lasting or beat.frames[0] == 0:
            past = looks.from_start()
        else:
            past = looks.of(beat.predicate, beat.frames, (0, beat.frames[0] - 1))
        initial = lasting and not beat.causes
        found = (
            initial_state(beat_id, past.last, candidate.spec)
            if initial and past
            else _judged(beat_id, beat, past, candidate.spec)
        )
    except EvidenceError as error:
        found = lacking(error)
    then = evaluate(candidate, beat.predicate, (past.first, past.first) if past is not None else (0, 0))
    found = replace(
        found,
        measured=then.value,
        bound=then.bound,
        unit=then.unit,
        predicate=f"not true before its interval begins: {describe_predicate(beat.predicate)}",
        evidence={"pointers": [f"/story/beats/{beat_id}/predicate"], **(found.evidence or {})},
        frames=(0, beat.frames[1]),
    )
    entities = (beat.subject, *entities_of(beat.predicate))
    question = replace(VACUOUS, mandatory=beat.mandatory)
    return [row_of(candidate, question, (beat_id,), found, entities=entities, extra=beat.model_dump(mode="json"))]


def _judged(beat_id: str, beat: Beat, past: Past | None, spec: WorldSpec) -> Finding:
    """The finding of a beat that was true before its interval in the way given, or was not."""
    begin, end = beat.frames
    if past is None:
        return Finding(
            "pass", f"not true {'from frame 0 on' if is_invariant(beat.predicate) or not begin else f'before frame {begin}'}"
        )
    if past.first == 0 and not past.event:
        since = f"at every frame up to {past.last}" if past.last else "at frame 0"
        text = f"already true {since}, so nothing needs to happen: {past.told}"
    else:
        when = f"at frame {past.first}" if past.first == past.last else f"at frames {past.first}..{past.last}"
        text = (
            f"was true {when}, before its interval {begin}..{end} begins ({past.told}): begin the interval there, "
            f"or ask for what comes only later"
        )
    evidence = {"true_from": past.first, "true_to": past.last}
    hints = tuple(_hints(beat_id, beat, past, spec))
    return Finding("fail", text, entity=beat.subject, frame=past.first, hints=hints, evidence=evidence)


def _hints(beat_id: str, beat: Beat, past: Past, spec: WorldSpec) -> list[Correction]:
    place = f"/story/beats/{beat_id}"
    found = []
    if past.first > 0:
        moved = [past.first, beat.frames[1]]
        found.append(
            offered(
                spec,
                f"it comes true at frame {past.first}, and the interval begins at frame {beat.frames[0]}",
                "story",
                f"begin the interval there: frames {moved}",
                pointers=(f"{place}/frames",),
                patch=({"op": "replace", "path": f"{place}/frames", "value": moved},),
            )
        )
    if past.event:
        found.append(
            correction(
                "it happens more than once, and a later time is meant",
                "story",
                f"give each earlier time a beat of its own and name it in the causes of {beat_id}, or ask `after` that beat",
                pointers=(f"{place}/causes", f"{place}/predicate"),
            )
        )
    found += [
        correction(
            "the predicate describes what was so before",
            "story",
            "ask for a state that no earlier frame has, e.g. another region, a larger min, or a contact with an impulse",
            pointers=(f"{place}/predicate",),
        ),
        correction(
            "the subject starts where it should end",
            "placement",
            f"start {beat.subject} where the predicate is false",
            pointers=(f"/entities/{beat.subject}/pose",),
        ),
    ]
    if getattr(beat.predicate, "when", "always") != "always" and past.first == 0 and not past.event and not beat.causes:
        found.append(
            offered(
                spec,
                "it is meant to be so all the time: nothing is to happen",
                "story",
                "ask it of every frame, `when` always: what lasts needs no cause (where the prompt tells an event, that needs a beat of its own)",
                pointers=(f"{place}/predicate/when",),
                patch=({"op": "add", "path": f"{place}/predicate/when", "value": "always"},),
            )
        )
    return found
