"""Shortest ways through a graph by several stops."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from .columns import Ints

__all__ = ["shortest_way"]


def shortest_way(graph: Any, stops: Sequence[Ints]) -> Ints | None:
    """Nodes of a shortest way from any node of the first stop through one of each next; None where there is none.

    Args:
        graph: sparse matrix of lengths between nodes, read in both directions.
        stops: nodes of each.
    """
    from scipy.sparse.csgraph import dijkstra

    if any(len(stop) == 0 for stop in stops):
        return None
    path: list[int] = []
    start = stops[0]
    for goal in stops[1:]:
        distance, before, _ = dijkstra(graph, directed=False, indices=start, min_only=True, return_predecessors=True)
        node = int(goal[np.argmin(distance[goal])])
        if not np.isfinite(distance[node]):
            return None
        leg = [node]
        while before[leg[-1]] >= 0:
            leg.append(int(before[leg[-1]]))
        path += leg[::-1][1 if path else 0 :]
        start = np.array([node])
    return np.array(path, dtype=np.intp)
