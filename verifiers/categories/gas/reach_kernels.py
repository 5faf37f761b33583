"""Greatest values within the reach of cells, step by step. Compiled by numba, kept on disk."""

import numpy as np
from numba import njit

__all__ = ["widened"]


@njit(cache=True, nogil=True)
def _greater(most, value):
    """The greater of two numbers; not a number where one of them is none, as `numpy.maximum`."""
    return value if value > most or value != value else most


@njit(cache=True, nogil=True)
def _wider_planes(values, walls, low, high, out):
    """Greatest value of every cell and its two neighbours along the first axis; nothing comes through walls."""
    nx, ny, nz = values.shape
    for i in range(nx):
        for j in range(ny):
            for k in range(nz):
                most = values[i, j, k]
                before = low if i == 0 else (most if walls[i - 1, j, k] else values[i - 1, j, k])
                most = _greater(most, before)
                after = high if i == nx - 1 else (most if walls[i, j, k] else values[i + 1, j, k])
                out[i, j, k] = _greater(most, after)


@njit(cache=True, nogil=True)
def _wider_rows(values, walls, low, high, out):
    """The same along the second axis."""
    nx, ny, nz = values.shape
    for i in range(nx):
        for j in range(ny):
            for k in range(nz):
                most = values[i, j, k]
                before = low if j == 0 else (most if walls[i, j - 1, k] else values[i, j - 1, k])
                most = _greater(most, before)
                after = high if j == ny - 1 else (most if walls[i, j, k] else values[i, j + 1, k])
                out[i, j, k] = _greater(most, after)


@njit(cache=True, nogil=True)
def _wider_cells(values, walls, low, high, out):
    """The same along the third axis."""
    nx, ny, nz = values.shape
    for i in range(nx):
        for j in range(ny):
            out[i, j, 0] = _greater(values[i, j, 0], low)
            for k in range(1, nz):
                most = values[i, j, k]
                out[i, j, k] = _greater(most, most if walls[i, j, k - 1] else values[i, j, k - 1])
            for k in range(nz - 1):
                most = out[i, j, k]
                out[i, j, k] = _greater(most, most if walls[i, j, k] else values[i, j, k + 1])
            out[i, j, nz - 1] = _greater(out[i, j, nz - 1], high)


@njit(cache=True, nogil=True)
def widened(values, way, walls_x, walls_y, walls_z, beyond, steps):
    """Greatest value within so many cells along each axis, of each cell as far as its own `way` goes; shapes (nx, ny, nz)."""
    grown, one, other = values.copy(), np.empty_like(values), np.empty_like(values)
    for step in range(1, steps + 1):
        _wider_planes(grown, walls_x, beyond[0], beyond[1], one)
        _wider_rows(one, walls_y, beyond[2], beyond[3], other)
        _wider_cells(other, walls_z, beyond[4], beyond[5], one)
        for i in range(values.shape[0]):
            for j in range(values.shape[1]):
                for k in range(values.shape[2]):
                    grown[i, j, k] = one[i, j, k] if way[i, j, k] >= step else grown[i, j, k]
    return grown
