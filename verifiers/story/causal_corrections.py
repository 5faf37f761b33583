"""Corrections of causal rows: broken chains, wrong order, and effects that come without their cause."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.errors import EvidenceError
from ..ledgers import motion
from ..predicates import evaluate
from ..rows.corrections import correction
from .bounds import MOVED

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Correction
    from .edges import Edge

__all__ = ["ask_for_displacement", "comes_anyway", "link_hints", "not_prevented", "order_hints", "wrong_cause"]


def wrong_cause(edge: Edge, more: str = "", pointers: tuple[str, ...] = ()) -> Correction:
    """Correct the causes that the story names; `more` ends the sentence, `pointers` come behind that of the causes."""
    return correction(
        "the story names the wrong cause",
        "story",
        f"correct the causes of {edge.effect_id}{more}",
        pointers=(f"/story/beats/{edge.effect_id}/causes", *pointers),
    )


def link_hints(edge: Edge, stuck: str, tip: str | None = None, away: float | None = None) -> tuple[Correction, ...]:
    """Corrections of a chain that ends too early.

    Args:
        edge: cause and effect.
        stuck: first entity that the chain does not reach.
        tip: last entity that it reaches.
        away: distance between the centres of the two [m].
    """
    near = f"bring {stuck} within reach of {tip}: their centres are {away:.3g} m apart" if tip and away is not None else ""
    return (
        correction(
            "the chain of contacts is broken",
            "placement",
            near or f"bring {stuck} into the path of what {edge.cause_id} sets in motion",
            pointers=(f"/entities/{stuck}/pose/position",),
        ),
        correction(
            "the push is too weak to be passed on",
            "initial_state",
            f"raise the speed of {tip or 'what hits it'}",
            pointers=(f"/entities/{tip or stuck}/physics",),
        ),
        wrong_cause(edge),
    )


def order_hints(edge: Edge, frame: int, gap: float) -> tuple[Correction, ...]:
    """Corrections of an effect that comes before its cause.

    Args:
        edge: cause and effect.
        frame: at which the effect came true.
        gap: frames from the cause to the effect, negative.
    """
    found = []
    then = evaluate(edge.candidate, edge.cause.predicate, (frame, frame))
    if then.value is not None and then.bound is not None:
        found.append(
            correction(
                f"{edge.cause_id} is under way before its threshold is passed",
                "story",
                f"at frame {frame} it measured {then.value:.4g} {then.unit}, its bound is {then.bound:.4g}: choose a bound that is "
                f"reached by then if the process itself is the cause (a weakening edit: give weakening_reason)",
                pointers=(f"/story/beats/{edge.cause_id}/predicate",),
            )
        )
    if edge.driven:
        found.append(
            correction(
                f"{edge.cause_id} comes too late",
                "drivers",
                f"let it act {abs(gap):.3g} frames earlier",
                pointers=(f"/simulation/drivers/{edge.cause.owner}",),
            )
        )
    earlier = correction(
        f"something else starts {edge.effect_id} before {edge.cause_id}",
        "placement",
        f"look at what touches {edge.subject} first and keep it away until {edge.cause_id}",
        pointers=(f"/entities/{edge.subject}/pose",),
    )
    return (*found, earlier, wrong_cause(edge))


def comes_anyway(edge: Edge) -> tuple[Correction, ...]:
    """Corrections of an effect that comes without its cause."""
    margins = f"; where {edge.cause_id} only hastens or strengthens it, say by how much in its margins (a weakening)"
    return (
        correction(
            f"something else brings {edge.effect_id} about",
            "placement",
            f"look at what touches or releases {edge.subject} in this run and let only {edge.cause_id} lead to it",
            pointers=(f"/entities/{edge.subject}/pose",),
        ),
        correction(
            f"a driver acts on {edge.subject}, or releases it, by its own clock",
            "drivers",
            f"take that driver away and let {edge.cause_id} do it",
            pointers=("/simulation/drivers",),
        ),
        wrong_cause(edge, "" if edge.cause_id in edge.effect.margins else margins, (f"/story/beats/{edge.effect_id}/margins",)),
    )


def ask_for_displacement(edge: Edge, variant: Candidate) -> tuple[Correction, ...]:
    """Correction of an effect that is true of a body also where nothing moves it, such as rest; none where it does not apply."""
    last = edge.effect.frames[1]
    try:
        ways = [
            float(np.linalg.norm(np.diff(motion.centers(c, edge.subject)[[0, last]], axis=0))) for c in (edge.candidate, variant)
        ]
    except (EvidenceError, IndexError):
        return ()
    drift = edge.candidate.spec.simulation.limits.support_drift
    if ways[1] > drift or ways[0] < MOVED * drift:
        return ()
    place, value = _moved_too(edge, edge.effect_id, 0.5 * ways[0], "end")
    return (
        correction(
            f"{edge.effect_id} is true of {edge.subject} wherever nothing moves it",
            "story",
            f"ask also how far it has come by then: it went {ways[0]:.3g} m",
            pointers=(place,),
            patch=({"op": "replace", "path": place, "value": value},),
        ),
    )


def not_prevented(edge: Edge) -> tuple[Correction, ...]:
    """Corrections of a cause that holding its bodies does not prevent: ask for its motion where it moves, or name another cause."""
    cause, candidate = edge.cause, edge.candidate
    index, place = edge.effect.causes.index(edge.cause_id), f"/story/beats/{edge.effect_id}/causes"
    another = correction(
        f"{edge.cause_id} is so whatever moves",
        "story",
        f"take {edge.cause_id} out of the causes of {edge.effect_id} and name a beat of what moves or strikes {edge.subject} in its place",
        pointers=(place,),
        patch=({"op": "remove", "path": f"{place}/{index}"},),
    )
    try:
        centers = motion.centers(candidate, cause.subject)
    except EvidenceError:
        return (another,)
    way = float(np.linalg.norm(centers[cause.frames[0] : cause.frames[1] + 1] - centers[0], axis=1).max(initial=0.0))
    if not way >= MOVED * candidate.spec.simulation.limits.support_drift:
        return (another,)
    pointer, value = _moved_too(edge, edge.cause_id, 0.5 * way, "eventually")
    moves = correction(
        f"{edge.cause_id} is true of {cause.subject} also while it is held in its place",
        "story",
        f"ask also that {cause.subject} has come some way: it goes {way:.3g} m from its place by frame {cause.frames[1]}",
        pointers=(pointer,),
        patch=({"op": "replace", "path": pointer, "value": value},),
    )
    return moves, another


def _moved_too(edge: Edge, beat_id: str, least: float, when: str) -> tuple[str, dict[str, Any]]:
    """Pointer and value of a beat's predicate that also asks its subject to be `least` [m] away from where it starts."""
    beat = edge.candidate.spec.story.beats[beat_id]
    moved = {"kind": "displacement", "entity": beat.subject, "min": float(f"{least:.2g}"), "when": when}
    both = {"kind": "and", "of": [beat.predicate.model_dump(mode="json", exclude_none=True), moved]}
    return f"/story/beats/{beat_id}/predicate", both
