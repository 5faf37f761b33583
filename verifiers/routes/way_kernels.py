"""Widest ways over nodes, and points moved within their cells to where most room is. Compiled by numba, kept on disk."""

from __future__ import annotations

import numpy as np
from numba import njit

__all__ = ["bottleneck", "moved"]


@njit(cache=True)
def _root(parent, node):
    while parent[node] != node:
        parent[node] = parent[parent[node]]
        node = parent[node]
    return node


@njit(cache=True)
def bottleneck(order, clearance, start, target, stops):
    """Largest value that all nodes of some connected piece reach which touches every stop; -1 where there is none.

    Nodes come in, the widest first, and join those that they are linked to (Kruskal 1956), until one piece has a node of every stop.

    Args:
        order: nodes that count, by falling clearance.
        clearance: of each node [m].
        start, target: linked nodes, those of node n from start[n] to start[n + 1].
        stops: marks of the nodes of each stop, shape (s, n).
    """
    count = stops.shape[1]
    parent, there = np.full(count, -1), stops.copy()
    for node in order:
        parent[node] = node
        root = node
        for k in range(start[node], start[node + 1]):
            if parent[target[k]] < 0:
                continue
            other = _root(parent, target[k])
            if other != root:
                parent[root] = other
                for s in range(len(stops)):
                    there[s, other] = there[s, other] or there[s, root]
                root = other
        full = True
        for s in range(len(stops)):
            full = full and there[s, root]
        if full:
            return clearance[node]
    return -1.0


@njit(cache=True)
def _least(obstacle, some, count, x, y, cap):
    found = np.inf
    for k in range(count):
        dx, dy = x - obstacle[some[k], 0], y - obstacle[some[k], 1]
        found = min(found, dx * dx + dy * dy)
    return min(np.sqrt(found), cap)


@njit(cache=True)
def moved(first, obstacle, center, half, cap, levels, ways, best, place):
    """Move each point within its cell to where its obstacles are farthest: pattern search with halved steps.

    Args:
        first: first obstacle of each point, shape (n + 1,).
        obstacle: places [m], shape (m, 2).
        center: of each point's cell [m], shape (n, 2).
        half: of a cell's side [m].
        cap: distances count up to this [m].
        levels: halvings.
        ways: directions of a step, shape (w, 2).
        best: gets the distance of each point to its nearest obstacle [m].
        place: gets where that is; holds the points at first.
    """
    longest = 0.0
    for w in range(len(ways)):
        longest = max(longest, np.sqrt(ways[w, 0] ** 2 + ways[w, 1] ** 2))
    some = np.empty(len(obstacle), np.intp)
    for n in range(len(center)):
        count = first[n + 1] - first[n]
        for k in range(count):
            some[k] = first[n] + k
        x, y, step = center[n, 0], center[n, 1], 0.5 * half
        here = _least(obstacle, some, count, x, y, cap)
        for _ in range(levels):
            # All further steps together are shorter than this, and what is nearest now comes no nearer than by as much.
            beyond, kept = _least(obstacle, some, count, x, y, np.inf) + 8.0 * longest * step, 0
            for k in range(count):
                dx, dy = x - obstacle[some[k], 0], y - obstacle[some[k], 1]
                if np.sqrt(dx * dx + dy * dy) <= beyond:
                    some[kept] = some[k]
                    kept += 1
            count = kept
            for _ in range(2):
                most, at_x, at_y = -1.0, x, y
                for w in range(len(ways)):
                    tx = min(max(x + step * ways[w, 0], center[n, 0] - half), center[n, 0] + half)
                    ty = min(max(y + step * ways[w, 1], center[n, 1] - half), center[n, 1] + half)
                    gap = _least(obstacle, some, count, tx, ty, cap)
                    if gap > most:
                        most, at_x, at_y = gap, tx, ty
                if most > here:
                    here, x, y = most, at_x, at_y
            step *= 0.5
        best[n], place[n, 0], place[n, 1] = here, x, y
