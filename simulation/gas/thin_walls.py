"""Walls thinner than a cell: they lie between corners that are all outside, so that distances do not show them.

A face counts as closed by as much as ways from the middle of one cell to that of the next enter such a wall.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...geometry.launch import launch, warp

if TYPE_CHECKING:
    from ...worlds.arrays import F64
    from ..liquid.filling import PlacedSolid

__all__ = ["crossed"]

ACROSS = ((-0.25, -0.25), (-0.25, 0.25), (0.25, -0.25), (0.25, 0.25))
"""Ways through each face, in cells from its middle."""


def crossed(solid: PlacedSolid, corners: F64, distance: F64, cell: float) -> NDArray[np.float32]:
    """Share of each lower face of a block of cells that walls thinner than a cell close, shape (nx, ny, nz, 3) as `corners`.

    Args:
        solid: in its own frame.
        corners: of the cells, in that frame [m], shape (nx, ny, nz, 3).
        distance: of the corners to the surface [m].
        cell: [m]
    """
    from .thin_wall_kernels import meet

    wp = warp()
    found = np.zeros(corners.shape, np.float32)
    near = np.flatnonzero((np.abs(distance) < np.sqrt(3.0) * cell).ravel())
    if not len(near) or min(corners.shape[:3]) < 2:
        return found
    axes = np.stack([corners[1, 0, 0], corners[0, 1, 0], corners[0, 0, 1]]) - corners[0, 0, 0]
    mesh, middle = solid.tree
    flat = found.reshape(-1, 3)
    for axis in range(3):
        along, side, other = axes[axis], axes[(axis + 1) % 3], axes[(axis + 2) % 3]
        start = corners.reshape(-1, 3)[near] - middle - 0.5 * along
        origin = np.concatenate([start + (0.5 + a) * side + (0.5 + b) * other for a, b in ACROSS])
        hit = wp.zeros(len(origin), dtype=wp.int32, device="cpu")
        points = wp.array(origin.astype(np.float32), dtype=wp.vec3, device="cpu")
        launch(meet, len(origin), [mesh.id, points, wp.vec3(*map(float, along / cell)), cell, hit], device="cpu")
        flat[near, axis] = hit.numpy().reshape(len(ACROSS), -1).mean(axis=0)
    return found
