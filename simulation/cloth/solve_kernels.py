"""Numba kernels of the linear system of an implicit step: products, triangular solves and conjugate gradients."""

from __future__ import annotations

import numpy as np
from numba import njit

__all__ = ["descend", "dot", "gradients", "multiply", "precondition", "redirect", "substitute", "turned"]


@njit(cache=True, nogil=True)
def multiply(diagonal, start, column, block, bend_start, bend_column, bend, p, out):
    """out = matrix p: 3 x 3 blocks of the upper half and scalars of bending, the upper half too; (n, 3)."""
    for i in range(len(p)):
        d = diagonal[i]
        for a in range(3):
            out[i, a] = d[a, 0] * p[i, 0] + d[a, 1] * p[i, 1] + d[a, 2] * p[i, 2]
    for i in range(len(p)):
        x, y, z = p[i, 0], p[i, 1], p[i, 2]
        s0 = s1 = s2 = 0.0
        for k in range(start[i], start[i + 1]):
            j = column[k]
            b = block[k]
            q0, q1, q2 = p[j, 0], p[j, 1], p[j, 2]
            s0 += b[0, 0] * q0 + b[0, 1] * q1 + b[0, 2] * q2
            s1 += b[1, 0] * q0 + b[1, 1] * q1 + b[1, 2] * q2
            s2 += b[2, 0] * q0 + b[2, 1] * q1 + b[2, 2] * q2
            out[j, 0] += b[0, 0] * x + b[1, 0] * y + b[2, 0] * z
            out[j, 1] += b[0, 1] * x + b[1, 1] * y + b[2, 1] * z
            out[j, 2] += b[0, 2] * x + b[1, 2] * y + b[2, 2] * z
        for k in range(bend_start[i], bend_start[i + 1]):
            j = bend_column[k]
            c = bend[k]
            s0 += c * p[j, 0]
            s1 += c * p[j, 1]
            s2 += c * p[j, 2]
            out[j, 0] += c * x
            out[j, 1] += c * y
            out[j, 2] += c * z
        out[i, 0] += s0
        out[i, 1] += s1
        out[i, 2] += s2


@njit(cache=True, nogil=True, fastmath=True)
def substitute(start, row, lower, pivot, room):
    """room = (L D L^T)^-1 room, three scalar factors of one pattern side by side, (n, 3)."""
    count = len(room)
    for j in range(count):
        x, y, w = room[j, 0], room[j, 1], room[j, 2]
        for k in range(start[j], start[j + 1]):
            i = row[k]
            room[i, 0] -= lower[k, 0] * x
            room[i, 1] -= lower[k, 1] * y
            room[i, 2] -= lower[k, 2] * w
    for j in range(count - 1, -1, -1):
        x, y, w = room[j, 0] * pivot[j, 0], room[j, 1] * pivot[j, 1], room[j, 2] * pivot[j, 2]
        for k in range(start[j], start[j + 1]):
            i = row[k]
            x -= lower[k, 0] * room[i, 0]
            y -= lower[k, 1] * room[i, 1]
            w -= lower[k, 2] * room[i, 2]
        room[j, 0] = x
        room[j, 1] = y
        room[j, 2] = w


@njit(cache=True, nogil=True, fastmath=True)
def precondition(place, frames, start, row, lower, pivot, r, room, z):
    """z = frames^T (L D L^T)^-1 frames r of the free vertices, three scalar factors of one pattern side by side; 0 elsewhere.

    place[j] is the vertex in row j of the factor."""
    count = len(place)
    for j in range(count):
        i = place[j]
        f = frames[i]
        for a in range(3):
            room[j, a] = f[a, 0] * r[i, 0] + f[a, 1] * r[i, 1] + f[a, 2] * r[i, 2]
    substitute(start, row, lower, pivot, room)
    for j in range(count):
        i = place[j]
        f = frames[i]
        for a in range(3):
            z[i, a] = f[0, a] * room[j, 0] + f[1, a] * room[j, 1] + f[2, a] * room[j, 2]


@njit(cache=True, nogil=True)
def dot(a, b):
    """Scalar product of two lists of vectors."""
    total = 0.0
    for i in range(len(a)):
        total += a[i, 0] * b[i, 0] + a[i, 1] * b[i, 1] + a[i, 2] * b[i, 2]
    return total


@njit(cache=True, nogil=True)
def descend(rate, p, q, d, r):
    """Take a step along p, which the matrix makes q of: the solution d gains by it, what is left r loses."""
    for i in range(len(r)):
        for a in range(3):
            d[i, a] += rate * p[i, a]
            r[i, a] -= rate * q[i, a]


@njit(cache=True, nogil=True)
def redirect(share, z, p):
    """The next direction: z, and a share of the last one."""
    for i in range(len(p)):
        for a in range(3):
            p[i, a] = z[i, a] + share * p[i, a]


@njit(cache=True, nogil=True)
def gradients(matrix, factor, r, d, tolerance, most):
    """Preconditioned conjugate gradients for matrix d = r, from d = 0; r becomes what is left, at held vertices too.

    Ends where what is left, measured by the preconditioner, is `tolerance` of what it was. Steps taken."""
    room = np.empty((len(factor[0]), 3), np.float32)
    z, q = np.zeros_like(r), np.empty_like(r)
    precondition(*factor, r, room, z)
    p = z.copy()
    d[:] = 0.0
    now = dot(r, z)
    aim = tolerance * tolerance * now
    for step in range(most):
        if now <= aim or now <= 0.0:
            return step
        multiply(*matrix, p, q)
        rate = now / dot(p, q)
        descend(rate, p, q, d, r)
        precondition(*factor, r, room, z)
        after = dot(r, z)
        redirect(after / now, z, p)
        now = after
    return most


@njit(cache=True, nogil=True)
def turned(edges, length, change):
    """Largest difference of velocities across an edge over its length [1/s]."""
    most = 0.0
    for k in range(len(edges)):
        a, b = edges[k]
        square = 0.0
        for c in range(3):
            apart = change[a, c] - change[b, c]
            square += apart * apart
        most = max(most, square / (length[k] * length[k]))
    return np.sqrt(most)
