"""Beats and requirements of the story: does what the specification promises happen (R15, R86, R156)?

Rows: `beat:<id>` and `requirement:<id>` judge the declared predicate over its frames; `beat:vacuous:<id>` fails a
beat that was true before its interval begins (`story/vacuity.py`); `beat:branches:<id>` an `or` one side of which never comes true
(`story/branches.py`); `beat:driven:<id>` fails an outcome whose motion
is authored, or that nothing of the story starts (`story/driven.py`). An *invariant* (`always`, `stays_in`, `supported`, `no_contact`, `not`, an atom with `when=always`)
without causes may be true from the start: an initial state, which is told as such and causes nothing. A beat with causes may not.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ...worlds.candidate import Candidate
from ...worlds.predicates import atoms_of, describe_predicate, entities_of
from ...worlds.predicates.registry import is_invariant
from ...worlds.spec import Requirement
from ..predicates.evaluators import beat_times, evaluate
from ..predicates.outcome import Outcome
from ..rows.answers import row_of
from ..rows.findings import Finding
from .beat_corrections import corrections_of, happens_at
from .branches import check_branches
from .driven import check_driven
from .questions import BEAT, REQUIREMENT
from .vacuity import check_vacuity

if TYPE_CHECKING:
    from ...worlds.requirements import Row
    from ...worlds.spec import Beat, SpecModel

__all__ = ["check"]

SPATIAL = frozenset(
    {
        "reaches",
        "stays_in",
        "separation",
        "supported",
        "rests_on",
        "crosses",
        "displacement",
        "landscape_water",
        "landscape_field",
    }
)


def check(candidate: Candidate) -> list[Row]:
    """One row per beat and requirement, and the derived rows."""
    times = beat_times(candidate)
    rows: list[Row] = []
    for beat_id, beat in candidate.spec.story.beats.items():
        found = _judged(candidate, beat, times.outcome(beat_id), f"/story/beats/{beat_id}", beat.subject)
        rows.append(row_of(candidate, replace(BEAT, mandatory=beat.mandatory), (beat_id,), found))
        rows += check_vacuity(candidate, beat_id)
        rows += check_driven(candidate, beat_id) + check_branches(candidate, beat, beat_id)
    for name, asked in candidate.spec.story.requirements.items():
        frames = asked.frames or (0, candidate.spec.simulation.frames - 1)
        found = _judged(candidate, asked, evaluate(candidate, asked.asked, frames), f"/story/requirements/{name}")
        group = "spatial" if asked.predicate.kind in SPATIAL else REQUIREMENT.group
        question = replace(REQUIREMENT, mandatory=asked.mandatory, matrix_group=group)
        rows += [row_of(candidate, question, (name,), found), *check_branches(candidate, asked, name)]
    return rows


def _judged(
    candidate: Candidate, declared: Beat | Requirement, outcome: Outcome, pointer: str, subject: str | None = None
) -> Finding:
    """The finding about a predicate that the story declares.

    Args:
        candidate: what is judged.
        declared: a beat or requirement.
        outcome: outcome of its predicate over its own frames.
        pointer: its place in the specification.
        subject: the beat's; a requirement has none.
    """
    predicate = declared.asked if isinstance(declared, Requirement) else declared.predicate
    plan = candidate.spec.simulation
    frames = declared.frames or (0, plan.frames - 1)
    outcome = _decided_early(candidate, predicate, outcome)
    return Finding(
        outcome.status,
        outcome.explanation,
        outcome.value,
        outcome.bound,
        outcome.unit,
        outcome.first_failing_entity,
        outcome.first_failing_frame,
        tuple(corrections_of(candidate, predicate, outcome, pointer, frames)),
        {
            "text": declared.text,
            **_kinds(candidate, predicate, outcome),
            "first_true_frame": outcome.first_true_frame,
            "margin": outcome.margin,
            "failing": list(outcome.failing),
            "pointers": [pointer],
            **_lateness(candidate, predicate, outcome),
            **outcome.details,
        },
        outcome.comparison,
        (*outcome.failing, *([subject] if subject else []), *entities_of(predicate)),
        outcome.frames,
        predicate=describe_predicate(predicate),
        extra=[declared.model_dump(mode="json"), plan.limits.contact_gap],
    )


def _lateness(candidate: Candidate, predicate: SpecModel, outcome: Outcome) -> dict[str, Any]:
    """By how much a failing event misses its interval, where it does happen; negative where it is early.

    `shift_s` is the time that brings it inside: a fifth more than it is late, but no farther than the middle of the interval.
    """
    at = happens_at(candidate, predicate, outcome.frames) if outcome.status == "fail" else None
    if at is None:
        return {}
    late, fps = at - outcome.frames[0 if at < outcome.frames[0] else 1], candidate.spec.simulation.fps
    shift = min(1.2 * late, at - sum(outcome.frames) / 2, key=abs)
    return {"happens_at_frame": at, "late_frames": late, "late_s": late / fps, "shift_s": shift / fps}


def _decided_early(candidate: Candidate, predicate: SpecModel, outcome: Outcome) -> Outcome:
    """A state that had to last and already broke within a shorter run has failed, whatever the rest brings."""
    first, last = outcome.frames
    if outcome.status != "unverified" or not is_invariant(predicate) or not first <= candidate.last_frame < last:
        return outcome
    if getattr(predicate, "kind", "") == "not" or candidate.stage == "static":
        return outcome
    partial = evaluate(candidate, predicate, (first, candidate.last_frame))
    return partial if partial.status == "fail" else outcome


def _kinds(candidate: Candidate, predicate: SpecModel, outcome: Outcome) -> dict[str, str]:
    """Kind of matter that the row is about, and of the atom that asks: the one about the failing entity, where only one kind does."""
    entities, named = candidate.spec.entities, entities_of(predicate)
    entity = next((n for n in (outcome.first_failing_entity, *outcome.failing, *named) if n in entities), None)
    atoms = [a for a in atoms_of(predicate) if entity is None or {entity, "each"} & {*_fields(a)}] or atoms_of(predicate)
    asks = {str(getattr(a, "kind", "")) for a in atoms}
    about = {} if entity is None else {"about": entities[entity].physics.category}
    return {**about, "asks": asks.pop() if len(asks) == 1 else str(getattr(predicate, "kind", ""))}


def _fields(atom: SpecModel) -> list[str]:
    return [v for n in type(atom).model_fields if isinstance(v := getattr(atom, n), str)]
