"""Widest and shortest ways over walkable ground between sets of nodes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from .clearances import Obstacles, clearance_at, obstacles_near
from .columns import Ints, expand
from .shortest import shortest_way
from .walkable import DIRECTIONS, Floor

if TYPE_CHECKING:
    from collections.abc import Callable

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


def _highest(values: F64, holds: Callable[[float], bool]) -> float:
    """Largest of the sorted values for which a monotone condition holds; it holds for the first."""
    low, high = 0, len(values) - 1
    while low < high:
        middle = (low + high + 1) // 2
        low, high = (middle, high) if holds(float(values[middle])) else (low, middle - 1)
    return float(values[low])


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

    def joined(threshold: float) -> bool:
        return _joined(floor, free & (clearance >= threshold), stops)

    values = np.unique(np.concatenate([[0.0], clearance[free]]))
    widest = _highest(values, joined)
    if widest < cap * (1 - 1e-9):
        # Centres of cells miss the middle of a door by up to half a cell: let the points near the bottleneck move.
        cell = floor.columns.grid.cell
        near = np.flatnonzero(free & (clearance >= widest - 0.75 * cell) & (clearance <= widest + cell))
        clearance[near], points[near, :2] = _centred(floor, obstacles, near, cap)
        widest = _highest(np.unique(np.concatenate([[0.0], clearance[free]])), joined)
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
    row, label = obstacles_near(floor, obstacles, nodes, LOST)
    first = obstacles.start[label]
    group, number = expand(obstacles.start[label + 1] - first)
    owner, obstacle = row[group], obstacles.point[first[group] + number]
    center, half = floor.points[nodes, :2], 0.5 * floor.columns.grid.cell
    # A point that moves within its cell cannot come nearer to obstacles farther than this.
    gap = np.linalg.norm(center[owner] - obstacle, axis=1)
    least = np.full(len(nodes), np.inf)
    np.minimum.at(least, owner, gap)
    matters = gap <= least[owner] + 4.0 * half
    owner, obstacle = owner[matters], obstacle[matters]
    place = center.copy()
    gaps = _Gaps(owner, obstacle, cap)
    best = gaps.least(place)
    step = 0.5 * half
    ways = np.array(DIRECTIONS, dtype=np.float64)
    longest = float(np.linalg.norm(ways, axis=1).max())
    for _ in range(LEVELS):
        # All further steps together are shorter than this, and what is nearest now comes no nearer than by as much.
        gaps = gaps.near(place, 2.0 * 4.0 * longest * step)
        for _ in range(2):
            trial = [np.clip(place + step * way, center - half, center + half) for way in ways]
            values = np.stack([gaps.least(t) for t in trial])
            k = values.argmax(axis=0)
            rows = np.arange(len(nodes))
            better = values[k, rows] > best
            best = np.where(better, values[k, rows], best)
            place = np.where(better[:, None], np.stack(trial)[k, rows], place)
        step *= 0.5
    return best, place


class _Gaps:
    """Distances of points to the obstacles about each of them.

    Args:
        owner: point of each obstacle, in order, shape (m,).
        obstacle: where it is [m], shape (m, 2).
        cap: distances count up to this [m].
    """

    def __init__(self, owner: Ints, obstacle: F64, cap: float) -> None:
        self.owner, self.cap = owner, cap
        self.x, self.y = np.ascontiguousarray(obstacle[:, 0]), np.ascontiguousarray(obstacle[:, 1])
        self.present, self.begin = np.unique(owner, return_index=True)

    def _squares(self, points: F64) -> F64:
        x, y = points[:, 0][self.owner] - self.x, points[:, 1][self.owner] - self.y
        return np.asarray(x * x + y * y)

    def least(self, points: F64) -> F64:
        """Distance of each point to the nearest of its obstacles [m], shape (n,)."""
        found = np.full(len(points), self.cap)
        if len(self.owner):
            found[self.present] = np.minimum(np.sqrt(np.minimum.reduceat(self._squares(points), self.begin)), self.cap)
        return found

    def near(self, points: F64, beyond: float) -> _Gaps:
        """Those obstacles that are no farther than the nearest and so much beyond [m]."""
        if not len(self.owner):
            return self
        gap = np.sqrt(self._squares(points))
        least = np.full(len(points), np.inf)
        least[self.present] = np.minimum.reduceat(gap, self.begin)
        some = gap <= least[self.owner] + beyond
        return _Gaps(self.owner[some], np.column_stack([self.x[some], self.y[some]]), self.cap)
