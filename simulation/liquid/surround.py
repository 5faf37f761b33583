"""Neighbourhoods of particles as drawing needs them: counts, outward direction, foam potentials, connected clumps."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.launch import cores
from ...worlds.arrays import F64

__all__ = ["Surroundings", "clumps", "surroundings"]

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
    lower = position.min(0) - 0.5 * support
    cell = np.floor((position - lower) / support).astype(np.int64)
    dims = cell.max(0) + 2
    key = (cell[:, 0] * dims[1] + cell[:, 1]) * dims[2] + cell[:, 2]
    order = np.argsort(key, kind="stable")
    key, near, speed = key[order], np.ascontiguousarray(position[order]), np.ascontiguousarray(velocity[order])
    count, side, trapped, crest = np.empty(n, np.int32), np.empty((n, 3)), np.empty(n), np.empty(n)
    _sliced(surroundings, n, near, speed, lower, support, dims, key, support, count, side, trapped)
    length = np.linalg.norm(side, axis=1)
    outside = length > INSIDE
    normal = np.where(outside[:, None], side / np.maximum(length, 1e-12)[:, None], 0.0)
    _sliced(crests, n, near, normal, lower, support, dims, key, support, crest)
    moving = np.linalg.norm(speed, axis=1)
    crest[(speed * normal).sum(1) < 0.6 * moving] = 0.0
    back = np.empty(n, np.int64)
    back[order] = np.arange(n)
    return Surroundings(count[back], normal[back], trapped[back], crest[back])


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
