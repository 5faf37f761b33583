"""Greatest values about cells, axis by axis. Compiled by numba, kept on disk."""

import numpy as np
from numba import njit

__all__ = ["most_near"]


@njit(cache=True, nogil=True)
def _greater(most, value):
    return value if value > most else most


@njit(cache=True, nogil=True)
def most_near(values, reach):
    """Greatest value within so many cells along each axis, of every cell; beyond the sides nothing is. All are numbers."""
    nx, ny, nz = values.shape
    one, two = np.empty_like(values), np.empty_like(values)
    for i in range(nx):
        one[i] = values[i]
        for a in range(max(i - reach, 0), min(i + reach, nx - 1) + 1):
            for j in range(ny):
                for k in range(nz):
                    one[i, j, k] = _greater(one[i, j, k], values[a, j, k])
    for i in range(nx):
        for j in range(ny):
            two[i, j] = one[i, j]
            for b in range(max(j - reach, 0), min(j + reach, ny - 1) + 1):
                for k in range(nz):
                    two[i, j, k] = _greater(two[i, j, k], one[i, b, k])
    for i in range(nx):
        for j in range(ny):
            for k in range(nz):
                one[i, j, k] = two[i, j, k]
            for c in range(1, min(reach, nz - 1) + 1):
                for k in range(nz - c):
                    one[i, j, k] = _greater(one[i, j, k], two[i, j, k + c])
                for k in range(c, nz):
                    one[i, j, k] = _greater(one[i, j, k], two[i, j, k - c])
    return one
