"""Dart throwing on a grid of buckets. Compiled by numba, kept on disk."""

from __future__ import annotations

from numba import njit

__all__ = ["throw"]


@njit(cache=True)
def throw(x, y, radius, taken_x, taken_y, taken_r, head, chain, count, cols, rows, size, left, bottom):
    """Place candidates in their order unless one that stands is too near; returns the new count.

    Two plants keep a distance of the sum of their radii. `head` and `chain` are lists per bucket of side `size`, which
    is at least twice the largest radius.
    """
    placed = count
    for k in range(x.size):
        i, j = int((x[k] - left) / size), int((y[k] - bottom) / size)
        free = True
        for di in range(-1, 2):
            for dj in range(-1, 2):
                p, q = i + di, j + dj
                if not free or p < 0 or q < 0 or p >= cols or q >= rows:
                    continue
                at = head[q * cols + p]
                while at >= 0:
                    reach = radius[k] + taken_r[at]
                    if (x[k] - taken_x[at]) ** 2 + (y[k] - taken_y[at]) ** 2 < reach * reach:
                        free = False
                        break
                    at = chain[at]
        if not free or placed >= taken_x.size:
            continue
        taken_x[placed], taken_y[placed], taken_r[placed] = x[k], y[k], radius[k]
        bucket = j * cols + i
        chain[placed] = head[bucket]
        head[bucket] = placed
        placed += 1
    return placed
