"""Meshes of landscapes for Mitsuba: the only other place than `mitsuba_scene` that knows its mesh API."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.landscape import SavedLandscape

__all__ = ["grid_faces", "grid_uv", "mesh_of", "top_of"]


def mesh_of(
    mi: Any, name: str, vertices: F64, faces: np.ndarray, bsdf: Any, *, uv: F64 | None = None, smooth: bool = False
) -> Any:
    """A mesh of corners (n, 3) and triangles (m, 3); smooth ones get normals of their corners."""
    properties = mi.Properties()
    properties["mesh_bsdf"] = bsdf
    properties["face_normals"] = not smooth
    mesh = mi.Mesh(
        name, len(vertices), len(faces), props=properties, has_vertex_normals=smooth, has_vertex_texcoords=uv is not None
    )
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = vertices.astype(np.float32).ravel()
    parameters["faces"] = faces.astype(np.uint32).ravel()
    if uv is not None:
        parameters["vertex_texcoords"] = uv.astype(np.float32).ravel()
    parameters.update()
    if smooth:
        mesh.recompute_vertex_normals()
    return mesh


def grid_faces(rows: int, cols: int, keep: np.ndarray) -> np.ndarray:
    """Two triangles for every cell of corners that `keep`, shape (rows - 1, cols - 1), lets stand."""
    index = np.arange(rows * cols).reshape(rows, cols)
    a, b, c, d = (x[keep] for x in (index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]))
    return np.concatenate([np.stack([a, b, d], 1), np.stack([a, d, c], 1)])


def grid_uv(land: SavedLandscape, vertices: F64) -> F64:
    """Texture coordinates in a picture of the whole landscape, shape (n, 2)."""
    extent = np.array([land.shape[1], land.shape[0]]) * land.cell
    return np.asarray(vertices[:, :2] / extent + 0.5)


def top_of(vertices: F64, faces: np.ndarray) -> tuple[F64, np.ndarray]:
    """The upper surface of a solid ground: corners and triangles that face upwards."""
    a, b, c = (vertices[faces[:, k], :2] for k in range(3))
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    upward = faces[area > 1e-9 * np.abs(area).max()]
    used, numbers = np.unique(upward, return_inverse=True)
    return vertices[used], numbers.reshape(-1, 3)
