"""Plan and section: true-to-scale drawings with entity ids, regions, routes and a scale bar."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Literal

import numpy as np

from ..geometry.camera import Camera
from ..geometry.idcast import IdCaster
from ..worlds.arrays import F64, U8, RigidPose
from ..worlds.built import TriangleMesh
from ..worlds.candidate import Candidate
from ..worlds.errors import InputError
from ..worlds.spec.story import BoxRegion, Connects, CylinderRegion, SphereRegion
from .categories.layer import VolumeLayer
from .categories.registry import layers_of
from .drawing import Color, distinct_color, label_regions, line, region_edges, text, text_size
from .views import Bounds, active, focus_bounds

__all__ = ["plan_view", "section_view"]

FAR = 2000.0
"""Distance of the eye in drawing heights: the picture is orthographic within 0.05 %."""
REGION_COLOR: Color = (20, 110, 60)
ROUTE_COLOR: Color = (190, 60, 20)
Project = Callable[[F64], F64]


def _behind(mesh: TriangleMesh, normal: F64, offset: float) -> TriangleMesh:
    """The part of a mesh where `normal . x <= offset`; triangles across the plane are cut."""
    distance = mesh.vertices @ normal - offset
    inside = distance[mesh.faces] <= 0
    whole = mesh.faces[inside.all(1)]
    mixed = np.flatnonzero(inside.any(1) & ~inside.all(1))
    triangles = [mesh.vertices[whole]]
    for face in mixed:
        corners, depth = mesh.vertices[mesh.faces[face]], distance[mesh.faces[face]]
        kept: list[F64] = []
        for k in range(3):
            a, b, da, db = corners[k], corners[(k + 1) % 3], depth[k], depth[(k + 1) % 3]
            if da <= 0:
                kept.append(a)
            if (da <= 0) != (db <= 0):
                kept.append(a + (b - a) * (da / (da - db)))
        triangles.append(np.array([[kept[0], kept[k], kept[k + 1]] for k in range(1, len(kept) - 1)]).reshape(-1, 3, 3))
    vertices = np.concatenate(triangles).reshape(-1, 3)
    return TriangleMesh(vertices, np.arange(len(vertices), dtype=np.int32).reshape(-1, 3))


def _region_points(candidate: Candidate, name: str, frame: int) -> F64:
    """Points whose convex hull outlines a region in the world, shape (n, 3)."""
    region = candidate.spec.graph.regions[name]
    turn = np.linspace(0, 2 * math.pi, 48, endpoint=False)
    ring = np.stack([np.cos(turn), np.sin(turn), np.zeros_like(turn)], axis=1)
    if isinstance(region, BoxRegion):
        points = Bounds(np.array(region.min), np.array(region.max)).corners()
    elif isinstance(region, CylinderRegion):
        half = np.array([0, 0, region.height / 2])
        points = np.concatenate([region.radius * ring + half, region.radius * ring - half]) + np.array(region.center)
    else:
        assert isinstance(region, SphereRegion)
        points = np.concatenate([region.radius * np.roll(ring, k, axis=1) for k in range(3)]) + np.array(region.center)
    if region.relative_to is not None:
        points = candidate.pose(region.relative_to, frame).apply(points)
    return np.asarray(points)


def _overlay(image: U8, candidate: Candidate, frame: int, project: Project) -> None:
    """Outline regions and draw routes between them."""
    import cv2

    centers: dict[str, F64] = {}
    for name in candidate.spec.graph.regions:
        points = _region_points(candidate, name, frame)
        centers[name] = points.mean(0)
        hull = cv2.convexHull(project(points).astype(np.float32)).reshape(-1, 2)
        line(image, hull, REGION_COLOR, thickness=2, closed=True)
        corner = hull[np.argmin(hull.sum(1))]
        text(image, name, (float(corner[0]) + 3, float(corner[1]) - 4), height=9, color=REGION_COLOR, box=(255, 255, 255))
    for name, relation in candidate.spec.graph.relations.items():
        if not isinstance(relation, Connects):
            continue
        level = centers[relation.a][2]
        stops = [centers[relation.a], *(np.array([x, y, level]) for x, y in relation.waypoints), centers[relation.b]]
        pixels = project(np.array(stops))
        line(image, pixels, ROUTE_COLOR, thickness=2)
        tail, tip = ((round(float(p[0])), round(float(p[1]))) for p in pixels[-2:])
        cv2.arrowedLine(image, tail, tip, ROUTE_COLOR, 2, cv2.LINE_AA, 0, 0.08)
        text(image, name, (float(pixels[0][0]) + 6, float(pixels[0][1]) + 14), height=9, color=ROUTE_COLOR, box=(255, 255, 255))


def _round_length(most: float) -> float:
    power = 10.0 ** math.floor(math.log10(most))
    return max(m * power for m in (1, 2, 5) if m * power <= most)


def _scale_bar(image: U8, pixels_per_metre: float) -> None:
    length = _round_length(0.25 * image.shape[1] / pixels_per_metre)
    words = f"{length:g} m" if length >= 1 else (f"{length * 100:g} cm" if length >= 0.01 else f"{length * 1000:g} mm")
    size = round(length * pixels_per_metre)
    left, base = image.shape[1] - size - 20, image.shape[0] - 16
    image[base - 24 : base + 10, left - 10 :] = (0.25 * image[base - 24 : base + 10, left - 10 :] + 191).astype(np.uint8)
    for k in range(4):
        shade: Color = (20, 20, 20) if k % 2 == 0 else (250, 250, 250)
        image[base - 4 : base + 2, left + k * size // 4 : left + (k + 1) * size // 4] = shade
    line(image, [(left, base - 5), (left + size, base - 5), (left + size, base + 2), (left, base + 2)], (20, 20, 20), closed=True)
    text(image, words, (left + size / 2 - text_size(words, 10)[0] / 2, base - 10), height=10)


def _rulers(image: U8, project: Project, box: Bounds, axes: tuple[int, int]) -> None:
    """Coordinates along the upper and the left border [m]."""
    for side, axis in enumerate(axes):
        step = _round_length(0.3 * float(box.high[axis] - box.low[axis]))
        for k in range(math.ceil(box.low[axis] / step), math.floor(box.high[axis] / step) + 1):
            point = box.center.copy()
            point[axis] = k * step
            x, y = (float(v) for v in project(point[None])[0])
            words = f"{'xyz'[axis]}={k * step:.4g}"
            if side == 0:
                line(image, [(x, 0), (x, 6)], (90, 90, 90))
                text(image, words, (x - text_size(words, 8)[0] / 2, 17), height=8, color=(90, 90, 90))
            else:
                line(image, [(0, y), (6, y)], (90, 90, 90))
                text(image, words, (9, y + 4), height=8, color=(90, 90, 90))


def _drawing(
    candidate: Candidate, frame: int, towards: F64, axes: tuple[int, int], cut: float | None, title: str, width: int, height: int
) -> U8:
    """Draw what lies behind the cutting plane, seen against `towards`; cut solids are filled dark."""
    if not 0 <= frame <= candidate.last_frame:
        raise InputError(f"frame {frame} is not in 0..{candidate.last_frame}; choose one of these or bake further")
    box = focus_bounds(candidate)
    across, upward = (float(box.high[a] - box.low[a]) for a in axes)
    span = 1.16 * max(upward, across * height / width, 1e-3)
    eye = box.center + FAR * span * towards
    camera = Camera(eye, box.center, 2 * math.degrees(math.atan(0.5 / FAR)), width, height)
    layers = layers_of(candidate)
    names = [n for n in sorted(layers.of) if n in candidate.built and active(candidate, n, frame)]
    meshes, owned = [], []
    for k, name in enumerate(names):
        layer = layers.of[name]
        nearer = layer.nearer * span * towards
        placed = [TriangleMesh(mesh.vertices + nearer, mesh.faces) for mesh in layer.meshes(name, frame)]
        meshes += placed if cut is None else [_behind(mesh, towards, cut) for mesh in placed]
        owned += [k] * len(placed)
    owner = np.array(owned, dtype=np.int32)
    still = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
    seen = IdCaster(meshes).cast(camera, [still] * len(meshes))
    entity = np.where(seen.ids >= 0, owner[np.maximum(seen.ids, 0)], -1)
    palette = np.array([distinct_color(k) for k in range(len(names))] or [(0, 0, 0)], dtype=np.float64)
    facing = seen.normals.astype(np.float64) @ towards
    color = palette[np.maximum(entity, 0)]
    pale = 255 - (255 - color) * (0.25 + 0.25 * (1 - np.abs(facing)))[..., None]
    solid = (facing < 0) & (entity >= 0)
    image = np.where((entity >= 0)[..., None], np.where(solid[..., None], 0.75 * color, pale), 255.0).astype(np.uint8)
    image[region_edges(2 * entity + solid)] = (35, 35, 35)
    start = np.full_like(seen.depth, 0.0 if cut is None else float(eye @ towards) - cut)
    for volume in (layer for layer in layers.loose if isinstance(layer, VolumeLayer)):
        _veil(image, entity, names, volume, frame, camera, np.stack([start, seen.depth], axis=-1))

    def project(points: F64) -> F64:
        return camera.project(points)[0]

    _overlay(image, candidate, frame, project)
    label_regions(image, entity, names)
    _rulers(image, project, box, axes)
    _scale_bar(image, height / span)
    text(image, f"{title}, frame {frame}{layers.note}", (8, height - 10), height=10, box=(255, 255, 255))
    return image


def _veil(image: U8, entity: Any, names: list[str], layer: VolumeLayer, frame: int, camera: Camera, spans: F64) -> None:
    """Draw matter without a face over what lies behind it, in the colour of its entity, which is written where it is thick."""
    for name in layer.entities:
        if name not in names:
            continue
        depth = layer.depths(frame, camera, spans, name)
        left = np.exp(-depth)[..., None]
        image[:] = (left * image + (1 - left) * np.array(distinct_color(names.index(name)))).round().astype(np.uint8)
        entity[depth > layer.thick] = names.index(name)


def plan_view(candidate: Candidate, frame: int = 0, *, cut: float | None = None, width: int = 900, height: int = 700) -> U8:
    """Top view: +x to the right, +y up.

    Args:
        candidate: what to draw.
        frame: frame index.
        cut: leave out what is higher than this [m]; cut solids are dark.
        width: pixels.
        height: pixels.
    """
    title = "plan" if cut is None else f"plan, cut at z = {cut:.4g} m"
    return _drawing(candidate, frame, np.array([0.0, 0.0, 1.0]), (0, 1), cut, title, width, height)


def section_view(
    candidate: Candidate,
    frame: int = 0,
    *,
    axis: Literal["x", "y"] = "y",
    at: float | None = None,
    width: int = 900,
    height: int = 700,
) -> U8:
    """Upright section, z up: cut solids are dark, what lies behind is pale.

    Args:
        candidate: what to draw.
        frame: frame index.
        axis: the plane's normal; `y` is seen from -y (+x to the right), `x` from +x (+y to the right).
        at: coordinate of the plane along `axis` [m]; default the middle of what matters.
        width: pixels.
        height: pixels.
    """
    where = float(focus_bounds(candidate).center["xy".index(axis)]) if at is None else at
    title = f"section at {axis} = {where:.4g} m"
    if axis == "y":
        return _drawing(candidate, frame, np.array([0.0, -1.0, 0.0]), (0, 2), -where, title, width, height)
    return _drawing(candidate, frame, np.array([1.0, 0.0, 0.0]), (1, 2), where, title, width, height)
