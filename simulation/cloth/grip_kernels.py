"""Numba kernels of implicit steps with contacts: impulses by augmented Lagrangians, and conjugate gradients that feel them."""

from __future__ import annotations

import numpy as np
from numba import njit

from .solve_kernels import descend, dot, multiply, redirect, substitute

__all__ = ["agree", "answer", "clamp", "ease", "fails", "grip", "near_ones", "offer", "press", "pressing", "weigh"]


@njit(cache=True, nogil=True)
def near_ones(wanted, count):
    """Pairs that may press, (k,)."""
    found = np.empty(count, np.int32)
    k = 0
    for p in range(count):
        if wanted[p] > -1.0e29:
            found[k] = p
            k += 1
    return found[:k].copy()


@njit(cache=True, nogil=True)
def ease(which, pairs, share, inverse, hard, stiff):
    """Impulse [N s] of each contact for a relative velocity of 1 m/s, (k,): `hard` times the mass that both would move alone."""
    for k in range(len(which)):
        p = which[k]
        light = 0.0
        for c in range(4):
            light += share[p, c] * share[p, c] * inverse[pairs[p, c]]
        stiff[k] = hard / light if light > 0.0 else 0.0


@njit(cache=True, nogil=True)
def _change(pair, share, impulse, given, left):
    """Give a contact another impulse, and the difference to its vertices."""
    x, y, z = impulse
    for s in range(4):
        i = pair[s]
        if i < len(left):
            w = share[s]
            left[i, 0] += w * (x - given[0])
            left[i, 1] += w * (y - given[1])
            left[i, 2] += w * (z - given[2])
    given[0], given[1], given[2] = x, y, z


@njit(cache=True, nogil=True)
def offer(which, pairs, kinds, share, normal, wanted, friction, stiff, u, given, part, slide, left):
    """Impulses `given` (pairs, 3) as the contacts would have them now, into `left` too; which part of their stiffness they keep across
    the normal (k,): -1 where they do not press; and the way that those that slide go (k, 3), 0 where they stick."""
    for k in range(len(which)):
        p = which[k]
        a, b, c = 0.0, 0.0, 0.0
        for s in range(4):
            w, i = share[p, s], pairs[p, s]
            a += w * u[i, 0]
            b += w * u[i, 1]
            c += w * u[i, 2]
        nx, ny, nz = normal[p, 0], normal[p, 1], normal[p, 2]
        old = given[p, 0] * nx + given[p, 1] * ny + given[p, 2] * nz
        rate = a * nx + b * ny + c * nz
        press = old + stiff[k] * (wanted[p] - rate)
        x, y, z = 0.0, 0.0, 0.0
        part[k] = -1.0
        slide[k] = 0.0
        if press > 0.0 and stiff[k] > 0.0:
            x = given[p, 0] - old * nx - stiff[k] * (a - rate * nx)
            y = given[p, 1] - old * ny - stiff[k] * (b - rate * ny)
            z = given[p, 2] - old * nz - stiff[k] * (c - rate * nz)
            rub = np.sqrt(x * x + y * y + z * z)
            cap = _friction(friction, kinds[p, 0]) * press
            keep = 1.0
            if rub > cap:
                keep = cap / rub
                slide[k, 0], slide[k, 1], slide[k, 2] = x / rub, y / rub, z / rub
            part[k] = keep
            x, y, z = press * nx + keep * x, press * ny + keep * y, press * nz + keep * z
        _change(pairs[p], share[p], (x, y, z), given[p], left)


@njit(cache=True, nogil=True)
def _friction(friction, kind):
    """Friction coefficient of a kind of pair."""
    return friction[(kind - 2) // 4 + 1] if kind > 1 else friction[0]


@njit(cache=True, nogil=True)
def _slides(way):
    return way[0] != 0.0 or way[1] != 0.0 or way[2] != 0.0


@njit(cache=True, nogil=True)
def answer(which, vertex, value, d, part, given):
    """Impulses of the contacts that press (see `pressing`) after the velocities changed by d."""
    j = 0
    for k in range(len(which)):
        if part[k] < 0.0:
            continue
        x, y, z = _felt(vertex[j], value[j], d)
        p = which[k]
        given[p, 0] -= x
        given[p, 1] -= y
        given[p, 2] -= z
        j += 1


@njit(cache=True, nogil=True)
def fails(which, pairs, kinds, share, normal, wanted, friction, slide, u, given):
    """Largest relative speed by which a pair misses what it wants [m/s], and the share of all that presses by which impulses pull or rub
    too much."""
    most, total, over = 0.0, 0.0, 0.0
    for k in range(len(which)):
        p = which[k]
        rate = 0.0
        for s in range(4):
            i = pairs[p, s]
            rate += share[p, s] * (u[i, 0] * normal[p, 0] + u[i, 1] * normal[p, 1] + u[i, 2] * normal[p, 2])
        most = max(most, wanted[p] - rate)
        x, y, z = given[p, 0], given[p, 1], given[p, 2]
        press = x * normal[p, 0] + y * normal[p, 1] + z * normal[p, 2]
        rub = np.sqrt(max(x * x + y * y + z * z - press * press, 0.0))
        total += abs(press)
        off = rub - _friction(friction, kinds[p, 0]) * max(press, 0.0)
        over += max(-press, 0.0) + (abs(off) if _slides(slide[k]) else max(off, 0.0))
    return most, over / total if total > 0.0 else 0.0


@njit(cache=True, nogil=True)
def clamp(which, pairs, kinds, share, normal, friction, slide, given, left):
    """Take back impulses that pull, and what of others is more than friction bears; what is left over tells the vertices."""
    for k in range(len(which)):
        p = which[k]
        nx, ny, nz = normal[p, 0], normal[p, 1], normal[p, 2]
        press = given[p, 0] * nx + given[p, 1] * ny + given[p, 2] * nz
        x, y, z = 0.0, 0.0, 0.0
        if press > 0.0:
            x, y, z = given[p, 0] - press * nx, given[p, 1] - press * ny, given[p, 2] - press * nz
            rub = np.sqrt(x * x + y * y + z * z)
            cap = _friction(friction, kinds[p, 0]) * press
            keep = 1.0
            if rub > cap or (rub > 0.0 and _slides(slide[k])):
                keep = cap / rub
            x, y, z = press * nx + keep * x, press * ny + keep * y, press * nz + keep * z
        _change(pairs[p], share[p], (x, y, z), given[p], left)


@njit(cache=True, nogil=True)
def press(which, pairs, share, given, left):
    """Add impulses of contacts (pairs, 3) to those of the vertices."""
    for k in range(len(which)):
        p = which[k]
        for s in range(4):
            i = pairs[p, s]
            if i < len(left):
                for a in range(3):
                    left[i, a] += share[p, s] * given[p, a]


@njit(cache=True, nogil=True)
def pressing(which, pairs, share, normal, stiff, part, slide, count):
    """Contacts that press, side by side: vertices (k, 4), -1 for those of solids; shares, normal, way of sliding, stiffness along the
    normal and across it (k, 12)."""
    active = 0
    for k in range(len(which)):
        active += part[k] >= 0.0
    vertex, value = np.empty((active, 4), np.int32), np.empty((active, 12))
    j = 0
    for k in range(len(which)):
        if part[k] >= 0.0:
            p = which[k]
            for s in range(4):
                i = pairs[p, s]
                vertex[j, s] = i if i < count and share[p, s] != 0.0 else -1
                value[j, s] = share[p, s]
            for a in range(3):
                value[j, 4 + a] = normal[p, a]
                value[j, 7 + a] = slide[k, a]
            value[j, 10], value[j, 11] = stiff[k], stiff[k] * part[k]
            j += 1
    return vertex, value


@njit(cache=True, nogil=True)
def _felt(v, g, p):
    """Impulse against velocities p of a contact's vertices: stiff along the normal, and across it where it does not slide."""
    a, b, c = 0.0, 0.0, 0.0
    for s in range(4):
        i = v[s]
        if i >= 0:
            a += g[s] * p[i, 0]
            b += g[s] * p[i, 1]
            c += g[s] * p[i, 2]
    along = (g[10] - g[11]) * (a * g[4] + b * g[5] + c * g[6])
    off = g[11] * (a * g[7] + b * g[8] + c * g[9])
    return (
        g[11] * a + along * g[4] - off * g[7],
        g[11] * b + along * g[5] - off * g[8],
        g[11] * c + along * g[6] - off * g[9],
    )


@njit(cache=True, nogil=True)
def _pressed(vertex, value, p, out):
    for k in range(len(vertex)):
        v, g = vertex[k], value[k]
        x, y, z = _felt(v, g, p)
        for s in range(4):
            i = v[s]
            if i >= 0:
                out[i, 0] += g[s] * x
                out[i, 1] += g[s] * y
                out[i, 2] += g[s] * z


@njit(cache=True, nogil=True)
def agree(which, pairs, share, normal, stiff, part, place, frames, rest, room, weight):
    """Factor by which each free vertex moves less along its warp, weft and normal with its contacts than without, as if alone: square roots
    (free, 3), in the order of the factor. `rest` is the diagonal of what is factored."""
    room[:] = 0.0
    for k in range(len(which)):
        if part[k] < 0.0:
            continue
        p = which[k]
        for s in range(4):
            i = pairs[p, s]
            if i < len(room):
                own = share[p, s] * share[p, s] * stiff[k]
                f = frames[i]
                for a in range(3):
                    along = f[a, 0] * normal[p, 0] + f[a, 1] * normal[p, 1] + f[a, 2] * normal[p, 2]
                    room[i, a] += own * (part[k] + (1.0 - part[k]) * along * along)
    for j in range(len(place)):
        i = place[j]
        for a in range(3):
            weight[j, a] = np.sqrt(rest[j, a] / (rest[j, a] + room[i, a]))


@njit(cache=True, nogil=True, fastmath=True)
def _ready(factor, weight, r, room, z):
    place, frames, start, row, lower, pivot = factor
    count = len(place)
    for j in range(count):
        i = place[j]
        f = frames[i]
        for a in range(3):
            room[j, a] = weight[j, a] * (f[a, 0] * r[i, 0] + f[a, 1] * r[i, 1] + f[a, 2] * r[i, 2])
    substitute(start, row, lower, pivot, room)
    for j in range(count):
        i = place[j]
        f = frames[i]
        x, y, w = weight[j, 0] * room[j, 0], weight[j, 1] * room[j, 1], weight[j, 2] * room[j, 2]
        for a in range(3):
            z[i, a] = f[0, a] * x + f[1, a] * y + f[2, a] * w


@njit(cache=True, nogil=True)
def weigh(factor, r):
    """Square of what is left, measured by the sheets at rest."""
    z = np.zeros((len(r), 3))
    _ready(factor, np.ones((len(factor[0]), 3)), r, np.empty((len(factor[0]), 3), np.float32), z)
    return dot(r, z)


@njit(cache=True, nogil=True)
def grip(matrix, factor, contact, weight, r, d, aim, most):
    """Preconditioned conjugate gradients for (matrix + contacts) d = r, from d = 0; r becomes what is left, at held vertices too.

    Ends where the square of what is left, measured by the preconditioner, is `aim`. Steps taken."""
    room = np.empty((len(factor[0]), 3), np.float32)
    z, q = np.zeros_like(r), np.empty_like(r)
    _ready(factor, weight, r, room, z)
    p = z.copy()
    d[:] = 0.0
    now = dot(r, z)
    for step in range(most):
        if now <= aim or now <= 0.0:
            return step
        multiply(*matrix, p, q)
        _pressed(*contact, p, q)
        rate = now / dot(p, q)
        descend(rate, p, q, d, r)
        _ready(factor, weight, r, room, z)
        after = dot(r, z)
        redirect(after / now, z, p)
        now = after
    return most
