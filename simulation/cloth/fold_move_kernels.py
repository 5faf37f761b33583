"""Numba kernels that move vertices in folds: what is known of pairs, where they are expected, and how far they may go."""

from __future__ import annotations

import numpy as np
from numba import njit

from .fold_kernels import apart, dot

__all__ = ["binding", "cut", "gather", "move", "renew", "sway"]

SHARE, KEEP = 0.8, 0.05
"""As in `bound_kernels`."""
NOTHING = 1e9
"""Distance [m] beyond all, of what is not known."""


@njit(cache=True, nogil=True)
def sway(plan, u, dt, strays, ahead):
    """Distances by which vertices can have strayed from their plans by the end of a step with velocities u, from those by its start."""
    for i in range(len(ahead)):
        ahead[i] = strays[i] + dt * np.sqrt(apart(u, i, plan, i))


@njit(cache=True, nogil=True)
def binding(first, count, corner, kind, share, way, x, u, inverse, radius, dt, bound, value):
    """Displacements of vertices that would go too near the plane of their pair (see `bound_kernels.bound`), from place `first` of some
    pairs on: place of the corner (4 pair + corner) and the share of the displacement that is left, or below 0 how far a solid carries the
    plane on over it [m]; how many they are."""
    m = 4 * first
    for p in range(first, first + count):
        nx, ny, nz, d = way[p, 0], way[p, 1], way[p, 2], way[p, 3]
        i0 = corner[p, 0]
        edges = kind[p] % 4 == 1 or kind[p] % 4 == 3
        solid = kind[p] > 1
        middle, both = 0.0, 0.0
        for k in range(4):
            i = corner[p, k]
            h = 0.5 * abs(share[p, k])
            middle += h * dot(x[i, 0] - x[i0, 0], x[i, 1] - x[i0, 1], x[i, 2] - x[i0, 2], nx, ny, nz)
            both += h * dt * dot(u[i, 0], u[i, 1], u[i, 2], nx, ny, nz)
        keep = KEEP * (radius[i0] + radius[corner[p, 2]])
        free = SHARE * 0.25 * max(d - 2.0 * keep, 0.0)
        drift = min(max(both, -free), free)
        led = 0.0
        if solid:
            for k in range(4):
                i = corner[p, k]
                a = dt * dot(u[i, 0], u[i, 1], u[i, 2], nx, ny, nz)
                if kind[p] % 4 == 0:
                    if k == 0:
                        led = min(led, a)
                elif k > 1 or (k == 1 and not edges):
                    led = max(led, a)
        for k in range(4):
            i = corner[p, k]
            if inverse[i] <= 0.0:
                continue
            side = -1.0 if k > 1 or (k == 1 and not edges) else 1.0
            away = side * (dot(x[i, 0] - x[i0, 0], x[i, 1] - x[i0, 1], x[i, 2] - x[i0, 2], nx, ny, nz) - middle)
            rise = side * dt * dot(u[i, 0], u[i, 1], u[i, 2], nx, ny, nz)
            out = 1.0
            if solid:
                away = max(away + 0.5 * d - keep, 0.0)
                carried = side * led
                if rise < carried - SHARE * away:
                    if carried <= SHARE * away:
                        out = min(max((carried - SHARE * away) / rise, 0.0), 1.0)
                    else:
                        out = -(carried - SHARE * away)
            else:
                least = side * drift - SHARE * max(away - keep, 0.0)
                if rise < least and rise < 0.0:
                    out = min(max(least / rise, 0.0), 1.0)
            if out < 1.0:
                bound[m] = 4 * p + k
                value[m] = out
                m += 1
    return m - 4 * first


@njit(cache=True, nogil=True)
def cut(starts, counts, bound, value, corner, kind, way, part, dt, x, u, place, plan, speed):
    """Velocities of the sheets' vertices with displacements cut at all planes (see `bound_kernels.move`), `speed` (n, 3); the farthest that
    any then is from where it is expected [m].

    part: 1 for each vertex; 2 after it where something was cut. place, plan: where vertices are expected now, and how fast they go."""
    n = len(speed)
    speed[:] = u[:n]
    for b in range(len(starts)):
        for m in range(4 * starts[b], 4 * starts[b] + counts[b]):
            i = corner[bound[m] // 4, bound[m] % 4]
            if i < n:
                part[i] = min(part[i], value[m])
    for b in range(len(starts)):
        for m in range(4 * starts[b], 4 * starts[b] + counts[b]):
            k, s = bound[m] // 4, bound[m] % 4
            i = corner[k, s]
            if i >= n:
                continue
            if part[i] < 1.0:
                keep = max(part[i], 0.0)
                for e in range(3):
                    speed[i, e] = keep * u[i, e]
                part[i] = 2.0
            if value[m] < 0.0:
                side = -1.0 if kind[k] % 4 == 0 else 1.0
                for e in range(3):
                    speed[i, e] += side * (-value[m] / dt) * way[k, e]
    most = 0.0
    for i in range(n):
        gone = 0.0
        for e in range(3):
            off = x[i, e] - place[i, e] + dt * (speed[i, e] - plan[i, e])
            gone += off * off
        most = max(most, gone)
    return np.sqrt(most)


@njit(cache=True, nogil=True)
def move(dt, part, mass, u, speed, plan, place, x, v, held_back, ahead, strays):
    """Take the velocities and move with them; what was cut is kept in `held_back`. `part` is 1 again, `place` goes with its plan, and
    `strays` becomes what was to be `ahead`, with what was cut."""
    strays[:] = ahead
    for i in range(len(v)):
        if part[i] == 2.0:
            strays[i] += dt * np.sqrt(apart(speed, i, u, i))
        for e in range(3):
            if part[i] == 2.0:
                held_back[i, e] += mass[i] * (speed[i, e] - u[i, e])
            v[i, e] = speed[i, e]
            x[i, e] = x[i, e] + dt * speed[i, e]
            place[i, e] += dt * plan[i, e]
        part[i] = 1.0


@njit(cache=True, nogil=True)
def renew(x, v, least, place, plan, strays, moved):
    """Expect vertices where they are, to go on as they do, where they have strayed by more than `least` [m]; say which in `moved`. What was
    known of their pairs is so no more."""
    for i in range(len(moved)):
        gone = 0.0
        for e in range(3):
            off = x[i, e] - place[i, e]
            gone += off * off
        moved[i] = gone > least * least
        if moved[i]:
            strays[i] += NOTHING
            for e in range(3):
                place[i, e], plan[i, e] = x[i, e], v[i, e]


@njit(cache=True, nogil=True)
def gather(found, room, pairs, kinds, due, before, known, start, rows):
    """Pairs of all triangles one after the other, from where each triangle's begin (`start`), with what is known of those of triangles that
    are not due.

    before: where each triangle's began in the rows that are `known`, both of no triangle if nothing is."""
    every, sorts, level, rate, stamp = rows
    _, _, old_level, old_rate, _ = known
    keeps = len(before) > 0
    for t in range(len(found)):
        keep = keeps and due[t] == 0
        for s in range(found[t]):
            p, q = start[t] + s, t * room + s
            for c in range(4):
                every[p, c] = pairs[q, c]
            sorts[p, 0], sorts[p, 1] = kinds[q, 0], kinds[q, 1]
            stamp[p] = -1
            if keep:
                level[p], rate[p] = old_level[before[t] + s], old_rate[before[t] + s]
            else:
                level[p], rate[p] = -NOTHING, 0.0
