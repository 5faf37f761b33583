"""Widest ways and roomiest places against searches that try everything."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from worldagent.verifiers.routes.walkable import DIRECTIONS
from worldagent.verifiers.routes.way_kernels import bottleneck, moved

NODES, LINKS = 80, 130


def _bisected(source: Any, target: Any, clearance: Any, free: Any, stops: list[Any]) -> float:
    """Largest of the clearances at which one piece of the nodes that have it touches every stop; -1 for none."""
    for value in np.unique(clearance[free])[::-1]:
        keep = free & (clearance >= value)
        both = keep[source] & keep[target]
        graph = coo_array((np.ones(both.sum()), (source[both], target[both])), shape=(NODES, NODES))
        label = connected_components(graph, directed=False)[1]
        if set.intersection(*(set(label[s[keep[s]]].tolist()) for s in stops)):
            return float(value)
    return -1.0


@pytest.mark.parametrize("seed", range(25))
def test_the_widest_way_is_that_of_a_search_over_all_widths(seed: int) -> None:
    rng = np.random.default_rng(seed)
    source, target = rng.integers(0, NODES, size=(2, LINKS))
    clearance, free = rng.integers(0, 30, NODES) / 10.0, rng.uniform(size=NODES) < 0.9
    stops = [rng.integers(0, NODES, size=3) for _ in range(rng.integers(1, 4))]
    ends = np.concatenate([source, target])
    order = np.argsort(ends, kind="stable")
    start = np.searchsorted(ends[order], np.arange(NODES + 1))
    widest = np.argsort(-clearance, kind="stable")
    seen = np.zeros((len(stops), NODES), dtype=bool)
    for k, stop in enumerate(stops):
        seen[k, stop] = True
    found = bottleneck(widest[free[widest]], clearance, start, np.concatenate([target, source])[order], seen)
    assert found == _bisected(source, target, clearance, free, stops)


def test_a_point_moves_to_where_its_obstacles_are_farthest() -> None:
    """Two posts 10 cm apart, the middle between them 2 cm off the middle of the cell: found to a 250th of the cell."""
    obstacle = np.array([[-0.03, 0.0], [0.07, 0.0], [5.0, 5.0]])
    best, place = np.zeros(2), np.zeros((2, 2))
    moved(np.array([0, 3, 3]), obstacle, np.zeros((2, 2)), 0.025, 1.0, 6, np.array(DIRECTIONS, dtype=float), best, place)
    assert best[1] == 1.0, "without obstacles the cap"
    tries = np.stack(np.meshgrid(*[np.linspace(-0.025, 0.025, 201)] * 2), axis=-1).reshape(-1, 1, 2)
    most = np.linalg.norm(tries - obstacle, axis=2).min(axis=1).max()
    assert most - 0.05 / 250 <= best[0] <= most + 1e-12
    assert np.abs(place[0]).max() <= 0.025
    assert np.linalg.norm(place[0] - obstacle, axis=1).min() == pytest.approx(best[0], abs=1e-15)
