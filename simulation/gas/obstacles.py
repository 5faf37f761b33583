"""Rigid bodies in a gas's box: open shares of its cells and faces, and the velocity of what closes them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...geometry.solids import Solid
from ...worlds.arrays import F64
from ..liquid.filling import PlacedSolid
from .solids import corners_of, cut

if TYPE_CHECKING:
    from ...worlds.categories.gas.facts import Grid
    from ..boundaries import Surround
    from .engine import Solids

__all__ = ["standing"]

REACH = 2.0
"""Cells from a surface within which distances are known; farther away only the side counts."""


def standing(surround: Surround, grid: Grid) -> Solids:
    """The bodies where they stand at frame 0."""
    points = corners_of(grid.shape, grid.cell, grid.corner)
    flat = points.reshape(-1, 3)
    distance = np.full(len(flat), np.inf)
    for row, mesh in surround.parts:
        placed = PlacedSolid("", Solid.from_mesh(mesh, closed=True), surround.start[row])
        near = placed.near(flat, REACH * grid.cell)
        if len(near):
            distance[near] = np.minimum(distance[near], _signed(placed, flat[near], REACH * grid.cell))
    return cut(np.clip(distance, -REACH * grid.cell, REACH * grid.cell).reshape(points.shape[:3]))


def _signed(placed: PlacedSolid, points: F64, reach: float) -> F64:
    """Distance to a solid, negative in it; plus or minus `reach` where its surface is farther away (n,)."""
    distance, _ = placed.signed(points, reach)
    far = ~np.isfinite(distance)
    if far.any():
        distance[far] = np.where(placed.inside(points[far]), -reach, reach)
    return distance
