"""Reach of gas between two frames: no farther than the fastest gas nearby, by ways through open cells (R100)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import F64
from .bounds import REACH

if TYPE_CHECKING:
    from .cells import GasFrame, Mask
    from .frames import GasBox

__all__ = ["reach_of", "within_reach"]


def reach_of(box: GasBox, now: GasFrame, before: GasFrame) -> tuple[F64, tuple[Mask, Mask, Mask]]:
    """Reach of every cell between two frames [cells], and the faces between neighbours, along each axis, that nothing passed."""
    from scipy.ndimage import maximum_filter

    speed = np.maximum(now.speed, before.speed)
    far = min(int(np.ceil(float(speed.max()) * box.duration / box.cell)) + 1, max(box.shape))
    way = maximum_filter(speed, size=2 * far + 1, mode="nearest") * (box.duration / box.cell) + REACH
    return np.asarray(way), _walls(now, before, box.bodies.blocked(now), box.bodies.blocked(before))


def within_reach(values: F64, way: F64, walls: tuple[Mask, Mask, Mask], beyond: tuple[float, ...]) -> F64:
    """Greatest value within the reach of every cell, by ways through open faces.

    Args:
        values: (nx, ny, nz).
        way: (nx, ny, nz) reach of each cell, in cells along each axis.
        walls: faces between neighbours that nothing passes, along each axis.
        beyond: value beyond each of the six sides.
    """
    grown = values.copy()
    for step in range(1, min(int(np.ceil(float(way.max(initial=0.0)))), max(values.shape)) + 1):
        wider = grown.copy()
        for axis in range(3):
            wider = _wider(wider, axis, walls[axis], beyond[2 * axis : 2 * axis + 2])
        grown = np.where(way >= step, wider, grown)
    return grown


def _wider(values: F64, axis: int, walls: Mask, beyond: tuple[float, ...]) -> F64:
    """Greatest value of every cell and its two neighbours along an axis."""
    count = values.shape[axis]
    low, high = (np.take(values, range(k, k + count - 1), axis=axis) for k in (0, 1))
    ends = [np.full_like(np.take(values, [0], axis=axis), b) for b in beyond]
    from_low = np.concatenate([ends[0], np.where(walls, -np.inf, low)], axis=axis)
    from_high = np.concatenate([np.where(walls, -np.inf, high), ends[1]], axis=axis)
    return np.asarray(np.maximum(values, np.maximum(from_low, from_high)))


def _walls(now: GasFrame, before: GasFrame, *blocked: tuple[Mask, Mask, Mask]) -> tuple[Mask, Mask, Mask]:
    """Faces between neighbours that nothing passed over the frame: in bodies at both ends of it, or beside a cell that stayed closed."""
    shut = ~(now.open | before.open)
    found = []
    for axis in range(3):
        count = shut.shape[axis] - 1
        low, high = (np.take(shut, range(k, k + count), axis=axis) for k in (0, 1))
        found.append(low | high | (blocked[0][axis] & blocked[1][axis]))
    return found[0], found[1], found[2]
