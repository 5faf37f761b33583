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

__all__ = ["SurfaceMesh", "area", "closed_volume", "reconstruct", "vertex_normals"]

CELL = 0.5
"""Side of a marching cube in spacings."""
THRESHOLD = 0.585
"""Of the colour field: a flat face then lies half a spacing outside its outermost particles (measured, tests)."""
SUPPORT = 2.0
"""Smoothing length in particle radii; the kernel reaches twice as far."""
SMOOTHING = 25
"""Passes of smoothing over cubes of `CELL`: how far they reach grows with their number's root, so coarser cubes need fewer."""
SPREAD = 12
"""Passes that spread what smoothing took away before it is given back, over cubes of `CELL`; about 2 spacings."""
BLOCK = 64
"""The corner of the grid is a multiple of this many cubes, so that cubes stay where they are when particles move."""


@dataclass(frozen=True)
class SurfaceMesh:
    """Triangles around one liquid, outward."""

    vertices: F64
    """(v, 3) [m]"""
    faces: I32
    """(m, 3)"""
    velocity: F64
    """Of the liquid at the vertices (v, 3) [m/s]."""
    temperature: F64
    """There (v,) [K]."""


def closed_volume(vertices: F64, faces: I32) -> float:
    """Volume inside a closed mesh [m^3]."""
    if not len(faces):
        return 0.0
    a, b, c = (vertices[faces[:, k]] - vertices[0] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def _area_vectors(vertices: F64, faces: I32) -> F64:
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return 0.5 * np.cross(b - a, c - a)


def area(vertices: F64, faces: I32) -> float:
    """Area of a mesh [m^2]."""
    return float(np.linalg.norm(_area_vectors(vertices, faces), axis=1).sum())


def vertex_normals(vertices: F64, faces: I32) -> tuple[F64, F64]:
    """Unit normals (v, 3), weighted by area, and the third of the area of its faces that belongs to each vertex (v,)."""
    vectors = _area_vectors(vertices, faces)
    total = np.empty_like(vertices)
    corner, size = faces.reshape(-1), np.repeat(np.linalg.norm(vectors, axis=1) / 3, 3)
    share = np.bincount(corner, size, minlength=len(vertices)).astype(np.float64)
    for k in range(3):
        total[:, k] = np.bincount(corner, np.repeat(vectors[:, k], 3), minlength=len(vertices))
    return total / np.maximum(np.linalg.norm(total, axis=1), 1e-300)[:, None], share


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
    carried = {"velocity": velocity} | ({} if temperature is None else {"temperature": temperature})
    mesh, _ = pysplashsurf.reconstruction_pipeline(
        # In units of the spacing: the library drops triangles by absolute size.
        np.ascontiguousarray(position / spacing, dtype=np.float32),
        attributes_to_interpolate={k: np.ascontiguousarray(v, dtype=np.float32) for k, v in carried.items()},
        particle_radius=0.5,
        smoothing_length=support,
        cube_size=2 * cell,
        iso_surface_threshold=threshold,
        subdomain_grid_auto_disable=False,  # without its blocks, sums depend on threads
        mesh_smoothing_iters=0,
        mesh_smoothing_weights=True,
        output_mesh_smoothing_weights=True,
        aabb_min=[math.floor(v / block - 0.01) * block / spacing for v in position.min(0)],
        aabb_max=[math.ceil(v / block + 0.01) * block / spacing for v in position.max(0)],
    )
    raw = np.asarray(mesh.mesh.vertices, dtype=np.float64) * spacing
    order, faces = _canonical(raw, np.asarray(mesh.mesh.triangles).astype(np.int64))
    data = {k: np.asarray(v, dtype=np.float64)[order] for k, v in mesh.point_attributes.items()}
    vertices = _smooth(raw[order], faces, np.clip(data["sw"], 0, 1), cell)
    return SurfaceMesh(vertices, faces, data["velocity"], data.get("temperature", np.zeros(len(vertices))))
