"""Areas in which nothing may grow (R45): discs, polygons, zones, and what entities cover in plan."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ...worlds.arrays import F64, pose_of
from ...worlds.errors import InputError
from ...worlds.hints import did_you_mean
from ...worlds.spec import HeightField, WorldSpec
from ...worlds.spec.terrain import Clearing, Terrain, Zone
from ..build import build_entity
from .grid import Grid
from .zones import declared_zone, polygon_distance, zone_distance

__all__ = ["cleared", "outlines_of"]

HALF_DIAGONAL = 0.7072
"""Half the diagonal of a cell of side 1, rounded up: a cell whose centre is farther away holds no point of the area."""


def outlines_of(spec: WorldSpec, terrain: Terrain, assets: Path) -> dict[str, F64]:
    """Convex outline in plan, corners (n, 2) [m], of every entity that a clearing names.

    Raises:
        InputError: an entity is not declared, is ground itself, or cannot be built.
    """
    from scipy.spatial import ConvexHull

    found = {}
    for area in terrain.vegetation.clear.values() if terrain.vegetation is not None else ():
        name = area.around
        if name is None:
            continue
        if name not in spec.entities:
            raise InputError(
                f"a clearing lies around entity {name!r}, which is not declared{did_you_mean(name, spec.entities) or ';'} the world has "
                f"{sorted(spec.entities)[:20]}. Add /entities/{name} first, or give center and radius"
            )
        contract = spec.entities[name]
        if any(isinstance(p.shape, HeightField) for p in contract.parts.values()):
            raise InputError(f"a clearing lies around entity {name!r}, which is ground; name what stands on it")
        if contract.generator is not None:
            raise InputError(f"a clearing lies around entity {name!r}, which is a rope; give polygon, or center and radius")
        pose = pose_of(contract.pose)
        corners = np.concatenate([pose.apply(p.render.vertices)[:, :2] for p in build_entity(spec, name, assets).parts])
        found[name] = corners[ConvexHull(corners).vertices]
    return found


def cleared(grid: Grid, terrain: Terrain, outlines: Mapping[str, F64]) -> np.ndarray:
    """Cells that reach into a clearing or its margin, shape (rows, cols)."""
    found = np.zeros(grid.shape, dtype=bool)
    for area in terrain.vegetation.clear.values() if terrain.vegetation is not None else ():
        found |= _distance(grid, area, terrain, outlines) <= area.margin + HALF_DIAGONAL * grid.cell
    return found


def _distance(grid: Grid, area: Clearing, terrain: Terrain, outlines: Mapping[str, F64]) -> F64:
    if area.zone is not None:
        return zone_distance(grid, declared_zone(terrain, area.zone))
    if area.around is not None:
        return polygon_distance(grid, outlines[area.around])
    return zone_distance(grid, Zone(polygon=area.polygon, center=area.center, radius=area.radius))
