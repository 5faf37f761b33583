"""Which instance is seen in which pixel, by exact ray casting without GL, JIT or a device.

A ray through a pixel centre is linear in the pixel's coordinates, so the three signed volumes of the ray with the edges
of a triangle, and the reciprocal depth, are linear too: they are evaluated over the pixels of each triangle's bounding
rectangle only. Homogeneous edge functions need no clipping at the eye plane. Source: Olano and Greer (1997),
doi:10.1145/258694.258723.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F64, I32, RigidPose, rotation_matrix
from ..worlds.built import TriangleMesh
from ..worlds.errors import InputError
from .camera import Camera

__all__ = [
    "IdCaster",
    "IdImage",
]

F32 = NDArray[np.float32]
LARGE = 512
"""Pixels of a bounding rectangle from which on a triangle is drawn by itself; measured."""
CHUNK = 1_000_000
"""Triangle-pixel pairs drawn at once."""
SEAM = 1e-12
"""Barycentric overlap of neighbouring triangles, so that no ray slips through their common edge."""
ROUNDED = 1e-9
"""Share of its terms by which an edge function may err, a million times what rounding does and a thousand times the seam."""
NEAR = 1e-9
"""Least depth [m] of a hit."""


class IdImage(NamedTuple):
    """Instances, depths and normals in the pixels of one view."""

    ids: I32
    """Index of the instance in front, shape (height, width); -1 where nothing is."""
    depth: F32
    """Depth along the viewing axis [m], shape (height, width); inf where nothing is."""
    normals: F32
    """World normal of the triangle hit, outward by its winding, shape (height, width, 3); 0 where nothing is."""


class IdCaster:
    """Casts rays at a fixed list of rigid instances. Both sides of every triangle are seen."""

    def __init__(self, meshes: Sequence[TriangleMesh]) -> None:
        self._count = len(meshes)
        counts = [len(m.vertices) for m in meshes]
        starts = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
        empty = np.empty((0, 3))
        self._vertices = np.concatenate([empty, *(np.asarray(m.vertices, dtype=np.float64).reshape(-1, 3) for m in meshes)])
        self._vertex_start = starts
        faces = [np.asarray(m.faces, dtype=np.int64).reshape(-1, 3) + s for m, s in zip(meshes, starts, strict=False)]
        self._faces = np.concatenate([empty.astype(np.int64), *faces])
        self._owner = np.repeat(np.arange(self._count), [len(f) for f in faces])

    def reshaped(self, shapes: Mapping[int, F64]) -> IdCaster:
        """A caster at the same instances, of which some have other vertices, as many as before, shape (n, 3)."""
        if not shapes:
            return self
        made = copy(self)
        made._vertices = self._vertices.copy()
        for i, vertices in shapes.items():
            made._vertices[self._vertex_start[i] : self._vertex_start[i + 1]] = vertices
        return made

    def cast(
        self,
        camera: Camera,
        poses: Sequence[RigidPose],
        *,
        only: Sequence[int] | None = None,
        window: tuple[int, int, int, int] | None = None,
        until: float = np.inf,
        normals: bool = True,
    ) -> IdImage:
        """Look at the instances at `poses`.

        Args:
            camera: the view.
            poses: pose of each instance.
            only: indices of the instances to look at, as if the others were not there; default all.
            window: first and last (exclusive) column, first and last row of the part of the picture to cast; default all.
            until: triangles that lie whole beyond this depth [m] may be left out.
            normals: whether to work normals out; without, they are 0.

        Raises:
            InputError: the number of poses differs from the number of instances, or the window is empty or beyond the picture.
        """
        if len(poses) != self._count:
            raise InputError(f"{len(poses)} poses for {self._count} instances; give one pose per instance")
        x0, x1, y0, y1 = window or (0, camera.width, 0, camera.height)
        if not (0 <= x0 < x1 <= camera.width and 0 <= y0 < y1 <= camera.height):
            raise InputError(f"window {window} must lie in the picture of {camera.width} x {camera.height} pixels")
        chosen = np.ones(self._count, dtype=bool)
        if only is not None:
            chosen[:] = False
            chosen[list(only)] = True
        local = self._camera_vertices(camera, poses, chosen)
        faces = np.flatnonzero(chosen[self._owner])
        if np.isfinite(until):
            near = local[:, 2] <= until
            faces = faces[near[self._faces[faces]].any(axis=1)]
        index, rectangle = _rectangles(camera, local, self._faces, faces, (x0, x1, y0, y1))
        buffer = _Buffer(camera, (x0, x1, y0, y1))
        buffer.draw(local[self._faces[index]], index, rectangle)
        return self._image(camera, local, buffer, normals=normals)

    def _camera_vertices(self, camera: Camera, poses: Sequence[RigidPose], chosen: NDArray[np.bool_]) -> F64:
        """Vertices of the chosen instances in camera coordinates with the viewing axis as +z: (right, down, forward)."""
        flip = np.array([1.0, -1.0, -1.0])[:, None] * camera.axes
        local = np.zeros_like(self._vertices)
        for i, pose in enumerate(poses):
            if not chosen[i]:
                continue
            part = slice(self._vertex_start[i], self._vertex_start[i + 1])
            turn = flip @ rotation_matrix(pose.quaternion)
            local[part] = self._vertices[part] @ turn.T + flip @ (pose.position - camera.position)
        return local

    def _image(self, camera: Camera, local: F64, buffer: _Buffer, *, normals: bool) -> IdImage:
        face = buffer.face.reshape(buffer.height, buffer.width)
        hit = face >= 0
        ids = np.full(face.shape, -1, dtype=np.int32)
        ids[hit] = self._owner[face[hit]]
        facing = np.zeros((*face.shape, 3), dtype=np.float32)
        if normals:
            seen, inverse = np.unique(face[hit], return_inverse=True)
            corner = local[self._faces[seen]]
            normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
            normal /= np.linalg.norm(normal, axis=1)[:, None]
            flip = np.array([1.0, -1.0, -1.0])[:, None] * camera.axes
            facing[hit] = (normal @ flip)[inverse]
        depth = np.where(hit, buffer.depth.reshape(face.shape), np.inf).astype(np.float32)
        return IdImage(ids, depth, facing)


def _rectangles(
    camera: Camera, local: F64, faces: NDArray[np.int64], index: NDArray[np.intp], window: tuple[int, int, int, int]
) -> tuple[NDArray[np.intp], I32]:
    """Triangles that can cover a pixel centre and the pixels they may cover: x0, x1, y0, y1 (exclusive ends)."""
    z = local[:, 2]
    front = z > NEAR
    scale = camera.focal / np.where(front, z, 1.0)
    x = 0.5 * camera.width + local[:, 0] * scale
    y = 0.5 * camera.height + local[:, 1] * scale
    # Corner by corner: sums over an axis of three are slow.
    a, b, c = (faces[index, k] for k in range(3))
    seen = front[a] | front[b] | front[c]
    if not seen.all():
        index, a, b, c = index[seen], a[seen], b[seen], c[seen]
    whole = front[a] & front[b] & front[c]
    bounds = np.empty((4, len(index)))
    for k, (value, start, stop) in enumerate(((x, *window[:2]), (y, *window[2:]))):
        first, second, third = value[a], value[b], value[c]
        low, high = np.minimum(np.minimum(first, second), third), np.maximum(np.maximum(first, second), third)
        # Triangles through the eye plane may cover anything.
        bounds[2 * k] = np.clip(np.where(whole, np.ceil(low - 0.5), start), start, stop)
        bounds[2 * k + 1] = np.clip(np.where(whole, np.floor(high - 0.5) + 1, stop), start, stop)
    some = (bounds[0] < bounds[1]) & (bounds[2] < bounds[3])
    return index[some], np.ascontiguousarray(bounds[:, some].T).astype(np.int32)


def _reaching(edge: F64, rectangle: I32) -> NDArray[np.bool_]:
    """Triangles that may cover a pixel of their rectangles, by edge functions that are largest at a corner of it.

    Of a ground under the camera many triangles lead through the eye plane, and their rectangles are whole windows.
    """
    edge = np.concatenate([edge, edge.sum(axis=1, keepdims=True)], axis=1)
    ends = rectangle[:, None, :].astype(np.float64)
    column, row, rest = edge[..., :1], edge[..., 1:2], edge[..., 2]
    most = (column * ends[..., :2]).max(axis=2) + (row * ends[..., 2:]).max(axis=2) + rest
    size = (np.abs(column) * ends[..., :2]).max(axis=2) + (np.abs(row) * ends[..., 2:]).max(axis=2) + np.abs(rest)
    return np.asarray((most >= -ROUNDED * size).all(axis=1))


class _Buffer:
    """Depth buffer of triangles, flat over the pixels of a window."""

    def __init__(self, camera: Camera, window: tuple[int, int, int, int]) -> None:
        self.camera = camera
        self.left, self.top = window[0], window[2]
        self.width, self.height = window[1] - window[0], window[3] - window[2]
        self.depth = np.full(self.width * self.height, np.inf)
        self.face = np.full(self.width * self.height, -1, dtype=np.int64)

    def draw(self, corner: F64, index: NDArray[np.intp], rectangle: I32) -> None:
        """Draw triangles with camera-space corners, shape (n, 3, 3)."""
        a, b, c = corner[:, 0], corner[:, 1], corner[:, 2]
        edge = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)
        volume = np.einsum("ni,ni->n", a, edge[:, 0])
        solid = volume != 0.0
        edge, index, rectangle = edge[solid] / volume[solid][:, None, None], index[solid], rectangle[solid]
        # Ray (x, y, 1) with x = (column + 0.5 - w / 2) / f: the edge functions as column, row, constant coefficients.
        camera = self.camera
        edge[:, :, 2] += (edge[:, :, 0] * (0.5 - 0.5 * camera.width) + edge[:, :, 1] * (0.5 - 0.5 * camera.height)) / camera.focal
        edge[:, :, :2] /= camera.focal
        wide, high = rectangle[:, 1] - rectangle[:, 0], rectangle[:, 3] - rectangle[:, 2]
        area = wide.astype(np.int64) * high
        large = np.flatnonzero(area > LARGE)
        large = large[_reaching(edge[large], rectangle[large])]
        self._draw_large(edge[large], index[large], rectangle[large])
        small = np.flatnonzero(area <= LARGE)
        self._draw_small(edge[small], index[small], rectangle[small], _chunks(area[small]))

    def _draw_large(self, edge: F64, index: NDArray[np.intp], rectangle: I32) -> None:
        from .draw_kernels import draw_large

        draw_large(edge, index, rectangle, (self.left, self.top), (SEAM, NEAR), *self._pictures)

    def _draw_small(self, edge: F64, index: NDArray[np.intp], rectangle: I32, chunk: NDArray[np.int64]) -> None:
        from .draw_kernels import draw_small

        draw_small(edge, index, rectangle, chunk, (self.left, self.top), (SEAM, NEAR), *self._pictures)

    @property
    def _pictures(self) -> tuple[F64, NDArray[np.int64]]:
        """Depths and triangles by row and column."""
        return self.depth.reshape(self.height, self.width), self.face.reshape(self.height, self.width)


def _chunks(area: NDArray[np.int64]) -> NDArray[np.int64]:
    """Number of the chunk of each triangle, of as many as have `CHUNK` pixels together."""
    total, found = np.cumsum(area), np.zeros(len(area), dtype=np.int64)
    start = number = 0
    while start < len(area):
        stop = max(start + 1, int(np.searchsorted(total, (total[start - 1] if start else 0) + CHUNK, side="right")))
        found[start:stop] = number
        start, number = stop, number + 1
    return found
