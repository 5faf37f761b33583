"""Gradient noise. Compiled by numba, kept on disk."""

from __future__ import annotations

import numpy as np
from numba import njit

__all__ = ["gradient"]

GOLDEN = 2.399963229728653
"""Golden angle [rad]."""
SHIFT_X, SHIFT_Y = 0.7548776662466927, 0.5698402909980532
"""Additive recurrence with the lowest discrepancy in two dimensions (Roberts 2018)."""
MASK = 0xFFFFFFFF


@njit(cache=True)
def _angle(i, j, seed):
    """Direction of the gradient at a lattice point [rad]: a mix of 32-bit words."""
    h = ((i & MASK) * 0x9E3779B1 & MASK) ^ ((j & MASK) * 0x85EBCA77 & MASK) ^ (seed & MASK)
    h ^= h >> 15
    h = h * 0x2C1B3C6D & MASK
    h ^= h >> 12
    h = h * 0x297A2D39 & MASK
    h ^= h >> 15
    return h * (2.0 * np.pi / 4294967296.0)


@njit(cache=True, nogil=True)
def gradient(x, y, wavelength, seed):
    """Noise of one wavelength at points x, y [m], shape (n,).

    The lattice is turned and shifted by the seed, so that its points, where the noise is zero, share no direction
    between octaves.
    """
    c, s = np.cos(seed * GOLDEN), np.sin(seed * GOLDEN)
    shift_x, shift_y = seed * SHIFT_X % 1.0, seed * SHIFT_Y % 1.0
    mixed = seed * 0x27D4EB2F & MASK
    out = np.empty(x.size)
    last_i, last_j, known = 0, 0, False
    ax = ay = bx = by = cx = cy = dx = dy = 0.0
    for k in range(x.size):
        u = (c * x[k] + s * y[k]) / wavelength + shift_x
        v = (c * y[k] - s * x[k]) / wavelength + shift_y
        i, j = int(np.floor(u)), int(np.floor(v))
        p, q = u - i, v - j
        ease_p, ease_q = p * p * p * (p * (p * 6.0 - 15.0) + 10.0), q * q * q * (q * (q * 6.0 - 15.0) + 10.0)
        if not known or i != last_i or j != last_j:  # neighbours often share the lattice cell
            a, b = _angle(i, j, mixed), _angle(i + 1, j, mixed)
            ax, ay, bx, by = np.cos(a), np.sin(a), np.cos(b), np.sin(b)
            a, b = _angle(i, j + 1, mixed), _angle(i + 1, j + 1, mixed)
            cx, cy, dx, dy = np.cos(a), np.sin(a), np.cos(b), np.sin(b)
            last_i, last_j, known = i, j, True
        south = (ax * p + ay * q) * (1.0 - ease_p) + (bx * (p - 1.0) + by * q) * ease_p
        north = (cx * p + cy * (q - 1.0)) * (1.0 - ease_p) + (dx * (p - 1.0) + dy * (q - 1.0)) * ease_p
        out[k] = np.sqrt(2.0) * (south + ease_q * (north - south))
    return out
