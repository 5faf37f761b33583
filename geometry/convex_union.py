"""The proof that a surface is a union of convex solids, so that its inside is definite wherever they overlap."""

from __future__ import annotations

import numpy as np

from .solids import CONVEX_TOLERANCE, Solid

__all__ = ["is_convex_union"]

LARGEST = 1024
"""Most vertices of one of the solids; larger ones are not tried."""


def is_convex_union(solid: Solid) -> bool:
    """True if a closed surface consists of more than one connected piece, each of them convex and facing outwards.

    Of each piece no vertex stands above any of its face planes, so its winding number is 0 outside its hull and not negative
    inside; their sum is nowhere negative.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    if not (solid.closed and solid.is_watertight):
        return False
    faces, count = solid.faces.astype(np.int64), len(solid.vertices)
    one, two = faces.reshape(-1), np.roll(faces, 1, axis=1).reshape(-1)
    pieces, label = connected_components(coo_array((np.ones(len(one), dtype=np.int8), (one, two)), shape=(count, count)), False)
    if pieces < 2 or np.bincount(label).max() > LARGEST:
        return False
    points = np.split(np.argsort(label, kind="stable"), np.cumsum(np.bincount(label, minlength=pieces))[:-1])
    owner = label[faces[:, 0]]
    planes = np.split(np.argsort(owner, kind="stable"), np.cumsum(np.bincount(owner, minlength=pieces))[:-1])
    offsets = np.einsum("ij,ij->i", solid.face_normals, solid.triangles[:, 0])
    for own, sides in zip(points, planes, strict=True):
        corners = solid.vertices[own]
        size = float(np.linalg.norm(np.ptp(corners, axis=0)))
        height = solid.face_normals[sides] @ corners.T - offsets[sides, None]
        if len(sides) and height.max() > CONVEX_TOLERANCE * size:
            return False
    return True
