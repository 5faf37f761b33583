"""Triangles drawn into a depth buffer, pixel by pixel. Compiled by numba, kept on disk.

The edge functions of a triangle and its reciprocal depth are linear in the column and the row (`idcast.py`). Sums are taken in one order each,
so that a triangle has the same depth however it is drawn with others.
"""

import numpy as np
from numba import njit

__all__ = ["draw_large", "draw_small"]


@njit(cache=True, nogil=True)
def _least(one, other):
    """The less of two numbers; not a number where one of them is none, as `numpy.minimum`."""
    return other if other < one or other != other else one


@njit(cache=True, nogil=True)
def draw_large(edge, index, rectangle, corner, bounds, depth, face):
    """Draw triangles of many pixels one after another; of equals the first wins. `bounds`: seam and least depth of a hit."""
    seam, near = bounds
    for n in range(len(index)):
        e = edge[n]
        for row in range(rectangle[n, 2], rectangle[n, 3]):
            for column in range(rectangle[n, 0], rectangle[n, 1]):
                one = (e[0, 0] * column + e[0, 2]) + e[0, 1] * row
                two = (e[1, 0] * column + e[1, 2]) + e[1, 1] * row
                three = (e[2, 0] * column + e[2, 2]) + e[2, 1] * row
                inverse = one + two + three
                if inverse > 0.0 and _least(_least(one, two), three) >= -seam * inverse:
                    hit = 1.0 / inverse
                    i, j = row - corner[1], column - corner[0]
                    if hit >= near and hit < depth[i, j]:
                        depth[i, j] = hit
                        face[i, j] = index[n]


@njit(cache=True, nogil=True)
def draw_small(edge, index, rectangle, chunk, corner, bounds, depth, face):
    """Draw triangles of few pixels; of equals the first of a chunk wins, over those of other chunks and what was drawn before."""
    seam, near = bounds
    drawn = np.full(depth.shape, -1, np.int64)
    for n in range(len(index)):
        e = edge[n]
        for row in range(rectangle[n, 2], rectangle[n, 3]):
            for column in range(rectangle[n, 0], rectangle[n, 1]):
                one = e[0, 0] * column + e[0, 1] * row + e[0, 2]
                two = e[1, 0] * column + e[1, 1] * row + e[1, 2]
                three = e[2, 0] * column + e[2, 1] * row + e[2, 2]
                inverse = one + two + three
                if inverse > 0.0 and _least(_least(one, two), three) >= -seam * inverse:
                    hit = 1.0 / inverse
                    i, j = row - corner[1], column - corner[0]
                    if hit >= near and hit < depth[i, j]:
                        depth[i, j] = hit
                        face[i, j], drawn[i, j] = index[n], chunk[n]
                    elif hit == depth[i, j] and drawn[i, j] != chunk[n]:
                        face[i, j], drawn[i, j] = index[n], chunk[n]
