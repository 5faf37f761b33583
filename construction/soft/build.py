"""A built part -> the same part with a simulation mesh, its visible surface being that of the tetrahedra."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ...geometry.solids import Solid
from ...worlds.arrays import F64
from ...worlds.built import BuiltPart, TriangleMesh
from ...worlds.simulation_mesh import SimulationMesh
from .clipping import clipped_mesh
from .lattice import block_tets, cells_of, grid_points, outer_faces

if TYPE_CHECKING:
    from ...worlds.spec import ElasticPhysics

__all__ = ["soft_part"]

DIVISIONS = 2
"""Blocks of tetrahedra along the edge of a cell: one vertex per node of its quadratic displacements."""
THIN_DIVISIONS = 4
"""The same along an axis with a single cell, so that faces have corners enough to be touched between their edges."""
ROUND_BLOCKS = 8
"""Least blocks along each axis of solids that are no boxes: their surface is cut out of these."""
BOX_NOISE = 1e-9
"""Relative to the size: how far a vertex may lie from a corner of the bounding box and the mesh still be that box."""


def soft_part(part: BuiltPart, physics: ElasticPhysics) -> BuiltPart:
    """The part as a body that deforms; a box is filled exactly, other solids to within the measured deviation.

    Raises:
        LimitError: the resolution asks for too many cells.
        InputError: the solid is thinner than its cells resolve.
    """
    low, high = part.render.vertices.min(0), part.render.vertices.max(0)
    cells = cells_of(high - low, physics.resolution)
    box = _is_box(part.render, low, high)
    if box:
        x, y, z = (THIN_DIVISIONS if c == 1 else DIVISIONS * c for c in cells)
    else:
        x, y, z = (c * max(DIVISIONS, math.ceil(ROUND_BLOCKS / c)) for c in cells)
    counts = (x, y, z)
    points = grid_points(low, high, counts)
    lattice = np.array(cells, dtype=np.int32)
    if not box:
        return clipped_mesh(part, points, block_tets(counts, points), lattice)
    tets = block_tets(counts, points)
    faces = outer_faces(tets)
    used, place = np.unique(faces, return_inverse=True)
    surface = TriangleMesh(points[used], place.reshape(-1, 3).astype(np.int32))
    indices = np.repeat(used[:, None], 4, axis=1).astype(np.int32)
    weights = np.repeat([[1.0, 0.0, 0.0, 0.0]], len(used), axis=0)
    mesh = SimulationMesh(points, faces, tets, indices, weights, lattice)
    return replace(part, render=surface, simulation=mesh, deviation=(0.0, 0.0), smooth=True)


def _is_box(mesh: TriangleMesh, low: F64, high: F64) -> bool:
    near = np.minimum(np.abs(mesh.vertices - low), np.abs(mesh.vertices - high)).max()
    if near > BOX_NOISE * float(np.linalg.norm(high - low)):
        return False
    return abs(Solid.from_mesh(mesh, closed=True).volume / float(np.prod(high - low)) - 1.0) < BOX_NOISE
