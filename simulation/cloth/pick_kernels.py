"""Numba kernels that pick from triangles near each other their vertices, edges and triangles that are; on a GPU `near_part_kernels.py` does."""

from __future__ import annotations

import numpy as np
from numba import njit

from .fold_kernels import apart, on_segments, on_triangle

__all__ = ["bounds", "pick"]


@njit(cache=True, nogil=True)
def bounds(faces, x, box):
    """Bounds of triangles, lower and upper (t, 6)."""
    for t in range(len(faces)):
        a, b, c = faces[t, 0], faces[t, 1], faces[t, 2]
        for e in range(3):
            box[t, e] = min(x[a, e], min(x[b, e], x[c, e]))
            box[t, 3 + e] = max(x[a, e], max(x[b, e], x[c, e]))


@njit(cache=True, nogil=True)
def _beyond(x, i, j, box, k, reach):
    """True if vertices i and j are on one side of the bounds of a triangle and out of reach of them."""
    for e in range(3):
        if max(x[i, e], x[j, e]) < box[k, e] - reach or min(x[i, e], x[j, e]) > box[k, 3 + e] + reach:
            return True
    return False


@njit(cache=True, nogil=True)
def pick(first, end, due, near, count, spare, x, u, span, far, faces, kin, owned, spread, box, found, room, pairs, kinds):
    """Pairs of triangles first to end that are due: their own vertices and edges with other triangles and their own edges (see `near_self_parts`).

    near, count, spare: triangles that are near each (`near_ones`), and the room for those of one. found, room, pairs, kinds: where pairs go."""
    for t in range(first, end):
        if due[t] == 0:
            continue
        slot, mine = 0, owned[t]
        for s in range(count[t]):
            k = near[t * spare + s]
            others, reach = owned[k], far
            if span > 0.0:
                reach += span * np.sqrt(apart(u, faces[t, 0], u, faces[k, 0])) + spread[t] + spread[k]
            away = False
            for e in range(3):
                away = away or box[t, 3 + e] + reach < box[k, e] or box[k, 3 + e] + reach < box[t, e]
            if away:
                continue
            for c in range(3):
                if mine & (1 << c) == 0:
                    continue
                i, n = faces[t, c], kin[t, c]
                if n == kin[k, 0] or n == kin[k, 1] or n == kin[k, 2] or _beyond(x, i, i, box, k, reach):
                    continue
                a, b, d = faces[k, 0], faces[k, 1], faces[k, 2]
                p, q, r = on_triangle(x, i, a, b, d)
                square = 0.0
                for e in range(3):
                    off = x[i, e] - p * x[a, e] - q * x[b, e] - r * x[d, e]
                    square += off * off
                if square < reach * reach:
                    if slot < room:
                        m = t * room + slot
                        pairs[m, 0], pairs[m, 1], pairs[m, 2], pairs[m, 3] = i, a, b, d
                        kinds[m, 0], kinds[m, 1] = 0, others
                    slot += 1
            if t > k:
                continue
            for c in range(3):
                if mine & (8 << c) == 0:
                    continue
                h = (c + 1) % 3
                i, j, n, o = faces[t, c], faces[t, h], kin[t, c], kin[t, h]
                if _beyond(x, i, j, box, k, reach):
                    continue
                for d in range(3):
                    if others & (8 << d) == 0:
                        continue
                    g = (d + 1) % 3
                    a, b, p, q = faces[k, d], faces[k, g], kin[k, d], kin[k, g]
                    if n == p or n == q or o == p or o == q:
                        continue
                    away = False
                    for e in range(3):
                        away = away or max(x[i, e], x[j, e]) + reach < min(x[a, e], x[b, e])
                        away = away or max(x[a, e], x[b, e]) + reach < min(x[i, e], x[j, e])
                    if away:
                        continue
                    v, w = on_segments(x, i, j, a, b)
                    square = 0.0
                    for e in range(3):
                        off = x[i, e] + v * (x[j, e] - x[i, e]) - x[a, e] - w * (x[b, e] - x[a, e])
                        square += off * off
                    if square < reach * reach:
                        if slot < room:
                            m = t * room + slot
                            pairs[m, 0], pairs[m, 1], pairs[m, 2], pairs[m, 3] = i, j, a, b
                            kinds[m, 0], kinds[m, 1] = 1, 0
                        slot += 1
        found[t] = slot
