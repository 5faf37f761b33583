"""Render surfaces of parts: crease-aware normals and box-projected texture coordinates (NumPy only)."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

import numpy as np

from ...worlds.arrays import F32, F64, I32, RigidPose
from ...worlds.built import TriangleMesh
from .textures import BOARD_LENGTH, BOARDS, Tile, board_joint, brick_middle

__all__ = ["CREASE", "Surface", "corner_normals", "soft_normals", "textured_surfaces"]

CREASE = np.cos(np.radians(40.0))
"""Cosine of the angle between faces above which an edge stays sharp on a smooth part; own choice."""


@dataclass(frozen=True)
class Surface:
    """Triangles with a normal and a texture coordinate per vertex, in the body's frame."""

    positions: F64
    normals: F64
    uv: F64
    faces: I32


def _face_normals(vertices: F64, faces: I32) -> F64:
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.asarray(normals / np.maximum(length, 1e-300))


def _corner_angles(vertices: F64, faces: I32) -> F64:
    """Interior angle [rad] at each corner, shape (m, 3)."""
    corners = vertices[faces]
    one = np.roll(corners, -1, axis=1) - corners
    two = np.roll(corners, 1, axis=1) - corners
    dot = (one * two).sum(-1)
    return np.asarray(np.arctan2(np.linalg.norm(np.cross(one, two), axis=-1), dot))


def corner_normals(mesh: TriangleMesh, *, smooth: bool) -> F64:
    """Normals at the corners of every face, shape (m, 3, 3).

    On a smooth part a corner averages, weighted by interior angle, the faces around its vertex that turn by less
    than `CREASE` from its own face; so a cylinder's rim stays sharp.
    """
    faces, flat = mesh.faces, _face_normals(mesh.vertices, mesh.faces)
    if not smooth or len(faces) == 0:
        return np.repeat(flat[:, None], 3, axis=1)
    _, welded = np.unique(np.round(mesh.vertices, 9), axis=0, return_inverse=True)
    corner_vertex = welded.reshape(-1)[faces].reshape(-1)
    corner_face = np.repeat(np.arange(len(faces)), 3)
    weight = _corner_angles(mesh.vertices, faces).reshape(-1)
    order = np.argsort(corner_vertex, kind="stable")
    starts = np.searchsorted(corner_vertex[order], corner_vertex, side="left")
    counts = np.searchsorted(corner_vertex[order], corner_vertex, side="right") - starts
    corner = np.repeat(np.arange(len(corner_vertex)), counts)
    ramp = np.arange(len(corner)) - np.repeat(np.cumsum(counts) - counts, counts)
    other = order[starts[corner] + ramp]
    near = (flat[corner_face[corner]] * flat[corner_face[other]]).sum(1) > CREASE
    corner, other = corner[near], other[near]
    result = np.zeros((len(corner_vertex), 3))
    np.add.at(result, corner, flat[corner_face[other]] * weight[other, None])
    length = np.linalg.norm(result, axis=1, keepdims=True)
    result = np.where(length > 1e-12, result / np.maximum(length, 1e-12), flat[corner_face])
    return result.reshape(-1, 3, 3)


SOFTENING = 6
"""Passes that soften the normals of a liquid; own choice: ripples of single particles go, waves of three spacings stay."""


def soft_normals(vertices: F64, faces: I32) -> F32:
    """Normals of a closed surface without creases, averaged over neighbours; shape (v, 3)."""
    from scipy.sparse import csr_matrix

    count = len(vertices)
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    corner = faces.reshape(-1)
    normals: F64 = np.stack([np.bincount(corner, np.repeat(across[:, k], 3), minlength=count) for k in range(3)], axis=1).astype(
        float
    )
    start, end = faces.reshape(-1), np.roll(faces, -1, axis=1).reshape(-1)
    near = csr_matrix((np.ones(len(start)), (start, end)), shape=(count, count))
    near = near + near.T
    for _ in range(SOFTENING):
        normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
        normals = normals + 0.5 * (near @ normals) / np.maximum(np.asarray(near.sum(1)), 1)
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    return normals.astype(np.float32)


def _unit_hash(key: str) -> F64:
    """Three repeatable numbers in [0, 1) from a name."""
    raw = hashlib.sha256(key.encode()).digest()[:12]
    return np.frombuffer(raw, dtype="<u4").astype(np.float64) / 2**32


def _period(scale: float, extent: F64) -> float:
    """Pattern period [m] that still reads as the pattern on a part of this size."""
    return float(min(scale, 1.2 * max(np.sort(extent)[1], 1e-4)))


def _compact(mesh: TriangleMesh, faces: I32, normals: F64, uv: F64) -> Surface:
    """Merge equal corners of `faces` into vertices."""
    flat_faces = faces.reshape(-1)
    key = np.concatenate(
        [flat_faces[:, None].astype(np.float64), np.round(normals.reshape(-1, 3), 5), np.round(uv.reshape(-1, 2), 7)], axis=1
    )
    _, first, index = np.unique(key, axis=0, return_index=True, return_inverse=True)
    return Surface(
        mesh.vertices[flat_faces[first]],
        normals.reshape(-1, 3)[first],
        uv.reshape(-1, 2)[first],
        index.reshape(-1, 3).astype(np.int32),
    )


def _project(local: F64, axis: int, grain: int, tile: Tile, period: float, key: str, pattern: str) -> F64:
    """Texture coordinates of points (..., 3) seen along `axis`; wood runs along `grain`."""
    rest = [k for k in range(3) if k != axis]
    if axis != grain and pattern != "bricks":  # courses run level, whichever way is longest
        rest = [grain, next(k for k in rest if k != grain)]
    coordinates = local[..., rest] / period
    random = _unit_hash(f"{key}/{axis}")
    low, high = coordinates.reshape(-1, 2).min(0), coordinates.reshape(-1, 2).max(0)
    if pattern == "wood" and axis != grain and high[1] - low[1] <= 0.95:
        board = int(random[0] * BOARDS)
        slack = max(0.0, BOARD_LENGTH - 0.2 - (high[0] - low[0]))
        start = np.array([board_joint(board) + 0.1 + random[1] * slack, board + 0.025 + random[2] * (0.95 - high[1] + low[1])])
        coordinates = coordinates - low + start
    elif pattern == "wood":
        coordinates = coordinates - low + np.floor(random[:2] * 4) * np.array([1.7, 1.0])
    return np.asarray(coordinates / np.array(tile.periods))


def textured_surfaces(
    mesh: TriangleMesh,
    *,
    smooth: bool,
    tiles: dict[str, Tile],
    pattern: str,
    scale: float,
    frame: RigidPose,
    key: str,
) -> dict[str, Surface]:
    """Surfaces of a part by texture layer (`side`, and `end` for wood's end grain).

    Args:
        mesh: the part's visible surface in the body's frame.
        smooth: interpolate normals, except over creases.
        tiles: the pattern's tiles by layer; empty for a plain colour.
        pattern: name of the pattern.
        scale: size of one pattern period [m].
        frame: the part's own frame in the body's frame: textures are aligned with it.
        key: name that decides which piece of the tile the part shows.
    """
    normals = corner_normals(mesh, smooth=smooth)
    if not tiles:
        return {"side": _compact(mesh, mesh.faces, normals, np.zeros((len(mesh.faces), 3, 2)))}
    inverse = frame.inverse()
    local = inverse.apply(mesh.vertices)
    axes = np.abs(_face_normals(local, mesh.faces)).argmax(1)
    extent = np.ptp(local, axis=0)
    grain = int(extent.argmax())
    if pattern == "bricks" and np.sort(extent)[1] < scale:  # it is a brick or a piece of one, not masonry
        uv = np.broadcast_to(brick_middle(_unit_hash(key)), (len(mesh.faces), 3, 2))
        return {"side": _compact(mesh, mesh.faces, normals, np.ascontiguousarray(uv))}
    period = scale if pattern == "bricks" else _period(scale, extent)
    uv = np.zeros((len(mesh.faces), 3, 2))
    for axis in range(3):
        chosen = axes == axis
        if chosen.any():
            tile = tiles["end" if axis == grain and "end" in tiles else "side"]
            uv[chosen] = _project(local[mesh.faces[chosen]], axis, grain, tile, period, key, pattern)
    if "end" not in tiles:
        return {"side": _compact(mesh, mesh.faces, normals, uv)}
    layers = {"side": axes != grain, "end": axes == grain}
    return {n: _compact(mesh, mesh.faces[m], normals[m], uv[m]) for n, m in layers.items() if m.any()}
