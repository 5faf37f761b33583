"""Ways to prevent a cause, in the order in which the counterfactual check tries them.

1. The cause is owned by a driver: the driver is taken away (a hold never lets go, a path stays at its first key, forces and motors
   do nothing, a joint is not opened).
2. The cause is a contact, or a hit or push of the body whose effect is asked for, that acts on through what was struck: what moves in is held just before, out of touch. Letting it pass
   instead would have a ball strike the second domino in place of the first.
3. The cause is a contact that acts on through what moves in (a rebound, a landing): the two pass through each other.
4. Anything else: its subject is held at its pose and at rest from the onset on; where that is not enough, all moving bodies of its
   predicate are.

Sources: J. Pearl, *Causality*, 2nd ed. 2009, chapters 3 and 7 (the do operator and counterfactuals); J. Y. Halpern, *Actual
Causality*, 2016, chapter 2 (why the rest of the world is left as it happened).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...simulation.protocol import Intervention
from ...worlds.drivers import acts_from
from ...worlds.errors import EvidenceError
from ...worlds.predicates import Contact, PairEvent, entities_of
from ..ledgers import motion
from ..predicates.evaluators import beat_times
from .onsets import onset_of

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from .edges import Edge

__all__ = ["FollowsError", "Prevention", "first_absent", "preventions"]


_BLOWS = ("hits", "pushes")
"""Events of a pair that are contacts in which one acts on the other."""


class FollowsError(EvidenceError):
    """A beat did not come true, so that a row about it has nothing to judge."""

    def __init__(self, candidate: Candidate, beat: str, text: str) -> None:
        first = first_absent(candidate, beat)
        self.row = f"beat:{first}"
        why = "" if first == beat else f"; {first} is the first beat that leads to it and did not come true"
        super().__init__(f"{text}{why}; this row follows from {self.row}: mend that one first")


def first_absent(candidate: Candidate, beat: str) -> str:
    """The first beat that did not come true among those that lead to a beat, all of whose own causes did; that beat itself where all did."""
    beats, times, seen = candidate.spec.story.beats, beat_times(candidate), {beat}
    while True:
        lacking = (c for c in beats[beat].causes if c in beats and c not in seen and times.outcome(c).status != "pass")
        cause = next(lacking, None)
        if cause is None:
            return beat
        seen.add(cause)
        beat = cause


class Prevention(NamedTuple):
    """One way to prevent a cause."""

    done: Intervention
    start: int
    """Frame up to which the run is the candidate's own."""
    text: str


def preventions(edge: Edge) -> list[Prevention]:
    """Ways to prevent the cause, the first that works counts.

    Raises:
        FollowsError: the cause did not come true.
        EvidenceError: its onset is not known.
    """
    candidate, beat, fps = edge.candidate, edge.cause, edge.candidate.spec.simulation.fps
    outcome, _ = edge.outcomes
    if outcome.status != "pass" or outcome.first_true_frame is None:
        raise FollowsError(
            candidate, edge.cause_id, f"{edge.cause_id} did not come true, so it cannot be taken away: {outcome.explanation}"
        )
    found = []
    if edge.driven:
        moment, _ = acts_from(candidate.spec, beat.owner)
        start = min(max(0, int(np.floor(moment * fps + 1e-9))), candidate.last_frame)
        found.append(Prevention(Intervention(without=frozenset({beat.owner})), start, f"driver {beat.owner} is taken away"))
    frame = int(np.floor(onset_of(candidate, edge.cause_id, outcome.first_true_frame).start * fps + 1e-9))
    pair = _pair(edge)
    if pair is not None:
        frame = max(0, min(outcome.first_true_frame - 1, frame))
        found += _of_contact(edge, pair, frame)
    else:
        frame = max(0, frame)
        found += [_hold(candidate, (beat.subject,), frame)] if _moves(candidate, beat.subject) else []
    bodies = tuple(n for n in dict.fromkeys((beat.subject, *entities_of(beat.predicate))) if _moves(candidate, n))
    if bodies and (not found or found[-1].done.held != frozenset(bodies)):
        found.append(_hold(candidate, bodies, frame))
    return found


def _pair(edge: Edge) -> tuple[str, str] | None:
    """The two bodies of a cause that is a contact; of one that is a hit or a push of the very body whose effect is asked for, these two.

    That body held would do nothing, whoever else comes: the doer is to be taken away.
    """
    told = edge.cause.predicate
    if isinstance(told, Contact):
        return told.a, told.b
    if isinstance(told, PairEvent) and told.kind in _BLOWS and edge.subject in (told.entity, told.other):
        return told.entity, told.other
    return None


def _of_contact(edge: Edge, pair: tuple[str, str], frame: int) -> list[Prevention]:
    """The way to prevent a contact that begins after `frame`; none where neither body moves."""
    candidate = edge.candidate
    moving = [n for n in pair if _moves(candidate, n)]
    if not moving:
        return []
    mover = max(moving, key=lambda n: float(motion.fastest_points(candidate, n)[frame]))
    struck = pair[1] if mover == pair[0] else pair[0]
    if _acts_through(edge, struck, mover, frame):
        return [_hold(candidate, (mover,), _out_of_touch(candidate, mover, struck, frame))]
    apart = Intervention(apart=frozenset({pair}))
    return [Prevention(apart, frame, f"{pair[0]} and {pair[1]} pass through each other from frame {frame} on")]


def _out_of_touch(candidate: Candidate, mover: str, struck: str, frame: int) -> int:
    """Last frame at which the mover is far enough from where it will touch: held nearer, its skin would touch already."""
    path = motion.centers(candidate, mover)
    if _moves(candidate, struck):
        path = path - motion.centers(candidate, struck)
    meeting = path[min(frame + 1, len(path) - 1)]
    away = np.linalg.norm(path[: frame + 1] - meeting, axis=1)
    far = np.flatnonzero(away >= candidate.spec.simulation.limits.contact_gap)
    return int(far[-1]) if len(far) else 0


def _acts_through(edge: Edge, struck: str, mover: str, frame: int) -> bool:
    """True if the contact acts on through what was struck, not only through what struck it."""
    candidate = edge.candidate
    if edge.subject in (struck, mover):
        return edge.subject == struck
    last = edge.outcomes[1].first_true_frame
    until = candidate.last_frame if last is None else last
    reach = edge.chains.spread((struck,), frame / candidate.spec.simulation.fps, until, mute=(mover,))
    return reach.time(edge.subject) is not None


def _hold(candidate: Candidate, entities: tuple[str, ...], frame: int) -> Prevention:
    done = Intervention(held=frozenset(entities), since=frame / candidate.spec.simulation.fps)
    return Prevention(done, frame, f"{', '.join(entities)} held from frame {frame} on")


def _moves(candidate: Candidate, entity: str) -> bool:
    contract = candidate.spec.entities.get(entity)
    return contract is not None and contract.motion != "static"
