"""Neighbourhoods of particles as drawing needs them: counts, outward direction, foam potentials, connected clumps."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.launch import cores
from ...worlds.arrays import F64

__all__ = ["Surroundings", "carried", "clumps", "crowding", "surroundings"]

SUPPORT = 2.0
"""Reach of a neighbourhood in spacings; 32 neighbours inside a lattice, about 20 on its face."""
INSIDE = 1.5
"""Length of `side` below which a particle lies inside the liquid; on the face of a lattice it is 4.4."""
REACH = 1.4
"""Side of the cells in spacings: particles in neighbouring cells belong to one clump."""
SLICE = 4096


@dataclass(frozen=True)
class Surroundings:
    """One entry per particle, in the order given."""

    count: NDArray[np.int32]
    """Neighbours within two spacings."""
    normal: F64
    """Unit vector out of the liquid (n, 3); 0 inside it."""
    trapped: F64
    """Potential of trapped air [m/s]."""
    crest: F64
    """Potential of wave crests: convexity where a particle moves outwards, else 0."""


@dataclass(frozen=True)
class _Cells:
    """Particles sorted into cubic cells."""

    order: NDArray[np.int64]
    """Index of each in the order given (n,)."""
    position: F64
    """Sorted (n, 3)."""
    grid: tuple[F64, float, NDArray[np.int64], NDArray[np.int64]]
    """Lower corner, side of a cell, cells along each axis, key of each particle's cell (n,)."""

    @classmethod
    def of(cls, position: F64, size: float) -> _Cells:
        """Sort particles (n, 3), n > 0, into cells of a side."""
        lower = position.min(0) - 0.5 * size
        cell = np.floor((position - lower) / size).astype(np.int64)
        dims = cell.max(0) + 2
        key = (cell[:, 0] * dims[1] + cell[:, 1]) * dims[2] + cell[:, 2]
        order = np.argsort(key, kind="stable")
        return cls(order, np.ascontiguousarray(position[order]), (lower, size, dims, key[order]))

    def in_given_order(self, *values: NDArray[Any]) -> list[NDArray[Any]]:
        """Sorted values, as the particles were given."""
        back = np.empty(len(self.order), np.int64)
        back[self.order] = np.arange(len(self.order))
        return [v[back] for v in values]


def _sliced(kernel: object, count: int, *inputs: object) -> None:
    starts = range(0, count, SLICE)
    with ThreadPoolExecutor(max(1, min(cores(), len(starts)))) as pool:
        list(pool.map(lambda k: kernel(k, min(k + SLICE, count), *inputs), starts))  # type: ignore[operator]


def surroundings(position: F64, velocity: F64, spacing: float) -> Surroundings:
    """Look around every particle.

    Args:
        position: (n, 3) [m].
        velocity: (n, 3) [m/s].
        spacing: distance of particles at rest [m].
    """
    n = len(position)
    if n == 0:
        return Surroundings(np.empty(0, np.int32), np.empty((0, 3)), np.empty(0), np.empty(0))
    from .surround_kernels import crests, surroundings

    support = SUPPORT * spacing
    cells = _Cells.of(position, support)
    near, speed = cells.position, np.ascontiguousarray(velocity[cells.order])
    count, side, trapped, crest = np.empty(n, np.int32), np.empty((n, 3)), np.empty(n), np.empty(n)
    _sliced(surroundings, n, near, speed, *cells.grid, support, count, side, trapped)
    length = np.linalg.norm(side, axis=1)
    outside = length > INSIDE
    normal = np.where(outside[:, None], side / np.maximum(length, 1e-12)[:, None], 0.0)
    _sliced(crests, n, near, normal, *cells.grid, support, crest)
    moving = np.linalg.norm(speed, axis=1)
    crest[(speed * normal).sum(1) < 0.6 * moving] = 0.0
    return Surroundings(*cells.in_given_order(count, normal, trapped, crest))


def crowding(position: F64, support: float, enough: float) -> F64:
    """Neighbours of every particle within a support [m], weighted by 1 - (distance / support)^2, up to `enough` (n,)."""
    from .surround_kernels import crowding as kernel

    cells, found = _Cells.of(position, support), np.empty(len(position))
    _sliced(kernel, len(position), cells.position, *cells.grid, 1, enough, found)
    return cells.in_given_order(found)[0]


def carried(points: F64, position: F64, values: F64, support: float) -> F64:
    """Values of particles at points (v, c): means weighted by the cubic spline kernel; 0 where no particle is within the support.

    Args:
        points: (v, 3) [m].
        position: of the particles (n, 3) [m], n > 0.
        values: theirs (n, c).
        support: radius of the kernel [m].
    """
    from .surround_kernels import carried as kernel

    reach = 2
    cells, found = _Cells.of(position, support / reach), np.empty((len(points), values.shape[1]))
    _sliced(kernel, len(points), points, cells.position, np.ascontiguousarray(values[cells.order]), *cells.grid, reach, found)
    return found


def clumps(position: F64, spacing: float) -> NDArray[np.int64]:
    """Number of particles in the connected clump that each belongs to, shape (n,).

    Particles are connected when their cells of 1.4 spacings touch: always up to 1.4 spacings apart, never beyond 4.9.
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    if len(position) == 0:
        return np.empty(0, np.int64)
    size = REACH * spacing
    cell = np.floor((position - position.min(0)) / size).astype(np.int64) + 1
    dims = cell.max(0) + 2
    keys, own = np.unique((cell[:, 0] * dims[1] + cell[:, 1]) * dims[2] + cell[:, 2], return_inverse=True)
    rows, columns = [], []
    steps = [(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if (x, y, z) > (0, 0, 0)]
    for x, y, z in steps:
        other = keys + (x * dims[1] + y) * dims[2] + z
        place = np.minimum(np.searchsorted(keys, other), len(keys) - 1)
        hit = np.flatnonzero(keys[place] == other)
        rows.append(hit)
        columns.append(place[hit])
    row, column = np.concatenate(rows), np.concatenate(columns)
    graph = coo_matrix((np.ones(len(row), np.int8), (row, column)), shape=(len(keys), len(keys)))
    label = connected_components(graph, directed=False)[1][own.reshape(-1)]
    return np.asarray(np.bincount(label)[label])
