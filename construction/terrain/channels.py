"""Beds of rivers and streams: cut into the land where the grid can carry them, and the level of the water in them.

Filling and routing never touch the land; a bed is a declared change of it, kept as a field of its own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...geometry.watercourses import centre_line
from ...worlds.arrays import F64
from .flood import Drainage
from .water import River, WaterBodies

__all__ = ["Channels", "carve"]

BANK_SLOPE = 1.5
"""Run of a bank per metre of rise."""
FREEBOARD = 0.3
"""Part of the depth of a bed that stands above its water."""


@dataclass(frozen=True)
class Channels:
    """Beds and water of all reaches. Fields of shape (rows, cols)."""

    cut: F64
    """Depth of the bed below the land that was there [m], >= 0."""
    level: F64
    """Surface of flowing water [m], NaN where there is none."""
    bed: np.ndarray
    """Cells of beds, banks included: nothing is placed there (R45)."""
    wet: np.ndarray
    """Cells under flowing water."""


def carve(drainage: Drainage, water: WaterBodies) -> Channels:
    """Cut a bed along every reach: trapezoidal, of its hydraulic width and depth, falling all the way downstream.

    A channel narrower than a cell is cut one cell wide, as deep as its cross section allows at that width.
    """
    grid = drainage.grid
    ground = np.where(drainage.valid, drainage.height, np.nan)
    target = np.full(grid.shape, np.inf)
    level = np.full(grid.shape, np.nan)
    bed = np.zeros(grid.shape, dtype=bool)
    wet = np.zeros(grid.shape, dtype=bool)
    for river in sorted(water.rivers, key=lambda r: float(r.discharge[-1])):
        _cut(river, drainage, water, target, level, bed, wet)
    standing = water.standing
    cut = np.where(np.isfinite(target) & ~standing & drainage.valid, np.maximum(ground - target, 0.0), 0.0)
    return Channels(
        cut=np.nan_to_num(cut),
        level=np.where(wet & ~standing, level, np.nan),
        bed=bed & ~standing,
        wet=wet & ~standing,
    )


def _cut(
    river: River,
    drainage: Drainage,
    water: WaterBodies,
    target: F64,
    level: F64,
    bed: np.ndarray,
    wet: np.ndarray,
) -> None:
    grid = drainage.grid
    line = centre_line(river.cells, float(river.width.mean()), grid.shape, grid.cell)
    surface = np.minimum.accumulate(drainage.filled.ravel()[river.cells])
    width, depth = river.width, river.depth
    narrow = np.minimum(width / grid.cell, 1.0)
    depth = np.maximum(depth * narrow, 0.02)
    water_level = surface - FREEBOARD * depth
    bottom = surface - (1.0 + FREEBOARD) * depth
    reach = int(np.ceil((width.max() / 2 + BANK_SLOPE * 2 * depth.max()) / grid.cell)) + 1
    stations = _dense(line, grid.cell / 2)
    at = np.interp(stations[:, 2], np.arange(len(line)), width)
    low = np.interp(stations[:, 2], np.arange(len(line)), bottom)
    high = np.interp(stations[:, 2], np.arange(len(line)), water_level)
    row, col = grid.indices(stations[:, 0], stations[:, 1])
    for dr in range(-reach, reach + 1):
        for dc in range(-reach, reach + 1):
            r, c = row + dr, col + dc
            inside = (r >= 0) & (c >= 0) & (r < grid.rows) & (c < grid.cols)
            cx, cy = (c - 0.5 * (grid.cols - 1)) * grid.cell, (r - 0.5 * (grid.rows - 1)) * grid.cell
            away = np.hypot(cx - stations[:, 0], cy - stations[:, 1])
            flat = np.maximum(at / 2, 0.5 * grid.cell)
            bank = np.maximum(away - flat, 0.0) / BANK_SLOPE
            within = inside & (away <= flat + BANK_SLOPE * 2 * (high - low + 0.05))
            if not within.any():
                continue
            where = r[within], c[within]
            np.minimum.at(target, where, (low + bank)[within])
            bed[where] = True
            soaked = within & (low + bank < high)
            if soaked.any():
                spot = r[soaked], c[soaked]
                wet[spot] = True
                level[spot] = high[soaked]


def _dense(line: F64, step: float) -> F64:
    """Points along a line at least every `step` [m]: x, y and the index along the line, shape (n, 3)."""
    lengths = np.hypot(*np.diff(line, axis=0).T) if len(line) > 1 else np.zeros(0)
    parts = [np.array([[line[0, 0], line[0, 1], 0.0]])]
    for k, length in enumerate(lengths):
        count = max(1, int(np.ceil(length / step)))
        share = np.arange(1, count + 1)[:, None] / count
        parts.append(np.hstack([line[k] + share * (line[k + 1] - line[k]), k + share]))
    return np.vstack(parts)
