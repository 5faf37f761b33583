"""An effect in a run without its cause: whether it vanishes, or changes by the margin that it declares for this cause."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from ...worlds.errors import EvidenceError
from ...worlds.noise import least_margin
from ...worlds.predicates import Contact
from ..predicates.evaluators import beat_times, evaluate
from ..predicates.outcome import Outcome
from ..rows.findings import Finding
from .bounds import LEAST_CHANGE
from .causal_corrections import ask_for_displacement, comes_anyway

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Correction
    from ...worlds.spec import CausalMargin
    from ..rows.questions import Comparison
    from .edges import Edge
    from .interventions import Prevention

__all__ = ["compare"]

FLIPPED: Mapping[str, Comparison] = {">=": "<=", "<=": ">="}


def compare(edge: Edge, prevention: Prevention, variant: Candidate) -> Finding:
    """Judge whether the effect is another without its cause.

    Args:
        edge: cause and effect, which both came true.
        prevention: how the cause was prevented.
        variant: the run in which it was.

    Raises:
        EvidenceError: the effect cannot be judged or compared there.
    """
    (_, original), without = edge.outcomes, beat_times(variant).outcome(edge.effect_id)
    if without.status == "unverified":
        raise EvidenceError(f"without {edge.cause_id}, {edge.effect_id} cannot be judged: {without.explanation}")
    came = without.status == "pass"
    found = _vanished(without, came=came)
    hints: tuple[Correction, ...] = ()
    if came:
        at, told = without.first_true_frame, found.text
        if (margin := edge.effect.margins.get(edge.cause_id)) is not None:
            found = _late(original, without, margin) if margin.frames is not None else _weaker(edge, variant, margin)
            told = found.text
        when = "" if at is None else f" at frame {at}"
        told = f"still comes{when} (with it at frame {original.first_true_frame}): {without.explanation}; {told}"
        found = replace(found, text=told, entity=edge.subject if found.status == "fail" else None, frame=at)
        first = original.first_true_frame
        hints = comes_anyway(edge, None if at is None or first is None else at - first)
        hints = (*ask_for_displacement(edge, variant), *hints)
    evidence = {
        "frame_with_cause": original.first_true_frame,
        "frame_without_cause": without.first_true_frame if came else None,
        "value_with_cause": original.value,
        "value_without_cause": without.value,
    }
    return replace(
        found,
        text=f"without {edge.cause_id} ({prevention.text}) {edge.effect_id} {found.text}",
        hints=hints,
        evidence=evidence,
        frames=(prevention.start, variant.last_frame),
    )


def _vanished(without: Outcome, *, came: bool) -> Finding:
    """The effect's predicate without the cause, against the bound that it must now miss."""
    text = "it needs no such cause, so that as its effect it is vacuous" if came else f"does not come: {without.explanation}"
    found = Finding("fail" if came else "pass", text, float(came), 0.0, "1", comparison="<=")
    if without.value is None or without.bound is None or without.comparison not in FLIPPED:
        return found
    flipped = FLIPPED[without.comparison]
    return replace(found, measured=without.value, bound=without.bound, unit=without.unit, comparison=flipped)


def _late(original: Outcome, without: Outcome, margin: CausalMargin) -> Finding:
    """Judge whether an effect that comes without its cause too comes later by its margin."""
    first, asked = original.first_true_frame, margin.frames
    assert first is not None
    assert asked is not None
    if without.first_true_frame is None:
        raise EvidenceError("without its cause it comes true, but at no one frame; declare a margin of its value instead")
    late = without.first_true_frame - first
    text = f"{late} frames later, {asked} are asked"
    return Finding("pass" if late >= asked else "fail", text, float(late), float(asked), "frame", comparison=">=")


def _weaker(edge: Edge, variant: Candidate, margin: CausalMargin) -> Finding:
    """Judge whether an effect that comes without its cause too has another value by its margin."""
    assert margin.value is not None
    predicate, first = edge.effect.predicate, edge.outcomes[1].first_true_frame
    assert first is not None
    pressed = isinstance(predicate, Contact)
    # An impulse adds up from the interval's beginning; everything else is what it is at the frame.
    span = (edge.effect.frames[0] if pressed else first, first)
    values = [evaluate(c, predicate, span) for c in (edge.candidate, variant)]
    unit = "N s" if pressed else values[0].unit
    here, there = (v.details.get("impulse", v.value) if pressed else v.value for v in values)
    if here is None or there is None or (values[0].unit != values[1].unit and not pressed):
        raise EvidenceError(f"{unit or 'the predicate'} has no measured value at frame {first}; declare a margin in frames")
    change = abs(here - there)
    floor = least_margin(edge.candidate.spec, edge.effect)
    noise = floor.value if floor is not None and floor.unit == unit else 0.0
    asked = max(margin.value, LEAST_CHANGE * abs(here), noise)
    text = f"at frame {first} it measures {there:.4g} instead of {here:.4g} {unit}, {asked:g} is asked"
    return Finding("pass" if change >= asked else "fail", text, change, asked, unit, comparison=">=")
