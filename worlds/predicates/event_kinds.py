"""Kinds of event that happen to bodies: their definitions with thresholds, and metadata.

The thresholds are the named bounds of `verifiers/predicates/events/bounds.py`; a test holds that every definition states them.
"""

from __future__ import annotations

from ..predicate_base import POSE, PredicateInfo

__all__ = ["BODY_EVENTS"]

_MOTION = (*POSE, "velocity", "angular_velocity")
_CONTACTS = (*_MOTION, "contact/pair", "contact/vector")
_OWN = "own choice: "


def _event(
    kind: str,
    unit: str,
    gloss: str,
    source: str,
    *,
    channels: tuple[str, ...] = _CONTACTS,
    directed: bool = False,
) -> PredicateInfo:
    return PredicateInfo(
        kind, unit, channels, {"min": "up"}, "narrower", bodily=True, event=True, directed=directed, gloss=gloss, source=source
    )  # fmt: skip


BODY_EVENTS = (
    _event(
        "falls",
        "m",
        "It goes down by at least its half-size while all that touches or holds it carries less than 0.5 of its weight; or it goes down so "
        "while it turns over an edge, and at least 0.5 of the potential energy that it loses becomes motion of it or of what it pushes.",
        "energy: what falls is not carried; the shares are own choices between free fall (0, 1) and being lowered (1, 0)",
    ),
    _event(
        "rises",
        "m",
        "Its centre goes up without a break by at least its half-size, against gravity; by whose work is measured and told.",
        _OWN + "less than its half-size is a stir",
    ),
    _event(
        "spins",
        "rad",
        "It turns about its own centre by at least 6.28 rad in one sense without rolling: what it touches slips, or its centre moves less "
        "than 0.5 of the radius of gyration per radian.",
        _OWN + "less than one turn is turning, not spinning",
    ),
    _event(
        "stops",
        "s",
        "It came at least its half-size, then it is still (slower than 0.0005 m/s and 0.005 rad/s; a soft body by its ways from frame to frame) for at least 0.25 s on end. A liquid: its root mean square "
        "speed was at least 0.2 of sqrt(g depth), then it is at most 0.05 of it for at least 1 s on end, depth being that of its columns, weighted by what they hold.",
        _OWN + "stillness as everywhere in the checks; a turning point is shorter than a quarter of a second",
        channels=_MOTION,
    ),
    _event(
        "slows",
        "1",
        "It loses at least 0.5 of its speed without a break over at least 0.2 s, no more than 0.5 of the loss between two frames.",
        _OWN + "half of the speed is seen; a blow is another event",
        channels=_MOTION,
    ),
    _event(
        "swings",
        "1",
        "It goes to and fro about a hinge, a ball joint or a rope: at least one turning point between turns of at least 0.05 rad, at which "
        "contacts and drivers give no more than 0.2 of its change of momentum and before which it has slowed to 0.5 of its rate; half periods differ by no more than a factor of 2.0.",
        "mechanics: a pendulum is turned back by its weight or spring, in even time; the shares are own choices",
    ),
    _event(
        "jumps",
        "m",
        "It leaves what carried it and rises by at least its half-size, having come down no faster than 0.2 of the speed with which it leaves; "
        "drivers, fields, liquids and contacts of others that move give no more than 0.2 of that momentum: the rest is from springs, from "
        "its own joints, or from the ground that stays.",
        "mechanics: still ground gives momentum and no energy; records do not tell the work of a body's own joints from that of others",
    ),
    _event(
        "drifts",
        "m",
        "It goes a level way of at least its half-size, no faster than 4.0 half-sizes per second, and air, liquid or a field gives at least 0.5 "
        "of the work that drives it along.",
        _OWN + "the share and the pace at which things drift",
    ),
    _event(
        "rolls",
        "rad",
        "It turns by at least 3.14 rad about an axis across the direction in which it moves while it touches or hops no higher than 0.1 of its "
        "half-size; the point of contact slips by less than 0.3 of its centre's way, 0.5 between two frames, and runs around the body by at "
        "least 0.3 of what it turns through.",
        "mechanics: pure rolling is v + w x r = 0; the share of a turn, the hop and the slips are own choices",
    ),
    _event(
        "slides",
        "m",
        "The point of contact slips over what it touches by at least its half-size, and by at least 0.5 of its centre's way.",
        "mechanics: sliding is v + w x r != 0 at the contact; the way is an own choice",
    ),
    _event(
        "tips",
        "rad",
        "It turns by at least 0.2 rad about a level axis over an edge or corner that stays the point of contact on it; its centre goes up to its "
        "highest place over that edge by 0.01 of its half-size, or at least 0.5 of the potential energy that it loses becomes motion of it or of "
        "what it pushes; and from there it comes down by at least 0.01 of its half-size.",
        "statics: balance is passed where the potential energy over the edge is greatest; the angle is an own choice, the balance of a slab "
        "five times as high as thick",
    ),
    _event(
        "lands",
        "N s",
        "It was carried by less than 0.5 of its weight on its way down, faster than a fall from 0.1 of its half-size gives; then contact from "
        "below takes that momentum, and over 0.2 s it is carried by at least 0.5 of its weight and changes its height by less than its half-size.",
        _OWN + "what bounces on has not landed yet",
    ),
    _event(
        "bounces",
        "m",
        "It moves itself and closes in on what it touches at least as fast as a fall from 0.01 of its half-size and 0.02 m/s, the contact turns that round to at "
        "least 0.1 of it, ends, and it comes off by at least 0.2 of its half-size before it touches again.",
        "impact mechanics: the normal velocity changes its sign; the shares are own choices",
    ),
    _event(
        "goes_uphill",
        "m",
        "Its centre goes up without a break by at least its half-size while something carries it that itself rises by no more than 0.5 of that, "
        "along a level way of at least 0.5 of the rise; by whose work is measured and told.",
        _OWN + "the shares; what lifts rises too, and walls are steeper",
    ),
    _event(
        "comes_loose",
        "m",
        "A joint, weld, spring or rope that held it is opened, and it moves at least 0.5 of its half-size against the other end. Bonds that break "
        "are told by `broken` and `debris`.",
        _OWN + "the way",
    ),
    _event(
        "opens",
        "1",
        "On its hinge its free edge was within 0.05 of its reach from `other` (default: what it is hinged to) and comes off by at least 0.25 of it.",
        _OWN + "through 15 degrees one sees; slides are asked by `joint_angle`, since surfaces do not tell what they cover",
        channels=POSE,
    ),
    _event(
        "closes",
        "1",
        "On its hinge its free edge was at least 0.25 of its reach off `other` (default: what it is hinged to) and comes to within 0.05 of it.",
        _OWN + "as for `opens`",
        channels=POSE,
    ),
    _event(
        "hits",
        "N s",
        "A contact with `other` begins at a closing speed of at least that of a fall from 0.01 of the smaller half-size and 0.02 m/s, of which its own "
        "motion is at least 0.5, with an impulse of at least 0.1 of the reduced mass times that speed.",
        "impact mechanics: J = (1 + e) m v for a central blow; the floors are own choices above resting contact",
        directed=True,
        channels=(*_CONTACTS, "event/time", "event/pair", "event/speed", "event/impulse"),
    ),
    _event(
        "pushes",
        "m",
        "It presses `other`, which follows no path, by contact for at least 0.1 s on end, at least 0.5 of the impulse along the way of the other's centre, and works on it "
        "over a way of at least 0.5 of the other's half-size. A liquid does so by what it gives level, with at least 0.5 of the work that drives the other along.",
        "work is force along a way; the time, longer than blows last, and the way are own choices",
        directed=True,
    ),
    _event(
        "pulls",
        "m",
        "By contact, spring, rope or joint it works on `other` for at least 0.1 s on end, over a way of at least 0.5 of the other's half-size, the "
        "impulse within 60 degrees (cosine 0.5) of the way and of the direction to its own centre.",
        "work is force along a way; the directions are own choices",
        directed=True,
    ),
    _event(
        "lifts",
        "m",
        "`other` rises without a break by at least its half-size, and this one, which moves, works on it by contact, spring, rope or joint at least 0.5 of "
        "its weight times that height; by contact alone, it rises where it is below the other by at least 0.5 of that too.",
        "energy: lifting is work against gravity; a slope that stays works on nothing",
        directed=True,
    ),
    _event(
        "lowers",
        "m",
        "`other` goes down without a break by at least its half-size while this one, which moves, bears at least 0.5 of its weight and takes at least "
        "0.5 of the potential energy that it loses; by contact alone, it goes down where it is below the other by at least 0.5 of that too.",
        "energy: what is lowered gives its energy to what bears it",
        directed=True,
    ),
    _event(
        "throws",
        "m",
        "It works on `other` for at least 0.1 s on end, at least 0.5 of the energy of motion with which that leaves, faster than a fall from 0.5 of the "
        "other's half-size; then the other flies at least 2.0 of its half-size, carried by less than 0.5 of its weight.",
        _OWN + "longer than a blow, faster than what is dropped",
        directed=True,
    ),
    _event(
        "rests_against",
        "s",
        "It is still for at least 0.25 s on end, touches `other` from the side, itself or by what joints tie to it; and without that contact the others "
        "could not hold it, or it came towards `other` at 0.02 m/s or more and that took at least 0.5 of this momentum.",
        "statics: forces within the cones of friction that balance its weight (Erdmann 1994, doi:10.1177/027836499401300306); or the impulse that stopped it",
        directed=True,
        channels=POSE,
    ),
    _event(
        "jams",
        "s",
        "It is still for at least 0.25 s on end while drivers, fields, springs or bodies on paths press it with at least 0.1 of its weight, of which "
        "`other` holds at least 0.5. The torque of motors is in no record.",
        "statics; the shares are own choices",
        directed=True,
    ),
)  # fmt: skip
"""In the order of the models' literals."""
