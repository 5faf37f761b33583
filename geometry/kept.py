"""Prepared surfaces, kept by content: grounds and other large things stay while smaller ones are placed on them."""

from __future__ import annotations

import hashlib

from ..worlds.built import TriangleMesh
from .recent import Recent
from .solids import Solid

__all__ = ["kept_solid"]

KEPT_FACES = 1_200_000
"""Triangles of surfaces whose search trees are kept: about 500 MB."""
LARGE = 500
"""Triangles from which on a surface is worth keeping."""
PER_FACE = 64
"""Entries of the table of facets and vertices of a convex surface that weigh as much as a triangle with its trees."""

_kept: Recent[Solid] = Recent(KEPT_FACES)
"""By content."""


def kept_solid(mesh: TriangleMesh, *, closed: bool) -> Solid:
    """The mesh ready for queries, with all that was derived from it before.

    Args:
        mesh: the surface.
        closed: whether it is meant to bound a volume.

    Raises:
        InputError: no triangle with area is left, or a coordinate is not finite.
    """
    if len(mesh.faces) < LARGE:
        return Solid.from_mesh(mesh, closed=closed)
    state = hashlib.sha256(repr((mesh.vertices.shape, mesh.vertices.dtype, mesh.faces.dtype, closed)).encode())
    state.update(mesh.vertices.tobytes())
    state.update(mesh.faces.tobytes())
    return _kept.of(state.digest(), lambda: Solid.from_mesh(mesh, closed=closed), _weight)


def _weight(solid: Solid) -> int:
    table = len(solid.faces) * len(solid.vertices) if solid.convex else 0
    return len(solid.faces) + table // PER_FACE
