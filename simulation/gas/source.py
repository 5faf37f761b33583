"""The source of a gas: the share of each cell that its shape covers, and what an emission makes there."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.solids import Solid
from ...worlds.arrays import F64, pose_of
from ..liquid.filling import PlacedSolid

if TYPE_CHECKING:
    from ...worlds.built import BuiltEntity
    from ...worlds.categories.gas.facts import Grid
    from ...worlds.spec import Entity

__all__ = ["LEAST_OPEN", "SAMPLES", "cover", "share_of"]

LEAST_OPEN = 0.01
"""Own choice: share of a source that solids must leave open; less is a mistake in its place."""
SAMPLES = 4
"""Points per cell along each axis: shares are multiples of 1/64."""


def cover(entity: Entity, built: BuiltEntity, grid: Grid) -> F64:
    """Share of each cell that the parts of a source cover, shape (nx, ny, nz)."""
    axes = [grid.corner[k] + grid.cell / SAMPLES * (np.arange(SAMPLES * n) + 0.5) for k, n in enumerate(grid.shape)]
    inside = np.zeros(tuple(len(a) for a in axes), dtype=bool)
    for part in built.parts:
        inside |= PlacedSolid("", Solid.from_mesh(part.render, closed=True), pose_of(entity.pose)).inside_lattice(axes)
    blocks = inside.reshape(*(m for n in grid.shape for m in (n, SAMPLES)))
    return np.asarray(blocks.mean(axis=(1, 3, 5)))


def share_of(covered: F64, room: NDArray[np.floating[Any]], cell: float) -> F64:
    """Gas per volume and second in each cell for an emission of 1 m^3/s; zero everywhere where solids leave too little of the source open.

    Args:
        covered: share of each cell that the source covers.
        room: open share of each cell in which gas can be made, else 0.
        cell: [m]
    """
    share = np.where(room > 0.0, covered, 0.0)
    opened = float((share * room).sum())
    if opened <= LEAST_OPEN * float(covered.sum()):
        return np.zeros_like(share)
    return np.asarray(share / (opened * cell**3))
