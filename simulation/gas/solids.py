"""Open shares of a box of cells between solids, from distances at the corners of cells."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from .engine import Solids

__all__ = ["corners_of", "cut"]


def corners_of(shape: tuple[int, int, int], cell: float, origin: F64) -> F64:
    """(nx + 1, ny + 1, nz + 1, 3) positions of the corners of cells [m]."""
    grid = np.stack(np.meshgrid(*(np.arange(n + 1) for n in shape), indexing="ij"), axis=-1)
    return np.asarray(grid * cell + origin, dtype=np.float64)


def open_share(a: F64, b: F64, c: F64, d: F64) -> F64:
    """Open area of unit squares, from signed distances at their corners in order around them (positive outside).

    The distance is taken as linear along edges, as marching squares does; a square that is cut twice counts as two corners.
    """
    values = np.stack([a, b, c, d], axis=-1)
    inside = values <= 0.0
    ahead = np.roll(values, -1, axis=-1)
    # Positions of the polygon's corners: open corners of the square, and crossings of its edges.
    corner = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    step = np.roll(corner, -1, axis=0) - corner
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(inside != (ahead <= 0.0), values / (values - ahead), 0.0)
    crossing = corner + share[..., None] * step
    total = np.zeros(values.shape[:-1])
    # Shoelace over edges of the open part: each edge of the square that is open or partly open, and the cuts from exit to entry.
    for k in range(4):
        start = np.where(inside[..., k, None], crossing[..., k, :], corner[k])
        end = np.where((ahead[..., k] <= 0.0)[..., None], crossing[..., k, :], corner[(k + 1) % 4])
        both = inside[..., k] & (ahead[..., k] <= 0.0)
        total += np.where(both, 0.0, _cross(start, end))
    out, back = ~inside & (ahead <= 0.0), inside & (ahead > 0.0)
    for k in range(4):
        # Where the open part leaves the square at edge k it comes back at the next edge on which it enters.
        pending = out[..., k].copy()
        for n in range(1, 4):
            e = (k + n) % 4
            here = pending & back[..., e]
            total += np.where(here, _cross(crossing[..., k, :], crossing[..., e, :]), 0.0)
            pending &= ~here
    return np.clip(0.5 * total, 0.0, 1.0)


def _cross(a: F64, b: F64) -> F64:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def cut(distance: F64, velocity: NDArray[np.float32] | None = None) -> Solids:
    """Open shares of a box's cells and faces.

    Args:
        distance: (nx + 1, ny + 1, nz + 1) signed distance to the solids at corners, in any unit; positive in the gas.
        velocity: (nx + 1, ny + 1, nz + 1, 3) of the solids at lower faces [m/s]; at rest when left out.
    """
    shape = distance.shape
    opening = np.zeros((*shape, 3), np.float32)
    for axis in range(3):
        u, v = ((axis + 1) % 3, (axis + 2) % 3)
        low: list[slice] = [slice(None)] * 3
        low[u] = low[v] = slice(0, -1)
        corners = []
        for du, dv in ((0, 0), (1, 0), (1, 1), (0, 1)):
            part = list(low)
            part[u] = slice(du, shape[u] - 1 + du)
            part[v] = slice(dv, shape[v] - 1 + dv)
            corners.append(distance[tuple(part)])
        opening[..., axis][tuple(low)] = open_share(*corners)
    inner = tuple(slice(0, n - 1) for n in shape)
    room = np.zeros(shape, np.float32)
    # Mean of the open shares of a cell's six faces: exact for planes along the axes, within a hundredth for other planes that cut it.
    sides = [opening[..., a][inner] for a in range(3)]
    for a in range(3):
        ahead = tuple(slice(1, n) if k == a else slice(0, n - 1) for k, n in enumerate(shape))
        sides.append(opening[..., a][ahead])
    room[inner] = np.mean(sides, axis=0)
    return Solids(room, opening, np.zeros((*shape, 3), np.float32) if velocity is None else velocity)
