"""Narrow ways through the space between fixed solids that liquid gets to.

Space is cut into cubes; those that a surface passes through are closed. A cube is wide where a ball of the least width fits about
it. Two neighbouring open cubes that are not wide, whose nearest wide cubes are not joined by wide ones in the surroundings, lie in
a throat: whatever passes there passes a narrow way. How narrow it is, is measured against the surfaces themselves.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64
from .barriers import liquid_space, still_barrier
from .solids import Piece, deepest

if TYPE_CHECKING:
    from .frames import Liquid

__all__ = ["Visited", "Way", "narrow_ways"]

MOST_CUBES = 12_000_000
"""Own choice: larger spaces get larger cubes."""
LARGEST = 1.01
"""[spacings] No passage is looked for with cubes larger than this."""
ROUNDING = 0.2
"""[cubes] by which half a way may seem wider than it is, as its walls lie anywhere in closed cubes."""
BLOCK, DETOUR = 8, 8
"""[cubes] Throats are looked at by blocks of this size, with this much of space around in which another way may lead."""
MOST_THROATS = 200
"""Own choice: so many are measured, the narrowest ones first."""

Grid = NDArray[np.bool_]
Cells = NDArray[np.intp]


@dataclass(eq=False)
class Visited:
    """Cubes of space, and in which of them particles have been."""

    low: F64
    cube: float
    """[m]"""
    grid: Grid
    closed: Grid | None
    """Cubes that a surface passes through; None where no solid stands still or cubes are too large to tell ways."""

    @classmethod
    def of(cls, liquid: Liquid) -> Visited | None:
        """The space that a liquid gets to; None where it never has a particle."""
        space, barrier = liquid_space(liquid), still_barrier(liquid)
        if space is None:
            return None
        low, high, cube = space
        if barrier is not None:
            low = barrier.low
        shape = np.maximum(np.ceil((high - low) / cube), 1).astype(int) if barrier is None else np.array(barrier.shape)
        times = 1
        while np.ceil(shape / times).prod() > MOST_CUBES:
            times += 1
        closed = None
        if barrier is not None and times * cube <= LARGEST * liquid.spacing:
            closed = _pooled(barrier.closed, times)
        return cls(low, times * cube, np.zeros(tuple(-(-shape // times)), dtype=bool), closed)

    @property
    def high(self) -> F64:
        """Greatest corner [m]."""
        return np.asarray(self.low + self.cube * np.array(self.grid.shape))

    def cells(self, points: F64) -> Cells:
        """Cubes of points within the space, shape (n, 3)."""
        cell = np.floor((points - self.low) / self.cube).astype(np.intp)
        return cell[((cell >= 0) & (cell < np.array(self.grid.shape))).all(axis=1)]

    def add(self, points: F64) -> None:
        """Particles were here."""
        self.grid[tuple(self.cells(points).T)] = True

    @cached_property
    def near(self) -> Grid:
        """Cubes that are or touch one in which particles have been; ask only after the last frame."""
        from scipy.ndimage import maximum_filter

        return np.asarray(maximum_filter(self.grid, size=3, mode="constant"))

    def at(self, points: F64) -> Grid:
        """True where particles were within a cube of points, shape (n,)."""
        cell = np.floor((points - self.low) / self.cube).astype(np.intp)
        found = np.zeros(len(points), dtype=bool)
        inside = ((cell >= 0) & (cell < np.array(self.grid.shape))).all(axis=1)
        found[inside] = self.near[tuple(cell[inside].T)]
        return found


@dataclass(frozen=True, eq=False)
class Way:
    """A narrow way."""

    middle: F64
    """World [m], shape (3,)."""
    width: float
    """[m]"""
    between: tuple[Piece, ...]
    """Pieces that it lies between, the nearest first."""


def narrow_ways(visited: Visited, still: tuple[Piece, ...], least: float) -> list[Way] | None:
    """Ways narrower than `least` [m] that particles came to; None where the space is too large to look for them."""
    from scipy.ndimage import binary_dilation, distance_transform_edt, label

    if visited.closed is None:
        return None
    open_ = ~visited.closed
    marks, _ = label(open_)
    room = distance_transform_edt(open_)
    open_ &= np.isin(marks, _outside(visited, still, marks, room))
    room[~open_] = 0.0
    wide = room > 0.5 * least / visited.cube + ROUNDING
    tight = open_ & ~wide
    touched = tight & binary_dilation(visited.grid, iterations=max(1, round(1.0 / (visited.cube / (least / 3.0)))))
    if not touched.any():
        return []
    if not wide.any():
        cell = np.array(np.unravel_index(int(np.argmax(room)), room.shape))
        return _measured(visited, still, least, cell, np.array([1.0, 0.0, 0.0]))
    home = _homes(tight, wide)
    ways = []
    for cells, direction in _throats(tight, touched, wide, home, room):
        ways += _measured(visited, still, least, cells, direction)
    return ways


def _outside(visited: Visited, still: tuple[Piece, ...], marks: Cells, room: F64) -> Cells:
    """Numbers of the open spaces that particles have been in and that are not the inside of a solid."""
    from scipy.ndimage import maximum_position

    reached = np.unique(marks[visited.grid])
    reached = reached[reached > 0]
    if not len(reached):
        return reached
    middle = visited.low + (np.array(maximum_position(room, marks, reached)) + 0.5) * visited.cube
    within = np.zeros(len(reached), dtype=bool)
    for found in deepest(still, middle, 0, 0.0):
        within[found.rows] = True
    return np.asarray(reached[~within])


def _pooled(grid: Grid, times: int) -> Grid:
    """Blocks of so many cubes each way that hold a closed one."""
    if times == 1:
        return grid
    padded = np.pad(grid, [(0, -n % times) for n in grid.shape])
    nx, ny, nz = (n // times for n in padded.shape)
    return np.asarray(padded.reshape(nx, times, ny, times, nz, times).any(axis=(1, 3, 5)))


def _homes(tight: Grid, wide: Grid) -> Cells:
    """Nearest wide cube of every one that is not, by ways through open cubes, shape (*grid, 3); -1 where none leads there."""
    from scipy.ndimage import maximum_filter

    shape = np.array(tight.shape) + 2
    left, home = np.pad(tight, 1).ravel(), np.full(int(shape.prod()), -1, dtype=np.int64)
    front = np.flatnonzero(np.pad(wide & maximum_filter(tight, size=3, mode="constant"), 1).ravel())
    home[front] = front
    around = [np.array(w) - 1 for w in np.ndindex(3, 3, 3) if w != (1, 1, 1)]
    # Faces first, then edges, then corners: ties go to the nearer one.
    around.sort(key=lambda w: int(np.abs(w).sum()))
    steps = [int(w[0] * shape[1] * shape[2] + w[1] * shape[2] + w[2]) for w in around]
    while len(front):
        found = []
        for step in steps:
            rows = front[left[front + step]]
            left[rows + step] = False
            home[rows + step] = home[rows]
            found.append(rows + step)
        front = np.concatenate(found)
    core = home.reshape(tuple(shape))[1:-1, 1:-1, 1:-1]
    cells = np.stack(np.unravel_index(np.maximum(core, 0), tuple(shape)), axis=-1) - 1
    cells[core < 0] = -1
    return np.asarray(cells, dtype=np.intp)


def _throats(tight: Grid, touched: Grid, wide: Grid, home: Cells, room: F64) -> list[tuple[Cells, F64]]:
    """Middle cube of every throat and the direction through it, the narrowest first."""
    from scipy.ndimage import label

    pairs = []
    for axis in range(3):
        ahead = tuple(slice(1, None) if a == axis else slice(None) for a in range(3))
        back = tuple(slice(None, -1) if a == axis else slice(None) for a in range(3))
        apart = tight[back] & tight[ahead] & (touched[back] | touched[ahead])
        cell = np.argwhere(apart)
        other = cell + np.eye(3, dtype=np.intp)[axis]
        a, b = home[tuple(cell.T)], home[tuple(other.T)]
        jump = (np.abs(a - b).max(axis=1) > 2) & (a[:, 0] >= 0) & (b[:, 0] >= 0)
        pairs.append(np.stack([cell[jump], other[jump]], axis=1))
    both = np.concatenate(pairs)
    both = both[_parted(both, wide, home)] if len(both) else both
    if not len(both):
        return []
    marked = np.zeros(tight.shape, dtype=bool)
    marked[tuple(both.reshape(-1, 3).T)] = True
    marks, _ = label(marked, structure=np.ones((3, 3, 3)))
    group = marks[tuple(both[:, 0].T)]
    found = []
    for number in np.unique(group):
        mine = both[group == number]
        size = room[tuple(mine[:, 0].T)] + room[tuple(mine[:, 1].T)]
        best = mine[int(np.argmax(size))]
        way = (home[tuple(best[1])] - home[tuple(best[0])]).astype(np.float64)
        found.append((float(size.max()), best[0], way / max(float(np.linalg.norm(way)), 1e-9)))
    found.sort(key=lambda f: f[0])
    return [(cell, way) for _, cell, way in found[:MOST_THROATS]]


def _parted(pairs: Cells, wide: Grid, home: Cells) -> Grid:
    """Which pairs have nearest wide cubes that no wide cubes join in their surroundings."""
    from scipy.ndimage import label

    block = pairs[:, 0] // BLOCK
    _, which = np.unique(block, axis=0, return_inverse=True)
    which = which.reshape(-1)
    order = np.argsort(which, kind="stable")
    result = np.zeros(len(pairs), dtype=bool)
    for rows in np.split(order, np.flatnonzero(np.diff(which[order])) + 1):
        low = np.maximum(block[rows[0]] * BLOCK - DETOUR, 0)
        high = np.minimum((block[rows[0]] + 1) * BLOCK + DETOUR, wide.shape)
        marks, _ = label(wide[tuple(slice(a, b) for a, b in zip(low, high, strict=True))])
        ends = home[tuple(pairs[rows].reshape(-1, 3).T)].reshape(-1, 2, 3)
        inside = ((ends >= low) & (ends < high)).all(axis=2)
        local = np.clip(ends, low, high - 1) - low
        number = np.where(inside, marks[tuple(local.reshape(-1, 3).T)].reshape(-1, 2), -1)
        far = np.abs(ends[:, 0] - ends[:, 1]).max(axis=1) > BLOCK + DETOUR
        result[rows] = np.where(inside.all(axis=1), number[:, 0] != number[:, 1], far)
    return result


def _measured(visited: Visited, still: tuple[Piece, ...], least: float, cell: Cells, direction: F64) -> list[Way]:
    """The way through a cube along a direction, if it is narrower than `least`: twice the largest ball about its narrowest place."""
    middle = visited.low + (cell + 0.5) * visited.cube
    side = np.cross(direction, np.eye(3)[int(np.argmin(np.abs(direction)))])
    side /= np.linalg.norm(side)
    across = np.stack([side, np.cross(direction, side)])
    steps = np.stack(np.meshgrid(*[np.linspace(-1.0, 1.0, 9)] * 2, indexing="ij"), axis=-1).reshape(-1, 2)
    narrowest, where = np.inf, middle
    for along in np.linspace(-1.5, 1.5, 13):
        center, radius = middle + along * visited.cube * direction, 0.0
        for reach in (1.5, 0.25, 0.05):
            points = center + reach * visited.cube * steps @ across
            gaps = _gaps(still, points, least).min(axis=0)
            center, radius = points[int(np.argmax(gaps))], float(gaps.max())
        if radius < narrowest:
            narrowest, where = radius, center
    if 2.0 * narrowest >= least * (1.0 - 1e-3):
        return []
    gaps = _gaps(still, where[None], least)[:, 0]
    order = np.argsort(gaps)
    named = [still[k] for k in order[:2] if gaps[k] < 1.5 * least]
    return [Way(where, 2.0 * narrowest, tuple(named or [still[int(order[0])]]))]


def _gaps(still: tuple[Piece, ...], points: F64, reach: float) -> F64:
    """Distance of points to the surface of every piece [m], shape (pieces, n); `reach` times two where it is farther than that; 0 within."""
    from ....geometry import distance_to_surface

    found = np.full((len(still), len(points)), 2.0 * reach)
    low, high = points.min(axis=0) - 2.0 * reach, points.max(axis=0) + 2.0 * reach
    for k, piece in enumerate(still):
        least, most = piece.box(0)
        if (least > high).any() or (most < low).any():
            continue
        local = piece.local(points, 0)
        found[k] = np.where(
            piece.depth(local) > 0.0, 0.0, np.minimum(distance_to_surface(piece.solid, local).distance, 2.0 * reach)
        )
    return found
