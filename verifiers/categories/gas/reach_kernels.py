"""Greatest values within the reach of cells, step by step. Compiled by numba, kept on disk."""

import numpy as np
from numba import njit

__all__ = ["widened"]


@njit(cache=True, nogil=True)
def _greater(most, value):
    """The greater of two numbers; not a number where one of them is none, as `numpy.maximum`."""
    return value if value > most or value != value else most


@njit(cache=True, nogil=True)
def _wider(values, walls, low, high, axis, out):
    """Greatest value of every cell and its two neighbours along an axis; nothing comes through walls."""
    nx, ny, nz = values.shape
    di, dj, dk = int(axis == 0), int(axis == 1), int(axis == 2)
    last = values.shape[axis] - 1
    for i in range(nx):
        for j in range(ny):
            for k in range(nz):
                at = i if axis == 0 else (j if axis == 1 else k)
                most = values[i, j, k]
                if at == 0:
                    most = _greater(most, low)
                elif not walls[i - di, j - dj, k - dk]:
                    most = _greater(most, values[i - di, j - dj, k - dk])
                if at == last:
                    most = _greater(most, high)
                elif not walls[i, j, k]:
                    most = _greater(most, values[i + di, j + dj, k + dk])
                out[i, j, k] = most


@njit(cache=True, nogil=True)
def widened(values, way, walls_x, walls_y, walls_z, beyond, steps):
    """Greatest value within so many cells along each axis, of each cell as far as its own `way` goes; shapes (nx, ny, nz)."""
    grown, one, other = values.copy(), np.empty_like(values), np.empty_like(values)
    for step in range(1, steps + 1):
        _wider(grown, walls_x, beyond[0], beyond[1], 0, one)
        _wider(one, walls_y, beyond[2], beyond[3], 1, other)
        _wider(other, walls_z, beyond[4], beyond[5], 2, one)
        for i in range(values.shape[0]):
            for j in range(values.shape[1]):
                for k in range(values.shape[2]):
                    if way[i, j, k] >= step:
                        grown[i, j, k] = one[i, j, k]
    return grown
