"""Beats and requirements of the story: does what the specification promises happen (R15, R86, R156)?

Rows: `beat:<id>` and `requirement:<id>` judge the declared predicate over its frames; `beat:vacuous:<id>` fails a
beat that was true before its interval begins (`story/vacuity.py`); `beat:driven:<id>` fails an outcome whose motion
is authored, or that nothing of the story starts (`story/driven.py`). An *invariant* (`always`, `stays_in`, `supported`, `no_contact`, `not`, an atom with `when=always`)
without causes may be true from the start; a beat with causes may not.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...worlds.candidate import Candidate
from ...worlds.predicates import atoms_of, describe_predicate, entities_of
from ...worlds.predicates.registry import is_invariant
from ...worlds.requirements import Group, Row, RowId
from ..predicates import Outcome, beat_times, evaluate
from ..rows.verdicts import make_row, requested_frames
from .beat_corrections import corrections_of, happens_at
from .driven import check_driven
from .vacuity import check_vacuity

if TYPE_CHECKING:
    from ...worlds.requirements import Correction
    from ...worlds.spec import Beat, Requirement, SpecModel

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
        outcome = _decided_early(candidate, beat.predicate, times.outcome(beat_id))
        hints = corrections_of(candidate, beat.predicate, outcome, f"/story/beats/{beat_id}", beat.frames)
        rows.append(_row(candidate, RowId("beat", beat_id), None, beat, outcome, hints, (beat.subject,)))
        rows += check_vacuity(candidate, beat_id)
        rows += check_driven(candidate, beat_id)
    for name, requirement in candidate.spec.story.requirements.items():
        frames = requirement.frames or requested_frames(candidate)
        outcome = _decided_early(candidate, requirement.predicate, evaluate(candidate, requirement.predicate, frames))
        hints = corrections_of(candidate, requirement.predicate, outcome, f"/story/requirements/{name}", frames)
        group: Group = "spatial" if requirement.predicate.kind in SPATIAL else "physical"
        rows.append(_row(candidate, RowId("requirement", name), group, requirement, outcome, hints, ()))
    return rows


def _decided_early(candidate: Candidate, predicate: SpecModel, outcome: Outcome) -> Outcome:
    """A state that had to last and already broke within a shorter run has failed, whatever the rest brings."""
    first, last = outcome.frames
    if outcome.status != "unverified" or not is_invariant(predicate) or not first <= candidate.last_frame < last:
        return outcome
    if getattr(predicate, "kind", "") == "not" or candidate.stage == "static":
        return outcome
    partial = evaluate(candidate, predicate, (first, candidate.last_frame))
    return partial if partial.status == "fail" else outcome


def _row(
    candidate: Candidate,
    row_id: RowId,
    group: Group | None,
    declared: Beat | Requirement,
    outcome: Outcome,
    hints: list[Correction],
    subjects: tuple[str, ...],
) -> Row:
    pointer = "/story/" + row_id.replace("beat:", "beats/").replace("requirement:", "requirements/")
    at = happens_at(candidate, declared.predicate, outcome.frames) if outcome.status == "fail" else None
    late = 0 if at is None else at - outcome.frames[0 if at < outcome.frames[0] else 1]
    off = {"happens_at_frame": at, "late_frames": late, "late_s": late / candidate.spec.simulation.fps} if late else {}
    return make_row(
        candidate,
        row_id,
        group=group,
        predicate=describe_predicate(declared.predicate),
        mandatory=declared.mandatory,
        status=outcome.status,
        explanation=outcome.explanation,
        frames=outcome.frames,
        measured=outcome.value,
        bound=outcome.bound,
        comparison=outcome.comparison,
        unit=outcome.unit,
        entities=(*outcome.failing, *subjects, *entities_of(declared.predicate)),
        first_failing_entity=outcome.first_failing_entity,
        first_failing_frame=outcome.first_failing_frame,
        corrections=hints,
        evidence={
            "text": declared.text,
            **_kinds(candidate, declared.predicate, outcome),
            "first_true_frame": outcome.first_true_frame,
            "margin": outcome.margin,
            "failing": list(outcome.failing),
            "pointers": [pointer],
            **off,
            **outcome.details,
        },
        extra=[declared.model_dump(mode="json"), candidate.spec.simulation.limits.contact_gap],
    )


def _kinds(candidate: Candidate, predicate: SpecModel, outcome: Outcome) -> dict[str, str]:
    """Of which kind of matter the row speaks, and which atom asks: the one about what fails, where only one kind does."""
    entities, named = candidate.spec.entities, entities_of(predicate)
    entity = next((n for n in (outcome.first_failing_entity, *outcome.failing, *named) if n in entities), None)
    atoms = [a for a in atoms_of(predicate) if entity is None or {entity, "each"} & {*_fields(a)}] or atoms_of(predicate)
    asks = {str(getattr(a, "kind", "")) for a in atoms}
    about = {} if entity is None else {"about": entities[entity].physics.category}
    return {**about, "asks": asks.pop() if len(asks) == 1 else str(getattr(predicate, "kind", ""))}


def _fields(atom: SpecModel) -> list[str]:
    return [v for n in type(atom).model_fields if isinstance(v := getattr(atom, n), str)]
