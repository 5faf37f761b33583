"""Coulomb's law for the impulses of one contact. Compiled by numba, kept on disk."""

from __future__ import annotations

import numpy as np
from numba import njit

__all__ = ["press", "rub"]

TURNS = 60
"""Most iterations for the direction in which a contact slides."""


@njit(cache=True, nogil=True)
def _slide(block, mu, free, normal, fixed, result):
    """Impulse of one contact that slides: `free` is its velocity without it; the normal impulse is `normal` where it is `fixed`.

    Friction opposes the slide that is left: found by turning its direction until both agree.
    """
    length = np.hypot(free[1], free[2])
    sx, sy = (free[1] / length, free[2] / length) if length > 0.0 else (1.0, 0.0)
    p = normal
    for _ in range(TURNS):
        if not fixed:
            stiff = block[0, 0] - mu * (block[0, 1] * sx + block[0, 2] * sy)
            p = -free[0] / stiff if stiff > 1e-3 * block[0, 0] else -free[0] / (1e-3 * block[0, 0])
        ux = free[1] + block[1, 0] * p * (0.0 if fixed else 1.0) - mu * p * (block[1, 1] * sx + block[1, 2] * sy)
        uy = free[2] + block[2, 0] * p * (0.0 if fixed else 1.0) - mu * p * (block[2, 1] * sx + block[2, 2] * sy)
        # A step along the slide keeps what friction works against; the length of the step is that which would stop it.
        most = mu * p * max(block[1, 1], block[2, 2])
        if most <= 0.0:
            break
        nx, ny = sx + ux / most, sy + uy / most
        length = np.hypot(nx, ny)
        if length < 1e-12:
            break
        nx, ny = nx / length, ny / length
        change = abs(nx - sx) + abs(ny - sy)
        sx, sy = nx, ny
        if change < 1e-12:
            break
    result[0], result[1], result[2] = p, -mu * p * sx, -mu * p * sy


@njit(cache=True, nogil=True)
def _stick(block, free, result):
    """Impulse that stops one contact altogether."""
    a, b, c = block[0, 0], block[0, 1], block[0, 2]
    d, e, f = block[1, 1], block[1, 2], block[2, 2]
    det = a * (d * f - e * e) - b * (b * f - c * e) + c * (b * e - c * d)
    if det <= 1e-14 * a * d * f:
        return False
    x, y, z = -free[0], -free[1], -free[2]
    result[0] = ((d * f - e * e) * x + (c * e - b * f) * y + (b * e - c * d) * z) / det
    result[1] = ((c * e - b * f) * x + (a * f - c * c) * y + (b * c - a * e) * z) / det
    result[2] = ((b * e - c * d) * x + (b * c - a * e) * y + (a * d - b * b) * z) / det
    return True


@njit(cache=True, nogil=True)
def press(block, mu, free, result):
    """Impulse of one contact without restitution, `free` being its velocity without it."""
    result[:] = 0.0
    if free[0] >= 0.0:
        return
    if mu <= 0.0:
        result[0] = -free[0] / block[0, 0]
        return
    if _stick(block, free, result) and result[0] >= 0.0 and np.hypot(result[1], result[2]) <= mu * result[0]:
        return
    _slide(block, mu, free, 0.0, False, result)


@njit(cache=True, nogil=True)
def rub(block, mu, free, normal, result):
    """Friction of one contact under a given normal impulse."""
    result[:] = 0.0
    if mu * normal <= 0.0:
        return
    det = block[1, 1] * block[2, 2] - block[1, 2] * block[1, 2]
    result[1] = (-free[1] * block[2, 2] + free[2] * block[1, 2]) / det
    result[2] = (-free[2] * block[1, 1] + free[1] * block[1, 2]) / det
    if np.hypot(result[1], result[2]) > mu * normal:
        _slide(block, mu, free, normal, True, result)
