"""Density of grains, up to the walls and the surface of a bed (R65, R103).

The space that counts is that of the tetrahedra between middles of neighbours (Delaunay's), and what fills it the part of every
grain that lies in them: the sum of r^3 / 3 times the solid angles at their corners. So what a wall or the air takes of a ball about
a grain is no part of it, and two layers are enough. Tetrahedra whose sphere is larger than that of a hole among packed grains
are not in a packing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....physics.grains import CLOSE_PACKING
from ....worlds.arrays import F64
from .bounds import SCATTER

if TYPE_CHECKING:
    from .frames import SwarmFrame

__all__ = ["LEAST", "PACKED", "chosen", "local_packing"]

PACKED = CLOSE_PACKING + SCATTER
"""Largest share of their space that grains may fill."""
NEIGHBOURS = 240
"""Grains about one that are looked at. Measured, nearly without friction, in beds of two to eight layers: equal grains 0.63 to 0.65, radii
spread by half of the mean 0.64 to 0.66."""
LEAST = 25.0
"""Grains: less than that in tetrahedra is no packing, but a single layer or a few that meet."""
FEWEST = 5
"""Grains: four make one tetrahedron, a packing has more."""
GRAINS = 8
"""Own choice: parts of a frame that are measured, about evenly chosen grains, others in every frame."""
ONWARD = 0.6180339887498949
"""The golden ratio: by this share of the way from one chosen grain to the next they go on from frame to frame."""
HOLE = 2.0
"""[largest radii] Radius of the spheres about tetrahedra: 1.22 to 1.41 in dense packings, up to 1.9 in loose ones."""
FLAT = 1e-9
"""Six times the volume up to which a tetrahedron counts as flat, in cubes of the largest radius."""


def chosen(frame: SwarmFrame) -> NDArray[np.intp]:
    """Rows of the grains about which a frame is measured."""
    count = min(GRAINS, frame.count)
    part = (np.arange(count) + frame.index * ONWARD % 1.0) / max(count, 1)
    return (part * frame.count).astype(np.intp)


def local_packing(frame: SwarmFrame, rows: NDArray[np.intp]) -> F64:
    """Share of the space about some grains that grains take up (overlaps count twice), shape (rows,); NaN where none are packed."""
    from scipy.spatial import cKDTree

    found = np.full(len(rows), np.nan)
    if frame.count < FEWEST:
        return found
    tree = cKDTree(frame.position)
    for k, row in enumerate(rows):
        far, near = tree.query(frame.position[row], k=min(NEIGHBOURS, frame.count))
        whole = len(near) == frame.count
        found[k] = _filled(frame.position[near] - frame.position[row], frame.radius[near], np.inf if whole else float(far[-1]))
    return found


def _filled(place: F64, radius: F64, known: float) -> float:
    """The share in tetrahedra of points about the first; those count that no grain farther off than `known` can be in."""
    from scipy.spatial import Delaunay, QhullError

    try:
        tets: NDArray[Any] = Delaunay(place).simplices
    except QhullError:  # all in one plane
        return np.nan
    largest = float(radius.max())
    corner = place[tets]
    edge = corner[:, 1:] - corner[:, :1]
    size = np.abs(np.linalg.det(edge))
    some = size > FLAT * largest**3
    tets, corner, edge, size = tets[some], corner[some], edge[some], size[some]
    middle = np.linalg.solve(2.0 * edge, (edge**2).sum(axis=2)[..., None])[..., 0]
    reach = np.linalg.norm(middle, axis=1)
    keep = (reach <= HOLE * largest) & (np.linalg.norm(middle + corner[:, 0], axis=1) + reach <= known)
    volume = _angles(corner[keep]) * radius[tets[keep]] ** 3 / 3.0
    if volume.sum() < LEAST * 4.0 / 3.0 * np.pi * float(np.mean(radius**3)):
        return np.nan
    return float(volume.sum() / (size[keep].sum() / 6.0))


def _angles(corner: F64) -> F64:
    """Solid angles of tetrahedra at their corners (m, 4, 3), shape (m, 4): Van Oosterom, Strackee (1983), doi:10.1109/TBME.1983.325207."""
    found = np.empty(corner.shape[:2])
    for k in range(4):
        a, b, c = (corner[:, (k + j) % 4] - corner[:, k] for j in (1, 2, 3))
        la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
        ab, ac, bc = (np.einsum("nd,nd->n", x, y) for x, y in ((a, b), (a, c), (b, c)))
        above = np.abs(np.einsum("nd,nd->n", a, np.cross(b, c)))
        found[:, k] = 2.0 * np.arctan2(above, la * lb * lc + ab * lc + ac * lb + bc * la)
    return found
