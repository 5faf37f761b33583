"""Particles that hang together."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64

__all__ = ["clumps_of"]


def clumps_of(points: F64, cube: float) -> NDArray[np.intp]:
    """Clump of every point, shape (n,), numbered from 0: points in cubes of this size [m] that touch are of one clump."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    cell = np.floor(points / cube).astype(np.int64)
    cell -= cell.min(axis=0) - 1
    span = cell.max(axis=0) + 2
    key = (cell[:, 0] * span[1] + cell[:, 1]) * span[2] + cell[:, 2]
    keys, which = np.unique(key, return_inverse=True)
    ways = np.array([(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if (x, y, z) > (0, 0, 0)])
    pairs = []
    for step in (ways[:, 0] * span[1] + ways[:, 1]) * span[2] + ways[:, 2]:
        at = np.searchsorted(keys, keys + step)
        hit = np.flatnonzero(keys[np.minimum(at, len(keys) - 1)] == keys + step)
        pairs.append(np.stack([hit, at[hit]]))
    a, b = np.concatenate(pairs, axis=1)
    label = connected_components(coo_array((np.ones(len(a)), (a, b)), shape=(len(keys),) * 2), directed=False)[1]
    return np.asarray(label[which.reshape(-1)], dtype=np.intp)
