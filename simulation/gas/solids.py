"""Open shares of a box of cells between solids, from distances at the corners of cells."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .settings import Side

__all__ = ["Solids", "corners_of", "cut", "enclosed", "passable"]

LEAST_OPEN = 0.05
"""Faces open by less are closed."""
SQUEEZED = 0.25
"""Own choice: open share of faces from which on what moving solids drive through them is carried as it is."""
ALONG = 1e-5
"""[1] Share of the largest distance within which a corner lies on a surface, whatever rounding says."""


@dataclass(frozen=True)
class Solids:
    """Open shares of a box between solids that stand or move; fields have one element more than cells along each axis.

    Attributes:
        room: (nx + 1, ny + 1, nz + 1) open share of each cell.
        opening: (nx + 1, ny + 1, nz + 1, 3) open share of the lower faces.
        velocity: as `opening`: speed of what closes them [m/s]; gas at closed faces has it. What solids displace follows from the rooms.
    """

    room: NDArray[np.float32]
    opening: NDArray[np.float32]
    velocity: NDArray[np.float32]


def enclosed(shape: tuple[int, int, int], sides: Sequence[Side], solids: Solids | None, *, widen: bool) -> Solids:
    """Open shares between solids and the closed sides of a box.

    Args:
        shape: cells along x, y, z.
        sides: x-, x+, y-, y+, z-, z+.
        solids: what is not open; the whole box when left out.
        widen: a cell cut smaller than its faces counts as large as the widest of them, so that what flows through it within a step fits in it.
    """
    padded = tuple(n + 1 for n in shape)
    room = np.zeros(padded, np.float32)
    opening = np.zeros((*padded, 3), np.float32)
    inner = tuple(slice(0, n) for n in shape)
    room[inner] = 1.0 if solids is None else solids.room[inner]
    opening[...] = 1.0 if solids is None else solids.opening
    for axis in range(3):
        opening[..., axis] *= np.all(
            [_within(padded, a, shape[a] + int(a == axis and sides[2 * a] != "periodic")) for a in range(3)], axis=0
        )
        for upper, place in ((0, 0), (1, shape[axis])):
            if sides[2 * axis + upper] == "closed":
                opening[(slice(None),) * axis + (place,)][..., axis] = 0.0
    opening[opening < LEAST_OPEN] = 0.0
    widest = np.zeros(padded, np.float32)
    for axis in range(3):
        ahead = np.roll(opening[..., axis], -1, axis=axis)
        if sides[2 * axis] == "periodic":
            ahead[(slice(None),) * axis + (shape[axis] - 1,)] = opening[(slice(None),) * axis + (0,)][..., axis]
        widest = np.maximum(widest, np.maximum(opening[..., axis], ahead))
    least = widest[inner] if widen else np.float32(0.0)
    room[inner] = np.where(widest[inner] > 0.0, np.maximum(room[inner], least), 0.0)
    return Solids(room, opening, np.zeros_like(opening) if solids is None else solids.velocity.astype(np.float32))


def passable(before: Solids, after: Solids) -> NDArray[np.float32]:
    """Open shares of faces in the mean over a step of solids that move, (nx + 1, ny + 1, nz + 1, 3).

    Faces beside a cell that loses or gains room are open by `SQUEEZED` at least, unless closed: under a body that lands or rolls, gaps
    finer than that would shoot out air by what a cell cannot tell of their shape.
    """
    opening = 0.5 * (before.opening + after.opening)
    changes = before.room != after.room
    for axis in range(3):
        own = opening[..., axis]
        beside = (changes | np.roll(changes, 1, axis=axis)) & (own > 0.0)
        own[beside] = np.maximum(own[beside], SQUEEZED)
    return opening


def _within(padded: tuple[int, ...], axis: int, count: int) -> NDArray[np.bool_]:
    """True for elements whose index along an axis is below a count."""
    shape = [1, 1, 1]
    shape[axis] = padded[axis]
    return np.broadcast_to((np.arange(padded[axis]) < count).reshape(shape), padded)


def corners_of(shape: tuple[int, int, int], cell: float, origin: F64) -> F64:
    """(nx + 1, ny + 1, nz + 1, 3) positions of the corners of cells [m]."""
    grid = np.stack(np.meshgrid(*(np.arange(n + 1) for n in shape), indexing="ij"), axis=-1)
    return np.asarray(grid * cell + origin, dtype=np.float64)


def open_share(a: F64, b: F64, c: F64, d: F64) -> F64:
    """Open area of unit squares, from signed distances at their corners in order around them (positive outside).

    The distance is taken as linear along edges, as marching squares does; a square that is cut twice counts as two corners.
    """
    values = np.stack([a, b, c, d], axis=-1)
    whole = _whole(values, -1)
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
    return np.where(whole, 1.0, np.clip(0.5 * total, 0.0, 1.0))


def _whole(values: F64, axis: int) -> NDArray[np.bool_]:
    """True where corners lie in the gas, or on surfaces beside it: as between a floor and a wall whose surfaces are those of cells."""
    return np.asarray((values.min(axis=axis) >= 0.0) & (values.max(axis=axis) > 0.0))


def _cross(a: F64, b: F64) -> F64:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def cut(distance: F64, velocity: NDArray[np.float32] | None = None) -> Solids:
    """Open shares of a box's cells and faces.

    Args:
        distance: (nx + 1, ny + 1, nz + 1) signed distance to the solids at corners, in any unit; positive in the gas.
        velocity: (nx + 1, ny + 1, nz + 1, 3) of the solids at lower faces [m/s]; at rest when left out.
    """
    shape = distance.shape
    distance = np.where(np.abs(distance) <= ALONG * np.abs(distance).max(), 0.0, distance)
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
    room[inner] = open_volume(distance)
    return Solids(room, opening, np.zeros((*shape, 3), np.float32) if velocity is None else velocity)


def open_volume(distance: F64) -> F64:
    """Open volumes of cells: six tetrahedra around a diagonal, in each of which the distance is linear; exact for planes.

    Args:
        distance: (nx + 1, ny + 1, nz + 1) signed distance at corners, positive in the gas.
    """
    shape = tuple(n - 1 for n in distance.shape)
    corners = {
        (i, j, k): distance[i : i + shape[0], j : j + shape[1], k : k + shape[2]].ravel()
        for i in (0, 1) for j in (0, 1) for k in (0, 1)
    }  # fmt: skip
    every = np.stack(list(corners.values()))
    whole = _whole(every, 0)
    share = np.where(whole, 1.0, 0.0)
    crossed = np.flatnonzero(~whole & (every.min(axis=0) <= 0.0) & (every.max(axis=0) > 0.0))
    total = np.zeros(len(crossed))
    for order in permutations(range(3)):
        at, way = [0, 0, 0], [corners[0, 0, 0][crossed]]
        for axis in order:
            at[axis] = 1
            way.append(corners[at[0], at[1], at[2]][crossed])
        total += _positive_share(np.stack(way))
    share[crossed] = total / 6.0
    return share.reshape(shape)


def _positive_share(values: F64) -> F64:
    """Share of tetrahedra in which a linear function is positive, from its values at the corners (4, n)."""
    a, b, c, d = -np.sort(-values, axis=0)
    found = np.where(d > 0.0, 1.0, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        one = a**3 / ((a - b) * (a - c) * (a - d))
        three = 1.0 + d**3 / ((a - d) * (b - d) * (c - d))
        ac, ad, bc, bd = a / (a - c), a / (a - d), b / (b - c), b / (b - d)
        two = ac * ad + ac * bd * (1.0 - ad) + bc * bd * (1.0 - ac)
    found = np.where((a > 0.0) & (b <= 0.0), one, found)
    found = np.where((b > 0.0) & (c <= 0.0), two, found)
    return np.where((c > 0.0) & (d <= 0.0), three, found)
