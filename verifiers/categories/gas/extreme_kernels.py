"""Cells that are farthest beyond what they may hold. Compiled by numba, kept on disk.

Each gives the greatest excess and the first cell that has it, in the order of memory; 0 and the first cell where none is beyond.
"""

import numpy as np
from numba import njit

__all__ = ["extremes", "hottest_beyond", "out_of_reach", "sootiest_beyond"]


@njit(cache=True, nogil=True)
def out_of_reach(held, room, sliver, highest, lowest):
    """Excess above the highest and below the lowest, given with its sign turned, of cells with more room than a sliver."""
    held, room, highest, lowest = held.ravel(), room.ravel(), highest.ravel(), lowest.ravel()
    over, under, first, second = 0.0, 0.0, 0, 0
    for n in range(held.size):
        if room[n] > sliver:
            above, below = held[n] - highest[n], -lowest[n] - held[n]
            if above > over and above < np.inf:
                over, first = above, n
            if below > under and below < np.inf:
                under, second = below, n
    return over, first, under, second


@njit(cache=True, nogil=True)
def extremes(values, room):
    """Least and greatest value of open cells; infinite where there are none."""
    values, room = values.ravel(), room.ravel()
    least, most = np.inf, -np.inf
    for n in range(values.size):
        if room[n] > 0.0:
            least, most = min(least, np.float64(values[n])), max(most, np.float64(values[n]))
    return least, most


@njit(cache=True, nogil=True)
def hottest_beyond(light, room, low, high, span):
    """Lightness of open cells below the low or above the high, over a span."""
    light, room = light.ravel(), room.ravel()
    most, first = 0.0, 0
    for n in range(light.size):
        if room[n] > 0.0:
            off = max(low - light[n], light[n] - high) / span
            if off > most:
                most, first = off, n
    return most, first


@njit(cache=True, nogil=True)
def sootiest_beyond(soot, room, high, span):
    """Soot of open cells below none or above the high, over a span, all in single precision."""
    soot, room = soot.ravel(), room.ravel()
    most, first = np.float32(0.0), 0
    for n in range(soot.size):
        if room[n] > 0.0:
            off = max(-soot[n], soot[n] - high) / span
            if off > most:
                most, first = off, n
    return most, first
