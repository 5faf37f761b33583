"""Turn of a ground's facets along a way: a body that rolls over them cannot tell it from a bounce."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from ...worlds.arrays import F64
from ...worlds.spec import HeightField

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["even_ground"]


def even_ground(candidate: Candidate, entity: str, point: F64, way: F64, *, most: float) -> bool:
    """True if the facets of a ground along a way turn by less than an angle; true for what is no height field.

    Args:
        candidate: what is judged.
        entity: what may be ground.
        point: where the way begins [m], shape (3,).
        way: from there on [m], shape (3,).
        most: the angle [rad].
    """
    fields = tuple(name for name, part in candidate.spec.entities[entity].parts.items() if isinstance(part.shape, HeightField))
    if not fields:
        return True
    pose = candidate.pose(entity, 0)
    for part in candidate.entity(entity).parts:
        if part.part not in fields:
            continue
        corners, normals = _facets(part.render.vertices.tobytes(), part.render.faces.tobytes())
        low, high = (f([point, point + way], axis=0)[:2] for f in (np.min, np.max))
        local = pose.inverse()
        ends = local.apply(
            np.array([[*low, point[2]], [*high, point[2]], [low[0], high[1], point[2]], [high[0], low[1], point[2]]])
        )[:, :2]
        low, high = ends.min(axis=0), ends.max(axis=0)
        near = (corners.max(axis=1)[:, :2] >= low).all(axis=1) & (corners.min(axis=1)[:, :2] <= high).all(axis=1)
        own = normals[near & (normals[:, 2] > 0)]
        if len(own) > 1 and float(np.arccos(np.clip((own @ own.T).min(), -1, 1))) > most:
            return False
    return True


@lru_cache(maxsize=4)
def _facets(vertices: bytes, faces: bytes) -> tuple[F64, F64]:
    """Corners (n, 3, 3) and unit normals (n, 3) of triangles."""
    corners = np.frombuffer(vertices).reshape(-1, 3)[np.frombuffer(faces, dtype=np.int32).reshape(-1, 3)]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return corners, normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
