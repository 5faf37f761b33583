"""Winding numbers of large watertight meshes by counting the triangles over a point, with a grid across the ray."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F64

__all__ = ["RayGrid"]

TILT = (0.012_347, 0.017_891)
"""Slant of the ray against the thinnest axis: meshes made on grids are then not hit along their edges."""
AMBIGUOUS = 1e-11
"""Relative to the size: rays this close to an edge are left to the solid angle."""
CELLS = 512


class RayGrid:
    """Signed crossings of a ray; exact where the mesh is watertight."""

    def __init__(self, triangles: F64) -> None:
        points = triangles.reshape(-1, 3)
        extent = points.max(axis=0) - points.min(axis=0)
        axis = int(extent.argmin())
        ray = np.zeros(3)
        ray[axis], ray[axis - 2], ray[axis - 1] = 1.0, *TILT
        ray /= np.linalg.norm(ray)
        side = np.zeros(3)
        side[axis - 2] = 1.0
        side -= side @ ray * ray
        side /= np.linalg.norm(side)
        self._origin = 0.5 * (points.max(axis=0) + points.min(axis=0))
        self._frame = np.stack([side, np.cross(ray, side), ray])
        self._size = float(np.linalg.norm(extent))
        self._corners = (triangles - self._origin) @ self._frame.T
        flat = self._corners[..., :2]
        self._low = flat.min(axis=(0, 1))
        self._count = int(np.clip(np.sqrt(len(triangles)), 1, CELLS))
        self._cell = np.maximum((flat.max(axis=(0, 1)) - self._low) / self._count, np.finfo(float).tiny)
        first, last = self._cells(flat.min(axis=1)), self._cells(flat.max(axis=1))
        wide, high = (last - first + 1).T
        owner = np.repeat(np.arange(len(triangles)), wide * high)
        offset = np.arange(len(owner)) - np.repeat(np.cumsum(wide * high) - wide * high, wide * high)
        row, column = np.divmod(offset, wide[owner])
        key = (row + first[owner, 1]) * self._count + column + first[owner, 0]
        order = np.argsort(key, kind="stable")
        self._members = owner[order]
        self._start = np.searchsorted(key[order], np.arange(self._count**2 + 1))

    def _cells(self, flat: F64) -> NDArray[np.int64]:
        return np.asarray(np.clip((flat - self._low) / self._cell, 0, self._count - 1), dtype=np.int64)

    def winding(self, points: F64) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """Winding numbers, shape (n,), and which of them are doubtful because the ray grazes an edge."""
        local = (points - self._origin) @ self._frame.T
        cell = self._cells(local[:, :2])
        key = cell[:, 1] * self._count + cell[:, 0]
        count = self._start[key + 1] - self._start[key]
        owner = np.repeat(np.arange(len(points)), count)
        offset = np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)
        corner = self._corners[self._members[np.repeat(self._start[key], count) + offset]] - local[owner, None]
        x, y, z = corner[..., 0], corner[..., 1], corner[..., 2]
        edge = x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y
        length = np.hypot(np.roll(x, -1, axis=1) - x, np.roll(y, -1, axis=1) - y)
        margin = AMBIGUOUS * self._size * length
        sign = np.where((edge > 0.0).all(axis=1), 1, np.where((edge < 0.0).all(axis=1), -1, 0))
        area = edge.sum(axis=1)
        # Corner k is weighted by the edge opposite to it.
        height = np.einsum("nk,nk->n", np.roll(edge, -1, axis=1), z)
        above = np.where(area != 0.0, height / np.where(area != 0.0, area, 1.0), 0.0) > 0.0
        winding = np.zeros(len(points), dtype=np.int64)
        np.add.at(winding, owner, np.where(above, sign, 0))
        grazes = (np.abs(edge) <= margin).any(axis=1) & ((edge >= -margin).all(axis=1) | (edge <= margin).all(axis=1))
        return winding, np.bincount(owner, weights=grazes, minlength=len(points)) > 0
