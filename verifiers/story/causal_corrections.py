"""Corrections of causal rows: broken chains, wrong order, and effects that come without their cause.

A patch stands where one edit is right; else the words name the beat and the body, and the choice is the author's.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.errors import EvidenceError
from ...worlds.predicates import entities_of
from ..ledgers import motion
from ..predicates.evaluators import evaluate
from ..rows.corrections import WEAKER, correction, set_value
from .bounds import MOVED
from .offers import acting, driver_offers, earlier, faster, offered

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Correction
    from .edges import Edge

__all__ = [
    "ask_for_displacement",
    "comes_anyway",
    "link_hints",
    "not_prevented",
    "order_hints",
    "other_body_hints",
    "wrong_cause",
]

NEARLY = 0.95
"""Share of a measured value that a suggested bound asks for."""


def wrong_cause(edge: Edge, more: str = "", pointers: tuple[str, ...] = ()) -> Correction:
    """Correct the causes that the story names; `more` ends the sentence, `pointers` come behind that of the causes."""
    return correction(
        "the story names the wrong cause",
        "story",
        f"correct the causes of {edge.effect_id}: name in place of {edge.cause_id} what does set {edge.subject} going{WEAKER}{more}",
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
    near = f"within reach of {tip}: their centres are {away:.3g} m apart" if tip and away is not None else ""
    return (
        _bring(edge, stuck, near),
        _faster(edge, tip, stuck),
        wrong_cause(edge),
    )


def other_body_hints(edge: Edge, body: str) -> tuple[Correction, ...]:
    """Corrections of a compound effect of which a body is brought about by none of its causes."""
    place, why = f"/story/beats/{edge.effect_id}", f"what moves {body} is none of the causes of {edge.effect_id}"
    return (
        correction(
            why, "story", f"name a beat that leads to {body} in the causes of {edge.effect_id}", pointers=(f"{place}/causes",)
        ),
        correction(
            why,
            "story",
            f"tell of {body} in a beat of its own, with its own causes{WEAKER}",
            pointers=(f"{place}/predicate",),
        ),
        _bring(edge, body),
    )


def _bring(edge: Edge, body: str, where: str = "") -> Correction:
    """Bring a body to where the chain gets; by default into the path of what the cause moves."""
    action = f"bring {body} {where or f'into the path of what {edge.cause_id} sets in motion'}"
    return correction("the chain of contacts is broken", "placement", action, pointers=(f"/entities/{body}/pose/position",))


def _faster(edge: Edge, tip: str | None, stuck: str) -> Correction:
    """More speed for the last that the chain reached; as a patch where something of the chain starts with a velocity."""
    spec, cause = edge.candidate.spec, "the push is too weak to be passed on"
    for name in dict.fromkeys(n for n in (tip, edge.cause.subject, *entities_of(edge.cause.predicate)) if n in spec.entities):
        speed = getattr(spec.entities[name].physics, "linear_velocity", None)
        if speed and any(speed) and spec.entities[name].motion == "dynamic":
            place, value = f"/entities/{name}/physics/linear_velocity", [2.0 * float(c) for c in speed]
            action = f"raise the start speed of {name}: try twice, {value} m/s"
            return offered(spec, cause, "initial_state", action, pointers=(place,), patch=set_value(place, value))
    return faster(tip or stuck, cause, tip or f"what hits {stuck}")


def order_hints(edge: Edge, frame: int, gap: float) -> tuple[Correction, ...]:
    """Corrections of an effect that comes before its cause.

    Args:
        edge: cause and effect.
        frame: at which the effect came true.
        gap: frames from the cause to the effect, negative.
    """
    spec, found = edge.candidate.spec, _started_before(edge, frame)
    if edge.driven:
        driver = edge.cause.owner
        by = (math.ceil(abs(gap)) + 1) / spec.simulation.fps
        found.append(
            offered(
                spec,
                f"{edge.cause_id} comes too late",
                "drivers",
                f"let driver {driver} act {by:.3g} s earlier: {edge.cause_id} comes {abs(gap):.3g} frames after {edge.effect_id}",
                pointers=(f"/simulation/drivers/{driver}",),
                patch=earlier(spec, driver, by),
            )
        )
    away = correction(
        f"something else starts {edge.effect_id} before {edge.cause_id}",
        "placement",
        f"look at what touches {edge.subject} before frame {frame} and keep it away until {edge.cause_id}",
        pointers=(f"/entities/{edge.subject}/pose",),
    )
    return (*found, away, wrong_cause(edge))


def _started_before(edge: Edge, frame: int) -> list[Correction]:
    """A bound of the cause that its process has passed by a frame; none where it has not begun."""
    then = evaluate(edge.candidate, edge.cause.predicate, (frame, frame))
    if then.value is None or then.bound is None:
        return []
    place = f"/story/beats/{edge.cause_id}/predicate"
    patch: tuple[dict[str, Any], ...] = ()
    least = float(f"{NEARLY * then.value:.3g}")
    if getattr(edge.cause.predicate, "min", None) == then.bound and 0.0 < least < then.bound:
        patch = set_value(f"{place}/min", least)
    chosen = f"a bound of {least:g}, which is" if patch else "a bound that is"
    action = (
        f"at frame {frame} it measured {then.value:.4g} {then.unit}, its bound is {then.bound:.4g}: choose {chosen} "
        f"reached by then if the process itself is the cause{WEAKER}"
    )
    cause = f"{edge.cause_id} is under way before its threshold is passed"
    return [offered(edge.candidate.spec, cause, "story", action, pointers=(place,), patch=patch)]


def comes_anyway(edge: Edge, later: int | None = None) -> tuple[Correction, ...]:
    """Corrections of an effect that comes without its cause.

    Args:
        edge: cause and effect.
        later: frames by which it comes later then, where it comes; None where that is not known.
    """
    spec, owner = edge.candidate.spec, edge.cause.owner
    clocks = [d for d in acting(spec, edge.subject) if d != owner]
    found = [c for d in clocks for c in driver_offers(spec, d, edge.cause_id, edge.effect_id)]
    found.append(
        correction(
            f"something else brings {edge.effect_id} about",
            "placement",
            f"look at what touches or releases {edge.subject} in this run and let only {edge.cause_id} lead to it",
            pointers=(f"/entities/{edge.subject}/pose",),
        )
    )
    if later is not None and later > 0:
        found.append(_hastened(edge, later))
    return (*found, wrong_cause(edge))


def _hastened(edge: Edge, later: int) -> Correction:
    """The margin that an effect meets which comes some frames later without its cause."""
    place = f"/story/beats/{edge.effect_id}/margins"
    return offered(
        edge.candidate.spec,
        f"{edge.cause_id} only hastens {edge.effect_id}",
        "story",
        f"say by how much in the margins of {edge.effect_id}: without {edge.cause_id} it comes {later} frames later",
        pointers=(place,),
        patch=set_value(f"{place}/{edge.cause_id}", {"frames": later}),
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
        offered(
            edge.candidate.spec,
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
    another = offered(
        candidate.spec,
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
    moves = offered(
        candidate.spec,
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
