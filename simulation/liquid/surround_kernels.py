"""Sums over the particles near a place: neighbours, their side and motion, means of their values. Compiled by numba, kept on disk.

Particles lie sorted by the key of their cell (z fastest), so that the cells of a column are one run of the arrays.
"""

import numpy as np
from numba import njit

__all__ = ["carried", "crests", "crowding", "surroundings"]


@njit(cache=True, nogil=True)
def _runs(point, lower, size, dims, keys, reach, first, last, here):
    """First and last (exclusive) index of the columns of cells within `reach` cells of a point, into `first` and `last`.

    `here` holds cell and number of columns of the point before: its neighbour in the same cell has the same ones.
    """
    x, y = int(np.floor((point[0] - lower[0]) / size)), int(np.floor((point[1] - lower[1]) / size))
    z = int(np.floor((point[2] - lower[2]) / size))
    if here[0] == x and here[1] == y and here[2] == z:
        return here[3]
    low, high = max(z - reach, 0), max(min(z + reach + 1, dims[2]), 0)
    n = 0
    for i in range(max(x - reach, 0), min(x + reach + 1, dims[0])):
        for j in range(max(y - reach, 0), min(y + reach + 1, dims[1])):
            base = (i * dims[1] + j) * dims[2]
            first[n] = np.searchsorted(keys, base + low)
            last[n] = np.searchsorted(keys, base + high)
            n += 1
    here[0], here[1], here[2], here[3] = x, y, z, n
    return n


@njit(cache=True, nogil=True)
def surroundings(start, stop, position, velocity, lower, size, dims, keys, support, count, side, trapped):
    """Neighbours within `support`, mean direction away from them, and how fast they close in on each particle.

    `trapped` is the potential of trapped air, the sum of |v_ij| (1 - v_ij . x_ij) (1 - |x_ij| / support) with unit
    vectors in the bracket. Source: Ihmsen et al. (2012), doi:10.1007/s00371-012-0697-9, equation 2.
    """
    first, last, here = np.empty(9, np.int64), np.empty(9, np.int64), np.full(4, -1)
    for i in range(start, stop):
        runs = _runs(position[i], lower, size, dims, keys, 1, first, last, here)
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
    first, last, here = np.empty(9, np.int64), np.empty(9, np.int64), np.full(4, -1)
    for i in range(start, stop):
        found[i] = 0.0
        if normal[i, 0] == 0.0 and normal[i, 1] == 0.0 and normal[i, 2] == 0.0:
            continue
        runs = _runs(position[i], lower, size, dims, keys, 1, first, last, here)
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


@njit(cache=True, nogil=True)
def crowding(start, stop, position, lower, size, dims, keys, reach, enough, found):
    """Sum of 1 - (distance / support)^2 over the neighbours of each particle within `reach` cells, up to `enough`.

    Source: Loeschner et al. (2023), doi:10.1111/cgf.14769: the number of neighbours that weights the smoothing.
    """
    first, last, here = np.empty((2 * reach + 1) ** 2, np.int64), np.empty((2 * reach + 1) ** 2, np.int64), np.full(4, -1)
    support = (reach * size) ** 2
    for i in range(start, stop):
        runs = _runs(position[i], lower, size, dims, keys, reach, first, last, here)
        total = 0.0
        for r in range(runs):
            for j in range(first[r], last[r]):
                dx, dy, dz = position[i, 0] - position[j, 0], position[i, 1] - position[j, 1], position[i, 2] - position[j, 2]
                square = dx * dx + dy * dy + dz * dz
                if j != i and square < support:
                    total += 1.0 - square / support
            if total >= enough:
                break
        found[i] = min(total, enough)


@njit(cache=True, nogil=True)
def carried(start, stop, points, position, values, lower, size, dims, keys, reach, found):
    """Means of the particles' values (n, c) at points, weighted by the cubic spline of `reach` cells; 0 where none is near."""
    first, last, here = np.empty((2 * reach + 1) ** 2, np.int64), np.empty((2 * reach + 1) ** 2, np.int64), np.full(4, -1)
    support, total = reach * size, np.empty(values.shape[1])
    for i in range(start, stop):
        runs = _runs(points[i], lower, size, dims, keys, reach, first, last, here)
        weights = 0.0
        total[:] = 0.0
        for r in range(runs):
            for j in range(first[r], last[r]):
                dx, dy, dz = points[i, 0] - position[j, 0], points[i, 1] - position[j, 1], points[i, 2] - position[j, 2]
                square = dx * dx + dy * dy + dz * dz
                if square >= support * support:
                    continue
                q = np.sqrt(square) / support
                weight = 1.0 - 6.0 * q * q * (1.0 - q) if q < 0.5 else 2.0 * (1.0 - q) ** 3
                weights += weight
                for c in range(len(total)):
                    total[c] += weight * values[j, c]
        for c in range(len(total)):
            found[i, c] = total[c] / weights if weights > 0.0 else 0.0
