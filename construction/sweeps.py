"""Profiles carried along paths: closed visible meshes, and a convex piece for each segment."""

from __future__ import annotations

import numpy as np

from ..geometry.booleans import union_volume
from ..worlds.arrays import F64, RigidPose, cross, length
from ..worlds.built import Convex, TriangleMesh
from ..worlds.errors import InputError
from ..worlds.spec import Sweep
from ..worlds.sweeps import side_faces, sweep_rings
from .polygons import convex_partition, signed_area, triangulate

__all__ = ["swept"]

IDENTITY = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
SMOOTH_SIDES = 8
"""Own choice: profiles of as many sides are drawn round."""
CROSSING = 1e-6
"""Own choice: share of the volume that pieces may have in common by rounding."""
LEVEL = 1e-12
"""[1] Own choice: share of its size by which a sweep may stand over the plane of a ring and still be on one side of it: rounding, far below `CROSSING`."""


def swept(shape: Sweep) -> tuple[TriangleMesh, tuple[Convex, ...], bool]:
    """Visible mesh, convex pieces and whether it is drawn smooth.

    The pieces fill the mesh exactly where nothing is scaled; where it is, sides of bent segments are not plane, and what lies
    between is measured as deviation.

    Raises:
        InputError: the profile or the path crosses itself.
    """
    if signed_area(shape.profile) < 0:
        shape = shape.model_copy(update={"profile": shape.profile[::-1]})
    try:
        rings = sweep_rings(shape)
    except ValueError as error:
        raise InputError(str(error)) from error
    count, corners = rings.shape[:2]
    caps = np.array(triangulate(shape.profile))
    faces = [side_faces(count, corners, closed=shape.closed)]
    if not shape.closed:
        faces += [caps, caps[:, ::-1] + (count - 1) * corners]
    mesh = TriangleMesh(rings.reshape(-1, 3), np.ascontiguousarray(np.concatenate(faces), dtype=np.int32))
    ahead = np.concatenate([rings, rings[:1]]) if shape.closed else rings
    partition = convex_partition(shape.profile)
    pieces = tuple(
        Convex("hull", (), IDENTITY, np.ascontiguousarray(np.concatenate([ahead[k, own], ahead[k + 1, own]])))
        for own in partition
        for k in range(len(ahead) - 1)
    )
    if len(partition) > 1 or not _apart_by_rings(ahead):
        _require_apart([p.points for p in pieces])
    return mesh, pieces, corners >= SMOOTH_SIDES


def _apart_by_rings(rings: F64) -> bool:
    """True if no two segments between neighbouring rings, shape (n, corners, 3), pass through each other: the plane of some ring is between them."""
    arms = rings - rings.mean(axis=1, keepdims=True)
    normals = cross(arms, np.roll(arms, -1, axis=1)).sum(axis=1)
    normals /= np.maximum(length(normals), np.finfo(float).tiny)[:, None]
    heights = np.einsum("rk,nck->rnc", normals, rings) - np.einsum("rk,rk->r", normals, rings.mean(axis=1))[:, None, None]
    slack = LEVEL * float(np.linalg.norm(np.ptp(rings.reshape(-1, 3), axis=0)))
    if np.abs(heights[np.arange(len(rings)), np.arange(len(rings))]).max() > slack:
        return False
    low, high = heights.min(axis=2), heights.max(axis=2)
    under = (np.maximum(high[:, :-1], high[:, 1:]) <= slack).astype(np.float64)
    over = (np.minimum(low[:, :-1], low[:, 1:]) >= -slack).astype(np.float64)
    between = under.T @ over
    return bool(((between + between.T > 0.0) | np.eye(len(between), dtype=bool)).all())


def _require_apart(pieces: list[F64]) -> None:
    """Refuse segments that pass through each other."""
    from scipy.spatial import ConvexHull

    if len(pieces) < 3:
        return
    alone = sum(float(ConvexHull(p).volume) for p in pieces)
    shared = 1.0 - union_volume(pieces) / alone
    if shared > CROSSING:
        raise InputError(
            f"the path passes through itself: {100 * shared:.2g} % of the volume is there twice; lead it past itself, or cut it"
        )
