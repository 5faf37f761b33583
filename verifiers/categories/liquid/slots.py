"""Slots between fixed solids that are too narrow for a liquid's spacing to pass, and lead from wet space to dry.

A slot narrower than a spacing counts as closed for the particles, whatever real liquid would do there: that nothing came through it is
no evidence. It is found at the surfaces themselves. Places all over wet solids are asked how far away the next solid faces them; the
middles of such gaps are joined to ways, and a way whose ends lie beside open space on two sides that no open way joins nearby is a slot.

Known gaps: solids that move, walls thicker than the space that is looked at (four spacings beyond the liquid), and holes much smaller
than a quarter of a spacing across.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import F64
from .barriers import Barrier
from .samples import scattered
from .solids import Piece, deepest

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ....worlds.spec import WorldSpec
    from .throats import Visited

__all__ = ["Slot", "slots", "touching"]

WIDEST = 1.0
"""[spacings] Wider ways are looked for among open space (`categories/liquid/throats.py`)."""
LEAST = 2e-4
"""[m] Own choice: a gap below this is a joint; what seeps through it in a scene's seconds is not seen."""
PITCH = 0.5
"""[spacings] Squares of surface that get four places each."""
REACH = 1.0
"""[spacings] Middles of gaps that are nearer to each other are joined."""
RUNGS = (1 / 64, 1 / 32, 1 / 16, 1 / 8, 1 / 4, 1 / 2, 3 / 4, 1.0)
"""[of the widest] At which it is asked whether a solid is there; closer ones would cost more and tell no more."""
HALVINGS = 7
WET = 3
"""[cubes] So near to cubes in which particles were, a way can begin."""
MOST_ENDS = 400
"""Ways that are looked at, evenly drawn from all."""


@dataclass(frozen=True)
class Slot:
    """A way too narrow for the liquid."""

    place: F64
    """Where liquid would get into it, world [m], shape (3,)."""
    width: float
    """At its narrowest between the ends [m]."""
    between: tuple[Piece, ...]


def touching(spec: WorldSpec) -> float:
    """Widest gap that is a joint [m]: bodies that rest on each other stand off by two skins."""
    return max([LEAST, *(2.0 * r.settings.skin for r in spec.simulation.rigid.values())])


def slots(visited: Visited, barrier: Barrier, spacing: float, least: float, joined: Callable[[F64, F64], bool]) -> list[Slot]:
    """Slots of fixed solids between `least` [m] and a spacing wide, the narrowest way of each, the widest slot first.

    Args:
        visited: where particles have been.
        barrier: the solids that stand still.
        spacing: of the liquid [m].
        least: narrower gaps are joints [m].
        joined: whether an open way leads from one point to another nearby.
    """
    middle, width, near = _gaps(visited, barrier.pieces, spacing, least)
    if not len(middle):
        return []
    ends = barrier.beside(middle)
    open_ = ~np.isnan(ends[:, 0])
    open_[open_] &= _free(barrier, ends[open_])
    wet = np.zeros(len(middle), dtype=bool)
    wet[open_] = visited.at(ends[open_])
    found: dict[frozenset[str], Slot] = {}
    for start, goal, narrowest in _ways(middle, width, wet, open_ & ~wet, REACH * spacing):
        if joined(ends[start], ends[goal]):
            continue
        pieces = tuple(dict.fromkeys((near[start][0], near[start][1], *near[goal])))[:2]
        key = frozenset(f"{p.entity}/{p.part}" for p in pieces)
        if key not in found or narrowest > found[key].width:
            found[key] = Slot(middle[start], narrowest, pieces)
    return sorted(found.values(), key=lambda s: -s.width)


def _free(barrier: Barrier, points: F64) -> np.ndarray:
    """Which points lie in open cubes outside of solids."""
    cell, inside = barrier.cells(points)
    found = np.zeros(len(points), dtype=bool)
    found[inside] = barrier.outer[tuple(cell[inside].T)]
    return found


def _gaps(visited: Visited, still: tuple[Piece, ...], spacing: float, least: float) -> tuple[F64, F64, list[tuple[Piece, Piece]]]:
    """Middles of gaps near wet space in front of surfaces, their widths [m], and what they lie between."""
    places, ways, mine = [np.zeros((0, 3))], [np.zeros((0, 3))], list[int]()
    for number, piece in enumerate(still):
        corner = np.array([[(visited.low, visited.high)[k >> a & 1][a] for a in range(3)] for k in range(8)])
        local = piece.local(corner, 0)
        points, normals = scattered(piece.solid, PITCH * spacing, local.min(axis=0), local.max(axis=0))
        points, normals = piece.world(points, 0), normals @ piece.turn[0].T
        inside = ((points >= visited.low) & (points <= visited.high)).all(axis=1)
        places.append(points[inside])
        ways.append(normals[inside])
        mine += [number] * int(inside.sum())
    point, way, owner = np.concatenate(places), np.concatenate(ways), np.array(mine, dtype=np.intp)
    most = WIDEST * spacing
    # What is free just in front of it is a gap's side; the next solid in that direction is its other one.
    rows = np.flatnonzero(~_within(still, point + 0.5 * least * way)[0]) if len(point) else np.zeros(0, dtype=np.intp)
    low, high = np.full(len(point), 0.5 * least), np.full(len(point), np.inf)
    for rung in RUNGS:
        distance = rung * most
        if distance <= 0.5 * least or not len(rows):
            continue
        hit, _ = _within(still, point[rows] + distance * way[rows])
        high[rows[hit]] = distance
        rows = rows[~hit]
        low[rows] = distance
    rows = np.flatnonzero(np.isfinite(high))
    other = np.zeros(len(point), dtype=np.intp)
    for _ in range(HALVINGS):
        half = 0.5 * (low[rows] + high[rows])
        hit, _ = _within(still, point[rows] + half[:, None] * way[rows])
        high[rows], low[rows] = np.where(hit, half, high[rows]), np.where(hit, low[rows], half)
    _, other[rows] = _within(still, point[rows] + (high[rows] + 1e-9)[:, None] * way[rows])
    rows = rows[high[rows] >= least]
    near = [(still[owner[r]], still[max(int(other[r]), 0)]) for r in rows]
    return point[rows] + 0.5 * high[rows, None] * way[rows], high[rows], near


def _within(still: tuple[Piece, ...], points: F64) -> tuple[np.ndarray, np.ndarray]:
    """Which points lie in a solid, and in which."""
    inside, which = np.zeros(len(points), dtype=bool), np.full(len(points), -1, dtype=np.intp)
    number: Mapping[int, int] = {id(p): k for k, p in enumerate(still)}
    for found in deepest(still, points, 0, 0.0):
        inside[found.rows], which[found.rows] = True, number[id(found.piece)]
    return inside, which


def _ways(middle: F64, width: F64, starts: np.ndarray, goals: np.ndarray, reach: float) -> list[tuple[int, int, float]]:
    """Nearest goals of starts along the middles of gaps, with the narrowest width between: (start, goal, width [m])."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import dijkstra
    from scipy.spatial import cKDTree

    first, goal = np.flatnonzero(starts), np.flatnonzero(goals)
    if not len(first) or not len(goal):
        return []
    pairs = cKDTree(middle).query_pairs(reach, output_type="ndarray")
    apart = np.linalg.norm(middle[pairs[:, 0]] - middle[pairs[:, 1]], axis=1)
    graph = coo_matrix((np.maximum(apart, 1e-9), (pairs[:, 0], pairs[:, 1])), shape=(len(middle), len(middle))).tocsr()
    distance, before, source = dijkstra(graph, directed=False, indices=goal, min_only=True, return_predecessors=True)
    first = first[np.isfinite(distance[first])]
    if len(first) > MOST_ENDS:
        first = first[np.linspace(0, len(first) - 1, MOST_ENDS).astype(np.intp)]
    found = []
    for start in first:
        at, narrowest = int(start), float(width[start])
        while before[at] >= 0:
            at = int(before[at])
            narrowest = min(narrowest, float(width[at]))
        found.append((int(start), int(source[start]), narrowest))
    return found
