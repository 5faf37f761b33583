"""Distance of one point to triangles. Compiled by numba, kept on disk."""

import numpy as np
from numba import njit

__all__ = ["to_triangles"]

TINY = 2.2250738585072014e-308


@njit(cache=True, nogil=True, inline="always")
def _dot(a, b):
    return (a[0] * b[0] + a[2] * b[2]) + a[1] * b[1]


@njit(cache=True, nogil=True, inline="always")
def _cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@njit(cache=True, nogil=True, inline="always")
def _less(a, b):
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@njit(cache=True, nogil=True)
def _square_to_segment(p, a, b):
    along, gap = _less(b, a), _less(p, a)
    t = min(max(_dot(gap, along) / max(_dot(along, along), TINY), 0.0), 1.0)
    rest = _less(p, (a[0] + t * along[0], a[1] + t * along[1], a[2] + t * along[2]))
    return _dot(rest, rest)


@njit(cache=True, nogil=True)
def to_triangles(point, triangles):
    """Least distance [m] of a point, shape (3,), to triangles, shape (m, 3, 3): that of `triangles.nearest_on_triangles`, bit for bit."""
    p, best = (point[0], point[1], point[2]), np.inf
    for k in range(len(triangles)):
        a = triangles[k, 0, 0], triangles[k, 0, 1], triangles[k, 0, 2]
        b = triangles[k, 1, 0], triangles[k, 1, 1], triangles[k, 1, 2]
        c = triangles[k, 2, 0], triangles[k, 2, 1], triangles[k, 2, 2]
        normal, from_a = _cross(_less(b, a), _less(c, a)), _less(p, a)
        side = min(_dot(_cross(normal, _less(b, a)), from_a), _dot(_cross(normal, _less(c, b)), _less(p, b)))
        if min(side, _dot(_cross(normal, _less(a, c)), _less(p, c))) >= 0.0:
            square = max(_dot(normal, normal), TINY)
            height = _dot(from_a, normal) / square
            best = min(best, height * height * square)
        best = min(best, min(_square_to_segment(p, a, b), min(_square_to_segment(p, b, c), _square_to_segment(p, c, a))))
    return np.sqrt(best)
