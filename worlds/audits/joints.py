"""Axes and ranges of joints that no engine can carry out, as the specification gives them (R27)."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ..problems import Problem, replaced
from ..spec import HingeJoint, SlideJoint, WorldSpec

__all__ = ["joint_problems"]

LEAST_AXIS = 1e-6
"""[1] Own choice: an axis shorter than this has no direction that anybody meant."""


def joint_problems(spec: WorldSpec) -> list[Problem]:
    """Hinges and slides without a direction, or whose range leaves out the pose that they start in."""
    return [
        problem
        for name, joint in spec.simulation.joints.items()
        if isinstance(joint, HingeJoint | SlideJoint)
        for problem in (*_axis(name, joint), *_range(name, joint))
    ]


def _axis(name: str, joint: HingeJoint | SlideJoint) -> Iterator[Problem]:
    length = math.hypot(*joint.axis)
    if length < LEAST_AXIS:
        does = "turns about it" if isinstance(joint, HingeJoint) else "moves along it"
        yield Problem(
            f"/simulation/joints/{name}/axis",
            f"axis {list(joint.axis)} of {joint.kind} {name!r} has length {length:g}, at least {LEAST_AXIS:g} is needed for a direction: give "
            f"the direction in the world in which {joint.child!r} {does}, such as [0, 0, 1] for the vertical; its length does not count",
        )


def _range(name: str, joint: HingeJoint | SlideJoint) -> Iterator[Problem]:
    if joint.range is None:
        return
    (first, second), unit = joint.range, "rad" if isinstance(joint, HingeJoint) else "m"
    if first < second and first <= 0.0 <= second:
        return
    place, what = f"/simulation/joints/{name}/range", f"range {list(joint.range)} {unit} of {joint.kind} {name!r}"
    if first == second:
        yield Problem(place, f"{what} leaves no way to go, first < second is allowed: widen it, or make {name!r} a weld")
    elif second <= 0.0 <= first:
        yield Problem(
            place,
            f"{what} is upside down, first < second is allowed: give {[second, first]}",
            replaced(place, [second, first]),
        )
    else:
        low, high = min(first, second), max(first, second)
        yield Problem(
            place,
            f"{what} leaves out 0 {unit}, which is where {joint.child!r} starts: positions count from the pose at frame 0, and "
            f"first <= 0 <= second is allowed; let it start in between and count from there, or widen the range to "
            f"{[min(low, 0.0), max(high, 0.0)]}",
        )
