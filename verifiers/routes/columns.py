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

__all__ = ["Columns", "Grid", "Hits", "Ints", "Pieces", "Soup", "expand", "heights_of", "rasterise"]

Ints = NDArray[np.intp]
CHUNK = 40_000
"""Triangle-cell pairs clipped at once; bounds memory to about 30 MB."""
SEAM = 1e-9
"""Relative slack of the point-in-triangle test, so that a centre on a shared edge is hit."""
UNCUT = (1, 1, 2, 2, 0, 0, 1)
"""Corners of a triangle that no side of a cell cuts, in the order in which `_clip_fully` leaves them."""
VERTICAL = 1e-9
"""A triangle whose normal has a smaller z share is a wall and has no height at a point."""


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


class Pieces(NamedTuple):
    """Triangles clipped to cells, sorted by cell."""

    cell: Ints
    triangle: Ints
    low: F64
    """[m], shape (p,)."""
    high: F64
    made: Ints
    """Place of each in `drawn`, shape (p,)."""
    drawn: F64
    """Corners in the xy plane [m], shape (p, 7, 2), padded by repetition, as they were made: few are ever asked for, and all in the order
    of the cells would take as long as the clipping."""

    def outline(self, pieces: Ints) -> F64:
        """Corners in the xy plane of some pieces [m], shape (n, 7, 2), padded by repetition."""
        return np.asarray(self.drawn[self.made[pieces]])


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
        found = np.full(len(points), np.nan)
        cells = self.grid.cells_of(points)
        inside = np.flatnonzero(cells >= 0)
        group, piece = self.pieces_in(cells[inside])
        row, triangle = inside[group], self.pieces.triangle[piece]
        # What is found below lies in its piece, and is gentle: most of what stands in a cell is neither at that height nor floor.
        apart = np.maximum(self.pieces.low[piece] - z[row], z[row] - self.pieces.high[piece])
        floor = self.gentle(tangent)[triangle] & (apart <= reach + self.grid.cell)
        row, triangle = row[floor], triangle[floor]
        height, covered, up, slope = heights_of(self.soup.triangles[triangle], points[row])
        off = np.abs(height - z[row])
        ok = np.flatnonzero(covered & up & (np.hypot(*slope.T) <= tangent) & (off <= reach))
        order = ok[np.lexsort((off[ok], row[ok]))]
        first = order[np.unique(row[order], return_index=True)[1]] if len(order) else order
        found[row[first]] = height[first]
        return found


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


def _clip(polygon: F64, axis: int, bound: F64, sign: float) -> tuple[F64, NDArray[np.bool_]]:
    """Keep the part of convex polygons, shape (n, k, 3), where sign * (x[axis] - bound) >= 0 (Sutherland-Hodgman)."""
    height = sign * (polygon[:, :, axis] - bound[:, None])
    following, after = np.roll(polygon, -1, axis=1), np.roll(height, -1, axis=1)
    inside, inside_after = height >= 0, after >= 0
    crossing = inside != inside_after
    t = np.where(crossing, height / np.where(crossing, height - after, 1.0), 0.0)
    cut = polygon + t[..., None] * (following - polygon)
    # Two possible points per edge, in order: where it crosses, then its end.
    points = np.stack([cut, following], axis=2).reshape(len(polygon), -1, 3)
    valid = np.stack([crossing, inside_after], axis=2).reshape(len(polygon), -1)
    order = np.argsort(~valid, axis=1, kind="stable")[:, : polygon.shape[1] + 1]
    rows = np.arange(len(polygon))[:, None]
    kept = valid[rows, order]
    points = points[rows, order]
    return np.where(kept[..., None], points, points[:, :1]), kept[:, 0]


def _parts(corner: F64, low: F64, cell: float, alone: NDArray[np.bool_]) -> tuple[F64, NDArray[np.bool_]]:
    """Parts of triangles within cells, shape (n, 7, 3), and which are not empty; those that lie in one cell alone are whole."""
    polygon, alive = np.empty((len(corner), 7, 3)), np.ones(len(corner), dtype=bool)
    polygon[alone] = corner[alone][:, UNCUT]
    cut = np.flatnonzero(~alone)
    polygon[cut], alive[cut] = _clip_to_cells(corner[cut], low[cut], cell)
    return polygon, alive


def _clip_to_cells(corner: F64, low: F64, cell: float) -> tuple[F64, NDArray[np.bool_]]:
    """Parts of triangles within cells, shape (n, 7, 3), and which are not empty.

    Most cells of a floor lie wholly inside one triangle, or wholly outside: only the others are clipped.
    """
    slack = SEAM * cell
    square = low[:, None] + np.array(
        [[-slack, -slack], [cell + slack, -slack], [cell + slack, cell + slack], [-slack, cell + slack]]
    )
    a, b, c = corner[:, 0], corner[:, 1], corner[:, 2]
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    weight = np.empty((len(corner), 3, 4))
    for k, (p, q) in enumerate(((b, c), (c, a), (a, b))):
        along = (q - p)[:, None]
        weight[:, k] = along[..., 0] * (square[..., 1] - p[:, None, 1]) - along[..., 1] * (square[..., 0] - p[:, None, 0])
    weight *= np.sign(area)[:, None, None]
    flat = np.abs(area) > SEAM * cell * cell
    whole = flat & (weight >= 0).all(axis=(1, 2))
    alive = ~(flat & (weight.max(axis=2) < 0).any(axis=1))
    polygon = np.empty((len(corner), 7, 3))
    share = weight[whole] / np.abs(area[whole])[:, None, None]
    polygon[whole, :4, :2] = square[whole]
    polygon[whole, :4, 2] = np.einsum("nkc,nk->nc", share, corner[whole, :, 2])
    polygon[whole, 4:] = polygon[whole, :1]
    inner = alive & ~whole & ((corner[:, :, :2] >= square[:, :1]) & (corner[:, :, :2] <= square[:, 2:3])).all(axis=(1, 2))
    polygon[inner] = corner[inner][:, UNCUT]
    rest = np.flatnonzero(alive & ~whole & ~inner)
    if len(rest):
        polygon[rest], alive[rest] = _clip_fully(corner[rest], low[rest], cell)
    return polygon, alive


def _clip_fully(corner: F64, low: F64, cell: float) -> tuple[F64, NDArray[np.bool_]]:
    slack = SEAM * cell
    polygon, alive = corner, np.ones(len(corner), dtype=bool)
    for axis in (0, 1):
        for sign, bound in ((1.0, low[:, axis] - slack), (-1.0, low[:, axis] + cell + slack)):
            polygon, kept = _clip(polygon, axis, bound, sign)
            alive &= kept
    return polygon, alive


def rasterise(soup: Soup, grid: Grid) -> Columns:
    """Sort all triangles of a soup into the columns of a grid."""
    flat = soup.triangles[:, :, :2]
    low = np.floor((flat.min(axis=1) - grid.origin) / grid.cell - SEAM).astype(np.intp)
    high = np.floor((flat.max(axis=1) - grid.origin) / grid.cell + SEAM).astype(np.intp)
    low, high = np.maximum(low, 0), np.minimum(high, [grid.nx - 1, grid.ny - 1])
    span = np.maximum(high - low + 1, 0)
    counts = span[:, 0] * span[:, 1]
    pieces: list[Pieces] = []
    hits: list[Hits] = []
    ends = np.cumsum(counts)
    for begin in range(0, int(counts.sum()), CHUNK):
        pair = np.arange(begin, min(begin + CHUNK, int(ends[-1])))
        triangle = np.searchsorted(ends, pair, side="right")
        number = pair - (ends - counts)[triangle]
        column, line = number // span[triangle, 1], number % span[triangle, 1]
        index = low[triangle] + np.stack([column, line], axis=1)
        cell = index[:, 0] * grid.ny + index[:, 1]
        corner = soup.triangles[triangle]
        polygon, alive = _parts(corner, grid.origin + grid.cell * index, grid.cell, counts[triangle] == 1)
        polygon = polygon[alive]
        z, made = polygon[:, :, 2], np.arange(len(polygon))
        pieces.append(Pieces(cell[alive], triangle[alive], z.min(axis=1), z.max(axis=1), made, polygon[:, :, :2]))
        height, covered, up, gradient = heights_of(corner, grid.centers(cell))
        covered &= soup.solid[triangle]
        hits.append(Hits(cell[covered], height[covered], up[covered], gradient[covered], triangle[covered]))
    return Columns(grid, soup, _sorted_pieces(pieces), _sorted_hits(hits))


def _sorted_pieces(blocks: list[Pieces]) -> Pieces:
    if not blocks:
        none = np.zeros(0)
        return Pieces(none.astype(np.intp), none.astype(np.intp), none, none, none.astype(np.intp), np.zeros((0, 7, 2)))
    cell = np.concatenate([b.cell for b in blocks])
    order = np.argsort(cell, kind="stable")
    return Pieces(
        cell[order],
        np.concatenate([b.triangle for b in blocks])[order],
        np.concatenate([b.low for b in blocks])[order],
        np.concatenate([b.high for b in blocks])[order],
        order,
        np.concatenate([b.drawn for b in blocks]),
    )


def _sorted_hits(blocks: list[Hits]) -> Hits:
    if not blocks:
        none = np.zeros(0)
        return Hits(none.astype(np.intp), none, none.astype(bool), np.zeros((0, 2)), none.astype(np.intp))
    cell, z = np.concatenate([b.cell for b in blocks]), np.concatenate([b.z for b in blocks])
    order = np.lexsort((z, cell))
    return Hits(
        cell[order],
        z[order],
        np.concatenate([b.up for b in blocks])[order],
        np.concatenate([b.gradient for b in blocks])[order],
        np.concatenate([b.triangle for b in blocks])[order],
    )
