"""Grains that fill a volume without overlap: a random packing in a periodic cube, relaxed once, repeated and cut to the volume."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ...worlds.arrays import F64

__all__ = ["Packing", "block", "fill_box"]

CELL = 2000
"""Grains of the cube."""
SWEEPS = 4000
"""Most relaxations. Packings up to 0.6 take some hundreds."""
CLOSE = 2e-3
"""Overlap in mean radii at which the cube is taken; it is then widened by as much, so that none is left."""


class Packing(NamedTuple):
    """Grains of a periodic cube of side `side`, in mean radii."""

    position: F64
    radius: F64
    side: float
    share: float
    """Share of the volume that the grains take up."""


@lru_cache(maxsize=8)
def block(share: float, spread: float, seed: int) -> Packing:
    """A cube that grains fill by about `share`, with radii evenly spread over 1 +- `spread`.

    They start at random places and are pushed off each other, as soft spheres that have no inertia.
    """
    from scipy.spatial import cKDTree

    rng = np.random.default_rng([seed, 23])
    radius = 1.0 + spread * rng.uniform(-1.0, 1.0, CELL)
    side = float((4.0 / 3.0 * np.pi * (radius**3).sum() / share) ** (1 / 3))
    position = rng.uniform(0.0, side, (CELL, 3))
    largest, worst = 2.0 * float(radius.max()), np.inf
    for _ in range(SWEEPS):
        pairs = cKDTree(position, boxsize=side).query_pairs(largest, output_type="ndarray")
        way = position[pairs[:, 0]] - position[pairs[:, 1]]
        way -= side * np.round(way / side)
        length = np.maximum(np.linalg.norm(way, axis=1), 1e-9)
        depth = radius[pairs].sum(axis=1) - length
        met = depth > 0
        worst = float(depth.max(initial=0.0))
        if worst < CLOSE:
            break
        push = 0.5 * depth[met, None] * way[met] / length[met, None]
        for axis in range(3):
            one = np.bincount(pairs[met, 0], push[:, axis], CELL) - np.bincount(pairs[met, 1], push[:, axis], CELL)
            position[:, axis] = (position[:, axis] + one) % side
    # Wider by the last overlap: a pair that overlapped by `worst` of about 2 - worst is then apart.
    scale = 1.0 / (1.0 - worst / (2.0 * float(radius.min()))) * (1 + 1e-6)
    wide = side * scale
    return Packing(position * scale, radius, wide, float(4.0 / 3.0 * np.pi * (radius**3).sum() / wide**3))


def fill_box(low: F64, high: F64, mean: float, *, share: float, spread: float, seed: int) -> tuple[F64, F64]:
    """Centres (n, 3) and radii (n,) [m] of grains whose centres lie in a box, in a fixed order."""
    cube = block(share, spread, seed)
    side = cube.side * mean
    counts = np.maximum(1, np.ceil((np.asarray(high) - low) / side).astype(int))
    shifts = np.stack(np.meshgrid(*(np.arange(k) for k in counts), indexing="ij"), axis=-1).reshape(-1, 3) * side
    found, radii = [], []
    for shift in shifts:
        points = low + shift + cube.position * mean
        kept = (points <= high).all(axis=1)
        found.append(points[kept])
        radii.append(cube.radius[kept] * mean)
    return np.concatenate(found), np.concatenate(radii)
