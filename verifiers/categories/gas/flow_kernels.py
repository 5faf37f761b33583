"""Velocities of cells, what they let out and what passes their faces, cell by cell. Compiled by numba, kept on disk.

Sums and products are taken in the order of the formulas that `flow.py` and `transport.py` tell, so that they round alike on every machine.
"""

import numpy as np
from numba import njit

__all__ = ["blurred", "driven", "mirrored", "moving", "netted", "through"]


@njit(cache=True, nogil=True)
def mirrored(velocity, closed):
    """Velocities with one more cell beyond each side, in double precision; `closed`: whether nothing passes a side, by side."""
    nx, ny, nz = velocity.shape[:3]
    out = np.empty((nx + 2, ny + 2, nz + 2, 3))
    for i in range(nx + 2):
        a = min(max(i - 1, 0), nx - 1)
        for j in range(ny + 2):
            b = min(max(j - 1, 0), ny - 1)
            for k in range(nz + 2):
                c = min(max(k - 1, 0), nz - 1)
                for axis in range(3):
                    out[i, j, k, axis] = np.float64(velocity[a, b, c, axis])
    for axis in range(3):
        for end in range(2):
            count = out.shape[axis]
            at = count - 1 if end else 0
            across, along = (axis + 1) % 3, (axis + 2) % 3
            for p in range(out.shape[across]):
                for q in range(out.shape[along]):
                    i = at if axis == 0 else (p if across == 0 else q)
                    j = at if axis == 1 else (p if across == 1 else q)
                    k = at if axis == 2 else (p if across == 2 else q)
                    if closed[2 * axis + end]:
                        out[i, j, k, axis] *= -1.0
                    else:
                        for other in range(3):
                            out[i, j, k, other] = np.nan
    return out


@njit(cache=True, nogil=True)
def _mean(low, middle, high):
    return 0.25 * (low + 2.0 * middle + high)


@njit(cache=True, nogil=True)
def netted(velocity, width):
    """Net outflow per volume of inner cells; `width`: two cells. Along each axis in turn a difference, or a mean weighted 1, 2, 1."""
    nx, ny, nz = velocity.shape[0] - 2, velocity.shape[1] - 2, velocity.shape[2] - 2
    total = np.zeros((nx, ny, nz))
    one, two = np.empty((ny + 2, nz + 2)), np.empty((ny, nz + 2))
    for axis in range(3):
        for i in range(nx):
            for j in range(ny + 2):
                for k in range(nz + 2):
                    low, middle, high = velocity[i, j, k, axis], velocity[i + 1, j, k, axis], velocity[i + 2, j, k, axis]
                    one[j, k] = (high - low) / width if axis == 0 else _mean(low, middle, high)
            for j in range(ny):
                for k in range(nz + 2):
                    low, middle, high = one[j, k], one[j + 1, k], one[j + 2, k]
                    two[j, k] = (high - low) / width if axis == 1 else _mean(low, middle, high)
            for j in range(ny):
                for k in range(nz):
                    low, middle, high = two[j, k], two[j, k + 1], two[j, k + 2]
                    total[i, j, k] += (high - low) / width if axis == 2 else _mean(low, middle, high)
    return total


@njit(cache=True, nogil=True)
def blurred(values):
    """Means of cells and their neighbours, weighted 1, 2, 1 along each axis; beyond the sides as along them."""
    nx, ny, nz = values.shape
    out = np.empty((nx, ny, nz))
    one, two = np.empty((ny, nz)), np.empty((ny, nz))
    for i in range(nx):
        low, high = max(i - 1, 0), min(i + 1, nx - 1)
        for j in range(ny):
            for k in range(nz):
                one[j, k] = _mean(values[low, j, k], values[i, j, k], values[high, j, k])
        for j in range(ny):
            before, after = max(j - 1, 0), min(j + 1, ny - 1)
            for k in range(nz):
                two[j, k] = _mean(one[before, k], one[j, k], one[after, k])
        for j in range(ny):
            for k in range(nz):
                out[i, j, k] = _mean(two[j, max(k - 1, 0)], two[j, k], two[j, min(k + 1, nz - 1)])
    return out


@njit(cache=True, nogil=True)
def moving(half, density, room, velocity):
    """Energy of motion of cells; `half`: half of their volume."""
    out = np.empty(density.shape)
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            for k in range(out.shape[2]):
                x, y, z = velocity[i, j, k, 0], velocity[i, j, k, 1], velocity[i, j, k, 2]
                out[i, j, k] = half * density[i, j, k] * room[i, j, k] * (x * x + y * y + z * z)
    return out


@njit(cache=True, nogil=True)
def driven(soot, light, air, room, volume):
    """Mass of cells beyond that of ambient air [kg]; `air`: its density."""
    out = np.empty(light.shape)
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            for k in range(out.shape[2]):
                out[i, j, k] = (soot[i, j, k] - air * light[i, j, k]) * room[i, j, k] * volume
    return out


@njit(cache=True, nogil=True)
def through(amount, velocity, axis):
    """Moment along an axis that passes the faces between cells, each taken from the cell that the gas there comes from."""
    di, dj, dk = int(axis == 0), int(axis == 1), int(axis == 2)
    nx, ny, nz = amount.shape[0] - di, amount.shape[1] - dj, amount.shape[2] - dk
    out = np.empty((nx, ny, nz))
    for i in range(nx):
        for j in range(ny):
            for k in range(nz):
                one, other = velocity[i, j, k, axis], velocity[i + di, j + dj, k + dk, axis]
                middle = 0.5 * (np.float64(one) + np.float64(other))
                out[i, j, k] = (amount[i, j, k] if middle > 0.0 else amount[i + di, j + dj, k + dk]) * middle
    return out
