"""Zones of a landscape as signed distances on its grid."""

from __future__ import annotations

import numpy as np

from ...worlds.arrays import F64
from ...worlds.errors import InputError
from ...worlds.spec.terrain import Terrain, Zone
from .grid import Grid

__all__ = ["along", "declared_zone", "inside_weight", "polygon_distance", "zone_distance"]


def declared_zone(terrain: Terrain, name: str) -> Zone:
    """A zone by its id.

    Raises:
        InputError: the terrain declares none of that id.
    """
    if name not in terrain.zones:
        raise InputError(
            f"zone {name!r} is not declared; the terrain has {sorted(terrain.zones)}. Add it to /terrains/<id>/zones"
        )
    return terrain.zones[name]


def zone_distance(grid: Grid, zone: Zone) -> F64:
    """Distance to the edge of a zone [m], negative inside, shape (rows, cols)."""
    x, y = grid.points()
    if zone.center is not None and zone.radius is not None:
        return np.asarray(np.hypot(x - zone.center[0], y - zone.center[1]) - zone.radius)
    if zone.line is not None and zone.width is not None:
        return along(grid, np.array(zone.line))[0] - 0.5 * zone.width
    return polygon_distance(grid, np.array(zone.polygon))


def polygon_distance(grid: Grid, corners: F64) -> F64:
    """Distance to the edge of a polygon, corners (n, 2) [m], negative inside, shape (rows, cols)."""
    x, y = grid.points()
    away = along(grid, np.vstack([corners, corners[:1]]))[0]
    inside = np.zeros(grid.shape, dtype=bool)
    for (ax, ay), (bx, by) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if ay == by:
            continue
        crosses = ((ay > y) != (by > y)) & (x < (bx - ax) * (y - ay) / (by - ay) + ax)
        inside ^= crosses
    return np.where(inside, -away, away)


def along(grid: Grid, line: F64) -> tuple[F64, F64, F64]:
    """Nearest point of a polyline to every cell.

    Args:
        grid: where.
        line: corners [m], shape (n, 2).

    Returns:
        distance [m], part of the length passed at the nearest point (0 to 1), side (+1 left of the line, -1 right).
    """
    x, y = grid.points()
    lengths = np.hypot(*np.diff(line, axis=0).T)
    total = max(float(lengths.sum()), 1e-12)
    best = np.full(grid.shape, np.inf)
    passed, side = np.zeros(grid.shape), np.ones(grid.shape)
    before = 0.0
    for (ax, ay), (bx, by), length in zip(line[:-1], line[1:], lengths, strict=True):
        dx, dy = bx - ax, by - ay
        share = np.clip(((x - ax) * dx + (y - ay) * dy) / max(length * length, 1e-24), 0.0, 1.0)
        away = np.hypot(x - ax - share * dx, y - ay - share * dy)
        nearer = away < best
        best = np.where(nearer, away, best)
        passed = np.where(nearer, (before + share * length) / total, passed)
        side = np.where(nearer, np.where(dx * (y - ay) - dy * (x - ax) >= 0, 1.0, -1.0), side)
        before += length
    return best, passed, side


def inside_weight(distance: F64, falloff: float) -> F64:
    """1 inside a zone, falling smoothly to 0 at `falloff` [m] outside its edge."""
    if falloff <= 0:
        return np.asarray(distance <= 0, dtype=np.float64)
    t = np.clip(1.0 - distance / falloff, 0.0, 1.0)
    return np.asarray(t * t * (3 - 2 * t))
