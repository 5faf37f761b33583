"""Volumes and boxes of declared shapes, without building geometry."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from .arrays import F64, pose_of
from .sweeps import sweep_rings, sweep_volume

if TYPE_CHECKING:
    from .shapes import Boolean, Member, Shape
    from .spec import Entity, WorldSpec

__all__ = ["box_extent", "box_size", "initial_box", "initial_volume", "least_extent", "part_box", "shape_volume", "told_mass"]


def _ends(shape: Shape) -> tuple[F64, F64] | None:
    """Lowest and highest corner of a box around a shape in its own frame [m]; None for files, which are not read here, and for letters."""

    if shape.kind == "box" or shape.kind == "wedge":
        low, high = -0.5 * np.array(shape.size), 0.5 * np.array(shape.size)
    elif shape.kind == "sphere":
        high = np.full(3, shape.radius)
        low = -high
    elif shape.kind == "cylinder" or shape.kind == "capsule":
        half = 0.5 * shape.height if shape.kind == "cylinder" else 0.5 * shape.length + shape.radius
        high = np.array([shape.radius, shape.radius, half])
        low = -high
    elif shape.kind == "extrusion":
        plan = np.array(shape.polygon)
        low, high = np.array([*plan.min(0), -0.5 * shape.height]), np.array([*plan.max(0), 0.5 * shape.height])
    elif shape.kind == "revolution":
        profile = np.array(shape.profile)
        reach = profile[:, 0].max()
        low, high = np.array([-reach, -reach, profile[:, 1].min()]), np.array([reach, reach, profile[:, 1].max()])
    elif shape.kind == "boolean":
        return _boolean_ends(shape)
    else:
        points = _points(shape)
        if points is None:
            return None
        low, high = points.min(0), points.max(0)
    return low, high


def _boolean_ends(shape: Boolean) -> tuple[F64, F64] | None:
    """Box that the solid does not leave: that of all members, of the first of a difference, what the boxes of an intersection share."""
    boxes = [_member_ends(m) for m in (shape.of[:1] if shape.operation == "difference" else shape.of)]
    if any(b is None for b in boxes):
        return None
    low, high = (np.array([b[k] for b in boxes if b is not None]) for k in (0, 1))
    return (low.max(0), high.min(0)) if shape.operation == "intersection" else (low.min(0), high.max(0))


def _member_ends(member: Member) -> tuple[F64, F64] | None:
    """Box around a member of a boolean and its copies."""
    corners = _corners(member.shape)
    if corners is None:
        return None
    placed = [pose_of(member.pose).apply(corners)]
    if (copies := member.repeat) is not None:
        c, s = math.cos(copies.turn), math.sin(copies.turn)
        for _ in range(copies.count - 1):
            placed.append(placed[-1] @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) + np.array(copies.move))
    points = np.concatenate(placed)
    if member.mirror is not None:
        points = np.concatenate([points, points * np.where(np.array(list("xyz")) == member.mirror, -1.0, 1.0)])
    return points.min(0), points.max(0)


def _points(shape: Shape) -> F64 | None:
    """Corners of a shape that says them [m], shape (n, 3); None for files and fields, and for sweeps that are refused where they are built."""
    if shape.kind == "hull":
        return np.array(shape.points)
    if shape.kind == "loft":
        return np.concatenate(
            [pose_of(s.pose).apply(np.column_stack([np.array(s.polygon), np.zeros(len(s.polygon))])) for s in shape.sections]
        )
    if shape.kind == "mesh" and shape.vertices is not None and shape.faces is not None:
        return np.array(shape.vertices) * shape.scale
    if shape.kind == "sweep":
        try:
            return sweep_rings(shape).reshape(-1, 3)
        except ValueError:
            return None
    return None


def _corners(shape: Shape) -> F64 | None:
    """Corners of a box around a shape in its own frame (8, 3) [m]; None for files."""
    ends = _ends(shape)
    if ends is None:
        return None
    low, high = ends
    return np.array([[(low, high)[i][0], (low, high)[j][1], (low, high)[k][2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])


def initial_box(entity: Entity) -> tuple[F64, F64] | None:
    """Box around an entity's parts in the world [m]; None where a part is a file or generated."""
    found = []
    for part in entity.parts.values():
        corners = _corners(part.shape)
        if corners is None:
            return None
        found.append(pose_of(entity.pose).apply(pose_of(part.pose).apply(corners)))
    return (np.concatenate(found).min(0), np.concatenate(found).max(0)) if found else None


def least_extent(shape: Shape) -> float | None:
    """Least extent of a simple shape along its own axes [m]; None for what may be thinner than its box: files, meshes, wedges, plans."""
    return box_extent(shape) if shape.kind in ("box", "sphere", "cylinder", "capsule") else None


def box_size(shape: Shape) -> F64 | None:
    """Extents of the box around a shape along its own axes (3,) [m]; None for files and fields."""
    ends = _ends(shape)
    return None if ends is None else np.asarray(ends[1] - ends[0])


def box_extent(shape: Shape) -> float | None:
    """Least extent of the box around a shape [m]: nothing is thicker than that everywhere; None for files and fields."""
    size = box_size(shape)
    return None if size is None else float(size.min())


def part_box(entity: Entity, part: str) -> tuple[F64, F64] | None:
    """Box around one part in the world [m]; None for files and fields."""
    contract = entity.parts[part]
    corners = _corners(contract.shape)
    if corners is None:
        return None
    placed = pose_of(entity.pose).apply(pose_of(contract.pose).apply(corners))
    return placed.min(0), placed.max(0)


def shape_volume(shape: Shape) -> float | None:
    """Volume of a shape [m^3], smooth ones without facets; None for files and for what is composed of others."""

    if shape.kind == "box":
        return math.prod(shape.size)
    if shape.kind == "wedge":
        return 0.5 * math.prod(shape.size)
    if shape.kind == "sphere":
        return 4 / 3 * math.pi * shape.radius**3
    if shape.kind == "cylinder":
        return math.pi * shape.radius**2 * shape.height
    if shape.kind == "capsule":
        return math.pi * shape.radius**2 * (shape.length + 4 / 3 * shape.radius)
    if shape.kind == "extrusion":
        x, y = np.array(shape.polygon).T
        return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2 * shape.height
    if shape.kind == "revolution":
        r, z = np.array(shape.profile).T
        next_r, next_z = np.roll(r, -1), np.roll(z, -1)
        return abs(float(((r + next_r) * (r * next_z - next_r * z)).sum())) * math.pi / 3  # Pappus, by triangles from the origin
    if shape.kind == "hull":
        return _hull_volume(np.array(shape.points))
    if shape.kind == "sweep":
        return None if _points(shape) is None else sweep_volume(shape)
    if shape.kind == "mesh" and shape.vertices is not None and shape.faces is not None:
        if np.max(shape.faces) >= len(shape.vertices):
            return None  # refused where it is built
        corner = (np.array(shape.vertices) * shape.scale)[np.array(shape.faces)]
        return abs(float(np.einsum("ij,ij->i", corner[:, 0], np.cross(corner[:, 1], corner[:, 2])).sum())) / 6
    return None


def _hull_volume(points: F64) -> float | None:
    from scipy.spatial import ConvexHull, QhullError

    try:
        return float(ConvexHull(points).volume)
    except QhullError:
        return None  # flat; refused where it is built


def initial_volume(entity: Entity) -> float:
    """Initial volume [m^3]; a file's is taken as that of the entity's declared box."""
    volumes = [shape_volume(p.shape) for p in entity.parts.values()]
    known = [v for v in volumes if v is not None]
    return sum(known) if len(known) == len(volumes) else math.prod(entity.dimensions.size)


def told_mass(spec: WorldSpec, name: str) -> float:
    """Mass of a moving entity as the specification tells it [kg]; 0 where it tells none, or the entity moves by no force."""
    entity = spec.entities.get(name)
    if entity is None or entity.motion != "dynamic":
        return 0.0
    declared = getattr(entity.physics, "mass", None)
    if declared is not None:
        return float(declared)
    used = {p.material or entity.material for p in entity.parts.values()} & set(spec.materials)
    return initial_volume(entity) * min((spec.materials[m].density for m in used), default=0.0) if entity.parts else 0.0
