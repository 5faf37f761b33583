"""Numba kernels of a sparse Cholesky factor L D L^T of three matrices with one pattern (after Davis 2005, doi:10.1145/1114268.1114277)."""

from __future__ import annotations

import numpy as np
from numba import njit

__all__ = ["decompose", "shape_of"]


@njit(cache=True, nogil=True)
def shape_of(start, row):
    """Parents in the elimination tree and entries of each column of the factor.

    start, row: compressed columns of the matrix' upper half, diagonal included."""
    n = len(start) - 1
    parent, seen, count = np.full(n, -1, np.int32), np.full(n, -1, np.int32), np.zeros(n, np.int32)
    for k in range(n):
        seen[k] = k
        for p in range(start[k], start[k + 1]):
            i = row[p]
            while i < k and seen[i] != k:
                if parent[i] == -1:
                    parent[i] = k
                count[i] += 1
                seen[i] = k
                i = parent[i]
    return parent, count


@njit(cache=True, nogil=True)
def decompose(start, row, values, parent, first, found, lower, pivot):
    """The factor: rows `found` and entries `lower` (columns start at `first`) and inverse pivots, each for three matrices side by side."""
    n = len(start) - 1
    room = np.zeros((n, 3))
    seen, chain, filled = np.full(n, -1, np.int32), np.empty(n, np.int32), np.zeros(n, np.int32)
    for k in range(n):
        top = n
        seen[k] = k
        for p in range(start[k], start[k + 1]):
            i = row[p]
            for c in range(3):
                room[i, c] += values[p, c]
            length = 0
            while seen[i] != k:
                chain[length] = i
                length += 1
                seen[i] = k
                i = parent[i]
            while length > 0:
                top -= 1
                length -= 1
                chain[top] = chain[length]
        d0, d1, d2 = room[k, 0], room[k, 1], room[k, 2]
        room[k, :] = 0.0
        for s in range(top, n):
            i = chain[s]
            y0, y1, y2 = room[i, 0], room[i, 1], room[i, 2]
            room[i, :] = 0.0
            end = first[i] + filled[i]
            for p in range(first[i], end):
                j = found[p]
                room[j, 0] -= lower[p, 0] * y0
                room[j, 1] -= lower[p, 1] * y1
                room[j, 2] -= lower[p, 2] * y2
            l0, l1, l2 = y0 * pivot[i, 0], y1 * pivot[i, 1], y2 * pivot[i, 2]
            d0 -= l0 * y0
            d1 -= l1 * y1
            d2 -= l2 * y2
            found[end] = k
            lower[end, 0], lower[end, 1], lower[end, 2] = l0, l1, l2
            filled[i] += 1
        pivot[k, 0], pivot[k, 1], pivot[k, 2] = 1.0 / d0, 1.0 / d1, 1.0 / d2
