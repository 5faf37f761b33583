"""Pairs of boxes that meet, by a sweep along one axis. Compiled by numba, kept on disk."""

import numpy as np
from numba import njit

__all__ = ["met_in_groups"]


@njit(cache=True, nogil=True)
def met_in_groups(low, high, order, first):
    """Pairs of boxes of one group that meet, shape (n, 2), in the order of the sweep.

    `order`: boxes, group after group, of each by its least corner along x; `first`: where each group begins in it, and the end.
    """
    found, count = np.empty((4 * len(order) + 64, 2), np.int64), 0
    for g in range(len(first) - 1):
        for p in range(first[g], first[g + 1]):
            i = order[p]
            for q in range(p + 1, first[g + 1]):
                j = order[q]
                if low[j, 0] > high[i, 0]:
                    break
                if low[i, 1] <= high[j, 1] and low[j, 1] <= high[i, 1] and low[i, 2] <= high[j, 2] and low[j, 2] <= high[i, 2]:
                    if count == len(found):
                        longer = np.empty((2 * len(found), 2), np.int64)
                        longer[:count] = found
                        found = longer
                    found[count, 0], found[count, 1] = min(i, j), max(i, j)
                    count += 1
    return found[:count].copy()
