"""Visible meshes and collision pieces of every shape kind, in the part's own frame."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from ..geometry import ground_solid
from ..worlds.arrays import F64, RigidPose
from ..worlds.built import Convex, TriangleMesh
from ..worlds.errors import InputError
from ..worlds.spec import (
    Boolean,
    Box,
    Capsule,
    Cylinder,
    Extrusion,
    HeightField,
    Hull,
    Loft,
    Mesh,
    Revolution,
    Shape,
    Sphere,
    StemField,
    Sweep,
    Text,
    Wedge,
)
from .composed import combined, lettered, lofted
from .imports import load_heights, load_mesh
from .polygons import convex_partition, signed_area, triangulate
from .stems import load_stems
from .sweeps import swept
from .turned import stacked_pieces

__all__ = ["ShapeGeometry", "build_shape"]

FACETS = 64
"""Segments around cylinders and capsules: facet error 0.12 % of the radius."""
SPHERE_SUBDIVISIONS = 4
"""Icosphere level: 5,120 triangles, facet error about 0.06 % of the radius."""
IDENTITY = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
NO_POINTS: F64 = np.zeros((0, 3))


@dataclass(frozen=True)
class ShapeGeometry:
    """A shape made concrete.

    `mass` is (volume [m^3], centre [m] (3,), inertia of unit density about the centre (3, 3)) where an exact
    formula exists, else None (then the closed visible mesh is integrated).
    """

    render: TriangleMesh
    collision: tuple[Convex, ...]
    smooth: bool
    facet_error: float
    """Largest distance of the analytic collision surface outside the visible mesh [m]."""
    mass: tuple[float, F64, F64] | None


def _mesh(vertices: object, faces: object) -> TriangleMesh:
    return TriangleMesh(np.ascontiguousarray(vertices, dtype=np.float64), np.ascontiguousarray(faces, dtype=np.int32))


def _hull(points: F64) -> Convex:
    return Convex("hull", (), IDENTITY, np.ascontiguousarray(points, dtype=np.float64))


def _box(shape: Box) -> ShapeGeometry:
    x, y, z = (s / 2 for s in shape.size)
    vertices = [(sx * x, sy * y, sz * z) for sx in (-1, 1) for sy in (-1, 1) for sz in (-1, 1)]
    faces = [
        (0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
        (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3),
    ]  # fmt: skip
    return ShapeGeometry(_mesh(vertices, faces), (Convex("box", (x, y, z), IDENTITY, NO_POINTS),), False, 0.0, None)


@lru_cache(maxsize=4)
def _icosphere(level: int) -> tuple[F64, tuple[tuple[int, int, int], ...]]:
    """Unit icosphere: vertices on the sphere and faces."""
    g = (1 + math.sqrt(5)) / 2
    points = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]  # fmt: skip
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]  # fmt: skip
    vertices = [np.array(p) / np.linalg.norm(p) for p in points]
    for _ in range(level):
        middle: dict[tuple[int, int], int] = {}

        def split(a: int, b: int, middle: dict[tuple[int, int], int] = middle) -> int:
            key = (min(a, b), max(a, b))
            if key not in middle:
                point = vertices[a] + vertices[b]
                vertices.append(point / np.linalg.norm(point))
                middle[key] = len(vertices) - 1
            return middle[key]

        finer = []
        for a, b, c in faces:
            ab, bc, ca = split(a, b), split(b, c), split(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = finer
    return np.array(vertices), tuple(faces)


def _sphere(shape: Sphere) -> ShapeGeometry:
    r = shape.radius
    unit, faces = _icosphere(SPHERE_SUBDIVISIONS)
    triangles = np.array(faces)
    sagitta = 1 - float(np.linalg.norm(unit[triangles].mean(1), axis=1).min())
    volume = 4 / 3 * math.pi * r**3
    inertia = np.eye(3) * (0.4 * volume * r * r)
    return ShapeGeometry(
        _mesh(unit * r, triangles),
        (Convex("sphere", (r,), IDENTITY, NO_POINTS),),
        True,
        sagitta * r,
        (volume, np.zeros(3), inertia),
    )


def _rings(profile: list[tuple[float, float]], on_axis: list[bool], segments: int) -> tuple[list[Any], list[list[int]]]:
    """Vertices of the rings that a profile of (r, z) turns into, one vertex where it is on the axis, and by ring their numbers."""
    vertices: list[tuple[float, float, float]] = []
    index: list[list[int]] = []
    angles = [2 * math.pi * k / segments for k in range(segments)]
    for (r, z), axis in zip(profile, on_axis, strict=True):
        start = len(vertices)
        vertices += [(0.0, 0.0, z)] if axis else [(r * math.cos(t), r * math.sin(t), z) for t in angles]
        index.append([start] * segments if axis else list(range(start, start + segments)))
    return vertices, index


def _band(low: list[int], high: list[int]) -> list[tuple[int, int, int]]:
    """Faces between two rings."""
    faces = []
    for k, n in enumerate([*range(1, len(low)), 0]):
        if low[k] != low[n]:
            faces.append((low[k], low[n], high[n]))
        if high[k] != high[n]:
            faces.append((low[k], high[n], high[k]))
    return faces


def _lathe(profile: list[tuple[float, float]], segments: int) -> TriangleMesh:
    """Closed surface from an open profile of (r, z) that starts and ends on the axis, walked upwards outside."""
    vertices, index = _rings(profile, [r <= 0 for r, _ in profile], segments)
    return _mesh(vertices, [face for low, high in itertools.pairwise(index) for face in _band(low, high)])


def _cylinder(shape: Cylinder) -> ShapeGeometry:
    r, h = shape.radius, shape.height
    mesh = _lathe([(0, -h / 2), (r, -h / 2), (r, h / 2), (0, h / 2)], FACETS)
    volume = math.pi * r * r * h
    side = volume * (3 * r * r + h * h) / 12
    inertia = np.diag([side, side, volume * r * r / 2])
    error = r * (1 - math.cos(math.pi / FACETS))
    return ShapeGeometry(
        mesh, (Convex("cylinder", (r, h / 2), IDENTITY, NO_POINTS),), False, error, (volume, np.zeros(3), inertia)
    )


def _capsule(shape: Capsule) -> ShapeGeometry:
    r, half = shape.radius, shape.length / 2
    steps = 12
    cap = [(r * math.cos(t), r * math.sin(t)) for t in (math.pi / 2 * k / steps for k in range(steps))]
    rings = [(0.0, -half - r), *[(c, -half - s) for c, s in reversed(cap)], *[(c, half + s) for c, s in cap], (0.0, half + r)]
    barrel, balls = math.pi * r * r * 2 * half, 4 / 3 * math.pi * r**3
    axial = barrel * r * r / 2 + balls * 0.4 * r * r
    side = barrel * (3 * r * r + 4 * half * half) / 12 + balls * (0.4 * r * r + half * half + 0.75 * half * r)
    error = r * (1 - math.cos(math.pi / FACETS) * math.cos(math.pi / 4 / steps))
    return ShapeGeometry(
        _lathe(rings, FACETS),
        (Convex("capsule", (r, half), IDENTITY, NO_POINTS),),
        True,
        error,
        (barrel + balls, np.zeros(3), np.diag([side, side, axial])),
    )


def _prism(polygon: list[tuple[float, float]], height: float) -> ShapeGeometry:
    if signed_area(polygon) < 0:
        polygon = polygon[::-1]
    n, half = len(polygon), height / 2
    vertices = [(x, y, -half) for x, y in polygon] + [(x, y, half) for x, y in polygon]
    faces = []
    for a, b, c in triangulate(polygon):
        faces += [(c, b, a), (a + n, b + n, c + n)]
    for k in range(n):
        m = (k + 1) % n
        faces += [(k, m, m + n), (k, m + n, k + n)]
    mesh = _mesh(vertices, faces)
    pieces = tuple(_hull(mesh.vertices[[*ring, *(i + n for i in ring)]]) for ring in convex_partition(polygon))
    return ShapeGeometry(mesh, pieces, False, 0.0, None)


def _wedge(shape: Wedge) -> ShapeGeometry:
    x, y, z = (s / 2 for s in shape.size)
    vertices = [(-x, -y, -z), (x, -y, -z), (-x, -y, z), (-x, y, -z), (x, y, -z), (-x, y, z)]
    faces = [(0, 1, 2), (3, 5, 4), (0, 3, 4), (0, 4, 1), (0, 2, 5), (0, 5, 3), (1, 4, 5), (1, 5, 2)]
    mesh = _mesh(vertices, faces)
    return ShapeGeometry(mesh, (_hull(mesh.vertices),), False, 0.0, None)


def _extrusion(shape: Extrusion) -> ShapeGeometry:
    return _prism(list(shape.polygon), shape.height)


def _turns_convex(ring: list[tuple[float, float]], on_axis: list[bool]) -> bool:
    """True if a convex profile revolves into a convex body: with an edge on the axis that nothing of it is above or below."""
    levels = [z for (_, z), axis in zip(ring, on_axis, strict=True) if axis]
    return len(levels) >= 2 and all(min(levels) - 1e-12 <= z <= max(levels) + 1e-12 for _, z in ring)


def _revolution(shape: Revolution) -> ShapeGeometry:
    """Each convex piece of the profile, times each segment, is a convex piece; a solid that goes up from axis to axis is a stack of fewer: both exact."""
    profile = list(shape.profile)
    if signed_area(profile) < 0:
        profile = profile[::-1]
    n, segments = len(profile), shape.segments
    on_axis = [r <= 1e-9 for r, _ in profile]
    vertices, index = _rings(profile, on_axis, segments)
    faces = []
    for k in range(n):
        m = (k + 1) % n
        if not (on_axis[k] and on_axis[m]):
            faces += _band(index[k], index[m])
    mesh = _mesh(vertices, faces)
    rings = convex_partition(profile)
    discs = [r for r in rings if _turns_convex([profile[i] for i in r], [on_axis[i] for i in r])]
    stack = stacked_pieces(profile, on_axis)
    if stack and len(stack) < len(discs) + segments * (len(rings) - len(discs)):
        return ShapeGeometry(
            mesh, tuple(_hull(mesh.vertices[sorted({v for i in p for v in index[i]})]) for p in stack), True, 0.0, None
        )
    pieces = []
    for ring in rings:
        if ring in discs:
            # One convex piece: a disc, not a cake of wedges.
            pieces.append(_hull(mesh.vertices[sorted({v for i in ring for v in index[i]})]))
            continue
        for s in range(segments):
            corners = sorted({index[i][t] for i in ring for t in (s, (s + 1) % segments)})
            pieces.append(_hull(mesh.vertices[corners]))
    return ShapeGeometry(mesh, tuple(pieces), True, 0.0, None)


def _heightfield(shape: HeightField, assets: Path) -> ShapeGeometry:
    z = load_heights(shape, assets)
    mesh = ground_solid(z, shape.size, shape.base)
    piece = Convex("heightfield", (shape.size[0] / 2, shape.size[1] / 2, shape.base), IDENTITY, z)
    # The engine cuts each cell along the same diagonal, from south-west to north-east, so nothing deviates.
    return ShapeGeometry(mesh, (piece,), True, 0.0, None)


def _convex_hull(shape: Hull) -> ShapeGeometry:
    from scipy.spatial import ConvexHull, QhullError

    points = np.array(shape.points, dtype=np.float64)
    try:
        hull = ConvexHull(points)
    except QhullError as error:
        raise InputError("the points of a hull lie in one plane; give at least 4 that do not") from error
    corners = points[hull.vertices]
    number = {int(v): k for k, v in enumerate(hull.vertices)}
    faces = np.array([[number[int(v)] for v in face] for face in hull.simplices])
    a, b, c = corners[faces].transpose(1, 0, 2)
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0
    faces[inward] = faces[inward][:, ::-1]
    return ShapeGeometry(_mesh(corners, faces), (_hull(corners),), False, 0.0, None)


def _composed(shape: Loft | Text | Boolean, assets: Path) -> ShapeGeometry:
    if isinstance(shape, Loft):
        mesh, pieces = lofted(shape)
    elif isinstance(shape, Text):
        mesh, pieces = lettered(shape)
    else:
        mesh, pieces = combined(shape, lambda member: build_shape(member, assets).collision)
    return ShapeGeometry(mesh, pieces, False, 0.0, None)


def build_shape(shape: Shape, assets: Path) -> ShapeGeometry:
    """Visible mesh and collision pieces of a shape.

    Args:
        shape: any of the specification's shapes.
        assets: folder that mesh files are read from.

    Raises:
        InputError: a polygon or mesh that is not a closed solid.
    """
    match shape:
        case Box():
            return _box(shape)
        case Sphere():
            return _sphere(shape)
        case Cylinder():
            return _cylinder(shape)
        case Capsule():
            return _capsule(shape)
        case Wedge():
            return _wedge(shape)
        case Extrusion():
            return _extrusion(shape)
        case Revolution():
            return _revolution(shape)
        case Hull():
            return _convex_hull(shape)
        case Sweep():
            mesh, pieces, smooth = swept(shape)
            return ShapeGeometry(mesh, pieces, smooth, 0.0, None)
        case Loft() | Text() | Boolean():
            return _composed(shape, assets)
        case HeightField():
            return _heightfield(shape, assets)
        case StemField():
            mesh, pieces, error = load_stems(shape, assets)
            return ShapeGeometry(mesh, pieces, False, error, None)
        case Mesh():
            mesh, pieces = load_mesh(shape, assets)
            return ShapeGeometry(mesh, pieces, False, 0.0, None)
    raise InputError(f"unknown shape kind {shape!r}")
