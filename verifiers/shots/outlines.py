"""Shape of a liquid at a frame, as pictures see it: its surface mesh, or where none was made the cells that its particles fill."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...worlds.arrays import F64
from ...worlds.built import TriangleMesh
from ...worlds.categories.liquid.surface import LiquidSurface, mesh_of
from ...worlds.errors import EvidenceError
from ..categories.liquid.links import liquid_cache

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["filled_cells", "liquid_outline"]

FACES = (
    *(((-1, 0, 0), ((0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0))), ((1, 0, 0), ((1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)))),
    *(((0, -1, 0), ((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1))), ((0, 1, 0), ((0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0)))),
    *(((0, 0, -1), ((0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0))), ((0, 0, 1), ((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)))),
)
"""Neighbour across each face of a unit cube, and the face's corners, counter-clockwise from outside."""


def filled_cells(points: F64, size: float) -> TriangleMesh:
    """Outer faces of the cubes of a grid that hold a point.

    Args:
        points: shape (n, 3) [m].
        size: edge of a cube [m].
    """
    if not len(points):
        return TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int32))
    low = np.floor(points.min(axis=0) / size).astype(np.int64) - 1
    shape = np.floor(points.max(axis=0) / size).astype(np.int64) - low + 2
    cells = np.unique(np.floor(points / size).astype(np.int64) - low, axis=0)
    weight = np.array([shape[1] * shape[2], shape[2], 1])
    keys = cells @ weight
    corners = []
    for step, square in FACES:
        other = keys + np.array(step) @ weight
        place = np.minimum(np.searchsorted(keys, other), len(keys) - 1)
        open_cells = cells[keys[place] != other]
        corners.append(open_cells[:, None] + np.array(square))
    quads = (np.concatenate(corners) + low) * size
    first = 4 * np.arange(len(quads))[:, None]
    faces = np.concatenate([first + np.array([0, 1, 2]), first + np.array([0, 2, 3])]).astype(np.int32)
    return TriangleMesh(quads.reshape(-1, 3), faces)


def particle_outline(candidate: Candidate, entity: str, frame: int) -> TriangleMesh:
    """World mesh of particles at a frame: an octahedron around each.

    Raises:
        EvidenceError: no cache holds them.
    """
    for cache in candidate.particle_caches.values():
        if entity in cache.index.bodies:
            found = cache.read(frame, ("origin", "particle/position", "particle/member", "particle/radius"))
            mine = found["particle/member"] == cache.index.bodies.index(entity)
            points = found["particle/position"][mine].astype(np.float64) + found["origin"]
            way = np.concatenate([np.eye(3), -np.eye(3)])
            vertices = points[:, None] + way[None] * found["particle/radius"][mine].astype(np.float64)[:, None, None]
            sides = np.array(
                [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]], dtype=np.int32
            )
            faces = sides[None] + 6 * np.arange(len(points), dtype=np.int32)[:, None, None]
            return TriangleMesh(vertices.reshape(-1, 3), faces.reshape(-1, 3).astype(np.int32))
    raise EvidenceError(f"no cache holds the particles {entity!r}; probe or bake them")


def liquid_outline(candidate: Candidate, liquid: str, frame: int) -> TriangleMesh:
    """World mesh of a liquid at a frame; before any simulation, its declared volume.

    Raises:
        EvidenceError: no cache holds it, or what is there is damaged.
    """
    if candidate.stage == "static":
        built = candidate.entity(liquid)
        meshes = [(candidate.pose(liquid, 0, p.body).apply(p.render.vertices), p.render.faces) for p in built.parts]
        starts = np.concatenate([[0], np.cumsum([len(v) for v, _ in meshes])])
        faces = np.concatenate([f + s for (_, f), s in zip(meshes, starts, strict=False)])
        return TriangleMesh(np.concatenate([v for v, _ in meshes]), faces.astype(np.int32))
    if liquid in candidate.particulates:
        return particle_outline(candidate, liquid, frame)
    cache, row = liquid_cache(candidate, liquid)
    surface = LiquidSurface(cache)
    if frame < surface.count():
        return TriangleMesh(*mesh_of(surface.read(frame), row))
    found = cache.read(frame, ("origin", "particle/position", "particle/fluid", "particle/volume"))
    mine = found["particle/fluid"] == row
    points = found["particle/position"][mine].astype(np.float64) + found["origin"]
    volume = found["particle/volume"][mine]
    return filled_cells(points, float(np.cbrt(np.median(volume))) * 1.5 if len(volume) else 1.0)
