"""Walkable ground: layers of floor in the columns of a grid, and how they are linked.

A *node* is a floor height in a cell. It is free when it is not too steep, nothing stands in the height of the carrier
and it lies inside no solid. Nodes of neighbouring cells are linked when the step between them is small enough, so that
several storeys share one grid.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from .bounds import GAP, GAPS_PER_WIDTH, SAME_HEIGHT
from .columns import Columns, Ints, expand

__all__ = ["DIRECTIONS", "Carrier", "Floor", "floor_end", "lay_floor", "standing"]

DIRECTIONS: tuple[tuple[int, int], ...] = ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1), (1, -1), (-1, 1))
PROFILE = 16
"""Samples along a link whose step or crack must be measured: 3 mm apart at a cell of 5 cm."""
EDGE_HALVINGS = 12
"""Bisections of the place at which the floor ends: a 4096th of a cell."""


@dataclass(frozen=True)
class Carrier:
    """Sizes and limits of whoever has to get through."""

    width: float
    """[m]"""
    headroom: float
    """[m]"""
    tangent: float
    """Tangent of the steepest slope."""
    step: float
    """[m]"""

    @property
    def gap(self) -> float:
        """Widest crack in the floor that stops nobody [m]."""
        return min(GAP, self.width / GAPS_PER_WIDTH)


class Nodes(NamedTuple):
    """Floor heights, sorted by cell and height."""

    cell: Ints
    z: F64
    """[m]"""
    gradient: F64
    """Slope dz/dx and dz/dy of the surface, shape (n, 2); 0 for the top of something that is stepped over."""
    owner: Ints
    """Entity of the surface; -1 for a bridged crack."""
    blocked: NDArray[np.bool_]
    ceiling: F64
    """Clear height above [m]; infinite under the sky."""
    blocker: Ints
    """Entity that limits the clear height or blocks; -1 for none."""

    @property
    def tangent(self) -> F64:
        """Tangent of the slope, shape (n,)."""
        return np.hypot(self.gradient[:, 0], self.gradient[:, 1])


@dataclass(frozen=True)
class Floor:
    """All layers and their links."""

    columns: Columns
    carrier: Carrier
    nodes: Nodes
    links: Ints
    """Linked node in each of the eight directions, -1 for none, shape (n, 8)."""

    @cached_property
    def points(self) -> F64:
        """Node positions [m], shape (n, 3)."""
        flat = self.columns.grid.centers(self.nodes.cell)
        return np.column_stack([flat, self.nodes.z])

    @cached_property
    def ways(self) -> tuple[Ints, Ints]:
        """Links that go either way: first of each node, shape (n + 1,), and the linked nodes."""
        row, way = np.nonzero(self.links >= 0)
        to = self.links[row, way]
        source, target = np.concatenate([row, to]), np.concatenate([to, row])
        order = np.argsort(source, kind="stable")
        return np.searchsorted(source[order], np.arange(len(self.links) + 1)), target[order]

    @cached_property
    def edges(self) -> tuple[Ints, Ints]:
        """Links between free nodes as (from, to)."""
        row, way = np.nonzero(self.links >= 0)
        to = self.links[row, way]
        keep = ~(self.nodes.blocked[row] | self.nodes.blocked[to])
        return row[keep], to[keep]


def lay_floor(columns: Columns, carrier: Carrier, *, ignore: int = -1) -> Floor:
    """Find all layers of floor for a carrier.

    Args:
        columns: the rasterised scene.
        carrier: sizes and limits.
        ignore: entity that is treated as absent, to find out whether it is in the way.
    """
    nodes = _nodes(columns, carrier, ignore)
    nodes = _bridge_cracks(columns, carrier, nodes, ignore)
    return Floor(columns, carrier, nodes, _links(columns, carrier, nodes))


def _nodes(columns: Columns, carrier: Carrier, ignore: int) -> Nodes:
    from .column_kernels import floors_of

    hits, soup = columns.hits, columns.soup
    keep = soup.owner[hits.triangle] != ignore
    cell, z, up, gradient, triangle = (x[keep] for x in hits)
    tangent = np.hypot(gradient[:, 0], gradient[:, 1])
    closed, owner = soup.closed[triangle], soup.owner[triangle]
    gentle = up & (tangent <= carrier.tangent * (1 + 1e-9))
    floor, inside = np.zeros((2, len(cell)), dtype=bool)
    floors_of(cell, z, up, gentle, closed, carrier.step, SAME_HEIGHT, floor, inside)
    slope = np.where(gentle[:, None], gradient, 0.0)[floor]
    cell, z, owner = cell[floor], z[floor], owner[floor]
    blocked, ceiling, blocker = _overhead(columns, carrier, cell, z, slope, ignore)
    blocked |= inside[floor]
    return Nodes(cell, z, slope, owner, blocked, ceiling, blocker)


def _band(columns: Columns, carrier: Carrier, gradient: F64) -> F64:
    """Height above floors below which things are stepped over; the floor's own slope within a cell is no obstacle."""
    return np.asarray(np.maximum(carrier.step, 0.75 * columns.grid.cell * np.hypot(gradient[:, 0], gradient[:, 1])) + SAME_HEIGHT)


def standing(columns: Columns, carrier: Carrier, cell: Ints, z: F64, gradient: F64, ignore: int) -> tuple[Ints, Ints, F64]:
    """Pieces of surfaces that are no floor for a foot at each height: (index into `cell`, piece, height above it).

    A gentle solid surface that begins within a step is floor, whatever it rises to within the cell.
    """
    group, piece = columns.pieces_in(cell)
    triangle = columns.pieces.triangle[piece]
    above = columns.pieces.low[piece] - z[group]
    over = (columns.pieces.high[piece] > (z + _band(columns, carrier, gradient))[group]) & (
        columns.soup.owner[triangle] != ignore
    )
    over &= ~(columns.gentle(carrier.tangent)[triangle] & (above <= carrier.step + SAME_HEIGHT))
    return group[over], piece[over], np.maximum(above[over], 0.0)


def _overhead(
    columns: Columns, carrier: Carrier, cell: Ints, z: F64, gradient: F64, ignore: int
) -> tuple[NDArray[np.bool_], F64, Ints]:
    """Flags of places with surfaces within the carrier's height over the floor, the clear height, and whose surfaces they are."""
    group, piece, height = standing(columns, carrier, cell, z, gradient, ignore)
    owner = columns.soup.owner[columns.pieces.triangle[piece]]
    order = np.lexsort((height, group))
    first = order[np.unique(group[order], return_index=True)[1]] if len(order) else order
    ceiling, blocker = np.full(len(cell), np.inf), np.full(len(cell), -1, dtype=np.intp)
    ceiling[group[first]], blocker[group[first]] = height[first], owner[first]
    return ceiling < carrier.headroom - SAME_HEIGHT, ceiling, blocker


def _neighbour(columns: Columns, cell: Ints, way: tuple[int, int]) -> Ints:
    """Flat cell in a direction, -1 outside the grid."""
    i, j = cell // columns.grid.ny + way[0], cell % columns.grid.ny + way[1]
    inside = (i >= 0) & (j >= 0) & (i < columns.grid.nx) & (j < columns.grid.ny)
    return np.where(inside, i * columns.grid.ny + j, -1)


def _link(columns: Columns, carrier: Carrier, nodes: Nodes, way: tuple[int, int]) -> Ints:
    """Node of the neighbouring cell that each node is linked to, -1 for none, shape (n,)."""
    start = np.searchsorted(nodes.cell, np.arange(columns.grid.nx * columns.grid.ny + 1))
    target = _neighbour(columns, nodes.cell, way)
    inside = np.flatnonzero(target >= 0)
    first, last = start[target[inside]], start[target[inside] + 1]
    group, number = expand(last - first)
    row, other = inside[group], first[group] + number
    stride = columns.grid.cell * np.array(way, dtype=np.float64)
    rise = nodes.z[other] - nodes.z[row]
    # The step at the edge of two slopes lies between what either slope leaves over the whole way.
    one, two = rise - nodes.gradient[row] @ stride, rise - nodes.gradient[other] @ stride
    least = np.where(one * two <= 0.0, 0.0, np.minimum(np.abs(one), np.abs(two)))
    ok = least <= carrier.step + SAME_HEIGHT
    row, other, rise, unsure = (
        row[ok],
        other[ok],
        np.abs(rise[ok]),
        np.maximum(np.abs(one), np.abs(two))[ok] > carrier.step + SAME_HEIGHT,
    )
    if unsure.any():
        sound = ~unsure
        at = row[unsure]
        sound[unsure] = _sound(
            columns, carrier, columns.grid.centers(nodes.cell[at]), nodes.z[at], nodes.z[other[unsure]], stride
        )
        row, other, rise = row[sound], other[sound], rise[sound]
    # Free floor goes before blocked floor: a slab that runs on inside the next stair is no obstacle to the stair's tread.
    order = np.lexsort((rise, nodes.blocked[other], row))
    best = order[np.unique(row[order], return_index=True)[1]] if len(order) else order
    linked = np.full(len(nodes.cell), -1, dtype=np.intp)
    linked[row[best]] = other[best]
    return linked


def _sound(columns: Columns, carrier: Carrier, start: F64, z: F64, goal: F64, stride: F64) -> NDArray[np.bool_]:
    """True where the floor from points along a stride has no crack wider than allowed, no high step, and arrives at `goal`.

    Args:
        columns: the rasterised scene.
        carrier: sizes and limits.
        start: [m], shape (n, 2).
        z: height there [m], shape (n,).
        goal: height at the end [m], shape (n,).
        stride: [m], shape (2,).
    """
    apart = float(np.linalg.norm(stride)) / PROFILE
    slack = carrier.tangent * apart
    sound, level, lost = np.ones(len(start), dtype=bool), z.copy(), np.zeros(len(start))
    for k in range(1, PROFILE + 1):
        here = columns.height_at(
            start + stride * (k / PROFILE), level, carrier.step + slack * (1.0 + PROFILE) + SAME_HEIGHT, carrier.tangent
        )
        there = np.isfinite(here)
        rise = np.abs(here - level)
        sound &= ~(there & (rise > carrier.step + SAME_HEIGHT + slack * (1.0 + np.round(lost / apart))))
        lost = np.where(there, 0.0, lost + apart)
        sound &= lost <= carrier.gap + apart
        level = np.where(there, here, level)
    return np.asarray(sound & (np.abs(level - goal) <= carrier.step + SAME_HEIGHT))


def _links(columns: Columns, carrier: Carrier, nodes: Nodes) -> Ints:
    links = np.stack([_link(columns, carrier, nodes, way) for way in DIRECTIONS], axis=1)
    # A diagonal can jump a crack that both cells beside it lie in.
    for k, (i, j) in enumerate(DIRECTIONS):
        if i == 0 or j == 0:
            continue
        beside = [links[:, DIRECTIONS.index(way)] for way in ((i, 0), (0, j))]
        rows = np.flatnonzero((links[:, k] >= 0) & (beside[0] < 0) & (beside[1] < 0))
        if len(rows):
            start = columns.grid.centers(nodes.cell[rows])
            stride = columns.grid.cell * np.array([i, j], dtype=np.float64)
            sound = _sound(columns, carrier, start, nodes.z[rows], nodes.z[links[rows, k]], stride)
            links[rows[~sound], k] = -1
    return links


def _bridge_cracks(columns: Columns, carrier: Carrier, nodes: Nodes, ignore: int) -> Nodes:
    """Add floor to cells over cracks no wider than allowed, measured along the grid and its diagonals (up to 8 % too wide)."""
    found_cell, found_z = [], []
    spans = range(2, int(np.ceil(carrier.gap / columns.grid.cell - 1e-9)) + 2)
    for way in ((1, 0), (0, 1), (1, 1), (1, -1)):
        near = _link(columns, carrier, nodes, way)
        open_rows = near < 0
        for span in spans:
            far = _link(columns, carrier, nodes, (span * way[0], span * way[1]))
            gap = np.flatnonzero(open_rows & (far >= 0))
            gap = gap[np.abs(nodes.z[far[gap]] - nodes.z[gap]) <= carrier.step + SAME_HEIGHT]
            if len(gap) == 0:
                continue
            stride = columns.grid.cell * np.array(way, dtype=np.float64)
            one = floor_end(columns, carrier, nodes, gap, np.broadcast_to(stride, (len(gap), 2)))
            two = floor_end(columns, carrier, nodes, far[gap], np.broadcast_to(-stride, (len(gap), 2)))
            width = np.einsum("ni,i->n", two - one, stride) / float(np.linalg.norm(stride))
            gap = gap[width <= carrier.gap]
            open_rows[gap] = False
            for k in range(1, span):
                found_cell.append(_neighbour(columns, nodes.cell[gap], (k * way[0], k * way[1])))
                found_z.append(nodes.z[gap] + (nodes.z[far[gap]] - nodes.z[gap]) * (k / span))
    if not any(len(c) for c in found_cell):
        return nodes
    cell, z = np.concatenate(found_cell), np.concatenate(found_z)
    order = np.lexsort((z, cell))
    cell, z = cell[order], z[order]
    # One of several that lie within a step of each other, and none where there is floor already.
    keep = np.concatenate([[True], (np.diff(cell) > 0) | (np.diff(z) > max(carrier.step, SAME_HEIGHT))])
    cell, z = cell[keep], z[keep]
    gradient = np.zeros((len(cell), 2))
    blocked, ceiling, blocker = _overhead(columns, carrier, cell, z, gradient, ignore)
    more = Nodes(cell, z, gradient, np.full(len(cell), -1, dtype=np.intp), blocked, ceiling, blocker)
    order = np.lexsort((np.concatenate([nodes.z, z]), np.concatenate([nodes.cell, cell])))
    return Nodes(*(np.concatenate([a, b])[order] for a, b in zip(nodes, more, strict=True)))


def floor_end(columns: Columns, carrier: Carrier, nodes: Nodes, row: Ints, stride: F64) -> F64:
    """Where the floor ends along strides from nodes, by bisection [m], shape (n, 2)."""
    start = columns.grid.centers(nodes.cell[row])
    reach = carrier.step + 1.5 * columns.grid.cell * carrier.tangent + SAME_HEIGHT
    low, high = np.zeros(len(row)), np.ones(len(row))
    for _ in range(EDGE_HALVINGS):
        middle = 0.5 * (low + high)
        there = columns.surface_at(start + middle[:, None] * stride, nodes.z[row], reach, carrier.tangent)
        low, high = np.where(there, middle, low), np.where(there, high, middle)
    return np.asarray(start + low[:, None] * stride)
