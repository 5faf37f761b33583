"""Areas in which nothing may grow, as the specification says them, and which places lie in one."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

import numpy as np
from scipy.spatial import ConvexHull

from ...worlds.arrays import F64
from ...worlds.candidate import Candidate
from ...worlds.errors import EvidenceError
from ...worlds.spec.terrain import Terrain, Zone
from ..predicates.landscape import in_polygon

__all__ = ["in_clearings", "line_distance", "outlines_of"]


def outlines_of(candidate: Candidate, terrain: Terrain) -> dict[str, F64]:
    """Convex outline in plan, corners (n, 2) [m], of every built entity around which nothing may grow.

    Raises:
        EvidenceError: one is not built.
    """
    found = {}
    for area in terrain.vegetation.clear.values() if terrain.vegetation is not None else ():
        if area.around is None:
            continue
        if area.around not in candidate.built:
            raise EvidenceError(f"a clearing lies around {area.around!r}, which is not built; call place_object")
        corners = candidate.vertices(area.around, 0)[:, :2]
        found[area.around] = corners[ConvexHull(corners).vertices]
    return found


def in_clearings(points: F64, terrain: Terrain, outlines: Mapping[str, F64]) -> np.ndarray:
    """True where places, shape (n, 2) [m], lie in a clearing of the vegetation or within its margin, shape (n,)."""
    found = np.zeros(len(points), dtype=bool)
    for area in terrain.vegetation.clear.values() if terrain.vegetation is not None else ():
        shape = area if area.zone is None else terrain.zones[area.zone]
        if shape.center is not None and shape.radius is not None:
            found |= np.hypot(*(points - shape.center).T) < shape.radius + area.margin
            continue
        if isinstance(shape, Zone) and shape.line is not None and shape.width is not None:
            found |= line_distance(points, np.array(shape.line)) < 0.5 * shape.width + area.margin
            continue
        corners = outlines[area.around] if area.around is not None else np.array(shape.polygon)
        found |= in_polygon(points[:, 0], points[:, 1], corners)
        found |= line_distance(points, np.vstack([corners, corners[:1]])) < area.margin
    return found


def line_distance(points: F64, line: F64) -> F64:
    """Distance of places, shape (n, 2), to a polyline, shape (m, 2) [m]."""
    best = np.full(len(points), np.inf)
    for a, b in pairwise(line):
        along = b - a
        share = np.clip(((points - a) @ along) / max(float(along @ along), 1e-24), 0.0, 1.0)
        best = np.minimum(best, np.hypot(*(points - a - share[:, None] * along).T))
    return best
