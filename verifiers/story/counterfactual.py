"""Counterfactual causality: take the cause away, let the world go on, and the effect must not come (R97, R156, S8).

Row `causal:without:<cause>:<effect>`: the world is continued from just before the onset of the cause, with the cause
prevented, up to the end of the effect's interval. The effect must vanish, or change by the margin that the effect
declares for this cause. Coincident independent events fail: each comes without the other. An effect that is true in a
run without its cause is vacuous.

How a cause is prevented, in this order; an intervention counts only if the cause's own predicate then stays false:

1. The cause is owned by a driver: the driver is taken away (a hold never lets go, a path stays at its first key, forces
   and motors do nothing, a joint is not opened).
2. The cause is a contact that acts on through what was struck: what moves in is held just before, out of touch.
   Letting it pass instead would have a ball strike the second domino in place of the first.
3. The cause is a contact that acts on through what moves in (a rebound, a landing): the two pass through each other.
4. Anything else: its subject is held at its pose and at rest from the onset on; where that is not enough, all moving
   bodies of its predicate are.

Sources: J. Pearl, *Causality*, 2nd ed. 2009, chapters 3 and 7 (the do operator and counterfactuals); J. Y. Halpern, *Actual
Causality*, 2016, chapter 2 (why the rest of the world is left as it happened).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...simulation.protocol import Intervention
from ...simulation.variants import first_frame, run_variant, simulated
from ...worlds.candidate import Candidate
from ...worlds.drivers import acts_from
from ...worlds.errors import EvidenceError
from ...worlds.predicates import Contact, entities_of
from ...worlds.requirements import Correction, Row, RowId, Status
from ..ledgers import motion
from ..predicates import Outcome, beat_times, evaluate, last_needed
from ..rows.verdicts import correction, make_row, postponed
from .causal import onset_of, wrong_cause
from .chains import Chains

if TYPE_CHECKING:
    from ...worlds.spec import Beat, CausalMargin, SpecModel, WorldSpec

__all__ = ["check", "row_ids"]

MOVED = 4.0
"""Own choice: what has come so many times as far as a resting body may creep has left its place."""
LEAST_CHANGE = 0.05
"""Own choice: a value that changes by less than this share of what it was with the cause has not changed, whatever margin was
declared: chaos alone moves numbers by a little."""
FLIPPED: Mapping[str, str] = {">=": "<=", "<=": ">="}


class _FollowsError(EvidenceError):
    """A beat did not come true, so that a row about it has nothing to judge."""

    def __init__(self, beat: str, text: str) -> None:
        self.row = f"beat:{beat}"
        super().__init__(f"{text}; this row follows from {self.row}: mend that one first")


class _Try(NamedTuple):
    """One way to prevent a cause."""

    done: Intervention
    start: int
    """Frame up to which the run is the candidate's own."""
    text: str


@dataclass(frozen=True)
class _Run:
    """A variant, and what it took."""

    candidate: Candidate
    frames: int
    start: int

    @property
    def instances(self) -> tuple[str, ...]:
        """Those that the judgement needed."""
        return simulated(self.candidate)

    @property
    def steps(self) -> int:
        """Solver steps of the frames from its start on; unlike seconds equal on every machine."""
        rigid = self.candidate.rigid_caches
        return int(sum(rigid[n].series("record/steps")[self.start + 1 :].sum() for n in self.instances if n in rigid))


def row_ids(spec: WorldSpec) -> frozenset[str]:
    """Ids of the rows that this check gives for a specification."""
    return frozenset(_row_id(c, e) for e, beat in spec.story.beats.items() for c in beat.causes if c in spec.story.beats)


def _row_id(cause_id: str, effect_id: str) -> RowId:
    return RowId("causal:without", cause_id, effect_id)


def check(
    candidate: Candidate, progress: Callable[[float, float, str], None] | None = None, failing: str | None = None
) -> list[Row]:
    """One row per declared cause of every beat; runs that serve several effects are made once.

    Args:
        candidate: what is judged.
        progress: called with (rows done, rows planned, message), also from within a run.
        failing: id of a row that fails; then nothing is simulated, and every row follows from that one.
    """
    beats = candidate.spec.story.beats
    edges = [(c, e) for e, beat in beats.items() for c in beat.causes if c in beats]
    if not edges:
        return []
    if failing is not None:
        return [_row(candidate, *edge, "unverified", postponed(failing), evidence={"follows": failing}) for edge in edges]
    rows: list[Row] = []

    def tell(done: int, total: int, message: str) -> None:
        if progress is not None:
            cause, effect = edges[len(rows)]
            progress(len(rows) + done / max(total, 1), len(edges), f"checking causal: {effect} without {cause}, {message}")

    work = _Work(candidate, edges, tell)
    for cause_id, effect_id in edges:
        tell(0, 1, f"{len(rows) + 1} of {len(edges)}")
        try:
            rows.append(work.judge(cause_id, effect_id))
        except EvidenceError as error:
            follows = {"follows": error.row} if isinstance(error, _FollowsError) else None
            rows.append(_row(candidate, cause_id, effect_id, "unverified", str(error), evidence=follows))
    return rows


class _Work:
    """The variants of one candidate."""

    def __init__(self, candidate: Candidate, edges: list[tuple[str, str]], tell: Callable[[int, int, str], None]) -> None:
        self.candidate = candidate
        self._tell = tell
        self._chains: Chains | None = None
        self._tries: dict[tuple[str, str], list[_Try] | EvidenceError] = {}
        self._ends: dict[_Try, int] = {}
        self._runs: dict[_Try, _Run | EvidenceError] = {}
        for edge in edges:
            try:
                tries = self._tries[edge] = self._interventions(*edge)
            except EvidenceError as error:
                self._tries[edge] = error
                continue
            end = min(candidate.last_frame, last_needed(candidate.spec, edge))
            for option in tries:
                self._ends[option] = max(end, self._ends.get(option, 0))

    def judge(self, cause_id: str, effect_id: str) -> Row:
        """The row of one edge.

        Raises:
            EvidenceError: the cause cannot be prevented, or the run not be repeated.
        """
        candidate, beats = self.candidate, self.candidate.spec.story.beats
        tries = self._tries[cause_id, effect_id]
        if isinstance(tries, EvidenceError):
            raise tries
        original = beat_times(candidate).outcome(effect_id)
        if original.status != "pass" or original.first_true_frame is None:
            raise _FollowsError(effect_id, f"{effect_id} did not come true, so nothing can vanish: {original.explanation}")
        failed: list[str] = []
        for option in tries:
            run = self._run(option)
            removed = evaluate(run.candidate, beats[cause_id].predicate, self._held(run, beats[cause_id]))
            if removed.status == "unverified":
                raise EvidenceError(f"cannot tell whether {cause_id} was prevented: {removed.explanation}")
            if removed.status == "fail":
                return _compare(candidate, (cause_id, effect_id), option, run, failed)
            failed.append(option.text)
        raise EvidenceError(
            f"nothing that this build can do prevents {cause_id} ({'; '.join(failed) or 'no body of it moves'}); "
            "state the cause as an event of a moving body"
        )

    def _held(self, run: _Run, beat: Beat) -> tuple[int, int]:
        return beat.frames[0], min(beat.frames[1], run.candidate.last_frame)

    def _run(self, option: _Try) -> _Run:
        if option not in self._runs:
            try:
                end = self._ends[option]
                made = run_variant(self.candidate, option.done, start=option.start, end=end, progress=self._tell)
                self._runs[option] = _Run(made, end - first_frame(self.candidate, option.start), option.start)
            except EvidenceError as error:
                self._runs[option] = error
        found = self._runs[option]
        if isinstance(found, EvidenceError):
            raise found
        return found

    # ---------------------------------------------------------------- interventions

    def _interventions(self, cause_id: str, effect_id: str) -> list[_Try]:
        candidate, plan = self.candidate, self.candidate.spec.simulation
        beat = candidate.spec.story.beats[cause_id]
        outcome = beat_times(candidate).outcome(cause_id)
        if outcome.status != "pass" or outcome.first_true_frame is None:
            raise _FollowsError(cause_id, f"{cause_id} did not come true, so it cannot be taken away: {outcome.explanation}")
        found = []
        if beat.owner in plan.drivers:
            moment, _ = acts_from(candidate.spec, beat.owner)
            frame = min(max(0, int(np.floor(moment * plan.fps + 1e-9))), candidate.last_frame)
            found.append(_Try(Intervention(without=frozenset({beat.owner})), frame, f"driver {beat.owner} is taken away"))
        onset = onset_of(candidate, cause_id, beat, outcome.first_true_frame)
        sources = [n for n in dict.fromkeys((beat.subject, *entities_of(beat.predicate))) if self._moves(n)]
        if isinstance(beat.predicate, Contact):
            frame = max(0, min(outcome.first_true_frame - 1, int(np.floor(onset.start * plan.fps + 1e-9))))
            found += self._contact(beat.predicate, effect_id, frame)
        else:
            frame = max(0, int(np.floor(onset.start * plan.fps + 1e-9)))
            if self._moves(beat.subject):
                found.append(self._hold((beat.subject,), frame))
        if sources and (not found or found[-1].done.held != frozenset(sources)):
            found.append(self._hold(tuple(sources), frame))
        return found

    def _contact(self, contact: Contact, effect_id: str, frame: int) -> list[_Try]:
        candidate = self.candidate
        moving = [n for n in (contact.a, contact.b) if self._moves(n)]
        if not moving:
            return []
        speed = {n: float(motion.fastest_points(candidate, n)[frame]) for n in moving}
        mover = max(moving, key=lambda n: speed[n])
        struck = contact.b if mover == contact.a else contact.a
        apart = Intervention(apart=frozenset({(contact.a, contact.b)}))
        passing = _Try(apart, frame, f"{contact.a} and {contact.b} pass through each other from frame {frame} on")
        if not self._acts_through(struck, mover, effect_id, frame):
            return [passing]
        return [self._hold((mover,), self._away(mover, struck, frame))]

    def _away(self, mover: str, struck: str, frame: int) -> int:
        """Last frame at which the mover is far enough from where it will touch: held nearer, its skin would touch already."""
        path = motion.centers(self.candidate, mover)
        if self._moves(struck):
            path = path - motion.centers(self.candidate, struck)
        meeting = path[min(frame + 1, len(path) - 1)]
        far = np.flatnonzero(
            np.linalg.norm(path[: frame + 1] - meeting, axis=1) >= self.candidate.spec.simulation.limits.contact_gap
        )
        return int(far[-1]) if len(far) else 0

    def _acts_through(self, struck: str, mover: str, effect_id: str, frame: int) -> bool:
        """Whether the contact acts on through what was struck, not only through what struck it."""
        subject = self.candidate.spec.story.beats[effect_id].subject
        if subject in (struck, mover):
            return subject == struck
        if self._chains is None:
            self._chains = Chains(self.candidate)
        last = beat_times(self.candidate).outcome(effect_id).first_true_frame
        until = self.candidate.last_frame if last is None else last
        reach = self._chains.spread((struck,), frame / self.candidate.spec.simulation.fps, until, mute=(mover,))
        return reach.time(subject) is not None

    def _hold(self, entities: tuple[str, ...], frame: int) -> _Try:
        done = Intervention(held=frozenset(entities), since=frame / self.candidate.spec.simulation.fps)
        return _Try(done, frame, f"{', '.join(entities)} held from frame {frame} on")

    def _moves(self, entity: str) -> bool:
        contract = self.candidate.spec.entities.get(entity)
        return contract is not None and contract.motion != "static"


# ---------------------------------------------------------------- judgement


def _compare(candidate: Candidate, edge: tuple[str, str], option: _Try, run: _Run, failed: list[str]) -> Row:
    cause_id, effect_id = edge
    effect = candidate.spec.story.beats[effect_id]
    original = beat_times(candidate).outcome(effect_id)
    first = original.first_true_frame
    assert first is not None
    without = beat_times(run.candidate).outcome(effect_id)
    if without.status == "unverified":
        raise EvidenceError(f"without {cause_id}, {effect_id} cannot be judged: {without.explanation}")
    came = without.status == "pass"
    margin = effect.margins.get(cause_id)
    evidence: dict[str, object] = {
        "intervention": option.text,
        "not_enough": failed,
        "from_frame": option.start,
        "frames_rerun": run.frames,
        "steps_rerun": run.steps,
        "instances_rerun": list(run.instances),
        "frame_with_cause": first,
        "frame_without_cause": without.first_true_frame if came else None,
        "value_with_cause": original.value,
        "value_without_cause": without.value,
    }
    measured: dict[str, object] = _vanishing(without, came=came)
    status: Status = "fail" if came else "pass"
    text = f"without {cause_id} ({option.text}) {effect_id} "
    if came:
        at = without.first_true_frame
        text += f"still comes{f' at frame {at}' if at is not None else ''} (with it at frame {first}): {without.explanation}"
        if margin is not None:
            status, measured, more = _changed(run.candidate, candidate, effect.predicate, effect, first, without, margin)
            text += f"; {more}"
        else:
            text += "; it needs no such cause, so that as its effect it is vacuous"
    else:
        text += f"does not come: {without.explanation}"
    return _row(
        candidate,
        cause_id,
        effect_id,
        status,
        text,
        frames=(option.start, run.candidate.last_frame),
        first=(effect.subject, without.first_true_frame) if status == "fail" else None,
        evidence=evidence,
        corrections=[
            *(_where_too(candidate, run.candidate, effect_id, effect) if came else ()),
            *_hints(cause_id, effect_id, effect, margin is not None),
        ],
        **measured,  # type: ignore[arg-type]
    )


def _vanishing(without: Outcome, *, came: bool) -> dict[str, object]:
    """What the effect's predicate measured without the cause, against the bound that it must now miss."""
    if without.value is not None and without.bound is not None and without.comparison in FLIPPED:
        return {
            "measured": without.value,
            "bound": without.bound,
            "comparison": FLIPPED[without.comparison],
            "unit": without.unit,
        }
    return {"measured": float(came), "bound": 0.0, "comparison": "<=", "unit": "1"}


def _changed(
    variant: Candidate,
    candidate: Candidate,
    predicate: SpecModel,
    effect: Beat,
    first: int,
    without: Outcome,
    margin: CausalMargin,
) -> tuple[Status, dict[str, object], str]:
    """Whether an effect that comes without its cause too differs by its margin."""
    if margin.frames is not None:
        if without.first_true_frame is None:
            raise EvidenceError("without its cause it comes true, but at no one frame; declare a margin of its value instead")
        late = without.first_true_frame - first
        text = f"{late} frames later, {margin.frames} are asked"
        measured = {"measured": float(late), "bound": float(margin.frames), "comparison": ">=", "unit": "frame"}
        return ("pass" if late >= margin.frames else "fail"), measured, text
    assert margin.value is not None
    # An impulse adds up from the interval's beginning; everything else is what it is at the frame.
    span = (effect.frames[0] if isinstance(predicate, Contact) else first, first)
    values = [evaluate(c, predicate, span) for c in (candidate, variant)]
    unit = "N s" if isinstance(predicate, Contact) else values[0].unit
    here, there = (v.details.get("impulse", v.value) if isinstance(predicate, Contact) else v.value for v in values)
    if here is None or there is None or (values[0].unit != values[1].unit and not isinstance(predicate, Contact)):
        raise EvidenceError(f"{unit or 'the predicate'} has no measured value at frame {first}; declare a margin in frames")
    change = abs(here - there)
    asked = max(margin.value, LEAST_CHANGE * abs(here))
    text = f"at frame {first} it measures {there:.4g} instead of {here:.4g} {unit}, {asked:g} is asked"
    measured = {"measured": change, "bound": asked, "comparison": ">=", "unit": unit}
    return ("pass" if change >= asked else "fail"), measured, text


def _where_too(candidate: Candidate, variant: Candidate, effect_id: str, effect: Beat) -> list[Correction]:
    """Correction for an effect that is also true of a body that nothing moves, such as rest: ask for its displacement, too."""
    last = effect.frames[1]
    try:
        ways = [
            float(np.linalg.norm(np.diff(motion.centers(c, effect.subject)[[0, last]], axis=0))) for c in (candidate, variant)
        ]
    except (EvidenceError, IndexError):
        return []
    drift = candidate.spec.simulation.limits.support_drift
    if ways[1] > drift or ways[0] < MOVED * drift:
        return []
    least = float(f"{0.5 * ways[0]:.2g}")
    moved = {"kind": "displacement", "entity": effect.subject, "min": least, "when": "end"}
    place = f"/story/beats/{effect_id}/predicate"
    both = {"kind": "and", "of": [effect.predicate.model_dump(mode="json", exclude_none=True), moved]}
    return [
        correction(
            f"{effect_id} is true of {effect.subject} wherever nothing moves it",
            "story",
            f"ask also how far it has come by then: it went {ways[0]:.3g} m",
            pointers=(place,),
            patch=({"op": "replace", "path": place, "value": both},),
        )
    ]


def _hints(cause_id: str, effect_id: str, effect: Beat, has_margin: bool) -> list[Correction]:
    margins = f"; where {cause_id} only hastens or strengthens it, say by how much in its margins (a weakening)"
    weaker = "" if has_margin else margins
    return [
        correction(
            f"something else brings {effect_id} about",
            "placement",
            f"look at what touches or releases {effect.subject} in this run and let only {cause_id} lead to it",
            pointers=(f"/entities/{effect.subject}/pose",),
        ),
        correction(
            f"a driver acts on {effect.subject}, or releases it, by its own clock",
            "drivers",
            f"take that driver away and let {cause_id} do it",
            pointers=("/simulation/drivers",),
        ),
        wrong_cause(effect_id, weaker, (f"/story/beats/{effect_id}/margins",)),
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
    comparison: str = "",
    unit: str = "",
    frames: tuple[int, int] | None = None,
    first: tuple[str, int | None] | None = None,
    evidence: Mapping[str, object] | None = None,
    corrections: list[Correction] | None = None,
) -> Row:
    beats = candidate.spec.story.beats
    cause, effect = beats[cause_id], beats[effect_id]
    margin = effect.margins.get(cause_id)
    asked = "does not come" if margin is None else f"does not come, or {margin.model_dump(exclude_none=True)} apart"
    return make_row(
        candidate,
        _row_id(cause_id, effect_id),
        predicate=f"without {cause_id}, {effect_id} {asked}",
        mandatory=effect.mandatory,
        status=status,
        explanation=explanation,
        frames=frames,
        measured=measured,
        bound=bound,
        comparison=comparison,  # type: ignore[arg-type]
        unit=unit,
        entities=(cause.subject, effect.subject),
        first_failing_entity=first[0] if first else None,
        first_failing_frame=first[1] if first else None,
        corrections=corrections or (),
        evidence={"pointers": [f"/story/beats/{effect_id}/causes"], **(evidence or {})},
        extra=[b.model_dump(mode="json") for b in (cause, effect)],
    )
