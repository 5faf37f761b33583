"""Meshes for Mitsuba: the only place besides `SceneRenderer.pose` that knows its mesh API (it changes in 3.10)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

import numpy as np

from ...worlds.arrays import F32, F64

__all__ = ["mesh_of", "rgb"]


def rgb(color: Any) -> dict[str, Any]:
    """A linear colour as an entry of a scene."""
    return {"type": "rgb", "value": [float(c) for c in color]}


def mesh_of(
    mi: Any,
    name: str,
    corners: tuple[F64 | F32, np.ndarray],
    bsdf: Any,
    *,
    normals: F64 | F32 | Literal["flat", "smooth"] = "flat",
    uv: F64 | F32 | None = None,
    emitter: Any = None,
    attributes: Mapping[str, F32] | None = None,
) -> Any:
    """A mesh of vertices (n, 3) [m] and triangles (m, 3).

    Args:
        mi: Mitsuba.
        name: of the shape.
        corners: vertices and triangles.
        bsdf: its material.
        normals: one per vertex (n, 3); or one per triangle, or averaged over the triangles about a vertex.
        uv: texture coordinates (n, 2).
        emitter: its light, where it glows.
        attributes: further values per vertex (n,), by name.
    """
    vertices, faces = corners
    given = not isinstance(normals, str)
    properties = mi.Properties()
    properties["mesh_bsdf"] = bsdf
    properties["face_normals"] = not given and normals == "flat"
    if emitter is not None:
        properties["mesh_emitter"] = emitter
    mesh = mi.Mesh(
        name,
        len(vertices),
        len(faces),
        props=properties,
        has_vertex_normals=given or normals == "smooth",
        has_vertex_texcoords=uv is not None,
    )
    for attribute, values in (attributes or {}).items():
        mesh.add_attribute(attribute, 1, values)
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = vertices.astype(np.float32).ravel()
    if given:
        parameters["vertex_normals"] = np.asarray(normals, dtype=np.float32).ravel()
    if uv is not None:
        parameters["vertex_texcoords"] = uv.astype(np.float32).ravel()
    parameters["faces"] = faces.astype(np.uint32).ravel()
    parameters.update()
    if not given and normals == "smooth":
        mesh.recompute_vertex_normals()
    return mesh
