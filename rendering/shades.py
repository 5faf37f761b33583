"""Share of its material's colour that a surface shows at points, by its pattern, for previews."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F64

__all__ = ["pattern_shade"]

DARK = 0.25
"""Share of the colour in a checker's dark squares, as in the rendered tile."""
JOINT, GROUT = 0.03, 0.42
"""[1] Own choice: width of a joint as share of a tile, wider than the film's so that a small picture shows it, and its brightness."""
COURSES, MORTAR = 3, 1.5
"""[1] Courses of bricks in one period, and own choice: brightness of their joints."""
GRAIN = 8.0
"""Lines of wood grain across one period."""


def pattern_shade(
    pattern: Literal["plain", "wood", "checker", "concrete", "tiles", "bricks"],
    points: F64,
    normals: F64,
    *,
    scale: float,
    extent: F64,
) -> F64:
    """Share of the material's colour at points of one part, shape (n,): squares for a checker, tiles with joints, lines along the grain for wood.

    Args:
        pattern: name of the pattern; plain and concrete are even.
        points: in the part's own frame [m], shape (n, 3).
        normals: there, shape (n, 3); the pattern is seen along the axis that is nearest to them.
        scale: size of one pattern period [m].
        extent: size of the part [m], shape (3,); a period is never larger than it still reads on the part.
    """
    if pattern not in ("checker", "wood", "tiles", "bricks") or not len(points):
        return np.ones(len(points))
    if pattern == "bricks" and np.sort(extent)[1] < scale:
        return np.ones(len(points))  # a single brick
    period = min(scale, 1.2 * max(float(np.sort(extent)[1]), 1e-4))
    axis = np.abs(normals).argmax(1)
    if pattern == "checker":
        cells = np.floor(2 * points / period + 1e-6).astype(np.int64)
        cells[np.arange(len(points)), axis] = 0
        return np.where(cells.sum(1) % 2 == 0, DARK, 1.0)
    if pattern == "tiles":
        return _tiled(points / period, axis)
    if pattern == "bricks":
        return _coursed(points / scale, axis)
    grain = int(np.argmax(extent))
    across = [k for k in range(3) if k != grain]
    seen = np.where(axis == across[0], across[1], across[0])
    phase = GRAIN * points[np.arange(len(points)), seen] / period
    return np.asarray(0.86 + 0.14 * np.cos(2 * np.pi * phase))


def _coursed(places: F64, axis: NDArray[np.intp]) -> F64:
    """Courses of bricks, one period long and a third of it high, every second one shifted by half of that; lighter joints."""
    along, up = np.where(axis == 0, places[:, 1], places[:, 0]), np.where(axis == 2, places[:, 1], places[:, 2])
    course = np.floor(COURSES * up)
    along = along - 0.5 * (course % 2)
    brick = np.floor(along)
    beside, above = along - brick, (COURSES * up - course) / COURSES
    edge = np.minimum(np.minimum(beside, 1.0 - beside), np.minimum(above, 1.0 / COURSES - above))
    tone = np.abs(np.sin(np.stack([brick, course, axis], 1) @ np.array([12.9898, 78.233, 37.719])) * 43758.5453) % 1.0
    return np.where(edge < JOINT, MORTAR, 0.82 + 0.36 * tone)


def _tiled(places: F64, axis: NDArray[np.intp]) -> F64:
    """Square tiles of one period with joints, each of a tone of its own; along the axis that a surface faces nothing changes."""
    cells = np.floor(places)
    edge = np.minimum(places - cells, 1.0 - (places - cells))
    rows = np.arange(len(places))
    edge[rows, axis], cells[rows, axis] = 0.5, 0.0
    tone = np.abs(np.sin(cells @ np.array([12.9898, 78.233, 37.719])) * 43758.5453) % 1.0
    return np.where(edge.min(axis=1) < JOINT / 2, GROUT, 0.94 + 0.12 * tone)
