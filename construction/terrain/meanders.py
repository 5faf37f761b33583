"""Courses that wind between the ends of a line (Langbein & Leopold 1966, doi:10.3133/pp422H): the sine-generated curve."""

from __future__ import annotations

import numpy as np

from ...worlds.arrays import F64
from ...worlds.errors import InputError

__all__ = ["winding"]

STEPS = 48
"""Points of a course per bend pair."""
BELT = 0.8
"""Part of the floor that the bends take."""
LEAST_CELLS = 3.0
"""Least swing of a bend [cells]: smaller ones are noise of the grid."""
SMOOTH = 0.05
"""Length over which corners of the declared line are rounded, over its whole length."""


def winding(line: F64, *, sinuosity: float, half_floor: float, cell: float) -> F64:
    """A course from the first to the last point of a line, `sinuosity` times as long, within a distance of it; shape (n, 2) [m].

    Args:
        line: corners [m], shape (m, 2).
        sinuosity: length of the course over that of the line, > 1.
        half_floor: farthest that it may leave the line [m].
        cell: of the grid [m].

    Raises:
        InputError: the floor is too narrow or the line too short for bends that the grid can hold.
    """
    from scipy.optimize import brentq
    from scipy.special import j0

    # Direction of the course against the line: swing * cos(2 pi s); its mean advance per length is J0(swing).
    swing = brentq(lambda w: j0(w) - 1.0 / sinuosity, 0.0, 2.2)
    s = np.arange(STEPS + 1) / STEPS
    turn = swing * np.cos(2 * np.pi * s)
    ahead, aside = (np.concatenate([[0.0], np.cumsum(0.5 * (f[1:] + f[:-1]))]) / STEPS for f in (np.cos(turn), np.sin(turn)))
    ahead *= 1.0 / (sinuosity * ahead[-1])
    lengths = np.hypot(*np.diff(line, axis=0).T)
    total = float(lengths.sum())
    reach = BELT * half_floor
    pairs = max(1, int(np.ceil(total / (reach / np.abs(aside).max() * ahead[-1]))))
    scale = total / (pairs * ahead[-1])
    away = scale * float(np.abs(aside).max())
    if away < LEAST_CELLS * cell:
        raise InputError(
            f"a course of sinuosity {sinuosity:g} on a floor of {2 * half_floor:.3g} m swings {away:.3g} m to each side; cells of {cell:g} m need "
            f"{LEAST_CELLS * cell:.3g} m: widen /floor or /width, or lower /cell"
        )
    passed = np.concatenate([scale * (k * ahead[-1] + ahead[:-1]) for k in range(pairs)] + [[total]])
    offset = np.concatenate([np.tile(scale * aside[:-1], pairs), [0.0]])
    along = np.concatenate([[0.0], np.cumsum(lengths)])
    at = np.stack([np.interp(passed, along, line[:, k]) for k in (0, 1)], axis=1)
    return at + offset[:, None] * _normals(line, along, passed)


def _normals(line: F64, along: F64, passed: F64) -> F64:
    """Directions to the left of a line at lengths along it, its corners rounded; shape (n, 2)."""
    from scipy.ndimage import gaussian_filter1d

    even = np.linspace(0.0, along[-1], 400)
    points = np.stack([np.interp(even, along, line[:, k]) for k in (0, 1)], axis=1)
    points = gaussian_filter1d(points, SMOOTH * 400, axis=0, mode="nearest")
    way = np.gradient(points, axis=0)
    way /= np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-12)
    found = np.stack([np.interp(passed, even, -way[:, 1]), np.interp(passed, even, way[:, 0])], axis=1)
    return np.asarray(found / np.linalg.norm(found, axis=1, keepdims=True))
