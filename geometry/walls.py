"""Thickness of a body where it is thin: what a fast body must pass to come out on the other side."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..worlds.arrays import F64
from .inside import distance_to_surface
from .triangles import ray_hits

if TYPE_CHECKING:
    from .solids import Solid

__all__ = ["cut_thickness", "wall_thickness"]

SAMPLES = 128
"""Own choice: places, spread evenly over the area, from which a wall is measured."""
THIN_SHARE = 0.05
"""Own choice: a twentieth of the area may be thinner (edges, tips)."""
JOINT = 1e-6
"""Relative to the size of a body: faces of its pieces that are this near abut."""
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
    origin, inward = _places(solid)
    chords = _exits(solid.triangles, origin, inward)
    real = chords[np.isfinite(chords)]
    return float(np.quantile(real, THIN_SHARE)) if len(real) else solid.size


def cut_thickness(pieces: Sequence[Solid]) -> list[float]:
    """Thickness [m] of each piece of a body that is cut into closed solids, which abut where they were one; all in one frame.

    A piece is as thick as the walls of the whole body, or as itself where it is deepest if that is less: the sharp edges that an
    oblique cut leaves make no wall thinner. Chords of the whole body go on through faces at which pieces abut.
    """
    triangles = np.concatenate([p.triangles if p.volume >= 0.0 else p.triangles[:, ::-1] for p in pieces])
    size = float(np.ptp(triangles.reshape(-1, 3), axis=0).max())
    joint = JOINT * size
    chords, deepest = [], []
    for solid in pieces:
        origin, inward = _places(solid)
        own = _exits(solid.triangles, origin, inward)
        middles = (origin + 0.5 * own[:, None] * inward)[np.isfinite(own)]
        deepest.append(2.0 * float(distance_to_surface(solid, middles).distance.max()) if len(middles) else solid.size)
        # Right outside a place where pieces abut lies another face.
        outer = np.array(
            [(ray_hits(triangles, o[None], -i[None]) <= joint).sum() < 2 for o, i in zip(origin, inward, strict=True)]
        )
        chords.append(_ways_out(triangles, origin[outer], inward[outer], joint))
    known = np.concatenate(chords)
    known = known[np.isfinite(known)]
    whole = float(np.quantile(known, THIN_SHARE)) if len(known) else size
    return [min(whole, own) for own in deepest]


def _places(solid: Solid) -> tuple[F64, F64]:
    """Places just under the surface, spread evenly over its area, and the directions inwards, both of shape (`SAMPLES`, 3)."""
    area = np.linalg.norm(_cross(solid), axis=1)
    along = np.cumsum(area) / area.sum()
    faces = np.minimum(np.searchsorted(along, (np.arange(SAMPLES) + 0.5) / SAMPLES), len(area) - 1)
    inward = -solid.face_normals[faces] * (1.0 if solid.volume >= 0.0 else -1.0)
    # Off the middle, so that rays miss the edges of regular meshes.
    weight = np.array([0.371, 0.337, 0.292])
    return np.einsum("k,nki->ni", weight, solid.triangles[faces]) + START * solid.size * inward, inward


def _cross(solid: Solid) -> F64:
    t = solid.triangles
    return np.asarray(np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]))


def _ways_out(triangles: F64, origin: F64, direction: F64, joint: float) -> F64:
    """Length of each ray, shape (n, 3), from inside up to where it leaves all solids for more than `joint` [m], shape (n,)."""
    found = np.full(len(origin), np.inf)
    for ray, (start, along) in enumerate(zip(origin, direction, strict=True)):
        hits = ray_hits(triangles, start[None], along[None])[0]
        met = np.flatnonzero(np.isfinite(hits))
        leaves = np.einsum("ij,j->i", _normals(triangles[met]), along) > 0.0
        # Where two pieces abut, the one is entered before the other is left.
        order = np.argsort(hits[met] - np.where(leaves, 0.0, joint), kind="stable")
        inside = 1 + np.cumsum(np.where(leaves[order], -1, 1))
        out = np.flatnonzero(inside <= 0)
        if len(out):
            found[ray] = hits[met][order][out[0]]
    return found


def _normals(triangles: F64) -> F64:
    return np.asarray(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]))


def _exits(triangles: F64, origin: F64, direction: F64) -> F64:
    """Distance along each ray, shape (n, 3), to the first triangle [m], shape (n,); infinite where none is hit."""
    step = max(1, PAIRS // len(triangles))
    return np.concatenate(
        [ray_hits(triangles, origin[k : k + step], direction[k : k + step]).min(axis=1) for k in range(0, len(origin), step)]
    )
