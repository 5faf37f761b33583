"""Causes where no beat names any: nothing is asked where all that the story tells lasts from the start and nothing moves.

Causes are asked of beats that tell of a change. A prompt such as "a book lies on a table" tells of none: its beats say what is so at every
frame. Whether that is true is measured, so that no event passes for a state:

- every beat and requirement is a state that lasts (`always`, `supported`, `no_contact` ...), and no driver acts but air at rest;
- each is true at every frame from 0 to the end of its interval, also where that begins later: what comes to be so has a cause;
- nothing leaves its place by more than supported bodies may creep: what moves is a change, whether or not a beat tells of it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...worlds.audits.story import tells_of_change, uncaused
from ..categories.registry import judge_of
from ..predicates.evaluators import evaluate
from ..rows.corrections import correction
from ..rows.findings import Finding, judged
from .bounds import TURNED

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.spec import SpecModel, WorldSpec

__all__ = ["without_causes"]


class _Way(NamedTuple):
    """Way of an entity from where it starts."""

    entity: str
    frame: int
    far: float
    """[m]"""
    turned: float
    """[rad]"""


def without_causes(candidate: Candidate) -> Finding:
    """The finding about a world of which no beat names causes."""
    spec = candidate.spec
    lacking = uncaused(spec)
    if lacking is None:
        text = "every entity is static, and there is no driver and no beat: nothing happens"
        return Finding("not_applicable", text, predicate="events have their causes")
    if tells_of_change(spec) or not _told(spec):
        hint = correction("no beat names causes", "story", lacking, pointers=("/story/beats",))
        return Finding("unverified", lacking, hints=(hint,))
    return judged(lambda: _begins(candidate) or _moves(candidate))


def _told(spec: WorldSpec) -> dict[str, tuple[SpecModel, int]]:
    """Predicate and last frame of every beat and requirement, by pointer."""
    last, story = spec.simulation.frames - 1, spec.story
    beats = {f"/story/beats/{n}": (b.predicate, b.frames[1]) for n, b in story.beats.items()}
    return {
        **beats,
        **{f"/story/requirements/{n}": (r.asked, r.frames[1] if r.frames else last) for n, r in story.requirements.items()},
    }


def _begins(candidate: Candidate) -> Finding | None:
    """The finding about a state that is not there from frame 0 on; None where all are."""
    for place, (predicate, last) in _told(candidate.spec).items():
        name = place.rsplit("/", 1)[1]
        told = evaluate(candidate, predicate, (0, last))
        if told.status == "pass" and told.truth is None:  # only the whole interval has a truth value
            told = evaluate(candidate, predicate, (0, 0))
        if told.status == "pass" and told.frames[0] == 0 and (told.truth is None or bool(told.truth.all())):
            continue
        if told.status == "unverified":
            return Finding("unverified", f"whether {name} holds from frame 0 on is not known: {told.explanation}")
        since = told.frames[0] if told.status == "pass" else told.first_failing_frame
        text = (
            f"{name} does not hold at every frame from 0 to {last} ({told.explanation}), so it tells of a change, and no beat names causes: "
            f"start the scene so that it holds from frame 0 on; or give what brings it about a beat of its own and name that in the `causes` "
            f"of a beat that says when it comes true (`when` eventually or end)"
        )
        hint = correction(f"{name} is a change that is told as a state", "story", text, pointers=(place,))
        return Finding("unverified", text, frame=since, hints=(hint,), evidence={"pointers": [place]})
    return None


def _moves(candidate: Candidate) -> Finding:
    """The finding about the entity that gets farthest from its place.

    Raises:
        EvidenceError: the motion of one is not known.
    """
    spec, names = candidate.spec, _told(candidate.spec)
    ways = [_way(candidate, n) for n, e in spec.entities.items() if e.motion != "static"]
    drift = spec.simulation.limits.support_drift
    held = f"{len(names)} beats and requirements hold from frame 0 on"
    worst = max(ways, key=lambda w: max(w.far / drift, w.turned / TURNED), default=_Way("", 0, 0.0, 0.0))
    evidence: dict[str, Any] = {
        "states": list(names),
        "farthest": {"entity": worst.entity, "m": worst.far, "rad": worst.turned, "allowed_m": drift, "allowed_rad": TURNED},
    }
    if worst.far <= drift and worst.turned <= TURNED:
        text = (
            f"not asked: no beat tells of a change; {held}, and nothing leaves its place by more than {drift:g} m or {TURNED:g} rad "
            f"({worst.entity or 'nothing moves'}: {worst.far:.2g} m, {worst.turned:.2g} rad)"
        )
        return Finding("not_applicable", text, predicate="events have their causes", evidence=evidence)
    name = worst.entity
    text = (
        f"{held}, but {name} goes {worst.far:.3g} m and turns {worst.turned:.3g} rad by frame {worst.frame}, at most {drift:g} m and {TURNED:g} rad "
        f"are a still world's, and no beat tells of it: place {name} where it rests from frame 0 on (place_object); or give its motion a beat "
        f"(displacement, tilts, contact), another of what starts it, and name that one in `causes`"
    )
    hints = (
        correction(
            f"{name} does not rest where it starts", "placement", f"place_object(entity={name!r}, on=...): set it at rest on what carries it",
            pointers=(f"/entities/{name}/pose",),
        ),
        correction(f"the motion of {name} is meant", "story", f"add a beat of {name} that names its cause", pointers=("/story/beats",)),
    )  # fmt: skip
    return Finding("unverified", text, worst.far, drift, "m", name, worst.frame, hints, evidence, comparison="<=")


def _way(candidate: Candidate, entity: str) -> _Way:
    """Way of an entity from its place, by its centre of mass and the turning of its bodies.

    Raises:
        EvidenceError: no cache holds its motion, or a number is not finite.
    """
    judge = judge_of(candidate.spec, entity)
    centers = judge.centers(candidate, entity)
    away = np.linalg.norm(centers - centers[0], axis=1)
    away = np.where(np.isfinite(away), away, np.inf)  # what comes, vanishes or is lost is no matter at rest
    turned = np.zeros(len(away))
    if judge.body:
        for body in candidate.entity(entity).bodies:
            position, turn = candidate.track(entity, body.name)
            away = np.maximum(away, np.linalg.norm(position - position[0], axis=1))
            turned = np.maximum(turned, 2.0 * np.arccos(np.clip(np.abs(turn @ turn[0]), 0.0, 1.0)))
    frame = int(np.argmax(np.maximum(away / candidate.spec.simulation.limits.support_drift, turned / TURNED)))
    return _Way(entity, frame, float(away[frame]), float(turned[frame]))
