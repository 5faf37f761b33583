"""Neighbours of each particle: how many, on which side, and how it moves against them. Compiled by numba, kept on disk.

Particles lie sorted by the key of their cell (z fastest), so that three cells in a column are one run of the arrays.
"""

import numpy as np
from numba import njit

__all__ = ["crests", "surroundings"]


@njit(cache=True, nogil=True)
def _runs(point, lower, size, dims, keys, first, last):
    """First and last (exclusive) index of the nine columns of cells around a point, into `first` and `last`."""
    x, y, z = int((point[0] - lower[0]) / size), int((point[1] - lower[1]) / size), int((point[2] - lower[2]) / size)
    n = 0
    for i in range(max(x - 1, 0), min(x + 2, dims[0])):
        for j in range(max(y - 1, 0), min(y + 2, dims[1])):
            base = (i * dims[1] + j) * dims[2]
            first[n] = np.searchsorted(keys, base + max(z - 1, 0))
            last[n] = np.searchsorted(keys, base + min(z + 2, dims[2]))
            n += 1
    return n


@njit(cache=True, nogil=True)
def surroundings(start, stop, position, velocity, lower, size, dims, keys, support, count, side, trapped):
    """Neighbours within `support`, mean direction away from them, and how fast they close in on each particle.

    `trapped` is the potential of trapped air, the sum of |v_ij| (1 - v_ij . x_ij) (1 - |x_ij| / support) with unit
    vectors in the bracket. Source: Ihmsen et al. (2012), doi:10.1007/s00371-012-0697-9, equation 2.
    """
    first, last = np.empty(9, np.int64), np.empty(9, np.int64)
    for i in range(start, stop):
        runs = _runs(position[i], lower, size, dims, keys, first, last)
        number, total, x, y, z = 0, 0.0, 0.0, 0.0, 0.0
        for r in range(runs):
            for j in range(first[r], last[r]):
                dx, dy, dz = position[i, 0] - position[j, 0], position[i, 1] - position[j, 1], position[i, 2] - position[j, 2]
                square = dx * dx + dy * dy + dz * dz
                if j == i or square >= support * support:
                    continue
                number += 1
                distance = np.sqrt(square)
                weight = 1.0 - distance / support
                inverse = weight / max(distance, 1e-12)
                x, y, z = x + dx * inverse, y + dy * inverse, z + dz * inverse
                u, v, w = velocity[i, 0] - velocity[j, 0], velocity[i, 1] - velocity[j, 1], velocity[i, 2] - velocity[j, 2]
                speed = np.sqrt(u * u + v * v + w * w)
                total += weight * (speed - (u * dx + v * dy + w * dz) / max(distance, 1e-12))
        count[i], trapped[i] = number, total
        side[i, 0], side[i, 1], side[i, 2] = x, y, z


@njit(cache=True, nogil=True)
def crests(start, stop, position, normal, lower, size, dims, keys, support, found):
    """Convexity of the surface: sum of (1 - n_i . n_j) (1 - |x_ij| / support) over neighbours that lie behind.

    Source: Ihmsen et al. (2012), equations 6 and 7. Particles inside the liquid have a normal of 0 and count for nothing.
    """
    first, last = np.empty(9, np.int64), np.empty(9, np.int64)
    for i in range(start, stop):
        found[i] = 0.0
        if normal[i, 0] == 0.0 and normal[i, 1] == 0.0 and normal[i, 2] == 0.0:
            continue
        runs = _runs(position[i], lower, size, dims, keys, first, last)
        total = 0.0
        for r in range(runs):
            for j in range(first[r], last[r]):
                dx, dy, dz = position[j, 0] - position[i, 0], position[j, 1] - position[i, 1], position[j, 2] - position[i, 2]
                square = dx * dx + dy * dy + dz * dz
                if j == i or square >= support * support:
                    continue
                along = normal[i, 0] * normal[j, 0] + normal[i, 1] * normal[j, 1] + normal[i, 2] * normal[j, 2]
                flat = normal[j, 0] * normal[j, 0] + normal[j, 1] * normal[j, 1] + normal[j, 2] * normal[j, 2]
                if flat == 0.0 or dx * normal[i, 0] + dy * normal[i, 1] + dz * normal[i, 2] >= 0.0:
                    continue
                total += (1.0 - along) * (1.0 - np.sqrt(square) / support)
        found[i] = total
