"""Numba kernels of explicit steps in folds: only pairs that could meet are looked at, only those that press are solved for.

The arithmetic is that of `contact_kernels.py` and `bound_kernels.py`, which every pair of a list goes through on a GPU.
"""

from __future__ import annotations

import numpy as np
from numba import njit

__all__ = ["GUARD", "apart", "dot", "lean", "on_segments", "on_triangle", "press", "tell", "wake"]

PUSH, FASTEST = 0.1, 0.2
"""As in `contact_kernels`."""
GUARD = 0.1
"""Share of the distance of contact that two things must keep beyond it in a step to be left alone."""


@njit(cache=True, nogil=True, inline="always")
def dot(ax, ay, az, bx, by, bz):
    """Scalar product of two vectors."""
    return ax * bx + ay * by + az * bz


@njit(cache=True, nogil=True)
def on_triangle(x, p, a, b, c):
    """Barycentric place of the point of a triangle that is nearest to vertex p, as `near_kernels.on_triangle`."""
    abx, aby, abz = x[b, 0] - x[a, 0], x[b, 1] - x[a, 1], x[b, 2] - x[a, 2]
    acx, acy, acz = x[c, 0] - x[a, 0], x[c, 1] - x[a, 1], x[c, 2] - x[a, 2]
    apx, apy, apz = x[p, 0] - x[a, 0], x[p, 1] - x[a, 1], x[p, 2] - x[a, 2]
    d1, d2 = dot(abx, aby, abz, apx, apy, apz), dot(acx, acy, acz, apx, apy, apz)
    if d1 <= 0.0 and d2 <= 0.0:
        return 1.0, 0.0, 0.0
    bpx, bpy, bpz = x[p, 0] - x[b, 0], x[p, 1] - x[b, 1], x[p, 2] - x[b, 2]
    d3, d4 = dot(abx, aby, abz, bpx, bpy, bpz), dot(acx, acy, acz, bpx, bpy, bpz)
    if d3 >= 0.0 and d4 <= d3:
        return 0.0, 1.0, 0.0
    vc = d1 * d4 - d3 * d2
    if vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        s = d1 / (d1 - d3)
        return 1.0 - s, s, 0.0
    cpx, cpy, cpz = x[p, 0] - x[c, 0], x[p, 1] - x[c, 1], x[p, 2] - x[c, 2]
    d5, d6 = dot(abx, aby, abz, cpx, cpy, cpz), dot(acx, acy, acz, cpx, cpy, cpz)
    if d6 >= 0.0 and d5 <= d6:
        return 0.0, 0.0, 1.0
    vb = d5 * d2 - d1 * d6
    if vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        s = d2 / (d2 - d6)
        return 1.0 - s, 0.0, s
    va = d3 * d6 - d5 * d4
    if va <= 0.0 and d4 - d3 >= 0.0 and d5 - d6 >= 0.0:
        s = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        return 0.0, 1.0 - s, s
    down = va + vb + vc
    return va / down, vb / down, vc / down


@njit(cache=True, nogil=True)
def on_segments(x, p0, p1, q0, q1):
    """Places along two edges at which they are nearest, as `near_kernels.on_segments`."""
    dx, dy, dz = x[p1, 0] - x[p0, 0], x[p1, 1] - x[p0, 1], x[p1, 2] - x[p0, 2]
    ex, ey, ez = x[q1, 0] - x[q0, 0], x[q1, 1] - x[q0, 1], x[q1, 2] - x[q0, 2]
    rx, ry, rz = x[p0, 0] - x[q0, 0], x[p0, 1] - x[q0, 1], x[p0, 2] - x[q0, 2]
    a, b, c = dot(dx, dy, dz, dx, dy, dz), dot(dx, dy, dz, ex, ey, ez), dot(dx, dy, dz, rx, ry, rz)
    f, g = dot(ex, ey, ez, rx, ry, rz), dot(ex, ey, ez, ex, ey, ez)
    down = a * g - b * b
    s = 0.0
    if down > 1.0e-12 * a * g:
        s = min(max((b * f - c * g) / down, 0.0), 1.0)
    t = (b * s + f) / g
    if t < 0.0:
        t = 0.0
        s = min(max(-c / a, 0.0), 1.0)
    elif t > 1.0:
        t = 1.0
        s = min(max((b - c) / a, 0.0), 1.0)
    return s, t


@njit(cache=True, nogil=True)
def _stands(c1, c2, c3, owned):
    """True if a vertex' nearest triangle is the one of several that counts, as `contact_kernels.stands`."""
    a, b, d = c1 < 0.0, c2 < 0.0, c3 < 0.0
    if a and b and d:
        return True
    if a and b:
        bit = 8
    elif b and d:
        bit = 16
    elif a and d:
        bit = 32
    elif a:
        bit = 1
    elif b:
        bit = 2
    else:
        bit = 4
    return (owned & bit) != 0


@njit(cache=True, nogil=True)
def apart(one, i, other, j):
    """Square of the distance of two vectors."""
    x, y, z = one[i, 0] - other[j, 0], one[i, 1] - other[j, 1], one[i, 2] - other[j, 2]
    return x * x + y * y + z * z


@njit(cache=True, nogil=True)
def _strayed(strays, i0, i1, i2, i3):
    """Distance by which the two things of a pair can have strayed towards each other."""
    return max(strays[i0], strays[i1]) + max(strays[i1], max(strays[i2], strays[i3]))


@njit(cache=True, nogil=True)
def wake(
    first,
    end,
    at,
    pairs,
    kinds,
    level,
    rate,
    stamp,
    now,
    time,
    dt,
    x,
    plan,
    u,
    radius,
    strays,
    ahead,
    late,
    corner,
    kind,
    share,
    way,
    aim,
):
    """Nearest points, ways and wanted relative velocities of those of some pairs that could meet in this step, written from place `at`
    on; how many they are. See `contact_kernels.meet`.

    A pair is at least level - rate t apart at time t, less what its vertices strayed from their plans, of which `strays` tells at the start
    of the step and `ahead` at its end. now: number of the step; `late`: those looked at in it before are left out, the others do not press."""
    k = at
    for p in range(first, end):
        i0, i1, i2, i3 = pairs[p, 0], pairs[p, 1], pairs[p, 2], pairs[p, 3]
        touch = radius[i0] + radius[i2]
        if level[p] - rate[p] * (time + dt) - _strayed(ahead, i0, i1, i2, i3) > GUARD * touch:
            continue
        if late and stamp[p] == now:
            continue
        stamp[p] = now
        sort = kinds[p, 0]
        if sort % 4 == 1 or sort % 4 == 3:
            s, r = on_segments(x, i0, i1, i2, i3)
            c0, c1, c2, c3 = 1.0 - s, s, r - 1.0, -r
            counts = c0 > 0.0 and c1 > 0.0 and c2 < 0.0 and c3 < 0.0
        else:
            a, b, c = on_triangle(x, i0, i1, i2, i3)
            c0, c1, c2, c3 = 1.0, -a, -b, -c
            counts = _stands(c1, c2, c3, kinds[p, 1])
        rx = c0 * x[i0, 0] + c1 * x[i1, 0] + c2 * x[i2, 0] + c3 * x[i3, 0]
        ry = c0 * x[i0, 1] + c1 * x[i1, 1] + c2 * x[i2, 1] + c3 * x[i3, 1]
        rz = c0 * x[i0, 2] + c1 * x[i1, 2] + c2 * x[i2, 2] + c3 * x[i3, 2]
        d = np.sqrt(rx * rx + ry * ry + rz * rz)
        deep = max(d, 1.0e-30)
        rx, ry, rz = rx / deep, ry / deep, rz / deep
        gap = d - radius[i0] - radius[i2]
        ux = c0 * u[i0, 0] + c1 * u[i1, 0] + c2 * u[i2, 0] + c3 * u[i3, 0]
        uy = c0 * u[i0, 1] + c1 * u[i1, 1] + c2 * u[i2, 1] + c3 * u[i3, 1]
        uz = c0 * u[i0, 2] + c1 * u[i1, 2] + c2 * u[i2, 2] + c3 * u[i3, 2]
        wish = -gap / dt
        if gap < 0.0:
            wish = min(PUSH * wish, FASTEST)
        if late or rx * ux + ry * uy + rz * uz >= wish or not counts:
            wish = -1.0e30
        fast = apart(plan, i1, plan, i0)
        fast = np.sqrt(max(fast, max(apart(plan, i2, plan, i0), apart(plan, i3, plan, i0))))
        if sort % 4 == 1 or sort % 4 == 3:
            other = max(apart(plan, i2, plan, i1), apart(plan, i3, plan, i1))
            fast = np.sqrt(max(max(apart(plan, i2, plan, i0), apart(plan, i3, plan, i0)), other))
        level[p], rate[p] = gap + time * fast + _strayed(strays, i0, i1, i2, i3), fast
        corner[k, 0], corner[k, 1], corner[k, 2], corner[k, 3] = i0, i1, i2, i3
        kind[k] = sort
        share[k, 0], share[k, 1], share[k, 2], share[k, 3] = c0, c1, c2, c3
        way[k, 0], way[k, 1], way[k, 2], way[k, 3] = rx, ry, rz, d
        aim[k] = wish
        k += 1
    return k - at


@njit(cache=True, nogil=True)
def press(
    starts, counts, corner, kind, share, way, aim, friction, inverse, rounds, u, which, impulse, crowd, spot, dt, came, ahead
):
    """Impulses of the contacts that press, `rounds` times, and what they do to velocities u; how many they are,
    and the farthest that any vertex goes by them [m], which is added to `ahead`.

    starts, counts: parts of the lists. came: u at the start. which (p,), impulse (p, 3): written. crowd, spot: 0 and -1 for each vertex, and again at the end."""
    m = 0
    for part in range(len(starts)):
        for k in range(starts[part], starts[part] + counts[part]):
            if aim[k] > -1.0e29:
                which[m] = k
                impulse[m] = 0.0
                m += 1
                for s in range(4):
                    crowd[corner[k, s]] += 1
    total, change = np.zeros((4 * m, 3)), np.empty((m, 3))
    place, touched, spots = np.empty((m, 4), np.int32), np.empty(4 * m, np.int32), 0
    for j in range(m):
        for s in range(4):
            i = corner[which[j], s]
            if spot[i] < 0:
                spot[i] = spots
                touched[spots] = i
                spots += 1
            place[j, s] = spot[i]
    for _ in range(rounds):
        for j in range(m):
            k = which[j]
            ease, a, b, c = 0.0, 0.0, 0.0, 0.0
            for s in range(4):
                i, w = corner[k, s], share[k, s]
                ease += w * w * (inverse[i] * crowd[i])
                a += w * u[i, 0]
                b += w * u[i, 1]
                c += w * u[i, 2]
            change[j] = 0.0
            if ease <= 0.0:
                continue
            nx, ny, nz = way[k, 0], way[k, 1], way[k, 2]
            along = a * nx + b * ny + c * nz
            ox, oy, oz = impulse[j, 0], impulse[j, 1], impulse[j, 2]
            before = ox * nx + oy * ny + oz * nz
            after = max(before + (aim[k] - along) / ease, 0.0)
            x = (ox - before * nx) - (a - along * nx) / ease
            y = (oy - before * ny) - (b - along * ny) / ease
            z = (oz - before * nz) - (c - along * nz) / ease
            most = friction[(kind[k] - 2) // 4 + 1 if kind[k] > 1 else 0] * after
            length = np.sqrt(x * x + y * y + z * z)
            if length > most:
                keep = most / length
                x, y, z = x * keep, y * keep, z * keep
            x, y, z = after * nx + x, after * ny + y, after * nz + z
            impulse[j, 0], impulse[j, 1], impulse[j, 2] = x, y, z
            change[j, 0], change[j, 1], change[j, 2] = x - ox, y - oy, z - oz
        total[:spots] = 0.0
        _give(m, which, share, place, change, total)
        for r in range(spots):
            i = touched[r]
            w = inverse[i]
            if w != 0.0:
                for e in range(3):
                    u[i, e] = u[i, e] + w * total[r, e]
    most = 0.0
    for r in range(spots):
        i = touched[r]
        crowd[i], spot[i] = 0, -1
        moved = dt * np.sqrt(apart(u, i, came, i))
        ahead[i] += moved
        most = max(most, moved)
    return m, most


@njit(cache=True, nogil=True)
def _give(count, which, share, place, given, total):
    """Add what contacts give to the sums of their vertices."""
    for j in range(count):
        k = which[j]
        for s in range(4):
            r = place[j, s]
            for e in range(3):
                total[r, e] += share[k, s] * given[j, e]


@njit(cache=True, nogil=True)
def lean(count, which, corner, share, impulse, inverse, reaction):
    """Add impulses on held vertices, which what holds them feels."""
    for j in range(count):
        k = which[j]
        for s in range(4):
            i = corner[k, s]
            if i < len(reaction) and inverse[i] == 0.0:
                for e in range(3):
                    reaction[i, e] += share[k, s] * impulse[j, e]


@njit(cache=True, nogil=True)
def tell(count, which, corner, kind, share, impulse, x, u, center, velocity, since, given, soft, felt, worked):
    """Add what each contact with a solid gave to it, and about its centre of mass, to `given` (bodies, 6); to vertices that move by
    themselves in `felt` (m, 3), with the work on them by body."""
    sheets = len(x) - len(felt)
    for j in range(count):
        k = which[j]
        if kind[k] < 2:
            continue
        b = (kind[k] - 2) // 4
        sign, px, py, pz = 1.0, 0.0, 0.0, 0.0
        if kind[k] % 4 == 0:
            i = corner[k, 0]
            px, py, pz = x[i, 0], x[i, 1], x[i, 2]
        else:
            sign = -1.0
            for s in range(4):
                w, i = share[k, s], corner[k, s]
                if w < 0.0:
                    px -= w * x[i, 0]
                    py -= w * x[i, 1]
                    pz -= w * x[i, 2]
        ox, oy, oz = sign * impulse[j, 0], sign * impulse[j, 1], sign * impulse[j, 2]
        ax, ay, az = (
            px - center[b, 0] - since * velocity[b, 0],
            py - center[b, 1] - since * velocity[b, 1],
            pz - center[b, 2] - since * velocity[b, 2],
        )
        given[b, 0] += ox
        given[b, 1] += oy
        given[b, 2] += oz
        given[b, 3] += ay * oz - az * oy
        given[b, 4] += az * ox - ax * oz
        given[b, 5] += ax * oy - ay * ox
        if soft:
            for s in range(4):
                i, w = corner[k, s], share[k, s]
                if i >= sheets:
                    work = 0.0
                    for e in range(3):
                        felt[i - sheets, e] += w * impulse[j, e]
                        work += impulse[j, e] * u[i, e]
                    worked[b] += w * work
