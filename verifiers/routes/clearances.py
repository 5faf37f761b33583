"""Width of the free way over a floor at every node.

The clearance of a node is its distance to the nearest obstacle *that is reached along the floor*: pieces of surfaces that block
a linked node, and the edges where the floor ends.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...worlds.arrays import F64
from .bounds import SAME_HEIGHT
from .columns import Ints, expand
from .walkable import DIRECTIONS, Floor, floor_end, standing

__all__ = ["Obstacles", "clearance_at", "measure_clearance", "obstacles_near"]

FINE = 512
"""Places along a cell, of which one corner of an obstacle each is kept."""
PAIRS = 2_000_000
"""Point-obstacle pairs measured at once."""


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


def obstacles_near(floor: Floor, obstacles: Obstacles, nodes: Ints, rings: int) -> tuple[Ints, Ints]:
    """Obstacles known at nodes and at those linked to them over up to `rings` links: pairs (row of `nodes`, label), sorted by row."""
    around = nodes[:, None]
    for _ in range(rings):
        more = np.where(around[..., None] >= 0, floor.links[around], -1).reshape(len(nodes), -1)
        around = np.concatenate([around, more], axis=1)
    labels = np.where(around >= 0, obstacles.label[around], -1)
    row, column = np.nonzero(labels >= 0)
    return _unique_pairs(row, labels[row, column], len(obstacles.start))


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
        row, label = obstacles_near(floor, obstacles, block, rings)
        distance, _ = _to_obstacles(obstacles, points[start + row], label)
        np.minimum.at(result, start + row, distance)
    return result


def _unique_pairs(row: Ints, label: Ints, labels: int) -> tuple[Ints, Ints]:
    """Distinct (row, label) pairs sorted by row; `labels` bounds the labels."""
    key = np.unique(row * labels + label)
    return key // labels, key % labels


def _to_obstacles(obstacles: Obstacles, points: F64, label: Ints) -> tuple[F64, F64]:
    """Distance of each point to one obstacle [m] and its nearest point."""
    first = obstacles.start[label]
    group, number = expand(obstacles.start[label + 1] - first)
    candidate = obstacles.point[first[group] + number]
    gap = np.linalg.norm(candidate - points[group], axis=1)
    begin = np.flatnonzero(np.diff(group, prepend=-1))
    if len(begin) == 0:
        return gap, candidate
    least = np.minimum.reduceat(gap, begin)
    nearest = np.flatnonzero(gap == np.repeat(least, np.diff(begin, append=len(group))))
    best = nearest[np.flatnonzero(np.diff(group[nearest], prepend=-1))]
    return gap[best], candidate[best]


def _obstacles(floor: Floor, ignore: int) -> tuple[tuple[Ints, Ints], Obstacles]:
    """All obstacles, and the free nodes next to them as (node, obstacle)."""
    nodes = floor.nodes
    free = ~nodes.blocked
    row, way = np.nonzero((floor.links >= 0) & free[:, None])
    other = floor.links[row, way]
    at_blocked = nodes.blocked[other]
    blocked, index = np.unique(other[at_blocked], return_inverse=True)
    points, counts = _blocking_points(floor, blocked, ignore)
    seeds = [np.stack([row[at_blocked], index.reshape(-1)], axis=1)]
    row, way = np.nonzero((floor.links < 0) & free[:, None])
    edges = _floor_ends(floor, row, way)
    seeds.append(np.stack([row, len(blocked) + np.arange(len(row))], axis=1))
    start = np.concatenate([[0], np.cumsum(np.concatenate([counts, np.ones(len(row), dtype=np.intp)]))])
    owner = np.concatenate([np.maximum(nodes.blocker[blocked], -1), np.full(len(row), -1, dtype=np.intp)])
    nothing = np.zeros(0)
    seed = np.concatenate(seeds)
    return (seed[:, 0], seed[:, 1]), Obstacles(nothing, nothing.astype(np.intp), start, np.concatenate([points, edges]), owner)


def _blocking_points(floor: Floor, blocked: Ints, ignore: int) -> tuple[F64, Ints]:
    """Corners of the pieces that block nodes; the corners of the cell where nothing stands in the band itself."""
    columns, nodes = floor.columns, floor.nodes
    group, piece, height = standing(
        columns, floor.carrier, nodes.cell[blocked], nodes.z[blocked], nodes.gradient[blocked], ignore
    )
    inside = height < floor.carrier.headroom - SAME_HEIGHT
    group, piece = group[inside], piece[inside]
    outline = columns.outline(piece)
    middle = 0.5 * (outline + np.roll(outline, -1, axis=1))
    points = np.concatenate([outline, middle], axis=1).reshape(-1, 2)
    owner = np.repeat(group, 2 * outline.shape[1])
    empty = np.setdiff1d(np.arange(len(blocked)), group)
    centers = columns.grid.centers(nodes.cell[blocked[empty]])
    half = 0.5 * columns.grid.cell
    corners = (centers[:, None] + half * np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]])).reshape(-1, 2)
    owner = np.concatenate([owner, np.repeat(empty, 4)])
    points = np.concatenate([points, corners])
    # A small ball of many facets has thousands of corners in one cell: one in every 512th of the cell will do.
    corner = columns.grid.centers(nodes.cell[blocked[owner]]) - 0.5 * columns.grid.cell
    place = np.clip((points - corner) * (FINE / columns.grid.cell), 0, FINE).astype(np.int64)
    _, keep = np.unique((owner * (FINE + 1) + place[:, 0]) * (FINE + 1) + place[:, 1], return_index=True)
    return points[keep], np.bincount(owner[keep], minlength=len(blocked)).astype(np.intp)


def _floor_ends(floor: Floor, row: Ints, way: Ints) -> F64:
    """Where the floor ends between each node and the neighbouring centre that has none, shape (n, 2)."""
    columns = floor.columns
    stride = columns.grid.cell * np.array(DIRECTIONS, dtype=np.float64)[way]
    return floor_end(columns, floor.carrier, floor.nodes, row, stride)
