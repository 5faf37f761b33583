"""Meshes from files or inline data: checked, scaled, decomposed into convex pieces."""

from __future__ import annotations

import hashlib
import io
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from ..worlds.arrays import F64, I32, RigidPose
from ..worlds.built import Convex, TriangleMesh
from ..worlds.errors import InputError
from ..worlds.folder import safe_join
from ..worlds.limits import HEIGHT_ROWS, check_cap
from ..worlds.spec import HeightField, Mesh
from .file_worker import LARGEST
from .outside import arrays_of, decomposed, file_digest

__all__ = ["load_heights", "load_mesh", "load_surface", "load_table", "mesh_digest"]

MAX_HEIGHT_BYTES = 8 * HEIGHT_ROWS**2 + 4096
FLAT = 1e-15
"""Least volume of a solid [m^3]."""


def mesh_digest(assets: Path, name: str) -> str:
    """SHA-256 of a mesh file, hex; `missing` where there is none to read."""
    return file_digest(assets, name, "mesh_bytes")


def load_heights(shape: HeightField, assets: Path) -> F64:
    """Heights of a height field [m], shape (rows, cols), row 0 south.

    Raises:
        InputError: the file is missing, is another one than the specification names, or holds no grid of numbers.
    """
    if shape.file is None:
        return np.array(shape.heights, dtype=np.float64)
    heights = load_table(assets, shape.file, str(shape.digest), MAX_HEIGHT_BYTES).astype(np.float64)
    if heights.ndim != 2 or not all(2 <= n <= HEIGHT_ROWS for n in heights.shape) or not np.isfinite(heights).all():
        raise InputError(
            f"height file {shape.file!r} has shape {heights.shape}; it must be 2 to {HEIGHT_ROWS} rows and columns of finite numbers"
        )
    return np.asarray(heights, dtype=np.float64)


def load_table(assets: Path, name: str, digest: str, most: int) -> npt.NDArray[Any]:
    """Array of numbers in a file that build_terrain wrote.

    Args:
        assets: folder of the world's assets.
        name: of the file.
        digest: SHA-256 that the specification names, hex.
        most: bytes that it may have.

    Raises:
        InputError: the file is missing or too large, is another one than the specification names, or holds no such array.
    """
    path = safe_join(assets, name)
    if not path.is_file() or path.stat().st_size > most:
        raise InputError(f"file {name!r} is missing or above {most:,} bytes; call build_terrain again")
    data = path.read_bytes()
    found = hashlib.sha256(data).hexdigest()
    if found != digest:
        raise InputError(
            f"file {name!r} has digest {found[:12]}..., the specification names {digest[:12]}...; call build_terrain again"
        )
    try:
        table: npt.NDArray[Any] = np.load(io.BytesIO(data), allow_pickle=False)
    except (ValueError, EOFError) as error:
        raise InputError(f"file {name!r} is no array of numbers: {error}; call build_terrain again") from error
    return table


def load_mesh(shape: Mesh, assets: Path) -> tuple[TriangleMesh, tuple[Convex, ...]]:
    """Read a mesh shape and its convex pieces.

    Raises:
        InputError: the file is missing or cannot be read, or the mesh is not closed or has no volume.
        LimitError: the file or the mesh is too large.
    """
    solid = _triangles(shape, assets)
    if not len(solid.faces) or not solid.is_watertight:
        raise InputError(
            f"mesh with {len(solid.faces)} faces is not closed (watertight); close its holes or model it with other shapes"
        )
    if solid.volume < 0:
        solid.invert()
    if not solid.volume > FLAT:
        raise InputError("mesh has no volume; check that its faces are oriented consistently")
    mesh = TriangleMesh(np.array(solid.vertices, dtype=np.float64), np.array(solid.faces, dtype=np.int32))
    if shape.collision == "hull" or solid.is_convex:
        return mesh, (_piece(_hull(solid)),)
    return mesh, tuple(map(_piece, decomposed({"vertices": mesh.vertices, "faces": mesh.faces})))


def load_surface(shape: Mesh, assets: Path) -> tuple[F64, I32]:
    """Vertices and faces of a mesh that need not be closed, equal vertices merged and unused ones left out.

    Raises:
        InputError: the file is missing or cannot be read, or no triangle is left.
        LimitError: the file or the mesh is too large.
    """
    mesh = _triangles(shape, assets)
    if not len(mesh.faces):
        raise InputError("mesh has no triangles")
    mesh.remove_unreferenced_vertices()
    return np.array(mesh.vertices, dtype=np.float64), np.array(mesh.faces, dtype=np.int32)


def _triangles(shape: Mesh, assets: Path) -> Any:
    """The `trimesh.Trimesh` of a mesh shape [m], equal vertices merged.

    Raises:
        InputError: the file is missing or cannot be read, an index is out of range, or the mesh reaches too far.
        LimitError: the file or the mesh is too large.
    """
    import trimesh

    vertices, faces = _arrays(shape, assets)
    check_cap("mesh_triangles", len(faces), what="this mesh")
    vertices = vertices * shape.scale
    if np.abs(vertices).max(initial=0.0) > LARGEST:
        raise InputError(f"mesh reaches to {np.abs(vertices).max():.3g} m, at most {LARGEST:g} m; lengths are in m, check scale")
    return trimesh.Trimesh(vertices, faces, process=True)


def _arrays(shape: Mesh, assets: Path) -> tuple[F64, npt.NDArray[np.int64]]:
    if shape.file is not None:
        found = arrays_of("mesh", assets, shape.file, "mesh_bytes")
        return found["vertices"], found["faces"]
    vertices, faces = np.array(shape.vertices, dtype=np.float64), np.array(shape.faces, dtype=np.int64)
    if faces.size and faces.max() >= len(vertices):
        raise InputError(f"face index {int(faces.max())} is out of range: the mesh has {len(vertices)} vertices")
    return vertices, faces


def _piece(points: F64) -> Convex:
    return Convex("hull", (), RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0])), points)


def _hull(solid: Any) -> F64:
    from scipy.spatial import QhullError

    try:
        return np.array(solid.convex_hull.vertices, dtype=np.float64)
    except QhullError as error:
        raise InputError("mesh has no convex hull of any volume: it is flat, or far too small for its coordinates") from error
