"""Closed surface of particles that does not depend on threads, keeps its volume when smoothed, and stands still when they do.

Marching cubes of the normalised colour field come from splashsurf; smoothing weights are those of Loeschner et al. (2023),
doi:10.1111/cgf.14769. The library's order of vertices depends on threads and its smoothing shrinks what is small: both are
mended here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64, I32
from .surround import carried, crowding

__all__ = ["SurfaceMesh", "area", "closed_volume", "face_volumes", "reconstruct", "vertex_normals"]

CELL = 0.5
"""Side of a marching cube in spacings."""
THRESHOLD = 0.585
"""Level of the colour field at the surface: a flat face then lies half a spacing outside its outermost particles (measured, tests)."""
SUPPORT = 2.0
"""Smoothing length in particle radii; the kernel reaches twice as far."""
SMOOTHING = 25
"""Passes of smoothing over cubes of `CELL`: how far they reach grows with their number's root, so coarser cubes need fewer."""
SPREAD = 12
"""Passes that spread what smoothing took away before it is given back, over cubes of `CELL`; about 2 spacings."""
CROWDED = 13.0
"""Weighted neighbours of a particle from which on its surface is smoothed fully: Loeschner et al., section 3."""
VALUES = 2.0
"""Support in spacings of the kernel that takes velocities and temperatures to the surface, which lies within one of a particle."""
BLOCK = 32
"""Cubes of a side of the library's blocks. The corner of the grid is a multiple of it, so that cubes stay where they are when particles
move. Measured: 64 take a quarter longer in a stream, 16 as long."""


@dataclass(frozen=True)
class SurfaceMesh:
    """Triangles around one liquid, outward."""

    vertices: F64
    """(v, 3) [m]"""
    faces: I32
    """(m, 3)"""
    velocity: F64
    """Velocity of the liquid at the vertices (v, 3) [m/s]."""
    temperature: F64
    """There (v,) [K]."""


def face_volumes(vertices: F64, faces: I32) -> F64:
    """Signed volume between each face and the first vertex (m,) [m^3]; over a closed piece they add up to what is inside."""
    from .mesh_kernels import volumes

    found = np.empty(len(faces))
    if len(faces):
        volumes(np.ascontiguousarray(vertices), faces, found)
    return found


def closed_volume(vertices: F64, faces: I32) -> float:
    """Volume inside a closed mesh [m^3]."""
    return float(face_volumes(vertices, faces).sum())


def vertex_normals(vertices: F64, faces: I32) -> tuple[F64, F64]:
    """Unit normals (v, 3), weighted by area, and the third of the area of its faces that belongs to each vertex (v,)."""
    from .mesh_kernels import normals

    total, share = np.zeros((len(vertices), 3)), np.zeros(len(vertices))
    normals(np.ascontiguousarray(vertices), faces, total, share)
    return total / np.maximum(np.linalg.norm(total, axis=1), 1e-300)[:, None], share


def area(vertices: F64, faces: I32) -> float:
    """Area of a mesh [m^2]."""
    return float(vertex_normals(vertices, faces)[1].sum())


def _canonical(vertices: F64, faces: NDArray[np.int64]) -> tuple[NDArray[np.intp], I32]:
    """Order of vertices by place, and the faces in that numbering, turned and sorted."""
    order = np.lexsort(vertices.T)
    number = np.empty(len(order), np.int64)
    number[order] = np.arange(len(order))
    faces = number[faces]
    first = faces.argmin(1)
    faces = np.take_along_axis(faces, (first[:, None] + np.arange(3)) % 3, axis=1)
    return order, np.ascontiguousarray(faces[np.lexsort(faces.T[::-1])], dtype=np.int32)


def _average(count: int, faces: I32) -> Any:
    """Sparse matrix that takes the mean over neighbouring vertices."""
    from scipy.sparse import csr_matrix, diags

    start, end = np.concatenate([faces[:, k] for k in range(3)]), np.concatenate([faces[:, (k + 1) % 3] for k in range(3)])
    near = csr_matrix((np.ones(len(start)), (start, end)), shape=(count, count))
    near = near.maximum(near.T)
    return diags(1 / np.maximum(np.asarray(near.sum(1)).reshape(-1), 1)) @ near


def _smooth(vertices: F64, faces: I32, weight: F64, cell: float) -> F64:
    """Weighted Laplacian smoothing; what it took along the normal, spread over some spacings, is given back."""
    mean = _average(len(vertices), faces)
    found, fewer = vertices.copy(), (CELL / cell) ** 2
    for _ in range(round(SMOOTHING * fewer)):
        found += weight[:, None] * (mean @ found - found)
    normal, share = vertex_normals(found, faces)
    share = np.maximum(share, 1e-3 * share.mean())
    lost = ((vertices - found) * normal).sum(1) * share
    for _ in range(round(SPREAD * fewer)):
        # The transpose moves volume between neighbours, so that none is lost.
        lost = 0.5 * lost + 0.5 * (mean.T @ lost)
        share = 0.5 * share + 0.5 * (mean.T @ share)
    return np.asarray(found + (lost / share)[:, None] * normal)


def reconstruct(
    position: F64,
    velocity: F64,
    temperature: F64 | None,
    spacing: float,
    *,
    support: float = SUPPORT,
    threshold: float = THRESHOLD,
    cell: float = CELL,
) -> SurfaceMesh:
    """Surface of particles of equal volume `spacing`^3.

    Args:
        position: (n, 3) [m], relative to an origin that stays where it is over frames.
        velocity: (n, 3) [m/s].
        temperature: (n,) [K]; the surface's is 0 where there is none.
        spacing: distance of particles at rest [m].
        support: smoothing length in particle radii.
        threshold: of the colour field.
        cell: side of a marching cube in spacings.
    """
    if len(position) == 0:
        return SurfaceMesh(np.empty((0, 3)), np.empty((0, 3), np.int32), np.empty((0, 3)), np.empty(0))
    import pysplashsurf

    block = BLOCK * cell * spacing
    mesh, _ = pysplashsurf.reconstruction_pipeline(
        # In units of the spacing: the library drops triangles by absolute size.
        np.ascontiguousarray(position / spacing, dtype=np.float32),
        particle_radius=0.5,
        smoothing_length=support,
        cube_size=2 * cell,
        iso_surface_threshold=threshold,
        subdomain_grid_auto_disable=False,  # without its blocks, sums depend on threads
        subdomain_num_cubes_per_dim=BLOCK,
        mesh_smoothing_iters=0,
        mesh_smoothing_weights=False,
        aabb_min=[math.floor(v / block - 0.01) * block / spacing for v in position.min(0)],
        aabb_max=[math.ceil(v / block + 0.01) * block / spacing for v in position.max(0)],
    )
    raw = np.asarray(mesh.mesh.vertices, dtype=np.float64) * spacing
    values = [velocity, crowding(position, support * spacing, CROWDED) / CROWDED]
    values += [] if temperature is None else [temperature]
    # In the library's order, in which neighbours follow one another.
    there = carried(raw, position, np.column_stack(values), VALUES * spacing)
    order, faces = _canonical(raw, np.asarray(mesh.mesh.triangles).astype(np.int64))
    raw, there = raw[order], there[order]
    crowd = there[:, 3]
    # Smootherstep: particles alone stay where they are, or smoothing would swallow them.
    weight = crowd**3 * (crowd * (6 * crowd - 15) + 10)
    heat = there[:, 4] if temperature is not None else np.zeros(len(raw))
    return SurfaceMesh(_smooth(raw, faces, weight, cell), faces, there[:, :3], heat)
