"""Loops over horizons. Compiled by numba, kept on disk."""

from __future__ import annotations

import numpy as np
from numba import njit

__all__ = ["raise_horizons", "shine"]


@njit(cache=True, nogil=True)
def raise_horizons(height, far, edge, row_step, col_step, away, first, last, found):
    """Raise the horizons of one direction by what stands at one distance.

    Args:
        height: [m], shape (rows, cols), float32.
        far: what is looked at, with `edge` more cells on each side.
        edge: [cells]
        row_step: how far away it is [cells].
        col_step: how far away it is [cells].
        away: the same [m].
        first: row of `height` that row 0 of `found` belongs to.
        last: the row after the last.
        found: tangent of the horizon, shape (last - first, cols), raised in place.
    """
    cols = height.shape[1]
    scale = np.float32(1.0 / away)
    for r in range(first, last):
        start = edge + col_step
        low, high, own = height[r], far[edge + r + row_step, start : start + cols], found[r - first]
        for q in range(cols):
            tangent = (high[q] - low[q]) * scale
            own[q] = tangent if tangent > own[q] else own[q]


@njit(cache=True, nogil=True)
def shine(horizon, east, north, places, hours, beam):
    """Add the sun at each of its places to the hours and the energy of the beam.

    Args:
        horizon: tangents, shape (azimuths, rows, cols).
        east: slope of the ground [m/m], shape (rows, cols).
        north: the same.
        places: rows of (bearing in azimuths, tangent of the elevation, up, to east, to north, hours, energy).
        hours: [h], added to in place.
        beam: [MJ/m^2], added to in place.
    """
    azimuths, rows, cols = horizon.shape
    for p in range(places.shape[0]):
        bearing, tangent, up, to_east, to_north, length, strength = places[p]
        below = int(bearing)
        share = np.float32(bearing - below)
        one, two = horizon[below % azimuths], horizon[(below + 1) % azimuths]
        for r in range(rows):
            for q in range(cols):
                if (np.float32(1.0) - share) * one[r, q] + share * two[r, q] <= tangent:
                    e, n = east[r, q], north[r, q]
                    hours[r, q] += length
                    beam[r, q] += strength * max(up - e * to_east - n * to_north, 0.0) / np.sqrt(1.0 + e * e + n * n)
