"""Metadata of every predicate kind, and what follows from it for their frames (R157)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..categories.registry import CATEGORIES
from ..predicate_base import BAND, POSE, Interval, PredicateInfo
from ..vocabulary import SpecModel
from .event_kinds import BODY_EVENTS

__all__ = ["PREDICATES", "interval_tightens", "is_event", "is_invariant"]

_GENERAL = (
    PredicateInfo("reaches", "m", POSE, bodily=True),
    PredicateInfo("stays_in", "m", POSE, bodily=True, lasting=True),
    PredicateInfo(
        "crosses",
        "m",
        POSE,
        frames="narrower",
        bodily=True,
        event=True,
        gloss="Its centre passes a plane from the back to the front.",
        source="geometry",
    ),
    PredicateInfo(
        "contact",
        "N s",
        ("contact/pair", "contact/impulse"),
        {"min_impulse": "up"},
        frames="narrower",
        bodily=True,
        event=True,
        gloss="The two touch, with at least `min_impulse` in all.",
        source="log of contacts; surfaces where both sleep",
    ),
    PredicateInfo("no_contact", "N s", ("contact/pair", "contact/impulse"), frames="wider", bodily=True, lasting=True),
    PredicateInfo(
        "rests_on",
        "m/s",
        (*POSE, "velocity", "angular_velocity"),
        {"max_speed": "down"},
        bodily=True,
    ),
    PredicateInfo("supported", "1", POSE, bodily=True, lasting=True),
    PredicateInfo("tilts", "rad", POSE, BAND, bodily=True, least={"min": 0.02}),
    PredicateInfo(
        "topples",
        "rad",
        POSE,
        {"min_angle": "up"},
        frames="either",
        bodily=True,
        least={"min_angle": 0.2},
        event=True,
        gloss="Its z axis ends at least `min_angle` from where it was at frame 0, and did not start there.",
        source="own choice: 0.6 rad is past the balance of what is twice as high as thick",
    ),
    PredicateInfo("speed", "m/s", ("velocity",), BAND, bodily=True, least={"min": 0.02}),
    PredicateInfo("displacement", "m", POSE, BAND, bodily=True),
    PredicateInfo("separation", "m", POSE, BAND, bodily=True),
    PredicateInfo("joint_angle", "rad", ("joint",), BAND, least={"min": 0.005}),
    PredicateInfo("compares", "1", POSE, {"margin": "none"}, bodily=True),
    PredicateInfo(
        "landscape_water",
        "1",
        (),
        {**BAND, "min_depth": "up", "min_area": "up", "min_length": "up", "min_width": "up"},
        frames="either",
        lasting=True,
    ),
    PredicateInfo("landscape_field", "1", (), BAND, frames="either", lasting=True),
    PredicateInfo("count", "1", (), BAND, frames="inner"),
    PredicateInfo("always", "1", (), frames="own", lasting=True),
    PredicateInfo("eventually", "1", (), frames="own"),
    PredicateInfo("until", "1", (), frames="either"),
    PredicateInfo("before", "frame", (), frames="either"),
    PredicateInfo("after", "frame", (), frames="either"),
    PredicateInfo("within", "frame", (), {"frames": "down"}, frames="either"),
    PredicateInfo("and", "1", (), frames="inner"),
    PredicateInfo("or", "1", (), frames="inner"),
    PredicateInfo("not", "1", (), frames="inner", lasting=True),
)
PREDICATES: Mapping[str, PredicateInfo] = {
    info.kind: info for info in (*_GENERAL, *BODY_EVENTS, *(p for category in CATEGORIES.values() for p in category.predicates))
}
"""All kinds: general ones, and those that the categories answer."""


def is_invariant(predicate: SpecModel) -> bool:
    """True if the predicate speaks of a state that lasts, not of an event."""
    kind = getattr(predicate, "kind", "")
    if kind == "count":
        return is_invariant(predicate.predicate)  # type: ignore[attr-defined]
    if kind in ("and", "or"):
        return all(is_invariant(p) for p in predicate.of)  # type: ignore[attr-defined]
    return (kind in PREDICATES and PREDICATES[kind].lasting) or getattr(predicate, "when", "") == "always"


def is_event(predicate: SpecModel) -> bool:
    """True if the predicate is one atom that says that something happens; a band without `min` says only that no more does."""
    info = PREDICATES.get(str(getattr(predicate, "kind", "")))
    if info is None or not info.event or getattr(predicate, "when", "eventually") != "eventually":
        return False
    return info.tightens != BAND or (getattr(predicate, "min", None) or 0.0) > 0.0


def _turned(interval: Interval) -> Interval:
    return {"narrower": "wider", "wider": "narrower"}.get(interval, interval)  # type: ignore[return-value]


def interval_tightens(predicate: Mapping[str, Any]) -> Interval:
    """Change of the frames of a beat or requirement that makes its predicate, as JSON, harder to meet.

    What has to happen is harder in fewer frames, what has to last in more.
    """
    kind, info = str(predicate.get("kind")), PREDICATES.get(str(predicate.get("kind")))
    if info is None:
        return "either"
    if info.frames == "inner":
        if kind == "count" and predicate.get("max") is not None:
            return "either"
        inner = [predicate["predicate"]] if "predicate" in predicate else list(predicate["of"])
        found = {interval_tightens(p) for p in inner}
        one = found.pop() if len(found) == 1 else "either"
        return _turned(one) if kind == "not" else one
    if info.frames == "own":
        mine: Interval = "wider" if kind == "always" else "narrower"
        return mine if predicate.get("frames") is None else "either"
    if info.frames == "when":
        by_when: dict[str, Interval] = {"eventually": "narrower", "always": "wider", "end": "end"}
        return by_when.get(str(predicate.get("when")), "either")
    return info.frames
