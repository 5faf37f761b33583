"""Loops along rays through cells. Compiled by numba, kept on disk."""

from __future__ import annotations

import math

from numba import njit

__all__ = ["march"]

OPAQUE = 12.0
"""Optical depth behind which nothing is seen."""


@njit(cache=True, nogil=True)
def _stretch(eye, way, low, high, near, far):
    """Where a ray enters a box and where it leaves it, within near..far; the first is not less where it misses."""
    for axis in range(3):
        if abs(way[axis]) < 1.0e-12:
            if eye[axis] < low[axis] or eye[axis] > high[axis]:
                return 1.0, 0.0
            continue
        a = (low[axis] - eye[axis]) / way[axis]
        b = (high[axis] - eye[axis]) / way[axis]
        near = max(near, min(a, b))
        far = min(far, max(a, b))
    return near, far


@njit(cache=True, nogil=True)
def march(sigma, source, box, cell, eyes, ways, spans, step, limit, tau, reach, gain):
    """Optical depth along rays, where it passes a limit, and the light that the gas sends back.

    Args:
        sigma: extinction at cell centres [1/m], float32, shape (nx, ny, nz); linear between them, constant beyond the outermost.
        source: radiance of gas that is thick there, shape (nx, ny, nz, 3); of no cells where none is wanted.
        box: its corners [m], shape (2, 3).
        cell: [m]
        eyes: where rays start [m], shape (n, 3) or (1, 3).
        ways: unit directions, shape (n, 3) or (1, 3).
        spans: first and last distance along each [m], shape (n, 2).
        step: longest between two looks [m].
        limit: optical depth whose place is asked for.
        tau: optical depth, added to, shape (n,).
        reach: distance at which `tau` passes the limit [m], lowered where it does, shape (n,).
        gain: radiance, added to, shape (n, 3).
    """
    last_x, last_y, last_z = sigma.shape[0] - 1, sigma.shape[1] - 1, sigma.shape[2] - 1
    shines = source.shape[0] > 0
    for p in range(spans.shape[0]):
        eye, way = eyes[p % eyes.shape[0]], ways[p % ways.shape[0]]
        first, last = _stretch(eye, way, box[0], box[1], spans[p, 0], spans[p, 1])
        if not last > first:
            continue
        count = math.ceil((last - first) / step)
        ds = (last - first) / count
        for k in range(count):
            t = first + (k + 0.5) * ds
            x = min(max((eye[0] + t * way[0] - box[0, 0]) / cell - 0.5, 0.0), float(last_x))
            y = min(max((eye[1] + t * way[1] - box[0, 1]) / cell - 0.5, 0.0), float(last_y))
            z = min(max((eye[2] + t * way[2] - box[0, 2]) / cell - 0.5, 0.0), float(last_z))
            i, j, m = int(x), int(y), int(z)
            fx, fy, fz = x - i, y - j, z - m
            ii, jj, mm = min(i + 1, last_x), min(j + 1, last_y), min(m + 1, last_z)
            a, b = (1.0 - fx) * (1.0 - fy), (1.0 - fx) * fy
            c, d = fx * (1.0 - fy), fx * fy
            s = (1.0 - fz) * (a * sigma[i, j, m] + b * sigma[i, jj, m] + c * sigma[ii, j, m] + d * sigma[ii, jj, m])
            s += fz * (a * sigma[i, j, mm] + b * sigma[i, jj, mm] + c * sigma[ii, j, mm] + d * sigma[ii, jj, mm])
            if s <= 0.0:
                continue
            passed = tau[p]
            tau[p] = passed + s * ds
            if passed < limit <= tau[p]:
                reach[p] = min(reach[p], t - 0.5 * ds + (limit - passed) / s)
            if shines:
                share = math.exp(-passed) - math.exp(-tau[p])
                for h in range(3):
                    low = a * source[i, j, m, h] + b * source[i, jj, m, h] + c * source[ii, j, m, h] + d * source[ii, jj, m, h]
                    up = a * source[i, j, mm, h] + b * source[i, jj, mm, h] + c * source[ii, j, mm, h] + d * source[ii, jj, mm, h]
                    gain[p, h] += share * ((1.0 - fz) * low + fz * up)
            if tau[p] > OPAQUE:
                break
