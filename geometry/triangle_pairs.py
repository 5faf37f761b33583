"""Pairs of triangles: how far they reach through each other, and how far those in one plane overlap."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F64, cross

__all__ = ["Pairs", "coplanar", "heights", "pairs_of", "planes_of", "properly"]

FLAT = 1e-6
"""Sine below which a triangle's plane is too ill-defined to be crossed: slivers are left out."""
IPoints = NDArray[np.intp]


def planes_of(t: F64) -> tuple[F64, NDArray[np.bool_]]:
    """Unit normals, shape (n, 3), and which triangles are wide enough to have a plane."""
    u, v = t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]
    normal = cross(u, v)
    length = np.linalg.norm(normal, axis=1)
    longest = np.maximum(np.linalg.norm(u, axis=1), np.linalg.norm(v, axis=1))
    return normal / np.maximum(length, np.finfo(float).tiny)[:, None], length > FLAT * longest**2


def heights(a: F64, b: F64, normal: F64, noise: float) -> F64:
    """Heights of the corners of a over the planes of b [m], shape (n, 3); 0 within the noise."""
    h = np.einsum("nki,ni->nk", a - b[:, :1], normal)
    return np.where(np.abs(h) <= noise, 0.0, h)


def _stretch(t: F64, h: F64, along: F64) -> tuple[F64, F64]:
    """Where triangles cross the other's plane, as an interval along the common line, shape (n,) each; empty: inf, -inf."""
    p = np.einsum("nki,ni->nk", t, along)
    low, high = np.full(len(t), np.inf), np.full(len(t), -np.inf)
    for k in range(3):
        m = (k + 1) % 3
        cut = h[:, k] * h[:, m] < 0.0
        share = np.where(cut, h[:, k] / np.where(cut, h[:, k] - h[:, m], 1.0), 0.0)
        at = p[:, k] + share * (p[:, m] - p[:, k])
        on = h[:, k] == 0.0
        for mask, value in ((cut, at), (on, p[:, k])):
            low, high = np.where(mask, np.minimum(low, value), low), np.where(mask, np.maximum(high, value), high)
    return low, high


class Pairs(NamedTuple):
    """Pairs of triangles, and how high the corners of each stand over the plane of the other."""

    a: F64
    """Corners [m], shape (n, 3, 3)."""
    b: F64
    normal_a: F64
    normal_b: F64
    wide: NDArray[np.bool_]
    """True where both have a plane."""
    h: F64
    """Heights of a over b [m], shape (n, 3)."""
    g: F64

    def take(self, rows: IPoints) -> Pairs:
        """Some of them."""
        corners, normals = (self.a[rows], self.b[rows]), (self.normal_a[rows], self.normal_b[rows])
        return Pairs(*corners, *normals, self.wide[rows], self.h[rows], self.g[rows])


def pairs_of(t: F64, planes: tuple[F64, NDArray[np.bool_]], one: IPoints, two: IPoints, noise: float) -> Pairs:
    """Pairs of some triangles with their planes, as `planes_of` gives them."""
    (a, b), (normal_a, normal_b) = ((own[one], own[two]) for own in (t, planes[0]))
    wide = planes[1][one] & planes[1][two]
    return Pairs(a, b, normal_a, normal_b, wide, heights(a, b, normal_b, noise), heights(b, a, normal_a, noise))


def properly(pairs: Pairs, noise: float) -> F64:
    """Depth to which pairs reach through each other [m], shape (n,); 0 where they do not cross."""
    value, h, g = np.zeros(len(pairs.h)), pairs.h, pairs.g
    reach = np.minimum(np.minimum(h.max(axis=1), -h.min(axis=1)), np.minimum(g.max(axis=1), -g.min(axis=1)))
    rows = np.flatnonzero(pairs.wide & (reach > 0.0))  # few, so that the others are asked no further
    if len(rows) == 0:
        return value
    some, reach = pairs.take(rows), reach[rows]
    line = cross(some.normal_a, some.normal_b)
    length = np.linalg.norm(line, axis=1)
    along = line / np.maximum(length, np.finfo(float).tiny)[:, None]
    low_a, high_a = _stretch(some.a, some.h, along)
    low_b, high_b = _stretch(some.b, some.g, along)
    overlap = np.minimum(high_a, high_b) - np.maximum(low_a, low_b)
    crossing = (length > FLAT) & (overlap > noise)
    value[rows] = np.where(crossing, np.minimum(reach, overlap), 0.0)
    return value


def coplanar(pairs: Pairs, noise: float) -> F64:
    """Width [m] by which coplanar triangles that face the same way overlap, shape (n,); 0 elsewhere."""
    value = np.zeros(len(pairs.h))
    flat = pairs.wide & (pairs.h == 0.0).all(axis=1) & (pairs.g == 0.0).all(axis=1)
    rows = np.flatnonzero(flat & (np.einsum("ni,ni->n", pairs.normal_a, pairs.normal_b) > 0.0))
    if len(rows):
        value[rows] = np.maximum(_width(pairs.a[rows], pairs.b[rows], pairs.normal_a[rows]), 0.0)
        value[value <= noise] = 0.0
    return value


def _width(a: F64, b: F64, normal: F64) -> F64:
    """Least overlap of the projections of coplanar triangles on their edge normals [m]; negative where they are apart.

    Separating axes: two convex figures in a plane are apart exactly where one edge normal separates them.
    """
    least = np.full(len(a), np.inf)
    for t in (a, b):
        for k in range(3):
            edge = t[:, (k + 1) % 3] - t[:, k]
            axis = cross(normal, edge)
            axis /= np.maximum(np.linalg.norm(axis, axis=1), np.finfo(float).tiny)[:, None]
            p, q = np.einsum("nki,ni->nk", a, axis), np.einsum("nki,ni->nk", b, axis)
            least = np.minimum(least, np.minimum(p.max(axis=1) - q.min(axis=1), q.max(axis=1) - p.min(axis=1)))
    return least
