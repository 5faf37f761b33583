"""Points all over surfaces and inside bodies, at which a judge of liquids asks its questions."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ....geometry import Solid, contains
from ....worlds.arrays import F64

if TYPE_CHECKING:
    from .frames import Liquid

__all__ = ["sample_inside", "samples", "scattered", "shares_under", "spread", "triangles_by_parts"]

MOST_PARTS = 32
"""Triangles whose edges would be cut into more parts are divided first."""
SCATTERED = 40_000
"""Most points scattered over one surface."""
PLASTIC = 1.2207440846057595
"""Root of x^4 = x + 1, the plastic number of three dimensions."""
POINTS = 600
"""Points inside a body at which it is asked whether they are under water."""


def samples(solid: Solid, spacing: float, low: F64, high: F64) -> tuple[F64, F64]:
    """Points all over a surface within a box, at most `spacing` [m] apart, and the normals there, each shape (n, 3)."""
    points, normals = [np.zeros((0, 3))], [np.zeros((0, 3))]
    for triangles, facing, k in triangles_by_parts(solid, spacing, low, high):
        i, j = np.meshgrid(np.arange(k + 1), np.arange(k + 1), indexing="ij")
        inner = i + j <= k
        weights = np.stack([i[inner], j[inner], k - i[inner] - j[inner]], axis=1) / k
        points.append(np.einsum("wc,tcx->twx", weights, triangles).reshape(-1, 3))
        normals.append(np.repeat(facing, len(weights), axis=0))
    return np.concatenate(points), np.concatenate(normals)


def triangles_by_parts(solid: Solid, spacing: float, low: F64, high: F64) -> Iterator[tuple[F64, F64, int]]:
    """Triangles of a surface that meet a box, shape (n, 3, 3), their normals, and in how many parts of at most `spacing` [m] their
    edges are to be cut. Large triangles come as smaller ones."""
    t, n = solid.triangles, solid.face_normals
    while len(t):
        meets = (t.max(axis=1) >= low).all(axis=1) & (t.min(axis=1) <= high).all(axis=1)
        t, n = t[meets], n[meets]
        edge = np.linalg.norm(t - np.roll(t, 1, axis=1), axis=2).max(axis=1, initial=0.0)
        large = edge > MOST_PARTS * spacing
        for k in 2 ** np.arange(int(np.log2(MOST_PARTS)) + 1):
            mine = ~large & (np.ceil(edge / spacing) <= k) & (np.ceil(edge / spacing) > k // 2)
            if mine.any():
                yield t[mine], n[mine], int(k)
        t, n = t[large], np.repeat(n[large], 4, axis=0)
        middle = 0.5 * (t + np.roll(t, -1, axis=1))
        a, b, c = t[:, 0], t[:, 1], t[:, 2]
        ab, bc, ca = middle[:, 0], middle[:, 1], middle[:, 2]
        t = np.stack([np.stack(q, axis=1) for q in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))], axis=1).reshape(
            -1, 3, 3
        )


def scattered(solid: Solid, spacing: float, low: F64, high: F64) -> tuple[F64, F64]:
    """Points within the triangles of a surface that meet a box, evenly by area, four per square of `spacing` [m], at most SCATTERED,
    and the normals there, each shape (n, 3). None lies on an edge.
    """  # fmt: skip
    t = solid.triangles
    meets = np.flatnonzero((t.max(axis=1) >= low).all(axis=1) & (t.min(axis=1) <= high).all(axis=1))
    if not len(meets):
        return np.zeros((0, 3)), np.zeros((0, 3))
    area = np.cumsum(0.5 * np.linalg.norm(np.cross(t[meets, 1] - t[meets, 0], t[meets, 2] - t[meets, 0]), axis=1))
    count = int(np.clip(4.0 * area[-1] / spacing**2, 16, SCATTERED))
    k = np.arange(count)
    face = meets[np.minimum(np.searchsorted(area, (k + 0.5) / count * area[-1]), len(meets) - 1)]
    # The additive recurrence of the plastic number fills a square evenly; folded it fills a triangle.
    u, v = (0.5 + k * 0.7548776662466927) % 1.0, (0.5 + k * 0.5698402909980532) % 1.0
    over = u + v > 1.0
    u, v = np.where(over, 1.0 - u, u), np.where(over, 1.0 - v, v)
    weight = 0.98 * np.stack([1.0 - u - v, u, v], axis=1) + 0.02 / 3.0
    return np.einsum("nk,nkx->nx", weight, t[face]), solid.face_normals[face]


def spread(low: F64, high: F64, count: int) -> F64:
    """About so many points all over a box, one in each of equal cells, shape (n, 3).

    They stand in their cells as the additive recurrence of the plastic number goes on: a plane, along the cells or not, parts a box of
    100,000 with an error of 1e-4, where the cells' middles err by up to 1e-2.
    """
    step = float(np.cbrt(np.prod(high - low) / count))
    counts = np.maximum(np.ceil((high - low) / step).astype(int), 2)
    cell = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1).reshape(-1, 3)
    within = (0.5 + np.arange(len(cell))[:, None] * PLASTIC ** -np.arange(1.0, 4.0)) % 1.0
    return np.asarray(low + (cell + within) * (high - low) / counts)


def sample_inside(liquid: Liquid, name: str) -> F64:
    """Points spread evenly inside the parts of a body, in its frame [m], shape (n, 3)."""
    entity, body = name.split("/")
    solids = [Solid.from_mesh(p.render, closed=p.closed) for p in liquid.candidate.entity(entity).parts_of(body)]
    low, high = np.min([s.lower for s in solids], axis=0), np.max([s.upper for s in solids], axis=0)
    step = float(np.cbrt(np.prod(high - low) / POINTS))
    counts = np.maximum(np.ceil((high - low) / step).astype(int), 4)
    axes = [np.linspace(a, b, 2 * n + 1)[1::2] for a, b, n in zip(low, high, counts, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    held = np.zeros(len(grid), dtype=bool)
    for solid in solids:
        held |= contains(solid, grid)
    return grid[held] if held.any() else 0.5 * (low + high)[None]


def shares_under(heights: F64, level: F64 | float, step: float) -> F64:
    """Share of cubes of edge `step` [m] about points at some heights [m] that lies under a level."""
    return np.asarray(np.clip((level - heights) / step + 0.5, 0.0, 1.0))
