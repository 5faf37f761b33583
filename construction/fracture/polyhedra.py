"""Convex polyhedra as polygons of their facets, cut by planes in double precision."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...worlds.arrays import F64, I32
from ...worlds.built import TriangleMesh

__all__ = ["Facet", "Polyhedron", "clip", "facets_of", "hull_mesh", "overlap", "polyhedron_of"]

FLAT = 1e-10
"""Relative to the size: heights that count as lying in a plane. Rounding of coordinates is 1e-15 of it."""
PARALLEL = 1e-9
"""1 - cosine between normals of planes that count as one."""


@dataclass(frozen=True)
class Facet:
    """One flat side."""

    normal: F64
    """Outward unit normal, shape (3,)."""
    offset: float
    """Plane: normal . x = offset [m]."""
    corners: F64
    """In order around the facet, counter-clockwise seen from outside [m], shape (k, 3)."""


@dataclass(frozen=True)
class Polyhedron:
    """A convex body given by its facets."""

    facets: tuple[F64, ...]
    """Corners of each facet in order [m], shape (k, 3) each."""

    @property
    def points(self) -> F64:
        """Corners of all facets, with repetitions, shape (n, 3)."""
        return np.concatenate(self.facets)


def _around(points: F64, normal: F64) -> F64:
    """Corners of a convex polygon in order, counter-clockwise about `normal`."""
    first = np.cross(normal, np.eye(3)[int(np.abs(normal).argmin())])
    first /= np.linalg.norm(first)
    arms = points - points.mean(axis=0)
    angle = np.arctan2(arms @ np.cross(normal, first), arms @ first)
    return np.asarray(points[np.argsort(angle, kind="stable")])


def _distinct(points: F64, tolerance: float) -> F64:
    """Points without those within `tolerance` [m] of an earlier one."""
    apart = np.linalg.norm(points[:, None] - points[None], axis=2) > tolerance
    keep = [i for i in range(len(points)) if apart[i, :i].all()]
    return points[keep]


def facets_of(points: F64) -> list[Facet]:
    """Facets of the convex hull of points, shape (n, 3); coplanar triangles are merged."""
    from scipy.spatial import ConvexHull

    hull = ConvexHull(points)
    size = float(np.ptp(points, axis=0).max())
    found: list[Facet] = []
    open_ = np.ones(len(hull.equations), dtype=bool)
    for k, plane in enumerate(hull.equations):
        if not open_[k]:
            continue
        same = open_ & (hull.equations[:, :3] @ plane[:3] > 1 - PARALLEL)
        same &= np.abs(hull.equations[:, 3] - plane[3]) < 1e-7 * size
        open_ &= ~same
        corners = points[np.unique(hull.simplices[same])]
        found.append(Facet(plane[:3].copy(), -float(plane[3]), _around(corners, plane[:3])))
    return found


def polyhedron_of(points: F64) -> Polyhedron:
    """Convex hull of points, shape (n, 3)."""
    return Polyhedron(tuple(f.corners for f in facets_of(points)))


def clip(body: Polyhedron, normal: F64, offset: float) -> Polyhedron | None:
    """The part of a convex body where normal . x <= offset; None where nothing of it lies there."""
    points = body.points
    height = points @ normal - offset
    flat = FLAT * float(np.ptp(points, axis=0).max())
    if height.max() <= flat:
        return body
    if height.min() >= -flat:
        return None
    kept: list[F64] = []
    cut: list[F64] = []
    for corners in body.facets:
        above = corners @ normal - offset
        above[np.abs(above) <= flat] = 0.0
        if above.max() <= 0.0:
            kept.append(corners)
            cut += list(corners[above == 0.0])
            continue
        if above.min() >= 0.0:
            cut += list(corners[above == 0.0])
            continue
        ahead, after = np.roll(corners, -1, axis=0), np.roll(above, -1)
        polygon: list[F64] = []
        for p, q, a, b in zip(corners, ahead, above, after, strict=True):
            if a <= 0.0:
                polygon.append(p)
            if a == 0.0:
                cut.append(p)
            if a * b < 0.0:
                # From the lower end, so that both facets at an edge get the same point.
                low, high, x, y = (p, q, a, b) if a < b else (q, p, b, a)
                point = low + (high - low) * (x / (x - y))
                polygon.append(point)
                cut.append(point)
        if len(polygon) > 2:
            kept.append(np.array(polygon))
    rim = _distinct(np.array(cut), 10 * flat)
    if len(rim) > 2:
        kept.append(_around(rim, normal))
    return Polyhedron(tuple(kept)) if len(kept) > 3 else None


def hull_mesh(points: F64) -> TriangleMesh:
    """Convex hull as a closed mesh without repeated vertices."""
    from scipy.spatial import ConvexHull

    hull = ConvexHull(points)
    used, faces = np.unique(hull.simplices, return_inverse=True)
    vertices = points[used]
    triangles = faces.reshape(-1, 3)
    corner = vertices[triangles]
    out = np.einsum("ij,ij->i", np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), hull.equations[:, :3])
    triangles = np.where((out < 0)[:, None], triangles[:, ::-1], triangles)
    order: I32 = np.ascontiguousarray(triangles, dtype=np.int32)
    return TriangleMesh(np.ascontiguousarray(vertices), order)


def overlap(one: F64, other: F64) -> F64:
    """Intersection of two convex polygons in a plane, counter-clockwise, shapes (k, 2) and (m, 2) -> (n, 2), n may be 0."""
    found = one
    for p, q in zip(other, np.roll(other, -1, axis=0), strict=True):
        edge = q - p
        side = edge[0] * (found[:, 1] - p[1]) - edge[1] * (found[:, 0] - p[0])
        side[np.abs(side) < FLAT * float(edge @ edge)] = 0.0
        if (side >= 0).all():
            continue
        if (side <= 0).all():
            return np.zeros((0, 2))
        polygon: list[F64] = []
        for a, b, x, y in zip(found, np.roll(found, -1, axis=0), side, np.roll(side, -1), strict=True):
            if x >= 0:
                polygon.append(a)
            if x * y < 0:
                polygon.append(a + (b - a) * (x / (x - y)))
        found = np.array(polygon).reshape(-1, 2)
        if len(found) < 3:
            return np.zeros((0, 2))
    return found
