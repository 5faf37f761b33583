"""Causal checks: order and connection of beats and their declared causes (R96, R97, S8).

Row `causal:<cause>:<effect>` passes when the cause came true no later than the effect, and an impulse chain leads
from the cause's subject to the effect's. Coincidence is no cause: two events without a chain fail. The chain may
use contacts from the onset of the cause on. For a cause that is an instant (contact, reaching, crossing) that is
one frame before its first true frame; for a process (toppling, moving, turning) it is when the subject began to
move, because a domino has struck its neighbour before it counts as toppled; for an authored driver it is the moment
at which the driver acts.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...worlds.candidate import Candidate
from ...worlds.drivers import acts_from
from ...worlds.errors import EvidenceError
from ...worlds.predicates import Contact
from ...worlds.requirements import Correction, Row, RowId, Status
from ..categories.registry import judge_of, logged
from ..predicates import Outcome, beat_times, evaluate
from ..rows.verdicts import correction, make_row
from .chains import MOMENTUM_SHARE, Chains, Hop, Reach, begins

if TYPE_CHECKING:
    from ...worlds.spec import Beat

__all__ = ["Onset", "check", "onset_of", "wrong_cause"]

INSTANTS = frozenset({"contact", "reaches", "crosses", "liquid_arrives"})


@dataclass(frozen=True)
class Onset:
    """When and where a cause starts to act."""

    sources: tuple[str, ...]
    start: float
    """[s] from which on contacts may carry its chain."""
    frame: float
    """At which it counts as having happened."""
    acting_until: int
    """Frame up to which its sources count as moving: its first true one."""
    text: str


def check(candidate: Candidate) -> list[Row]:
    """One row per declared cause of every beat."""
    rows: list[Row] = []
    beats = candidate.spec.story.beats
    chains: Chains | EvidenceError | None = None
    for effect_id, effect in beats.items():
        for cause_id in effect.causes:
            if cause_id not in beats:
                rows.append(_row(candidate, cause_id, effect_id, "unverified", f"beat {cause_id!r} is not in the story"))
                continue
            if chains is None:
                try:
                    chains = Chains(candidate)
                except EvidenceError as error:
                    chains = error
            try:
                if isinstance(chains, EvidenceError):
                    raise chains
                rows.append(_edge(candidate, chains, cause_id, effect_id))
            except EvidenceError as error:
                rows.append(_row(candidate, cause_id, effect_id, "unverified", str(error)))
    return rows


def onset_of(candidate: Candidate, beat_id: str, beat: Beat, first: int) -> Onset:
    """When and where a beat that came true at frame `first` started to act as a cause."""
    plan = candidate.spec.simulation
    if beat.owner in plan.drivers:
        time, entities = acts_from(candidate.spec, beat.owner)
        return Onset(
            tuple(dict.fromkeys((*entities, beat.subject))),
            time,
            time * plan.fps,
            first,
            f"driver {beat.owner} acts at {time:.3f} s",
        )
    onset = first - 1
    if beat.predicate.kind not in INSTANTS:
        active = judge_of(candidate.spec, beat.subject).moving(candidate, beat.subject)
        while onset > max(0, beat.frames[0] - 1) and active[onset]:
            onset -= 1
    # Interval frame k covers ((k-1)/fps, k/fps]: its contacts may have begun a frame earlier than k.
    start = onset / plan.fps
    if isinstance(beat.predicate, Contact):
        touched = begins(candidate, beat.predicate.a, beat.predicate.b, (beat.frames[0], first))
        start = start if touched is None else touched
    return Onset((beat.subject,), start, first, first, f"{beat_id} was first true at frame {first}")


def _instant(candidate: Candidate, beat: Beat, first: int) -> float | None:
    """Event time of a beat that is a contact and came true with its first touch [s]; None of any other, and where no log tells its moment."""
    if not isinstance(beat.predicate, Contact) or not logged(candidate.spec, beat.predicate.a, beat.predicate.b):
        return None
    time = begins(candidate, beat.predicate.a, beat.predicate.b, (beat.frames[0], first))
    return time if time is not None and time >= (first - 1) / candidate.spec.simulation.fps else None


def _edge(candidate: Candidate, chains: Chains, cause_id: str, effect_id: str) -> Row:
    beats, times = candidate.spec.story.beats, beat_times(candidate)
    cause, effect = beats[cause_id], beats[effect_id]
    outcomes = {cause_id: times.outcome(cause_id), effect_id: times.outcome(effect_id)}
    for name, outcome in outcomes.items():
        if outcome.status == "unverified":
            return _row(candidate, cause_id, effect_id, "unverified", f"beat {name} is unverified: {outcome.explanation}")
    first, last = outcomes[cause_id].first_true_frame, outcomes[effect_id].first_true_frame
    if first is None:
        return _absent(candidate, cause_id, effect_id, cause_id, outcomes[cause_id])
    start = onset_of(candidate, cause_id, cause, first)
    until = last if last is not None else min(effect.frames[1], candidate.last_frame)
    moments = _instant(candidate, cause, first), None if last is None else _instant(candidate, effect, last)
    reach = chains.spread(
        _sources(cause, effect, start),
        start.start,
        until,
        subject=effect.subject,
        acting_until=start.acting_until,
        limit=np.inf if moments[1] is None else moments[1],
    )
    if last is None:
        return _absent(candidate, cause_id, effect_id, effect_id, outcomes[effect_id], reach=reach, start=start)
    gap = last - start.frame
    evidence = {"order_frames": gap, "cause_frame": start.frame, "effect_frame": last, "event_times": list(moments)}
    late = gap < 0
    if moments[0] is not None and moments[1] is not None and cause.predicate != effect.predicate:
        late = moments[1] <= moments[0]
    if late:
        text = f"{effect_id} came true at frame {last}, before its cause: {start.text}"
        if moments[0] is not None and moments[1] is not None:
            text += f"; contacts at {moments[1]:.4f} s and {moments[0]:.4f} s"
        return _row(
            candidate,
            cause_id,
            effect_id,
            "fail",
            text,
            measured=gap,
            bound=0.0,
            unit="frame",
            frames=(last, max(last, first)),
            first=(effect.subject, last),
            evidence=evidence,
            corrections=_order_hints(candidate, cause_id, effect_id, last, gap),
        )
    return _linked(candidate, cause_id, effect_id, start, last, reach, evidence)


def _sources(cause: Beat, effect: Beat, start: Onset) -> tuple[str, ...]:
    """Where the cause's chain starts. A contact happens to both; it links the other one with itself as well."""
    if isinstance(cause.predicate, Contact) and effect.subject in (cause.predicate.a, cause.predicate.b):
        return tuple(dict.fromkeys((*start.sources, effect.subject)))
    return start.sources


def _linked(
    candidate: Candidate,
    cause_id: str,
    effect_id: str,
    start: Onset,
    last: int,
    reach: Reach,
    evidence: dict[str, object],
) -> Row:
    effect = candidate.spec.story.beats[effect_id]
    subject = effect.subject
    frames = (min(int(np.floor(start.frame)), last), last)
    if subject in _sources(candidate.spec.story.beats[cause_id], effect, start):
        return _same_subject(candidate, cause_id, effect_id, start, (frames[0], last), reach, evidence)
    chain = reach.chain(subject) if reach.ever(subject) else []
    evidence = {**evidence, "hops": len(chain), "chain": [h._asdict() for h in chain]}
    if chain and (reach.time(subject) is None or reach.negligible):
        return _not_its_doing(candidate, cause_id, effect_id, frames, reach, evidence)
    if chain:
        steps = ", ".join(_hop_text(h) for h in chain[:8]) + (f", ... {len(chain) - 8} more" if len(chain) > 8 else "")
        return _row(
            candidate,
            cause_id,
            effect_id,
            "pass",
            f"{len(chain)} hops lead from {chain[0].source} to {subject}: {steps}",
            measured=float(len(chain)),
            bound=1.0,
            unit="hops",
            frames=frames,
            evidence=evidence,
        )
    stuck, tip, away = _frontier(candidate, reach, subject, last)
    text = (
        f"no impulse chain leads from {', '.join(start.sources)} to {subject} by frame {last}; "
        f"it got as far as {tip}, and {stuck}, {away:.3g} m from it between centres, never received it"
    )
    hints = _link_hints(cause_id, effect_id, stuck, tip, away)
    if tip in reach.stopped:
        text += f"; {tip} came to rest at frame {reach.stopped[tip]}, and what rests passes nothing on: it only bears what comes to it"
        hints = [wrong_cause(effect_id, f": name what still moves when it meets {subject}"), *hints[:-1]]
    return _row(
        candidate,
        cause_id,
        effect_id,
        "fail",
        text,
        measured=0.0,
        bound=1.0,
        unit="hops",
        frames=frames,
        first=(stuck, last),
        evidence={**evidence, "reached": reach.reached(), "tip": tip, "gap_between_centers": away},
        corrections=hints,
    )


def _same_subject(
    candidate: Candidate,
    cause_id: str,
    effect_id: str,
    start: Onset,
    frames: tuple[int, int],
    reach: Reach,
    evidence: dict[str, object],
) -> Row:
    """The link of a body with itself: what it does later follows from its motion, unless that ended in between."""
    subject = candidate.spec.story.beats[effect_id].subject
    rest = reach.stopped.get(subject) if reach.time(subject) is None else None
    failed = reach.time(subject) is None
    text = f"{subject} moves on from {cause_id} (frame {start.frame:g}) to {effect_id} (frame {frames[1]})"
    if failed:
        text = f"{subject} came to rest at frame {rest}, between {cause_id} and {effect_id}, so nothing links them"
    owner = candidate.spec.story.beats[cause_id].owner
    if candidate.spec.entities[subject].motion == "kinematic" and owner not in candidate.spec.simulation.drivers:
        failed, text = True, f"{subject} follows an authored path, so {cause_id} does not bring {effect_id} about"
    return _row(
        candidate,
        cause_id,
        effect_id,
        "fail" if failed else "pass",
        text,
        measured=float(evidence["order_frames"]),  # type: ignore[arg-type]
        bound=0.0,
        unit="frame",
        frames=frames,
        first=(subject, rest if rest is not None else frames[1]) if failed else None,
        evidence={**evidence, "hops": 0, "chain": [], "same_subject": True},
        corrections=_link_hints(cause_id, effect_id, subject, None, None),
    )


def _not_its_doing(
    candidate: Candidate, cause_id: str, effect_id: str, frames: tuple[int, int], reach: Reach, evidence: dict[str, object]
) -> Row:
    """A chain arrived, but the effect is not of it: it ended before, or others pushed far harder."""
    subject = candidate.spec.story.beats[effect_id].subject
    arrived = float(reach.arrival[reach.names.index(subject)])
    if reach.time(subject) is None:
        rest = reach.stopped.get(subject, frames[1])
        text = f"{subject} was reached at {arrived:.3f} s, came to rest at frame {rest}, and then moved by something else"
        measured, bound, unit, first = 0.0, 1.0, "hops", (subject, rest)
    else:
        pushed = sum(reach.others.values())
        names = ", ".join(sorted(reach.others, key=lambda n: -reach.others[n])[:4])
        text = (
            f"the chain gave {subject} {reach.given:.3g} N s from {arrived:.3f} s on, others that were moving already gave it "
            f"{pushed:.3g} N s ({names}): at least {MOMENTUM_SHARE:.0%} of that is asked"
        )
        measured, bound, unit, first = reach.given, MOMENTUM_SHARE * pushed, "N s", (subject, frames[1])
        evidence = {**evidence, "others": reach.others}
    return _row(
        candidate,
        cause_id,
        effect_id,
        "fail",
        text,
        measured=measured,
        bound=bound,
        unit=unit,
        frames=frames,
        first=first,
        evidence=evidence,
        corrections=_link_hints(cause_id, effect_id, subject, None, None),
    )


def _hop_text(hop: Hop) -> str:
    through = "joint" if hop.impulse is None else f"{hop.impulse:.3g} N s"
    return f"{hop.source} -> {hop.target} at {hop.time:.3f} s ({through})"


def _frontier(candidate: Candidate, reach: Reach, subject: str, frame: int) -> tuple[str, str, float]:
    """First entity that never received the chain: the nearest such to where the chain got last."""
    entities = candidate.spec.entities
    reached = [n for n in reach.reached() if entities[n].motion != "static"]
    if not reached:
        return subject, "nothing", float("nan")
    tip = reached[-1]
    left = [n for n in reach.names if n != tip and reach.time(n) is None and entities[n].motion == "dynamic"]
    if subject not in left:
        left.append(subject)
    at = min(frame, candidate.last_frame)
    here = candidate.center(tip, at)
    away = {n: float(np.linalg.norm(candidate.center(n, at) - here)) for n in left}
    stuck = min(away, key=lambda n: away[n])
    return stuck, tip, away[stuck]


def _absent(
    candidate: Candidate,
    cause_id: str,
    effect_id: str,
    beat_id: str,
    outcome: Outcome,
    *,
    reach: Reach | None = None,
    start: Onset | None = None,
) -> Row:
    beat = candidate.spec.story.beats[beat_id]
    text = f"{'cause' if beat_id == cause_id else 'effect'} {beat_id} never came true: {outcome.explanation}"
    first: tuple[str, int | None] = (outcome.first_failing_entity or beat.subject, outcome.first_failing_frame)
    evidence: dict[str, object] = {"absent": beat_id}
    hints = _link_hints(cause_id, effect_id, first[0], None, None)
    if reach is not None and start is not None and reach.time(beat.subject) is None and beat.subject not in start.sources:
        stuck, tip, away = _frontier(candidate, reach, beat.subject, candidate.last_frame)
        text += f"; the chain from {', '.join(start.sources)} got as far as {tip} and never reached {stuck}"
        evidence |= {"reached": reach.reached(), "tip": tip}
        first, hints = (stuck, first[1]), _link_hints(cause_id, effect_id, stuck, tip, away)
    return _row(
        candidate, cause_id, effect_id, "fail", text, frames=outcome.frames, first=first, evidence=evidence, corrections=hints
    )


def _order_hints(candidate: Candidate, cause_id: str, effect_id: str, frame: int, gap: float) -> list[Correction]:
    beats = candidate.spec.story.beats
    cause, effect = beats[cause_id], beats[effect_id]
    found = []
    then = evaluate(candidate, cause.predicate, (frame, frame))
    if then.value is not None and then.bound is not None:
        found.append(
            correction(
                f"{cause_id} is under way before its threshold is passed",
                "story",
                f"at frame {frame} it measured {then.value:.4g} {then.unit}, its bound is {then.bound:.4g}: choose a bound that is "
                f"reached by then if the process itself is the cause (a weakening edit: give weakening_reason)",
                pointers=(f"/story/beats/{cause_id}/predicate",),
            )
        )
    if cause.owner in candidate.spec.simulation.drivers:
        found.append(
            correction(
                f"{cause_id} comes too late",
                "drivers",
                f"let it act {abs(gap):.3g} frames earlier",
                pointers=(f"/simulation/drivers/{cause.owner}",),
            )
        )
    return [
        *found,
        correction(
            f"something else starts {effect_id} before {cause_id}",
            "placement",
            f"look at what touches {effect.subject} first and keep it away until {cause_id}",
            pointers=(f"/entities/{effect.subject}/pose",),
        ),
        wrong_cause(effect_id),
    ]


def wrong_cause(effect_id: str, more: str = "", pointers: tuple[str, ...] = ()) -> Correction:
    """Correct what the story names as causes of a beat; `more` ends the sentence, `pointers` come behind that of the causes."""
    return correction(
        "the story names the wrong cause",
        "story",
        f"correct the causes of {effect_id}{more}",
        pointers=(f"/story/beats/{effect_id}/causes", *pointers),
    )


def _link_hints(cause_id: str, effect_id: str, stuck: str, tip: str | None, away: float | None) -> list[Correction]:
    near = f"bring {stuck} within reach of {tip}: their centres are {away:.3g} m apart" if tip and away is not None else ""
    return [
        correction(
            "the chain of contacts is broken",
            "placement",
            near or f"bring {stuck} into the path of what {cause_id} sets in motion",
            pointers=(f"/entities/{stuck}/pose/position",),
        ),
        correction(
            "the push is too weak to be passed on",
            "initial_state",
            f"raise the speed of {tip or 'what hits it'}",
            pointers=(f"/entities/{tip or stuck}/physics",),
        ),
        wrong_cause(effect_id),
    ]


def _row(
    candidate: Candidate,
    cause_id: str,
    effect_id: str,
    status: Status,
    explanation: str,
    *,
    measured: float | None = None,
    bound: float | None = None,
    unit: str = "",
    frames: tuple[int, int] | None = None,
    first: tuple[str, int | None] | None = None,
    evidence: dict[str, object] | None = None,
    corrections: list[Correction] | None = None,
) -> Row:
    beats = candidate.spec.story.beats
    effect, cause = beats[effect_id], beats.get(cause_id)
    subjects = [b.subject for b in (cause, effect) if b is not None]
    return make_row(
        candidate,
        RowId("causal", cause_id, effect_id),
        predicate=f"{cause_id} comes no later than {effect_id}, and an impulse chain leads from its subject to {effect.subject}",
        mandatory=effect.mandatory,
        status=status,
        explanation=explanation,
        frames=frames,
        measured=measured,
        bound=bound,
        comparison=">=" if measured is not None else "",
        unit=unit,
        entities=subjects,
        first_failing_entity=first[0] if first else None,
        first_failing_frame=first[1] if first else None,
        corrections=corrections or (),
        evidence={"pointers": [f"/story/beats/{effect_id}/causes"], **(evidence or {})},
        extra=[b.model_dump(mode="json") for b in (cause, effect) if b is not None],
    )
