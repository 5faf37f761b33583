"""Widest and shortest ways over walkable ground between sets of nodes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from .clearances import Obstacles, clearance_at, obstacles_near
from .columns import Ints, expand
from .shortest import shortest_way
from .walkable import DIRECTIONS, Floor

__all__ = ["Way", "passable", "pieces_of", "reachable", "widest_way"]

LEVELS = 6
"""Halvings of the search for the best point within a cell: ends at a 250th of the cell."""
SAGITTA = 0.1
"""[cells] How far an arc rises above the chord of two neighbouring points: c^2 / 8r for c = 2 cells, r = 4 cells, with room."""
SHIFTS = 9
LOST = 2
"""Rings of linked nodes whose obstacles are measured when a point moves within its cell."""


class Way(NamedTuple):
    """A route."""

    clearance: float
    """Smallest distance to an obstacle along the widest route [m]."""
    node: int
    """Node at the narrowest place of the widest route."""
    place: F64
    """The narrowest place [m], shape (3,)."""
    route: F64
    """Shortest route for the wanted width, or the widest one where that is narrower [m], shape (n, 3)."""
    nodes: Ints
    """Nodes of the route."""


def _components(floor: Floor, keep: NDArray[np.bool_]) -> Ints:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    source, target = floor.edges
    both = keep[source] & keep[target]
    count = len(keep)
    graph = coo_array((np.ones(int(both.sum()), dtype=np.int8), (source[both], target[both])), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.intp)


def _joined(floor: Floor, keep: NDArray[np.bool_], stops: Sequence[Ints]) -> bool:
    """True if one connected piece of the kept nodes touches every stop."""
    label = _components(floor, keep)
    common: set[int] | None = None
    for stop in stops:
        here = set(label[stop[keep[stop]]].tolist())
        common = here if common is None else common & here
        if not common:
            return False
    return True


def passable(floor: Floor, obstacles: Obstacles | None, stops: Sequence[Ints], wanted: float) -> bool:
    """True if a way through all stops keeps at least `wanted` [m] from obstacles, to within half a cell.

    Without `obstacles`: whether there is a way of any width.
    """
    free = ~floor.nodes.blocked
    return _joined(floor, free if obstacles is None else free & (obstacles.clearance >= wanted), stops)


def reachable(floor: Floor, start: Ints) -> NDArray[np.bool_]:
    """Free nodes that some path of any width joins to one of `start`, shape (n,)."""
    free = ~floor.nodes.blocked
    label = _components(floor, free)
    return np.asarray(free & np.isin(label, label[start[free[start]]]))


def pieces_of(floor: Floor, inside: NDArray[np.bool_], share: float) -> Ints:
    """Nodes of the connected pieces of a set that have at least `share` of the nodes of its largest piece."""
    rows = np.flatnonzero(inside)
    if len(rows) == 0:
        return rows
    _, piece = np.unique(_components(floor, inside)[rows], return_inverse=True)
    count = np.bincount(piece)
    return np.asarray(rows[count[piece] >= share * count.max()])


def _narrowest(floor: Floor, clearance: F64, free: NDArray[np.bool_], stops: Sequence[Ints]) -> float:
    """Largest clearance [m] that some way through all stops keeps, over free nodes; -1 where there is none."""
    from .way_kernels import bottleneck

    start, target = floor.ways
    order = np.argsort(-clearance, kind="stable")
    seen = np.zeros((len(stops), len(free)), dtype=bool)
    for k, stop in enumerate(stops):
        seen[k, stop] = True
    return float(bottleneck(order[free[order]], clearance, start, target, seen))


def widest_way(floor: Floor, obstacles: Obstacles, stops: Sequence[Ints], wanted: float, cap: float) -> Way | None:
    """The way through all stops with the largest clearance, and the shortest one for `wanted`; None where none exists.

    Args:
        floor: the floor.
        obstacles: clearances, from `measure_clearance`.
        stops: nodes of the start, of every waypoint, and of the goal.
        wanted: clearance that the carrier needs [m].
        cap: clearances were measured up to this [m].
    """
    free = ~floor.nodes.blocked
    if not _joined(floor, free, stops):
        return None
    clearance = obstacles.clearance.copy()
    points = floor.points.copy()

    widest = _narrowest(floor, clearance, free, stops)
    if widest < cap * (1 - 1e-9):
        # Centres of cells miss the middle of a door by up to half a cell: let the points near the bottleneck move.
        cell = floor.columns.grid.cell
        near = np.flatnonzero(free & (clearance >= widest - 0.75 * cell) & (clearance <= widest + cell))
        clearance[near], points[near, :2] = _centred(floor, obstacles, near, cap)
        widest = _narrowest(floor, clearance, free, stops)
    best = _shortest(floor, points, free & (clearance >= widest), stops)
    if best is None:
        return None
    between, midpoints = _between(floor, obstacles, points, best, cap)
    along = np.concatenate([clearance[best], between])
    where = np.concatenate([points[best], midpoints])
    k = int(np.argmin(along))
    nodes = best
    if wanted < along[k]:
        shortest = _shortest(floor, points, free & (clearance >= wanted), stops)
        nodes = best if shortest is None else shortest
    return Way(float(along[k]), int(best[k if k < len(best) else k - len(best)]), where[k], points[nodes], nodes)


def _between(floor: Floor, obstacles: Obstacles, points: F64, nodes: Ints, cap: float) -> tuple[F64, F64]:
    """Clearance halfway between successive points of a route, and these places.

    A way around a corner is an arc, its chord cuts the corner: each point may move across the way by `SAGITTA`.
    """
    here, there = points[nodes[:-1]], points[nodes[1:]]
    if len(here) == 0:
        return np.zeros(0), np.zeros((0, 3))
    along = (there - here)[:, :2]
    across = np.column_stack([-along[:, 1], along[:, 0]]) / np.maximum(np.linalg.norm(along, axis=1), 1e-12)[:, None]
    reach = SAGITTA * floor.columns.grid.cell
    best, place = np.full(len(here), -1.0), 0.5 * (here + there)
    for shift in np.linspace(-reach, reach, SHIFTS):
        trial = 0.5 * (here + there)
        trial[:, :2] += shift * across
        found = np.minimum(clearance_at(floor, obstacles, nodes[:-1], trial[:, :2], rings=LOST), cap)
        better = found > best
        best[better], place[better] = found[better], trial[better]
    return best, place


def _shortest(floor: Floor, points: F64, keep: NDArray[np.bool_], stops: Sequence[Ints]) -> Ints | None:
    """Shortest path over kept nodes through all stops in order; None where there is none."""
    from scipy.sparse import csr_array

    source, target = floor.edges
    both = keep[source] & keep[target]
    source, target = source[both], target[both]
    length = np.linalg.norm(points[source] - points[target], axis=1) + 1e-9
    count = len(keep)
    graph: Any = csr_array((length, (source, target)), shape=(count, count))
    label = _components(floor, keep)
    allowed = set.intersection(*(set(label[s[keep[s]]].tolist()) for s in stops))
    keep = keep & np.isin(label, list(allowed))
    return shortest_way(graph, [s[keep[s]] for s in stops])


def _centred(floor: Floor, obstacles: Obstacles, nodes: Ints, cap: float) -> tuple[F64, F64]:
    """Move points within their cells to where clearance is largest: pattern search with halved steps."""
    from .way_kernels import moved

    row, label = obstacles_near(floor, obstacles, nodes, LOST)
    begin = obstacles.start[label]
    group, number = expand(obstacles.start[label + 1] - begin)
    owner, obstacle = row[group], obstacles.point[begin[group] + number]
    center, half = floor.points[nodes, :2], 0.5 * floor.columns.grid.cell
    # A point that moves within its cell cannot come nearer to obstacles farther than this.
    gap = np.linalg.norm(center[owner] - obstacle, axis=1)
    least = np.full(len(nodes), np.inf)
    np.minimum.at(least, owner, gap)
    matters = gap <= least[owner] + 4.0 * half
    owner, obstacle = owner[matters], obstacle[matters]
    first = np.searchsorted(owner, np.arange(len(center) + 1))
    best, place = np.empty(len(center)), center.copy()
    moved(first, obstacle, center, half, cap, LEVELS, np.array(DIRECTIONS, dtype=np.float64), best, place)
    return best, place
