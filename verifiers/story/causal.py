"""Causal check: order and connection of beats and their declared causes (R96, R97, S8).

Row `causal:<cause>:<effect>` passes when the cause came true no later than the effect, and an impulse chain (`story/chains.py`)
leads from the cause's subject to the effect's; of a compound effect every body that it tells of is reached from one of its causes. Coincidence is no cause: two events without a chain fail. The chain may use contacts
from the onset of the cause on (`story/onsets.py`).
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.errors import EvidenceError
from ...worlds.predicates import Contact
from ..predicates.evaluators import beat_times
from ..rows.findings import Finding
from .beat_corrections import corrections_of
from .bodies import deeds_of
from .causal_corrections import link_hints, order_hints, other_body_hints, wrong_cause
from .chains import MOMENTUM_SHARE
from .edges import Edge, edges_of
from .interventions import first_absent
from .onsets import contact_time, onset_of
from .questions import CAUSAL

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Correction, Row
    from ..predicates.outcome import Outcome
    from .bodies import Deeds
    from .chains import Hop, Reach
    from .onsets import Onset

__all__ = ["check"]

Moments = tuple[float | None, float | None]
"""Event times of cause and effect [s], where each is a contact."""


def check(candidate: Candidate) -> list[Row]:
    """One row per declared cause of every beat."""
    return [edge.row(CAUSAL, partial(_judge, edge)) for edge in edges_of(candidate)]


def _judge(edge: Edge) -> Finding:
    """Judge whether the cause came first and a chain leads from it to the effect.

    Raises:
        EvidenceError: one of the beats cannot be judged, or a log is missing.
    """
    if not edge.known:
        raise EvidenceError(f"beat {edge.cause_id!r} is not in the story")
    candidate = edge.candidate
    cause, effect = edge.outcomes
    for name, outcome in ((edge.cause_id, cause), (edge.effect_id, effect)):
        if outcome.status == "unverified":
            raise EvidenceError(f"beat {name} is unverified: {outcome.explanation}")
    first, last = cause.first_true_frame, effect.first_true_frame
    if first is None:
        return _absent(edge, edge.cause_id, cause)
    start = onset_of(candidate, edge.cause_id, first)
    moments = contact_time(candidate, edge.cause, first), contact_time(candidate, edge.effect, last)
    until = min(edge.effect.frames[1], candidate.last_frame) if last is None else last

    def spread(about: Edge) -> Reach:
        limit = np.inf if moments[1] is None else moments[1]
        sources, acting = _sources(about, start), start.acting_until
        return edge.chains.spread(sources, start.start, until, subject=about.subject, acting_until=acting, limit=limit)

    if last is None:
        return _absent(edge, edge.effect_id, effect, spread(edge), start)
    found = _late(edge, start, last, moments)
    if found is None:
        found = _linked(edge, start, last, spread(edge))
        if deeds := deeds_of(candidate, edge.effect):
            others = (replace(edge, body=body) for body in dict.fromkeys(b for part in deeds for b in part.atoms))
            linked = (f for e in others if (f := _linked(e, start, last, spread(e))).status == "pass")
            found = found if found.status == "pass" else next(linked, found)
            found = (_each_body(edge, deeds, last) or found) if found.status == "pass" else found
    evidence = {
        "order_frames": last - start.frame,
        "cause_frame": start.frame,
        "effect_frame": last,
        "event_times": list(moments),
    }
    span = min(int(np.floor(start.frame)), last), last
    return replace(found, frames=found.frames or span, evidence={**evidence, **(found.evidence or {})})


def _late(edge: Edge, start: Onset, last: int, moments: Moments) -> Finding | None:
    """The failure of an effect that comes before its cause; None where it comes later, or with it."""
    gap, (before, after) = last - start.frame, moments
    told = ""
    late = gap < 0
    if before is not None and after is not None:
        told = f"; contacts at {after:.4f} s and {before:.4f} s"
        late = after <= before if edge.cause.predicate != edge.effect.predicate else late
    if not late:
        return None
    return Finding(
        "fail",
        f"{edge.effect_id} came true at frame {last}, before its cause: {start.text}{told}",
        gap,
        0.0,
        "frame",
        edge.subject,
        last,
        order_hints(edge, last, gap),
        frames=(last, max(last, start.acting_until)),
    )


def _sources(edge: Edge, start: Onset) -> tuple[str, ...]:
    """Where the cause's chain starts. A contact happens to both; it links the other one with itself as well."""
    cause = edge.cause.predicate
    if isinstance(cause, Contact) and edge.subject in (cause.a, cause.b):
        return tuple(dict.fromkeys((*start.sources, edge.subject)))
    return start.sources


def _linked(edge: Edge, start: Onset, last: int, reach: Reach) -> Finding:
    """Judge whether the cause's chain brings the effect about."""
    subject = edge.subject
    if subject in _sources(edge, start):
        return _same_subject(edge, start, last, reach)
    chain = reach.chain(subject) if reach.ever(subject) else []
    evidence = {"hops": len(chain), "chain": [h._asdict() for h in chain]}
    if not chain:
        found = _broken(edge, start, last, reach)
    elif reach.time(subject) is None:
        found = _interrupted(edge, last, reach)
    elif reach.negligible:
        found = _outweighed(edge, last, reach)
    else:
        steps = ", ".join(_hop_text(h) for h in chain[:8]) + (f", ... {len(chain) - 8} more" if len(chain) > 8 else "")
        text = f"{len(chain)} hops lead from {chain[0].source} to {subject}: {steps}"
        found = Finding("pass", text, float(len(chain)), 1.0, "hops")
    return replace(found, evidence={**evidence, **(found.evidence or {})})


def _each_body(edge: Edge, deeds: list[Deeds], last: int) -> Finding | None:
    """The failure of a compound effect of which some bodies are reached by none of its causes; None where all are."""
    reached = _reached(edge, last)
    idle = dict.fromkeys(body for part in deeds for body in part.lacking(lambda body, _: body in reached))
    if not idle:
        return None
    first, names = next(iter(idle)), ", ".join(idle)
    causes = ", ".join(edge.effect.causes)
    told = ", ".join(sorted(reached & {body for part in deeds for body in part.atoms})) or "none of its bodies"
    text = f"{edge.effect_id} tells of {names} too, and no chain leads there from {causes} by frame {last}: it reaches {told}"
    return Finding(
        "fail",
        text,
        0.0,
        1.0,
        "hops",
        first,
        last,
        other_body_hints(edge, first),
        {"unreached": list(idle), "reached": sorted(reached)},
    )


def _reached(edge: Edge, last: int) -> frozenset[str]:
    """Bodies that the causes of an effect start from or reach by a frame, all causes together."""
    candidate, found = edge.candidate, set[str]()
    for cause in edge.effect.causes:
        first = beat_times(candidate).first(cause)
        if first is None:
            continue
        other = Edge(candidate, cause, edge.effect_id)
        start = onset_of(candidate, cause, first)
        sources = _sources(other, start)
        reach = edge.chains.spread(sources, start.start, last, acting_until=start.acting_until)
        found |= {n for n in reach.names if n in sources or reach.time(n) is not None}
    return frozenset(found)


def _same_subject(edge: Edge, start: Onset, last: int, reach: Reach) -> Finding:
    """The link of a body with itself: what it does later follows from its motion, unless that ended in between."""
    subject, failed = edge.subject, reach.time(edge.subject) is None
    rest = reach.stopped.get(subject) if failed else None
    text = f"{subject} moves on from {edge.cause_id} (frame {start.frame:g}) to {edge.effect_id} (frame {last})"
    if failed:
        text = f"{subject} came to rest at frame {rest}, between {edge.cause_id} and {edge.effect_id}, so nothing links them"
    if edge.candidate.spec.entities[subject].motion == "kinematic" and not edge.driven:
        failed, text = True, f"{subject} follows an authored path, so {edge.cause_id} does not bring {edge.effect_id} about"
    return Finding(
        "fail" if failed else "pass",
        text,
        float(last - start.frame),
        0.0,
        "frame",
        subject if failed else None,
        last if rest is None else rest,
        link_hints(edge, subject),
        {"hops": 0, "chain": [], "same_subject": True},
    )


def _broken(edge: Edge, start: Onset, last: int, reach: Reach) -> Finding:
    """The failure of a chain that never arrives."""
    stuck, tip, away = _frontier(edge, reach, last)
    text = (
        f"no impulse chain leads from {', '.join(start.sources)} to {edge.subject} by frame {last}; "
        f"it got as far as {tip}, and {stuck}, {away:.3g} m from it between centres, never received it"
    )
    hints = link_hints(edge, stuck, tip, away)
    if tip in reach.stopped:
        text += f"; {tip} came to rest at frame {reach.stopped[tip]}, and what rests passes nothing on: it only bears what comes to it"
        hints = (wrong_cause(edge, f": name what still moves when it meets {edge.subject}"), *hints[:-1])
    evidence = {"reached": reach.reached(), "tip": tip, "gap_between_centers": away}
    return Finding("fail", text, 0.0, 1.0, "hops", stuck, last, hints, evidence)


def _interrupted(edge: Edge, last: int, reach: Reach) -> Finding:
    """The failure of a chain that arrived and ended, before something else moved the subject."""
    rest = reach.stopped.get(edge.subject, last)
    text = f"{edge.subject} was reached at {_arrival(edge, reach):.3f} s, came to rest at frame {rest}, and then moved by something else"
    return Finding("fail", text, 0.0, 1.0, "hops", edge.subject, rest, link_hints(edge, edge.subject))


def _outweighed(edge: Edge, last: int, reach: Reach) -> Finding:
    """The failure of a chain that arrived while others pushed far harder."""
    pushed = sum(reach.others.values())
    names = ", ".join(sorted(reach.others, key=lambda n: -reach.others[n])[:4])
    text = (
        f"the chain gave {edge.subject} {reach.given:.3g} N s from {_arrival(edge, reach):.3f} s on, others that were moving already "
        f"gave it {pushed:.3g} N s ({names}): at least {MOMENTUM_SHARE:.0%} of that is asked"
    )
    hints = link_hints(edge, edge.subject)
    bound = MOMENTUM_SHARE * pushed
    return Finding("fail", text, reach.given, bound, "N s", edge.subject, last, hints, {"others": reach.others})


def _arrival(edge: Edge, reach: Reach) -> float:
    """When the chain first arrived at the effect's subject [s]."""
    return float(reach.arrival[reach.names.index(edge.subject)])


def _hop_text(hop: Hop) -> str:
    through = "joint, heat, dust or steam" if hop.impulse is None else f"{hop.impulse:.3g} N s"
    return f"{hop.source} -> {hop.target} at {hop.time:.3f} s ({through})"


def _frontier(edge: Edge, reach: Reach, frame: int) -> tuple[str, str, float]:
    """First entity that never received the chain, the last that did, and the distance of their centres [m]."""
    candidate, entities = edge.candidate, edge.candidate.spec.entities
    reached = [n for n in reach.reached() if entities[n].motion != "static"]
    if not reached:
        return edge.subject, "nothing", float("nan")
    tip = reached[-1]
    left = [n for n in reach.names if n != tip and reach.time(n) is None and entities[n].motion == "dynamic"]
    at = min(frame, candidate.last_frame)
    here = candidate.center(tip, at)
    away = {n: float(np.linalg.norm(candidate.center(n, at) - here)) for n in dict.fromkeys([*left, edge.subject])}
    stuck = min(away, key=lambda n: away[n])
    return stuck, tip, away[stuck]


def _absent(edge: Edge, beat_id: str, outcome: Outcome, reach: Reach | None = None, start: Onset | None = None) -> Finding:
    """The failure of a cause or an effect that never came true; with the end of the chain where there is one."""
    candidate, subject = edge.candidate, edge.candidate.spec.story.beats[beat_id].subject
    text = f"{'cause' if beat_id == edge.cause_id else 'effect'} {beat_id} never came true: {outcome.explanation}"
    entity: str = outcome.first_failing_entity or subject
    evidence: dict[str, Any] = {"absent": beat_id}
    hints = link_hints(edge, entity)
    if reach is not None and start is not None and reach.time(subject) is None and subject not in start.sources:
        entity, tip, away = _frontier(edge, reach, candidate.last_frame)
        text += f"; the chain from {', '.join(start.sources)} got as far as {tip} and never reached {entity}"
        evidence |= {"reached": reach.reached(), "tip": tip}
        hints = link_hints(edge, entity, tip, away)
    frame = outcome.first_failing_frame
    root = first_absent(candidate, beat_id)
    text += f"; this row follows from beat:{root}{'' if root == beat_id else ', the first that leads to it and did not come true'}: mend that one first"
    evidence["follows"] = f"beat:{root}"
    # A faster push is the business of the beat's own row, which tells by how much.
    hints = (*_of_first(edge, root), *(h.model_copy(update={"patch": ()}) if h.group == "initial_state" else h for h in hints))
    return Finding("fail", text, entity=entity, frame=frame, hints=hints, evidence=evidence, frames=outcome.frames)


def _of_first(edge: Edge, beat_id: str) -> tuple[Correction, ...]:
    """Corrections of the first beat that did not come true: its row is the one to answer."""
    candidate, beat = edge.candidate, edge.candidate.spec.story.beats[beat_id]
    outcome, place = beat_times(candidate).outcome(beat_id), f"/story/beats/{beat_id}"
    found = corrections_of(candidate, beat.predicate, outcome, place, beat.frames)
    return tuple(c.model_copy(update={"patch": ()}) if c.edit_class == "story" else c for c in found)
