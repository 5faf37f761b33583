"""Exact distances between points, segments and triangles, vectorised in float64."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..worlds.arrays import F64, cross, dot

__all__ = [
    "Nearest",
    "nearest_on_triangles",
    "ray_hits",
    "segment_points",
    "triangle_pair",
    "triangle_pair_segments",
    "triangle_pairs",
]


class Nearest(NamedTuple):
    """Distance [m] and nearest point [m]; leading shape as the query, points with a last axis of 3."""

    distance: F64
    point: F64


def nearest_on_triangles(points: F64, triangles: F64) -> Nearest:
    """Nearest point of each triangle to each point, pairwise by broadcasting.

    Args:
        points: shape (..., 3).
        triangles: corners, shape (..., 3, 3), leading axes broadcast with those of `points`.
    """
    a, b, c = triangles[..., 0, :], triangles[..., 1, :], triangles[..., 2, :]
    normal = cross(b - a, c - a)
    square = np.maximum(dot(normal, normal), np.finfo(float).tiny)
    # Edge tests against the plane of each edge and the normal: inside all three, the foot of the plane is nearest.
    side = np.minimum(
        np.minimum(dot(cross(normal, b - a), points - a), dot(cross(normal, c - b), points - b)),
        dot(cross(normal, a - c), points - c),
    )
    height = dot(points - a, normal) / square
    best = points - height[..., None] * normal
    distance2 = np.where(side >= 0.0, height * height * square, np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        along = end - start
        t = np.clip(dot(points - start, along) / np.maximum(dot(along, along), np.finfo(float).tiny), 0.0, 1.0)
        foot = start + t[..., None] * along
        gap = points - foot
        d2 = dot(gap, gap)
        closer = d2 < distance2
        distance2 = np.where(closer, d2, distance2)
        best = np.where(closer[..., None], foot, best)
    return Nearest(np.sqrt(distance2), best)


def segment_points(p: F64, u: F64, q: F64, v: F64) -> tuple[F64, F64]:
    """Nearest parameters (s, t) of segments p + s u and q + t v, all in [0, 1], by broadcasting over shape (..., 3).

    Cross products instead of the usual a e - b^2 keep nearly parallel segments accurate (own derivation).
    """
    tiny = np.finfo(float).tiny
    uu, vv, uv = dot(u, u), dot(v, v), dot(u, v)
    r = q - p
    normal = cross(u, v)
    square = dot(normal, normal)
    crossing = square > 1e-30 * uu * vv
    s = np.clip(np.where(crossing, dot(cross(r, v), normal) / np.where(crossing, square, 1.0), 0.0), 0.0, 1.0)
    ru, rv = dot(r, u), dot(r, v)
    t = np.clip((s * uv - rv) / np.maximum(vv, tiny), 0.0, 1.0)
    s = np.clip((t * uv + ru) / np.maximum(uu, tiny), 0.0, 1.0)
    # One more sweep ends the alternation for parallel segments, whose first s was arbitrary.
    t = np.clip((s * uv - rv) / np.maximum(vv, tiny), 0.0, 1.0)
    return s, t


def triangle_pair(a: F64, b: F64) -> tuple[F64, F64]:
    """Nearest points of two triangles that do not cross, corners of shape (3, 3) each."""
    first, second = triangle_pairs(a[None], b[None])
    return first[0], second[0]


def triangle_pairs(a: F64, b: F64) -> tuple[F64, F64]:
    """The same of many pairs, shape (n, 3, 3) each: points of either, shape (n, 3)."""
    on_b, on_a = nearest_on_triangles(a, b[:, None]), nearest_on_triangles(b, a[:, None])
    u, v = np.roll(a, -1, axis=1) - a, np.roll(b, -1, axis=1) - b
    s, t = segment_points(a[:, :, None], u[:, :, None], b[:, None], v[:, None])
    edge_a = (a[:, :, None] + s[..., None] * u[:, :, None]).reshape(len(a), -1, 3)
    edge_b = (b[:, None] + t[..., None] * v[:, None]).reshape(len(b), -1, 3)
    first = np.concatenate([a, on_a.point, edge_a], axis=1)
    second = np.concatenate([on_b.point, b, edge_b], axis=1)
    rows, k = np.arange(len(a)), np.linalg.norm(first - second, axis=2).argmin(axis=1)
    return first[rows, k], second[rows, k]


def triangle_pair_segments(a: F64, b: F64, *, slack: float = 0.0) -> F64:
    """Where the edges of triangles pierce the triangles paired with them.

    Args:
        a: corners, shape (n, 3, 3).
        b: corners of the triangle paired with each, shape (n, 3, 3).
        slack: [m] by which a point may miss the triangle, so that rounding loses none between two of them.

    Returns:
        Piercing points, shape (n, 6, 3): edges of a through b, then edges of b through a; NaN where they miss.
    """
    found = []
    for one, other in ((a, b), (b, a)):
        normal = cross(other[:, 1] - other[:, 0], other[:, 2] - other[:, 0])
        height = np.einsum("nki,ni->nk", one - other[:, :1], normal)
        for k in range(3):
            h0, h1 = height[:, k], height[:, (k + 1) % 3]
            crosses = ((h0 <= 0.0) != (h1 <= 0.0)) & (h0 != h1)
            t = np.where(crosses, h0 / np.where(crosses, h0 - h1, 1.0), 0.0)
            point = one[:, k] + t[:, None] * (one[:, (k + 1) % 3] - one[:, k])
            inside = crosses
            for j in range(3):
                along = other[:, (j + 1) % 3] - other[:, j]
                inward = cross(normal, along)
                allowed = -slack * np.linalg.norm(inward, axis=1) if slack else 0.0
                inside = inside & (np.einsum("ni,ni->n", inward, point - other[:, j]) >= allowed)
            found.append(np.where(inside[:, None], point, np.nan))
    return np.stack(found, axis=1)


def ray_hits(triangles: F64, origin: F64, direction: F64) -> F64:
    """Where rays meet triangles, in lengths of their directions, shape (n, m); infinite where one is not hit.

    Moeller and Trumbore (1997), doi:10.1080/10867651.1997.10487468.

    Args:
        triangles: corners [m], shape (m, 3, 3).
        origin: of each ray [m], shape (n, 3).
        direction: of each ray, shape (n, 3).
    """
    a = triangles[:, 0]
    e1, e2 = triangles[:, 1] - a, triangles[:, 2] - a
    determinant = direction @ cross(e2, e1).T
    usable = determinant != 0.0
    inverse = 1.0 / np.where(usable, determinant, 1.0)
    s = origin[:, None] - a
    q, p = cross(s, np.broadcast_to(e1, s.shape)), cross(direction[:, None], e2[None])
    u = dot(s, p) * inverse
    v = dot(q, direction[:, None]) * inverse
    t = dot(q, e2) * inverse
    hit = usable & (u >= -1e-12) & (v >= -1e-12) & (u + v <= 1.0 + 1e-12) & (t > 0.0)
    return np.asarray(np.where(hit, t, np.inf))
