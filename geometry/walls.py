"""Thickness of a body where it is thin: what a fast body must pass to come out on the other side."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..worlds.arrays import F64
from .inside import distance_to_surface

if TYPE_CHECKING:
    from .solids import Solid

__all__ = ["wall_thickness"]

SAMPLES = 128
"""Own choice: places, spread evenly over the area, from which a wall is measured."""
THIN_SHARE = 0.05
"""Own choice: a twentieth of the area may be thinner (edges, tips)."""
PAIRS = 200_000
"""Ray-triangle pairs at once."""
START = 1e-9
"""Relative to the size: rays begin this far under the surface, so that they do not hit their own triangle."""


def wall_thickness(solid: Solid) -> float:
    """Thickness [m] of the walls of a closed solid; infinite for an open sheet, which has none.

    Convex: twice the depth of an inner point near the deepest one, which is the thickness of a plate. Otherwise rays
    are cast inwards from places on the surface, and the thickness is that which all but `THIN_SHARE` of them exceed.
    """
    if not solid.closed:
        return float("inf")
    if solid.convex:
        point = solid.interior_point
        assert point is not None
        return 2.0 * float(distance_to_surface(solid, point[None]).distance[0])
    area = np.linalg.norm(_cross(solid), axis=1)
    along = np.cumsum(area) / area.sum()
    faces = np.minimum(np.searchsorted(along, (np.arange(SAMPLES) + 0.5) / SAMPLES), len(area) - 1)
    inward = -solid.face_normals[faces] * (1.0 if solid.volume >= 0.0 else -1.0)
    # Off the middle, so that rays miss the edges of regular meshes.
    weight = np.array([0.371, 0.337, 0.292])
    origin = np.einsum("k,nki->ni", weight, solid.triangles[faces]) + START * solid.size * inward
    step = max(1, PAIRS // len(solid.triangles))
    chords = np.concatenate(
        [_exits(solid.triangles, origin[k : k + step], inward[k : k + step]) for k in range(0, len(origin), step)]
    )
    real = chords[np.isfinite(chords)]
    return float(np.quantile(real, THIN_SHARE)) if len(real) else solid.size


def _cross(solid: Solid) -> F64:
    t = solid.triangles
    return np.asarray(np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]))


def _exits(triangles: F64, origin: F64, direction: F64) -> F64:
    """Distance along each ray, shape (n, 3), to the first triangle [m], shape (n,); infinite where none is hit.

    Moeller and Trumbore (1997), doi:10.1080/10867651.1997.10487468.
    """
    a = triangles[:, 0]
    e1, e2 = triangles[:, 1] - a, triangles[:, 2] - a
    normal = np.cross(e2, e1)
    determinant = direction @ normal.T
    usable = determinant != 0.0
    inverse = 1.0 / np.where(usable, determinant, 1.0)
    s = origin[:, None] - a
    q = np.cross(s, e1)
    p = np.cross(direction[:, None], e2)
    u = np.einsum("rni,rni->rn", s, p) * inverse
    v = np.einsum("rni,ri->rn", q, direction) * inverse
    t = np.einsum("rni,ni->rn", q, e2) * inverse
    hit = usable & (u >= -1e-12) & (v >= -1e-12) & (u + v <= 1.0 + 1e-12) & (t > 0.0)
    return np.asarray(np.where(hit, t, np.inf).min(axis=1))
