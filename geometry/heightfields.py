"""Height fields as closed solids, and the proof that a surface is one."""

from __future__ import annotations

import numpy as np

from ..worlds.arrays import F64
from ..worlds.built import TriangleMesh
from ..worlds.errors import InputError
from .solids import Solid

__all__ = ["ground_solid", "is_height_field"]

AREA = 1e-9
"""Relative to the area: rounding of a sum of half a million triangles."""


def ground_solid(heights: F64, size: tuple[float, float], base: float) -> TriangleMesh:
    """The ground under a grid of heights as one watertight surface: top, walls down to a level base, and the base.

    Each cell is cut along its diagonal from south-west to north-east. The volume is the integral of the top over the
    rectangle, less that of the base.

    Args:
        heights: [m], shape (rows, cols), row 0 south, column 0 west.
        size: extent x, y [m], centred at the origin.
        base: thickness below the lowest height [m].

    Returns:
        The mesh; its first rows * cols vertices are the top in the order of `heights`.

    Raises:
        InputError: fewer than 2 x 2 heights, a height that is not finite, an extent or base that is not positive.
    """
    heights = np.asarray(heights, dtype=np.float64)
    if heights.ndim != 2 or min(heights.shape) < 2:
        raise InputError(f"heights have shape {heights.shape}; a ground needs at least 2 x 2")
    if not (min(size) > 0 and base > 0):
        raise InputError(f"ground of {size[0]:g} x {size[1]:g} m with a base of {base:g} m; all three must be > 0")
    if not np.isfinite(heights).all():
        row, col = (int(k) for k in np.argwhere(~np.isfinite(heights))[0])
        raise InputError(
            f"{int((~np.isfinite(heights)).sum())} heights are not finite, the first at row {row}, column {col}; fill the holes first"
        )
    rows, cols = heights.shape
    count = rows * cols
    x, y = np.meshgrid(np.linspace(-size[0] / 2, size[0] / 2, cols), np.linspace(-size[1] / 2, size[1] / 2, rows))
    floor = float(heights.min()) - base
    index = np.arange(count).reshape(rows, cols)
    a, b, d, e = (index[r, c].ravel() for r in (np.s_[:-1], np.s_[1:]) for c in (np.s_[:-1], np.s_[1:]))
    top = np.stack([a, b, e, a, e, d], axis=1).reshape(-1, 3)
    rim = np.concatenate([index[0, :-1], index[:-1, -1], index[-1, :0:-1], index[:0:-1, 0]])
    below, after = count + np.arange(len(rim)), np.roll(rim, -1)
    beyond = np.roll(below, -1)
    walls = np.stack([below, beyond, after, below, after, rim], axis=1).reshape(-1, 3)
    number = np.zeros(count, dtype=np.int64)
    number[rim] = below
    bottom = _bottom(number.reshape(rows, cols))
    upper = np.stack([x, y, heights], axis=-1).reshape(-1, 3)
    lower = upper[rim] * [1.0, 1.0, 0.0] + [0.0, 0.0, floor]
    vertices = np.concatenate([upper, lower])
    return TriangleMesh(vertices, np.concatenate([top, walls, bottom]).astype(np.int32))


def _bottom(number: np.ndarray) -> np.ndarray:
    """Faces of the base from the numbers of its rim's vertices, seen from below: strips, narrow as a cell, from side to side."""
    if number.shape[1] == 2:
        west, east = number[:, 0], number[:, 1]
        strips = [(west[:-1], east[1:], east[:-1]), (west[:-1], west[1:], east[1:])]
        return np.concatenate([np.stack(s, axis=1) for s in strips])
    south, north, west, east = number[0, 1:-1], number[-1, 1:-1], number[:, 0], number[:, -1]
    first, last = np.full(len(west) - 1, south[0]), np.full(len(east) - 1, south[-1])
    strips = [
        (south[:-1], north[1:], south[1:]),
        (south[:-1], north[:-1], north[1:]),
        (first, west[:-1], west[1:]),
        (first[:1], west[-1:], north[:1]),
        (last, east[1:], east[:-1]),
        (last[:1], north[-1:], east[-1:]),
    ]
    return np.concatenate([np.stack(s, axis=1) for s in strips])


def is_height_field(solid: Solid) -> bool:
    """True if a closed surface is provably the ground under a function over a rectangle, so that it cannot cross itself.

    It is watertight; what faces up, projected along z, has its rim on the rim of its bounding rectangle and exactly that
    area, so it covers each place once; what faces down lies at one level below all of it with the same area; the rest
    stands upright on the four sides, with just the area between.
    """
    if not (solid.closed and solid.is_watertight):
        return False
    t = solid.triangles
    one, two = t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]
    flat = 0.5 * (one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])
    up, down = flat > 0.0, flat < 0.0
    if not (up.any() and down.any()):
        return False
    low, high = solid.lower, solid.upper
    area = float((high[0] - low[0]) * (high[1] - low[1]))
    level = t[down][:, :, 2]
    if (level != low[2]).any() or t[up][:, :, 2].min() <= low[2]:
        return False
    if max(abs(float(flat[up].sum()) - area), abs(float(flat[down].sum()) + area)) > AREA * area:
        return False
    rim = _rim(solid.faces[up], len(solid.vertices))
    ends = solid.vertices[rim]
    if not _on_one_side(ends, low, high).all():
        return False
    wall = t[~up & ~down]
    if not _on_one_side(wall, low, high).all():
        return False
    upright = 0.5 * np.linalg.norm(np.cross(wall[:, 1] - wall[:, 0], wall[:, 2] - wall[:, 0]), axis=1)
    run = np.linalg.norm(ends[:, 1, :2] - ends[:, 0, :2], axis=1)
    between = float((run * (0.5 * ends[:, :, 2].sum(axis=1) - low[2])).sum())
    return abs(float(upright.sum()) - between) <= AREA * max(between, area)


def _rim(faces: np.ndarray, count: int) -> np.ndarray:
    """Directed edges that no face meets from the other side, shape (k, 2)."""
    edges = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64)
    forth, back = edges[:, 0] * count + edges[:, 1], edges[:, 1] * count + edges[:, 0]
    back.sort()
    place = np.minimum(np.searchsorted(back, forth), len(back) - 1)
    return np.asarray(edges[back[place] != forth])


def _on_one_side(corners: F64, low: F64, high: F64) -> np.ndarray:
    """True where all corners of each, shape (n, k, 3), lie on one same side of a rectangle."""
    sides = [(corners[:, :, axis] == bound[axis]).all(axis=1) for axis in (0, 1) for bound in (low, high)]
    return np.asarray(np.any(sides, axis=0))
