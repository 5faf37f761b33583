"""Sums over the triangles of a liquid's surface. Compiled by numba, kept on disk."""

import numpy as np
from numba import njit

__all__ = ["components", "normals", "volumes"]


@njit(cache=True, nogil=True)
def normals(vertices, faces, total, share):
    """Add up, at each vertex, the area vectors of its faces into `total` (v, 3) and a third of their areas into `share` (v,)."""
    for f in range(len(faces)):
        i, j, k = faces[f, 0], faces[f, 1], faces[f, 2]
        ax, ay, az = vertices[j, 0] - vertices[i, 0], vertices[j, 1] - vertices[i, 1], vertices[j, 2] - vertices[i, 2]
        bx, by, bz = vertices[k, 0] - vertices[i, 0], vertices[k, 1] - vertices[i, 1], vertices[k, 2] - vertices[i, 2]
        x, y, z = 0.5 * (ay * bz - az * by), 0.5 * (az * bx - ax * bz), 0.5 * (ax * by - ay * bx)
        third = np.sqrt(x * x + y * y + z * z) / 3.0
        for n in (i, j, k):
            total[n, 0] += x
            total[n, 1] += y
            total[n, 2] += z
            share[n] += third


@njit(cache=True, nogil=True)
def volumes(vertices, faces, found):
    """Signed volumes (m,) of the tetrahedra between each face and the first vertex."""
    ox, oy, oz = vertices[0, 0], vertices[0, 1], vertices[0, 2]
    for f in range(len(faces)):
        i, j, k = faces[f, 0], faces[f, 1], faces[f, 2]
        ax, ay, az = vertices[i, 0] - ox, vertices[i, 1] - oy, vertices[i, 2] - oz
        bx, by, bz = vertices[j, 0] - ox, vertices[j, 1] - oy, vertices[j, 2] - oz
        cx, cy, cz = vertices[k, 0] - ox, vertices[k, 1] - oy, vertices[k, 2] - oz
        found[f] = (ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 6.0


@njit(cache=True, nogil=True)
def components(faces, root):
    """Write the smallest vertex of its connected piece to each vertex; `root` comes as 0, 1, 2, ..."""
    for f in range(len(faces)):
        for side in range(2):
            a, b = faces[f, side], faces[f, side + 1]
            while root[a] != a:
                root[a] = root[root[a]]
                a = root[a]
            while root[b] != b:
                root[b] = root[root[b]]
                b = root[b]
            root[max(a, b)] = min(a, b)
    for v in range(len(root)):
        root[v] = root[root[v]]
