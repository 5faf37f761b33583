"""Sizes that the specification gives its parts, and sizes that were built: two routes to the same boxes (R87)."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64, cross, length, pose_of, rotation_matrix
from ...worlds.errors import EvidenceError
from ...worlds.spec import (
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
    Sheet,
    Sphere,
    StemField,
    Sweep,
    Text,
    Wedge,
)
from ...worlds.sweeps import sweep_rings
from .bounds import SPECK

if TYPE_CHECKING:
    from ...worlds.built import BuiltEntity
    from ...worlds.spec import Part, Region, Shape

__all__ = ["Extent", "built_extent", "part_extents", "region_diagonal", "specified_extent"]


class Extent(NamedTuple):
    """Axis-aligned box [m], shapes (3,)."""

    low: F64
    high: F64

    @property
    def size(self) -> F64:
        """Edges [m], shape (3,)."""
        return self.high - self.low


def specified_extent(part: Part) -> Extent | None:
    """Box of a part in the entity's frame, from the numbers of its shape and pose alone; None for a file, letters and booleans.

    Round shapes by their support function h(u) = max x . u; the others by their corners, meshes without dust.
    """
    pose = pose_of(part.pose)
    shape = part.shape
    turn = rotation_matrix(pose.quaternion)
    half: F64
    if isinstance(shape, Box):
        half = np.abs(turn) @ (0.5 * np.array(shape.size))
    elif isinstance(shape, Sphere):
        half = np.full(3, shape.radius)
    elif isinstance(shape, Cylinder):
        along = np.abs(turn[:, 2])
        half = shape.radius * np.sqrt(np.maximum(1.0 - along**2, 0.0)) + 0.5 * shape.height * along
    elif isinstance(shape, Capsule):
        half = shape.radius + 0.5 * shape.length * np.abs(turn[:, 2])
    elif isinstance(shape, Mesh):
        if shape.vertices is None or shape.faces is None:
            return None
        vertices = np.array(shape.vertices, dtype=np.float64) * shape.scale
        return _extent(pose.apply(vertices), np.array(shape.faces, dtype=np.intp))
    elif isinstance(shape, StemField | Text | Boolean) or (isinstance(shape, HeightField) and shape.heights is None):
        return None
    else:
        placed = pose.apply(_corners(shape))
        return Extent(placed.min(axis=0), placed.max(axis=0))
    return Extent(pose.position - half, pose.position + half)


def _corners(shape: Shape) -> F64:
    """Points whose convex hull is that of the shape, shape (n, 3)."""
    if isinstance(shape, Wedge):
        signs = np.array([[-1, -1, -1], [1, -1, -1], [-1, -1, 1], [-1, 1, -1], [1, 1, -1], [-1, 1, 1]])
        return np.asarray(0.5 * signs * np.array(shape.size))
    if isinstance(shape, Sheet):
        return np.array([[sx * shape.size[0] / 2, sy * shape.size[1] / 2, 0.0] for sx in (-1, 1) for sy in (-1, 1)])
    if isinstance(shape, Hull):
        return np.array(shape.points, dtype=np.float64)
    if isinstance(shape, Loft):
        return np.concatenate(
            [pose_of(s.pose).apply(np.column_stack([np.array(s.polygon), np.zeros(len(s.polygon))])) for s in shape.sections]
        )
    if isinstance(shape, Sweep):
        return sweep_rings(shape).reshape(-1, 3)
    if isinstance(shape, Extrusion):
        flat = np.array(shape.polygon, dtype=np.float64)
        return np.concatenate([np.column_stack([flat, np.full(len(flat), z)]) for z in (-shape.height / 2, shape.height / 2)])
    if isinstance(shape, Revolution):
        angle: F64 = np.linspace(0.0, 2.0 * np.pi, shape.segments, endpoint=False)
        profile: F64 = np.array(shape.profile, dtype=np.float64)
        radius, level = profile[:, 0], profile[:, 1]
        ring = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        flat = (radius[:, None, None] * ring).reshape(-1, 2)
        return np.column_stack([flat, np.repeat(level, len(angle))])
    if isinstance(shape, HeightField):
        heights = np.array(shape.heights, dtype=np.float64)
        rows, columns = heights.shape
        x = np.linspace(-shape.size[0] / 2, shape.size[0] / 2, columns)
        y = np.linspace(-shape.size[1] / 2, shape.size[1] / 2, rows)
        top = np.stack([*np.meshgrid(x, y), heights], axis=-1).reshape(-1, 3)
        bottom = np.array([[sx * x[0], sy * y[0], heights.min() - shape.base] for sx in (-1, 1) for sy in (-1, 1)])
        return np.concatenate([top, bottom])
    raise NotImplementedError(f"shape kind {shape.kind!r} has no extent")


def built_extent(built: BuiltEntity) -> Extent:
    """Box of everything built, in the entity's own frame.

    Raises:
        EvidenceError: nothing visible was built.
    """
    pose = {b.name: b.pose for b in built.bodies}
    with np.errstate(invalid="ignore"):
        visible = [(pose[p.body].apply(p.render.vertices), p.render.faces) for p in built.parts if len(p.render.faces)]
    if not visible:
        raise EvidenceError(f"entity {built.entity!r} has no visible geometry; call place_object")
    start = np.cumsum([0, *(len(v) for v, _ in visible)])
    return _extent(
        np.concatenate([v for v, _ in visible]), np.concatenate([f + s for (_, f), s in zip(visible, start, strict=False)])
    )


def part_extents(built: BuiltEntity, names: Iterable[str]) -> dict[str, Extent]:
    """Box of every named part that has a surface, in the entity's own frame."""
    pose = {b.name: b.pose for b in built.bodies}
    wanted = set(names)
    with np.errstate(invalid="ignore"):
        return {
            p.part: _extent(pose[p.body].apply(p.render.vertices), p.render.faces)
            for p in built.parts
            if p.part in wanted and len(p.render.faces)
        }


def _extent(vertices: F64, faces: NDArray[Any]) -> Extent:
    """Box of a surface without its dust: points outside all faces, slivers, loose specks."""
    triangles = vertices[faces]
    if not np.isfinite(triangles).all():
        return Extent(np.full(3, np.nan), np.full(3, np.nan))
    area = _areas(triangles)
    enough = SPECK * float(area.sum())
    found = Extent(triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1)))
    if enough == 0.0 or _borne_by_large(triangles, area, enough, found):
        return found
    longest = length(triangles - np.roll(triangles, 1, axis=1)).max(axis=1)
    wide = 2.0 * area > SPECK * float(np.linalg.norm(found.size)) * longest
    if not wide.any():
        return found
    triangles, area = triangles[wide], area[wide]
    # Pieces of faces that share vertices are parts of those whose corners coincide: if the large ones fill the box, that is all.
    label = _pieces(len(vertices), np.asarray(faces[wide], dtype=np.intp))
    piece_area = np.asarray(np.bincount(label, weights=area)[label], dtype=np.float64)
    if _borne_by_large(triangles, piece_area, enough, found):
        return found
    _, corner = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    label = _pieces(int(corner.max()) + 1, corner.reshape(-1, 3))
    kept = triangles[np.bincount(label, weights=area)[label] >= enough]
    return Extent(kept.min(axis=(0, 1)), kept.max(axis=(0, 1)))


def _areas(triangles: F64) -> F64:
    arms = triangles[:, 1:] - triangles[:, :1]
    return np.asarray(0.5 * length(cross(arms[:, 0], arms[:, 1])))


def _borne_by_large(triangles: F64, area: F64, enough: float, box: Extent) -> bool:
    """True if triangles (or pieces) larger than a speck reach each side of the box: then dust cannot matter."""
    large = triangles[area >= enough]
    return len(large) > 0 and bool((large.min(axis=(0, 1)) <= box.low).all() and (large.max(axis=(0, 1)) >= box.high).all())


def _pieces(count: int, corner: NDArray[np.intp]) -> NDArray[np.intp]:
    """Connected piece of every triangle from its corners' numbers, below `count`, shape (t, 3)."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    one, two = corner[:, [0, 1]].reshape(-1), corner[:, [1, 2]].reshape(-1)
    graph = coo_array((np.ones(len(one), dtype=np.int8), (one, two)), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1][corner[:, 0]], dtype=np.intp)


def region_diagonal(region: Region) -> float:
    """Diagonal of a region's bounding box in its own frame [m]."""
    if region.kind == "box":
        return float(np.linalg.norm(np.array(region.max) - np.array(region.min)))
    if region.kind == "sphere":
        return float(2.0 * np.sqrt(3.0) * region.radius)
    return float(np.linalg.norm([2.0 * region.radius, 2.0 * region.radius, region.height]))
