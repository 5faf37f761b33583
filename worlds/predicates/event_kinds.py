"""Kinds of event that happen to bodies: their definitions with thresholds, and metadata.

The thresholds are the named bounds of `verifiers/predicates/events/bounds.py`; a test holds that every definition states them.
"""

from __future__ import annotations

from ..predicate_base import POSE, PredicateInfo, Tells

__all__ = ["BODY_EVENTS"]

_MOTION = (*POSE, "velocity", "angular_velocity")
_CONTACTS = (*_MOTION, "contact/pair", "contact/vector")
_OWN = "own choice: "


def _event(
    kind: str,
    unit: str,
    gloss: str,
    source: str,
    *tells: Tells,
    channels: tuple[str, ...] = _CONTACTS,
    directed: bool = False,
) -> PredicateInfo:
    return PredicateInfo(
        kind, unit, channels, {"min": "up"}, "narrower", bodily=True, tells=tells, event=True, directed=directed, gloss=gloss, source=source
    )  # fmt: skip


BODY_EVENTS = (
    _event(
        "falls",
        "m",
        "It goes down by at least its half-size while all that touches or holds it carries less than 0.5 of its weight; or it goes down so "
        "while it turns over an edge, and at least 0.5 of the potential energy that it loses becomes motion of it or of what it pushes.",
        "energy: what falls is not carried; the shares are own choices between free fall (0, 1) and being lowered (1, 0)",
        "falls",
        "flies",
    ),
    _event(
        "rises",
        "m",
        "Its centre goes up without a break by at least its half-size, against gravity; by whose work is measured and told.",
        _OWN + "less than its half-size is a stir",
        "flies",
    ),
    _event(
        "spins",
        "rad",
        "It turns about its own centre by at least 6.28 rad in one sense without rolling: what it touches slips, or its centre moves less "
        "than 0.5 of the radius of gyration per radian.",
        _OWN + "less than one turn is turning, not spinning",
        "flies",
    ),
    _event(
        "stops",
        "s",
        "It came at least its half-size, then it is still (slower than 0.0005 m/s and 0.005 rad/s) for at least 0.25 s on end.",
        _OWN + "stillness as everywhere in the checks; a turning point is shorter than a quarter of a second",
        "falls",
        "flies",
        channels=_MOTION,
    ),
    _event(
        "rolls",
        "rad",
        "It turns by at least 3.14 rad about an axis across the direction in which it moves while it touches; the point of contact slips by "
        "less than 0.3 of its centre's way, and runs around the body by at least 0.3 of what it turns through.",
        "mechanics: pure rolling is v + w x r = 0; the share of a turn and the slip are own choices",
        "flies",
    ),
    _event(
        "slides",
        "m",
        "The point of contact slips over what it touches by at least its half-size, and by at least 0.5 of its centre's way.",
        "mechanics: sliding is v + w x r != 0 at the contact; the way is an own choice",
        "flies",
    ),
    _event(
        "tips",
        "rad",
        "It turns by at least 0.2 rad about a level axis over an edge or corner that stays the point of contact on it; its centre goes up to its "
        "highest place over that edge by 0.01 of its half-size, or at least 0.5 of the potential energy that it loses becomes motion of it or of "
        "what it pushes; and from there it comes down by at least 0.01 of its half-size.",
        "statics: balance is passed where the potential energy over the edge is greatest; the angle is an own choice, the balance of a slab "
        "five times as high as thick",
        "falls",
    ),
    _event(
        "lands",
        "N s",
        "It was carried by less than 0.5 of its weight on its way down, faster than a fall from 0.1 of its half-size gives; then contact from "
        "below takes that momentum, and over 0.2 s it is carried by at least 0.5 of its weight and changes its height by less than its half-size.",
        _OWN + "what bounces on has not landed yet",
        "falls",
        "flies",
    ),
    _event(
        "hits",
        "N s",
        "A contact with `other` begins at a closing speed of at least that of a fall from 0.01 of the smaller half-size and 0.02 m/s, of which its own "
        "motion is at least 0.5, with an impulse of at least 0.1 of the reduced mass times that speed.",
        "impact mechanics: J = (1 + e) m v for a central blow; the floors are own choices above resting contact",
        "blows",
        directed=True,
        channels=(*_CONTACTS, "event/time", "event/pair", "event/speed", "event/impulse"),
    ),
    _event(
        "pushes",
        "m",
        "It presses `other`, which follows no path, by contact for at least 0.1 s on end, at least 0.5 of the impulse along the way of the other's centre, and works on it "
        "over a way of at least 0.5 of the other's half-size.",
        "work is force along a way; the time, longer than blows last, and the way are own choices",
        "blows",
        directed=True,
    ),
)  # fmt: skip
"""In the order of the models' literals."""
