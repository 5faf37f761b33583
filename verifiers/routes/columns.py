"""Triangles of a scene in vertical columns: what a walker's grid cell contains, from the lowest surface to the highest.

Every cell of a square grid in the xy plane keeps the *pieces* of all triangles that reach into it (clipped to the
cell, so that thin walls are never missed) and the *hits* of the vertical line through its centre.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64, cross
from .bounds import SEAM, VERTICAL

__all__ = ["Columns", "Grid", "Hits", "Ints", "Pieces", "Soup", "expand", "heights_of", "rasterise"]

Ints = NDArray[np.intp]


class Soup(NamedTuple):
    """World triangles of many entities at one frame."""

    triangles: F64
    """Corners [m], shape (t, 3, 3)."""
    owner: Ints
    """Index of the entity, shape (t,)."""
    closed: NDArray[np.bool_]
    """True where the triangle belongs to a closed surface, shape (t,)."""
    solid: NDArray[np.bool_]
    """True where it collides: what is only drawn carries nobody, shape (t,)."""


@dataclass(frozen=True)
class Grid:
    """Square cells; cell (i, j) has its centre at origin + (i + 1/2, j + 1/2) cell and the flat index i * ny + j."""

    origin: F64
    """Lower corner [m], shape (2,)."""
    cell: float
    """[m]"""
    nx: int
    ny: int

    def centers(self, cells: Ints) -> F64:
        """Centres of flat cells [m], shape (n, 2)."""
        return np.asarray(self.origin + self.cell * (np.stack([cells // self.ny, cells % self.ny], axis=-1) + 0.5))

    def cells_of(self, points: F64) -> Ints:
        """Flat cell of each point, shape (n,); -1 outside."""
        index = np.floor((points - self.origin) / self.cell).astype(np.intp)
        inside = (index >= 0).all(axis=1) & (index[:, 0] < self.nx) & (index[:, 1] < self.ny)
        return np.where(inside, index[:, 0] * self.ny + index[:, 1], -1)

    def reach(self, triangles: F64) -> tuple[Ints, Ints]:
        """Column and line of the first and of the last cell that triangles reach into, shape (t, 2) each; last < first outside the grid."""
        a, b, c = (triangles[:, k, :2] for k in range(3))
        low = np.floor((np.minimum(np.minimum(a, b), c) - self.origin) / self.cell - SEAM).astype(np.intp)
        high = np.floor((np.maximum(np.maximum(a, b), c) - self.origin) / self.cell + SEAM).astype(np.intp)
        return np.maximum(low, 0), np.minimum(high, [self.nx - 1, self.ny - 1])


class Pieces(NamedTuple):
    """Triangles clipped to cells, sorted by cell."""

    cell: Ints
    triangle: Ints
    low: F64
    """[m], shape (p,)."""
    high: F64


class Hits(NamedTuple):
    """Where the vertical lines through the cell centres meet solid triangles, sorted by cell and height."""

    cell: Ints
    z: F64
    up: NDArray[np.bool_]
    """True where the surface faces upwards there."""
    gradient: F64
    """Its slope dz/dx and dz/dy, shape (h, 2)."""
    triangle: Ints


def expand(counts: Ints) -> tuple[Ints, Ints]:
    """For groups of the given sizes: the group of every element, and its number within the group."""
    group = np.repeat(np.arange(len(counts)), counts)
    return group, np.arange(len(group)) - np.repeat(np.cumsum(counts) - counts, counts)


@dataclass(frozen=True)
class Columns:
    """A rasterised scene."""

    grid: Grid
    soup: Soup
    pieces: Pieces
    hits: Hits

    @cached_property
    def piece_start(self) -> Ints:
        """First piece of every cell, shape (cells + 1,)."""
        return np.searchsorted(self.pieces.cell, np.arange(self.grid.nx * self.grid.ny + 1))

    def pieces_in(self, cells: Ints) -> tuple[Ints, Ints]:
        """All pieces in each of the cells: (index into `cells`, piece)."""
        first = self.piece_start[cells]
        group, number = expand(self.piece_start[cells + 1] - first)
        return group, first[group] + number

    def gentle(self, tangent: float) -> NDArray[np.bool_]:
        """Triangles that can be floor: solid, facing up, no steeper than `tangent`, shape (t,)."""
        if tangent not in self._gentle:
            a, b, c = self.soup.triangles[:, 0], self.soup.triangles[:, 1], self.soup.triangles[:, 2]
            normal = cross(b - a, c - a)
            level = np.hypot(normal[:, 0], normal[:, 1]) <= tangent * (1 + 1e-9) * normal[:, 2]
            self._gentle[tangent] = self.soup.solid & (normal[:, 2] > 0) & level
        return self._gentle[tangent]

    @cached_property
    def _gentle(self) -> dict[float, NDArray[np.bool_]]:
        return {}

    def surface_at(self, points: F64, z: F64, reach: float, tangent: float) -> NDArray[np.bool_]:
        """True where there is floor no steeper than `tangent` within `reach` of height z at each point.

        Args:
            points: [m], shape (n, 2).
            z: [m], shape (n,).
            reach: [m]
            tangent: of the steepest slope.
        """
        return np.isfinite(self.height_at(points, z, reach, tangent))

    def height_at(self, points: F64, z: F64, reach: float, tangent: float) -> F64:
        """Height of the floor nearest to z at each point, NaN where `surface_at` is False [m], shape (n,)."""
        from .column_kernels import heights_at

        found, pieces = np.full(len(points), np.nan), self.pieces
        heights_at(
            self.soup.triangles, self.gentle(tangent), tangent, self.grid.cell, self.piece_start, pieces.triangle, pieces.low, pieces.high,
            self.grid.cells_of(points), np.ascontiguousarray(points), z, reach, found,
        )  # fmt: skip
        return found

    def outline(self, pieces: Ints) -> F64:
        """Corners in the xy plane of some pieces [m], shape (n, 7, 2), padded by repetition."""
        from .column_kernels import outlines_of

        into, low_high = np.empty((len(pieces), 7, 2)), self.grid.reach(self.soup.triangles)
        cell, triangle = self.pieces.cell[pieces], self.pieces.triangle[pieces]
        outlines_of(self.soup.triangles, *low_high, self.grid.origin, self.grid.cell, self.grid.ny, cell, triangle, into)
        return into


def heights_of(corner: F64, points: F64) -> tuple[F64, NDArray[np.bool_], NDArray[np.bool_], F64]:
    """Height of each triangle's plane at its point, whether the triangle covers it, faces up, and its gradient (n, 2)."""
    a, b, c = corner[:, 0], corner[:, 1], corner[:, 2]
    normal = cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1)
    area = normal[:, 2]
    flat = np.abs(area) > VERTICAL * np.maximum(length, 1e-300)
    safe = np.where(flat, area, 1.0)

    def side(p: F64, q: F64) -> F64:
        return np.asarray((q[:, 0] - p[:, 0]) * (points[:, 1] - p[:, 1]) - (q[:, 1] - p[:, 1]) * (points[:, 0] - p[:, 0]))

    wa, wb, wc = side(b, c) / safe, side(c, a) / safe, side(a, b) / safe
    covered = flat & (np.minimum(np.minimum(wa, wb), wc) >= -SEAM)
    z = wa * a[:, 2] + wb * b[:, 2] + wc * c[:, 2]
    return z, covered, area > 0, -normal[:, :2] / safe[:, None]


def rasterise(soup: Soup, grid: Grid) -> Columns:
    """Sort all triangles of a soup into the columns of a grid."""
    from .column_kernels import pieces_of, placed

    low, high = grid.reach(soup.triangles)
    span = np.maximum(high - low + 1, 0)
    pairs, cells = int((span[:, 0] * span[:, 1]).sum()), grid.nx * grid.ny
    first = np.zeros(cells + 1, dtype=np.intp)
    cell, triangle, met, at = (np.empty(pairs, dtype=np.intp) for _ in range(4))
    below, above, z = (np.empty(pairs) for _ in range(3))
    up, gradient = np.empty(pairs, dtype=bool), np.empty((pairs, 2))
    made = (cell, triangle, below, above, at, z, up, gradient, met)
    pieces, hits = pieces_of(soup.triangles, soup.solid, low, high, grid.origin, grid.cell, grid.ny, cells, first, *made)
    order = placed(cell[:pieces], first)
    found = Pieces(cell[order], triangle[order], below[order], above[order])
    order = np.lexsort((z[:hits], at[:hits]))
    return Columns(grid, soup, found, Hits(at[order], z[order], up[order], gradient[order], met[order]))
