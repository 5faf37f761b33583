"""Walkable ground: layers of floor in the columns of a grid, what blocks them, and how wide the free way is.

A *node* is a floor height in a cell. It is free when it is not too steep, nothing stands in the height of the carrier
and it lies inside no solid. Nodes of neighbouring cells are linked when the step between them is small enough, so that
several storeys share one grid. The clearance of a node is its distance to the nearest obstacle *that is reached along
the floor*: pieces of surfaces that block a linked node, and the edges where the floor ends.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F64
from .columns import Columns, Ints, expand

__all__ = ["DIRECTIONS", "Carrier", "Floor", "Obstacles", "clearance_at", "lay_floor", "measure_clearance", "unique_pairs"]

DIRECTIONS: tuple[tuple[int, int], ...] = ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1), (1, -1), (-1, 1))
SAME = 1e-4
"""[m] Surfaces closer than this in height are one."""
EDGE_HALVINGS = 12
PAIRS = 2_000_000
"""Point-obstacle pairs measured at once."""


@dataclass(frozen=True)
class Carrier:
    """What has to get through."""

    width: float
    """[m]"""
    headroom: float
    """[m]"""
    tangent: float
    """Of the steepest slope."""
    step: float
    """[m]"""


class Nodes(NamedTuple):
    """Floor heights, sorted by cell and height."""

    cell: Ints
    z: F64
    """[m]"""
    tangent: F64
    """Slope of the surface; 0 for the top of something that is stepped over."""
    owner: Ints
    """Entity of the surface; -1 for a bridged crack."""
    blocked: NDArray[np.bool_]
    ceiling: F64
    """Clear height above [m]; infinite under the sky."""
    blocker: Ints
    """Entity that limits the clear height or blocks; -1 for none."""


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
    def edges(self) -> tuple[Ints, Ints]:
        """Links between free nodes as (from, to)."""
        row, way = np.nonzero(self.links >= 0)
        to = self.links[row, way]
        keep = ~(self.nodes.blocked[row] | self.nodes.blocked[to])
        return row[keep], to[keep]


class Obstacles(NamedTuple):
    """Clearance of every node and what it is measured to."""

    clearance: F64
    """[m], shape (n,); 0 for blocked nodes, at most the cap."""
    label: Ints
    """Nearest obstacle, -1 beyond the cap, shape (n,)."""
    start: Ints
    """First point of every obstacle, shape (obstacles + 1,)."""
    point: F64
    """Points of all obstacles in the xy plane [m], shape (p, 2)."""
    owner: Ints
    """Entity of every obstacle; -1 where the floor ends."""


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
    hits, soup = columns.hits, columns.soup
    keep = soup.owner[hits.triangle] != ignore
    cell, z, up, tangent, triangle = (x[keep] for x in hits)
    closed, owner = soup.closed[triangle], soup.owner[triangle]
    count = len(cell)
    gentle = up & (tangent <= carrier.tangent * (1 + 1e-9))
    covered, low_thing, inside, first_seen, stepped = np.zeros((5, count), dtype=bool)
    for k in range(1, count):
        here = np.arange(count - k)
        same = cell[here] == cell[here + k]
        if not same.any():
            break
        rise = z[here + k] - z[here]
        above = same & (rise > SAME)
        within = above & (rise <= carrier.step)
        covered[here] |= within & up[here + k]
        low_thing[here] |= within & ~up[here + k]
        # The first surface above that faces up means that the node lies inside the body that it belongs to.
        inside[here] |= above & ~first_seen[here] & up[here + k] & closed[here + k]
        first_seen[here] |= above
        stepped[here + k] |= within & gentle[here]
        duplicate = same & (rise <= SAME) & up[here] & up[here + k]
        covered[here] |= duplicate
    floor = up & ~covered & (gentle | stepped)
    slope = np.where(gentle, tangent, 0.0)[floor]
    cell, z, owner = cell[floor], z[floor], owner[floor]
    blocked, ceiling, blocker = _overhead(columns, carrier, cell, z, ignore)
    blocked |= inside[floor] | low_thing[floor]
    return Nodes(cell, z, slope, owner, blocked, ceiling, blocker)


def _band(columns: Columns, carrier: Carrier) -> float:
    """Height above the floor below which things are stepped over; the floor's own slope within a cell is no obstacle."""
    return max(carrier.step, 0.75 * columns.grid.cell * carrier.tangent) + SAME


def _overhead(columns: Columns, carrier: Carrier, cell: Ints, z: F64, ignore: int) -> tuple[NDArray[np.bool_], F64, Ints]:
    """Whether pieces of surfaces stand within the carrier's height over floors, the clear height, and whose they are."""
    group, piece = columns.pieces_in(cell)
    owner = columns.soup.owner[columns.pieces.triangle[piece]]
    over = (columns.pieces.high[piece] > z[group] + _band(columns, carrier)) & (owner != ignore)
    group, piece, owner = group[over], piece[over], owner[over]
    height = np.maximum(columns.pieces.low[piece] - z[group], 0.0)
    order = np.lexsort((height, group))
    first = order[np.unique(group[order], return_index=True)[1]] if len(order) else order
    ceiling, blocker = np.full(len(cell), np.inf), np.full(len(cell), -1, dtype=np.intp)
    ceiling[group[first]], blocker[group[first]] = height[first], owner[first]
    return ceiling < carrier.headroom - SAME, ceiling, blocker


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
    run = columns.grid.cell * float(np.hypot(*way))
    rise = np.abs(nodes.z[other] - nodes.z[row])
    # What two slopes explain over the distance of the centres is no step.
    step = rise - 0.5 * run * (nodes.tangent[row] + nodes.tangent[other])
    ok = step <= carrier.step + SAME
    row, other, rise = row[ok], other[ok], rise[ok]
    # Free floor goes before blocked floor: a slab that runs on inside the next stair is no obstacle to the stair's tread.
    order = np.lexsort((rise, nodes.blocked[other], row))
    best = order[np.unique(row[order], return_index=True)[1]] if len(order) else order
    linked = np.full(len(nodes.cell), -1, dtype=np.intp)
    linked[row[best]] = other[best]
    return linked


def _links(columns: Columns, carrier: Carrier, nodes: Nodes) -> Ints:
    return np.stack([_link(columns, carrier, nodes, way) for way in DIRECTIONS], axis=1)


def _bridge_cracks(columns: Columns, carrier: Carrier, nodes: Nodes, ignore: int) -> Nodes:
    """Add floor to single cells between two linked-height nodes: a crack narrower than a cell stops nobody."""
    found_cell, found_z = [], []
    for way in ((1, 0), (0, 1)):
        near = _link(columns, carrier, nodes, way)
        far = _link(columns, carrier, nodes, (2 * way[0], 2 * way[1]))
        gap = np.flatnonzero((near < 0) & (far >= 0))
        flat = np.abs(nodes.z[far[gap]] - nodes.z[gap]) <= carrier.step
        gap = gap[flat]
        found_cell.append(_neighbour(columns, nodes.cell[gap], way))
        found_z.append(0.5 * (nodes.z[gap] + nodes.z[far[gap]]))
    cell, z = np.concatenate(found_cell), np.concatenate(found_z)
    if len(cell) == 0:
        return nodes
    keep = np.unique(np.stack([cell, np.round(z / max(carrier.step, SAME)).astype(np.intp)], axis=1), axis=0, return_index=True)[
        1
    ]
    cell, z = cell[keep], z[keep]
    blocked, ceiling, blocker = _overhead(columns, carrier, cell, z, ignore)
    none = np.full(len(cell), -1, dtype=np.intp)
    more = Nodes(cell, z, np.zeros(len(cell)), none, blocked, ceiling, blocker)
    order = np.lexsort((np.concatenate([nodes.z, z]), np.concatenate([nodes.cell, cell])))
    return Nodes(
        np.concatenate([nodes.cell, more.cell])[order],
        np.concatenate([nodes.z, more.z])[order],
        np.concatenate([nodes.tangent, more.tangent])[order],
        np.concatenate([nodes.owner, more.owner])[order],
        np.concatenate([nodes.blocked, more.blocked])[order],
        np.concatenate([nodes.ceiling, more.ceiling])[order],
        np.concatenate([nodes.blocker, more.blocker])[order],
    )


def measure_clearance(floor: Floor, cap: float, *, ignore: int = -1) -> Obstacles:
    """Clearance of every node: distance to the nearest obstacle reached along the floor, at most `cap` [m]."""
    seeds, obstacles = _obstacles(floor, ignore)
    count = len(floor.nodes.cell)
    best = np.full(count, np.inf)
    label = np.full(count, -1, dtype=np.intp)
    nearest = np.zeros((count, 2))
    flat = floor.points[:, :2]
    distance, point = _to_obstacles(obstacles, flat[seeds[0]], seeds[1])
    _improve(best, label, nearest, seeds[0], distance, seeds[1], point)
    active = np.unique(seeds[0])
    for _ in range(int(2.0 * cap / floor.columns.grid.cell) + 4):
        active = active[best[active] < cap]
        if len(active) == 0:
            break
        target = floor.links[active].ravel()
        source = np.repeat(active, len(DIRECTIONS))
        ok = (target >= 0) & ~floor.nodes.blocked[target]
        source, target = source[ok], target[ok]
        gap = np.linalg.norm(flat[target] - nearest[source], axis=1)
        closer = gap < best[target] - 1e-12
        source, target, gap = source[closer], target[closer], gap[closer]
        _improve(best, label, nearest, target, gap, label[source], nearest[source])
        active = np.unique(target)
    result = Obstacles(best, label, obstacles.start, obstacles.point, obstacles.owner)
    free = np.flatnonzero(~floor.nodes.blocked & (label >= 0))
    exact = clearance_at(floor, result, free, flat[free], rings=1)
    best[free] = np.minimum(best[free], exact)
    best = np.where(floor.nodes.blocked, 0.0, np.minimum(best, cap))
    return result._replace(clearance=best)


def _improve(best: F64, label: Ints, nearest: F64, row: Ints, distance: F64, new: Ints, point: F64) -> None:
    """Keep, per row, the least distance that beats what is known."""
    order = np.lexsort((distance, row))
    first = order[np.unique(row[order], return_index=True)[1]] if len(order) else order
    better = first[distance[first] < best[row[first]]]
    best[row[better]], label[row[better]], nearest[row[better]] = distance[better], new[better], point[better]


def clearance_at(floor: Floor, obstacles: Obstacles, nodes: Ints, points: F64, *, rings: int) -> F64:
    """Distance from points near nodes to the obstacles known around them [m], shape (n,).

    Args:
        floor: the floor.
        obstacles: what `measure_clearance` found.
        nodes: node of every point.
        points: [m], shape (n, 2).
        rings: how far to look for obstacles among the labels of linked nodes.
    """
    result = np.full(len(nodes), np.inf)
    step = max(1, PAIRS // 400)
    for start in range(0, len(nodes), step):
        block = nodes[start : start + step]
        around = block[:, None]
        for _ in range(rings):
            more = np.where(around[..., None] >= 0, floor.links[around], -1).reshape(len(block), -1)
            around = np.concatenate([around, more], axis=1)
        labels = np.where(around >= 0, obstacles.label[around], -1)
        row, column = np.nonzero(labels >= 0)
        row, label = unique_pairs(row, labels[row, column], len(obstacles.start))
        distance, _ = _to_obstacles(obstacles, points[start + row], label)
        np.minimum.at(result, start + row, distance)
    return result


def unique_pairs(row: Ints, label: Ints, labels: int) -> tuple[Ints, Ints]:
    """Distinct (row, label) pairs sorted by row; `labels` bounds the labels."""
    key = np.unique(row * labels + label)
    return key // labels, key % labels


def _to_obstacles(obstacles: Obstacles, points: F64, label: Ints) -> tuple[F64, F64]:
    """Distance of each point to one obstacle [m] and its nearest point."""
    first = obstacles.start[label]
    group, number = expand(obstacles.start[label + 1] - first)
    candidate = obstacles.point[first[group] + number]
    gap = np.linalg.norm(candidate - points[group], axis=1)
    order = np.lexsort((gap, group))
    best = order[np.unique(group[order], return_index=True)[1]] if len(order) else order
    return gap[best], candidate[best]


def _obstacles(floor: Floor, ignore: int) -> tuple[tuple[Ints, Ints], Obstacles]:
    """All obstacles, and the free nodes next to them as (node, obstacle)."""
    nodes, columns = floor.nodes, floor.columns
    free = ~nodes.blocked
    row, way = np.nonzero((floor.links >= 0) & free[:, None])
    other = floor.links[row, way]
    at_blocked = nodes.blocked[other]
    blocked, index = np.unique(other[at_blocked], return_inverse=True)
    points, counts = _blocking_points(floor, blocked, ignore)
    seeds = [np.stack([row[at_blocked], index.reshape(-1)], axis=1)]
    row, way = np.nonzero((floor.links < 0) & free[:, None])
    edges = _floor_ends(columns, floor, row, way)
    seeds.append(np.stack([row, len(blocked) + np.arange(len(row))], axis=1))
    start = np.concatenate([[0], np.cumsum(np.concatenate([counts, np.ones(len(row), dtype=np.intp)]))])
    owner = np.concatenate([np.maximum(nodes.blocker[blocked], -1), np.full(len(row), -1, dtype=np.intp)])
    nothing = np.zeros(0)
    seed = np.concatenate(seeds)
    return (seed[:, 0], seed[:, 1]), Obstacles(nothing, nothing.astype(np.intp), start, np.concatenate([points, edges]), owner)


def _blocking_points(floor: Floor, blocked: Ints, ignore: int) -> tuple[F64, Ints]:
    """Corners of the pieces that block nodes; the corners of the cell where nothing stands in the band itself."""
    columns, nodes = floor.columns, floor.nodes
    group, piece = columns.pieces_in(nodes.cell[blocked])
    z = nodes.z[blocked][group]
    low, high = columns.pieces.low[piece], columns.pieces.high[piece]
    inside = (high > z + _band(columns, floor.carrier)) & (low < z + floor.carrier.headroom - SAME)
    inside &= columns.soup.owner[columns.pieces.triangle[piece]] != ignore
    group, piece = group[inside], piece[inside]
    outline = columns.pieces.outline[piece]
    middle = 0.5 * (outline + np.roll(outline, -1, axis=1))
    points = np.concatenate([outline, middle], axis=1).reshape(-1, 2)
    owner = np.repeat(group, 2 * outline.shape[1])
    empty = np.setdiff1d(np.arange(len(blocked)), group)
    centers = columns.grid.centers(nodes.cell[blocked[empty]])
    half = 0.5 * columns.grid.cell
    corners = (centers[:, None] + half * np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])).reshape(-1, 2)
    owner = np.concatenate([owner, np.repeat(empty, 4)])
    points = np.concatenate([points, corners])
    order = np.argsort(owner, kind="stable")
    return points[order], np.bincount(owner, minlength=len(blocked)).astype(np.intp)


def _floor_ends(columns: Columns, floor: Floor, row: Ints, way: Ints) -> F64:
    """Where the floor ends between each node and the neighbouring centre that has none, by bisection, shape (n, 2)."""
    start = floor.points[row, :2]
    stride = columns.grid.cell * np.array(DIRECTIONS, dtype=np.float64)[way]
    z = floor.nodes.z[row]
    reach = floor.carrier.step + 1.5 * columns.grid.cell * floor.carrier.tangent + SAME
    low, high = np.zeros(len(row)), np.ones(len(row))
    for _ in range(EDGE_HALVINGS):
        middle = 0.5 * (low + high)
        there = columns.surface_at(start + middle[:, None] * stride, z, reach, floor.carrier.tangent)
        low, high = np.where(there, middle, low), np.where(there, high, middle)
    return np.asarray(start + low[:, None] * stride)
