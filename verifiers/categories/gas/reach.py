"""Reach of gas between two frames: no farther than the fastest gas nearby, by ways through open cells (R100)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import F64
from .bounds import REACH
from .cells import most_near, neighbours

if TYPE_CHECKING:
    from .cells import GasFrame, Mask
    from .frames import GasBox

__all__ = ["reach_of", "within_reach"]


def reach_of(box: GasBox, now: GasFrame, before: GasFrame) -> tuple[F64, tuple[Mask, Mask, Mask]]:
    """Reach of every cell between two frames [cells], and the faces between neighbours, along each axis, that nothing passed.

    That of the last two frames asked for is kept with the box: several watches ask for it.
    """
    kept = box.last_reach
    if kept is not None and kept[0] is now and kept[1] is before:
        known: tuple[F64, tuple[Mask, Mask, Mask]] = kept[2]
        return known
    speed = np.maximum(now.speed, before.speed)
    far = min(int(np.ceil(float(speed.max()) * box.duration / box.cell)) + 1, max(box.shape))
    way = most_near(speed, far) * (box.duration / box.cell) + REACH
    found = np.asarray(way), _walls(now, before, box.bodies.blocked(now), box.bodies.blocked(before))
    box.last_reach = (now, before, found)
    return found


def within_reach(values: F64, way: F64, walls: tuple[Mask, Mask, Mask], beyond: tuple[float, ...]) -> F64:
    """Greatest value within the reach of every cell, by ways through open faces.

    Args:
        values: (nx, ny, nz).
        way: (nx, ny, nz) reach of each cell, in cells along each axis.
        walls: faces between neighbours that nothing passes, along each axis.
        beyond: value beyond each of the six sides.
    """
    from .reach_kernels import widened

    steps = min(int(np.ceil(float(way.max(initial=0.0)))), max(values.shape))
    whole = (np.ascontiguousarray(array) for array in (values.astype(np.float64), way, *walls))
    return np.asarray(widened(*whole, np.array(beyond, dtype=np.float64), steps))


def _walls(now: GasFrame, before: GasFrame, *blocked: tuple[Mask, Mask, Mask]) -> tuple[Mask, Mask, Mask]:
    """Faces between neighbours that nothing passed over the frame: in bodies at both ends of it, or beside a cell that stayed closed."""
    shut = ~(now.open | before.open)
    found = []
    for axis in range(3):
        low, high = neighbours(shut, axis)
        found.append(low | high | (blocked[0][axis] & blocked[1][axis]))
    return found[0], found[1], found[2]
