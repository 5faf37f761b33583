"""Triangles of one surface clipped to the solid that cuts them: as large as the cut, not as the triangle."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F64, I32, cross
from .triangles import triangle_pair_segments

if TYPE_CHECKING:
    from .solids import Solid

__all__ = ["clipped"]

MANY_PAIRS = 100_000
"""Own choice: of so many crossing triangles fcl may have left some out; then none is clipped to its cut."""


def clipped(
    corners: F64, within: NDArray[np.bool_], names: NDArray[np.intp], pairs: I32, other: Solid, noise: float
) -> list[F64]:
    """Triangles, each shape (k, 3, 3), that hold what of cut triangles lies inside `other`.

    What of a triangle is inside has its extreme points where edges of one surface pierce the other and in the triangle's own corners,
    so that their convex hull holds it: a large triangle that grazes is as small as its cut. One that meets a triangle of `other` in
    its plane, where rounding decides what pierces, stays whole.

    Args:
        corners: of the triangles [m], shape (f, 3, 3), in the frame of `other`.
        within: which of these are inside it, shape (f, 3).
        names: of the triangles in `pairs`, ascending, shape (f,).
        pairs: (triangle, triangle of `other`) that cross or touch.
        other: the solid.
        noise: [m] by which places are known.
    """
    row = np.searchsorted(names, pairs[:, 0])
    row[row == len(names)] = 0
    known = names[row] == pairs[:, 0]
    row, mates = row[known], other.triangles[pairs[known, 1]]
    if not len(row):
        return []
    doubtful = np.zeros(len(corners), dtype=bool)
    doubtful[row if len(pairs) >= MANY_PAIRS else row[_level(corners[row], mates, noise)]] = True
    points = triangle_pair_segments(corners[row], mates, slack=noise)
    found = [corners[np.unique(row[doubtful[row]])]]
    order = np.argsort(row, kind="stable")
    for group in np.split(order, np.flatnonzero(np.diff(row[order])) + 1):
        k = row[group[0]]
        if doubtful[k]:
            continue
        some = points[group].reshape(-1, 3)
        some = np.concatenate([some[~np.isnan(some[:, 0])], corners[k][within[k]]])
        found.append(_hull(some, corners[k]))
    return found


def _level(one: F64, two: F64, noise: float) -> NDArray[np.bool_]:
    """Pairs of triangles, each shape (n, 3, 3), of which one has two corners or more in the other's plane within `noise` [m]."""
    found = np.zeros(len(one), dtype=bool)
    for a, b in ((one, two), (two, one)):
        normal = cross(b[:, 1] - b[:, 0], b[:, 2] - b[:, 0])
        size = np.maximum(np.linalg.norm(normal, axis=1), np.finfo(float).tiny)
        height = np.abs(np.einsum("nki,ni->nk", a - b[:, :1], normal)) / size[:, None]
        found |= (height <= noise).sum(axis=1) >= 2
    return found


def _hull(points: F64, triangle: F64) -> F64:
    """Triangles, shape (k, 3, 3), that together are the convex hull of points in the plane of a triangle; none of fewer than three."""
    from scipy.spatial import ConvexHull, QhullError

    if len(points) < 3:
        return np.empty((0, 3, 3))
    first = triangle[1] - triangle[0]
    first = first / np.linalg.norm(first)
    second = np.cross(np.cross(first, triangle[2] - triangle[0]), first)
    second = second / np.linalg.norm(second)
    flat = (points - triangle[0]) @ np.stack([first, second], axis=1)
    try:
        ring = points[ConvexHull(flat).vertices]
    except QhullError:  # in a line: all of it holds the line
        return triangle[None]
    fan = np.arange(1, len(ring) - 1)
    return np.stack([np.broadcast_to(ring[0], (len(fan), 3)), ring[fan], ring[fan + 1]], axis=1)
