"""Taps that kitchens and bathrooms share."""

from __future__ import annotations

import math

from .made import MAIN, Body, Joint, Made, Point
from .profiles import arc, circle

__all__ = ["tap"]


def tap(
    made: Made, at: Point, size: tuple[float, float], kind: str, metal: str, *, turn: float = 0.9, name: str = "spout"
) -> None:
    """Add a mixer tap: a column with a lever on the main body, and a spout towards the front that turns on it.

    Args:
        made: gets the parts, the spout and its joint.
        at: point of a level surface that the column stands on [m].
        size: reach of the spout and its height over the column [m].
        kind: arch, or straight.
        metal: material.
        turn: largest angle of the spout to each side [rad].
        name: of the spout's body and joint.
    """
    (x, y, z), (reach, rise), body = at, size, made.main
    foot = [(0, 0), (0.027, 0), (0.027, 0.004), (0.018, 0.01), (0, 0.01)]
    body.turned(f"{name}_flange", foot, (x, y, z), segments=24, material=metal)
    top = z + 0.065
    body.cylinder(f"{name}_column", (x, y, z + 0.01), (x, y, top), 0.017, material=metal)
    lever = [
        (x + 0.017, y, z + 0.045),
        (x + 0.035, y, z + 0.045),
        (x + 0.055, y - 0.01, z + 0.062),
        (x + 0.09, y - 0.03, z + 0.075),
    ]
    body.sweep(f"{name}_lever", lever, circle(0.006, 8), scales=[1.2, 1.0, 0.9, 1.1], material=metal)
    spout = made.bodies[name] = Body("spout", metal)
    start = top + 0.001
    spout.cylinder("collar", (x, y, start), (x, y, start + 0.03), 0.014)
    foot_z, radius = start + 0.03, 0.5 * reach
    if kind == "arch":
        level = foot_z + max(0.02, rise - radius)
        way = [(y, foot_z), *arc((y - radius, level), radius, 0.0, math.pi, 8), (y - reach, level - 0.015)]
    else:
        way = [
            (y, foot_z),
            (y, foot_z + 0.02),
            (y - 0.03, foot_z + 0.045),
            (y - reach, foot_z + 0.05),
            (y - reach - 0.006, foot_z + 0.02),
        ]
    spout.sweep("pipe", [(x, b, c) for b, c in way], circle(0.009, 10))
    made.joints[name] = Joint(
        name, "hinge", (x, y, start + 0.015), MAIN, axis=(0, 0, 1), range=(-turn, turn), damping=0.05, friction=0.3
    )
