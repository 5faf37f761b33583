"""Soot, or fuel burnt or not, and heat that the velocities of a frame carry through the open sides of the box, or of the part of it that was solved.

A side's speed is not in a frame: the velocity at the middle of a cell is the mean of those of its faces, so that of the side follows from
the outermost two cells. How far it is from that of the outermost cell alone is left open, as `doubt`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ....worlds.arrays import F64
from .cells import layer, squares

if TYPE_CHECKING:
    from .cells import GasFrame
    from .frames import GasBox

__all__ = ["NAMES", "Outflow", "outflow"]

NAMES = ("-x", "+x", "-y", "+y", "-z", "+z")
"""Sides of the box."""


class Outflow(NamedTuple):
    """Per quantity, tracer [kg/s] and heat [W], and of motion [W]."""

    rate: F64
    """Shape (2,)."""
    doubt: F64
    """Shape (2,)."""
    moment: F64
    """Rate times the place where it leaves [m], shape (2, 3)."""
    sides: F64
    """Rate per side, shape (6, 2)."""
    inward: float
    """Energy of motion that flows in [W]."""


def outflow(box: GasBox, frame: GasFrame) -> Outflow:
    """Flow through the open sides at a frame; sides of its active part inside the box are open ones."""
    return box.fields.of(frame, "outflow", lambda: _outflow(box, frame))


def _outflow(box: GasBox, frame: GasFrame) -> Outflow:
    at, area = frame.active, box.cell**2
    light, traced, centers, density = box.lightness(frame)[at], box.tracer(frame)[at], frame.centers[at], box.density(frame)[at]
    velocity, open_to = frame.velocity[at], frame.room[at]
    rate, doubt, moment, sides, inward = np.zeros(2), np.zeros(2), np.zeros((2, 3)), np.zeros((6, 2)), 0.0
    for side in (s for s in range(6) if box.sides[s] == "open" or s in frame.inner_sides):
        axis, sign = side // 2, 1.0 if side % 2 else -1.0
        near, far = (sign * layer(velocity[..., axis], side, d) for d in (0, 1))
        room = layer(open_to, side)
        out = np.where(layer(open_to, side, 1) > 0.0, near + 0.5 * (near - far), near)
        place = layer(centers, side)
        place[..., axis] += 0.5 * sign * box.cell
        for n, amount in enumerate((layer(traced, side), box.joule * layer(light, side))):
            through = np.maximum(out, 0.0) * amount * room * area
            sides[side, n] = through.sum()
            doubt[n] += abs(float(through.sum() - (np.maximum(near, 0.0) * amount * room * area).sum()))
            moment[n] += np.tensordot(through, place, axes=2)
        motion = 0.5 * layer(density, side) * squares(layer(velocity, side))
        inward += float((motion * np.maximum(-np.minimum(out, near), 0.0) * room * area).sum())
    rate[:] = sides.sum(axis=0)
    return Outflow(rate, doubt, moment, sides, inward)
