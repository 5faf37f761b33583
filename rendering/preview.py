"""Pictures without a path tracer: a shaded preview and a view coloured by entity."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..geometry.camera import Camera
from ..geometry.idcast import IdCaster, IdImage
from ..worlds.arrays import F32, F64, U8, compose
from ..worlds.candidate import Candidate
from .categories.liquid.preview import LiquidLayer, over, tinted
from .categories.particles.shapes import GrainLayer
from .drawing import caption, distinct_color, label_regions, region_edges
from .land.preview import LandLayer
from .land.scenery import cut_from, is_stems
from .shades import brick_tone, pattern_shade
from .views import active, camera_for, focus_bounds, part_frame

__all__ = ["PreviewRenderer", "id_view", "preview"]

SHADOW_PIXELS = 640
"""Side of the sun's depth picture."""
PANE, GLAZE = 0.5, 0.12
"""Transmission from which on a part is a pane that one sees liquids through, and how much of its own colour it shows."""
SUN_DISTANCE = 30.0
"""Distance of the sun's eye in focus diagonals; far enough that its rays are nearly parallel."""
SKY, HORIZON, BELOW = (0.30, 0.48, 0.78), (0.74, 0.80, 0.86), (0.42, 0.40, 0.38)
"""Background colours, linear RGB."""


class PreviewRenderer:
    """Casts ids at one candidate; reusable over its frames. Instances are parts."""

    def __init__(self, candidate: Candidate) -> None:
        self.candidate = candidate
        self._grains = GrainLayer(candidate)
        loose = (*candidate.liquids, *self._grains.entities)
        solid = [name for name in sorted(candidate.built) if name not in loose]
        self.parts = [(name, part) for name in solid for part in candidate.built[name].parts]
        self._layer = LiquidLayer(candidate)
        self._loose = len(self.parts) + len(self._grains.entities)
        self._land: LandLayer | None = None
        self._grounds: dict[str, list[int]] = {}
        for k, (name, _) in enumerate(self.parts):
            land = cut_from(candidate, name)
            if land is not None:
                self._grounds.setdefault(land, []).append(k)
        liquid = [one.entity for one in self._layer.liquids]
        grains = self._grains.entities
        self.entities = sorted([*solid, *grains, *liquid])
        self._caster = IdCaster([part.render for _, part in self.parts])
        self._soft = [k for k, (name, _) in enumerate(self.parts) if name in candidate.deforming]
        index = {name: k for k, name in enumerate(self.entities)}
        self._entity_of = np.array([index[name] for name in [*(n for n, _ in self.parts), *grains, *liquid]], dtype=np.int32)
        looks = [candidate.spec.materials[part.material].appearance for _, part in self.parts]
        tones = np.array([brick_tone(candidate.spec, name, part.part) for name, part in self.parts], dtype=np.float32)
        colors = np.array([look.color for look in looks], dtype=np.float32).reshape(-1, 3) * tones[:, None]
        self._colors = np.concatenate([colors, self._grains.colors])
        self._looks = looks
        self._panes = [k for k, look in enumerate(looks) if look.transmission >= PANE]
        self._stems = [k for k, (name, part) in enumerate(self.parts) if is_stems(candidate, name, part.part)]
        self._frames = [part_frame(candidate, name, part) for name, part in self.parts]

    def _shaped(self, frame: int) -> IdCaster:
        """The caster with deforming parts in the shape of a frame."""
        parts = self.parts
        return self._caster.reshaped({k: self.candidate.shape(parts[k][0], parts[k][1].part, frame) for k in self._soft})

    def cast(self, frame: int, camera: Camera) -> IdImage:
        """Ids of parts and after them of liquids, depth and normals; entities that do not exist at the frame are left out."""
        solid = self._cast_solid(frame, camera, stems=True)
        if not self._layer.liquids:
            return solid
        # Panes hide no liquid.
        liquid = self._layer.cast(frame, camera)
        shown = (liquid.ids >= 0) & (liquid.depth < self._cast_solid(frame, camera, panes=False, stems=True).depth)
        return over(solid, liquid, self._loose, shown)

    def _cast_solid(self, frame: int, camera: Camera, *, panes: bool = True, stems: bool = False) -> IdImage:
        """Pictures leave out the stems of plants, which the layer of land draws."""
        poses = [self.candidate.pose(name, frame, part.body) for name, part in self.parts]
        left_out = {*(() if panes else self._panes), *(() if stems else self._stems)}
        shown = [k for k, (name, _) in enumerate(self.parts) if k not in left_out and active(self.candidate, name, frame)]
        seen = self._shaped(frame).cast(camera, poses, only=None if len(shown) == len(self.parts) else shown)
        return self._grains.over(seen, frame, camera, len(self.parts)) if self._grains.entities else seen

    def mask(self, frame: int, camera: Camera, entity: str) -> Any:
        """Pixels that an entity would cover if nothing stood before it, shape (height, width)."""
        if entity in self.candidate.liquids:
            return self._layer.cast(frame, camera, entity).ids >= 0
        if entity in self._grains.entities:
            size = (camera.height, camera.width)
            empty = IdImage(np.full(size, -1, np.int32), np.full(size, np.inf, np.float32), np.zeros((*size, 3), np.float32))
            return self._grains.over(empty, frame, camera, 0, entity).ids >= 0
        poses = [self.candidate.pose(name, frame, part.body) for name, part in self.parts]
        own = [k for k, (name, _) in enumerate(self.parts) if name == entity]
        return self._shaped(frame).cast(camera, poses, only=own).ids >= 0

    def entity_ids(self, image: IdImage) -> Any:
        """Index into `entities` per pixel, -1 where nothing is; shape (height, width)."""
        return np.where(image.ids >= 0, self._entity_of[np.maximum(image.ids, 0)], -1)

    def _sun(self) -> F64:
        look = self.candidate.spec.look
        elevation, azimuth = math.radians(max(look.sun_elevation_deg, 20.0)), math.radians(look.sun_azimuth_deg)
        return np.array([math.cos(elevation) * math.cos(azimuth), math.cos(elevation) * math.sin(azimuth), math.sin(elevation)])

    def _shadow(self, frame: int, points: F64) -> F32:
        """Share of sunlight at points, shape (n, 3): 0 in shadow, soft at its edge, 1 outside the sun's picture."""
        box = focus_bounds(self.candidate)
        size = max(box.diagonal, 1e-6)
        distance = SUN_DISTANCE * size
        fov = 2 * math.degrees(math.atan(0.62 / SUN_DISTANCE))
        eye = Camera(box.center + distance * self._sun(), box.center, fov, SHADOW_PIXELS, SHADOW_PIXELS)
        nearest = self._cast_solid(frame, eye).depth
        pixels, depth = eye.project(points)
        bias = 2.0 * 1.24 * size / SHADOW_PIXELS
        lit = np.zeros(len(points), dtype=np.float32)
        for dx, dy in ((-0.7, -0.3), (0.3, -0.7), (0.7, 0.3), (-0.3, 0.7)):
            column = np.floor(pixels[:, 0] + dx).astype(np.int64)
            row = np.floor(pixels[:, 1] + dy).astype(np.int64)
            inside = (column >= 0) & (column < SHADOW_PIXELS) & (row >= 0) & (row < SHADOW_PIXELS)
            hidden = inside & (nearest[np.where(inside, row, 0), np.where(inside, column, 0)] < depth - bias)
            lit += np.where(hidden, 0.0, 0.25).astype(np.float32)
        return lit

    def preview(self, frame: int, camera: Camera) -> U8:
        """Hemisphere light, sun with shadows, dark lines where entities meet, frame number and time."""
        image = self._cast_solid(frame, camera, panes=not self._layer.liquids)
        eye, directions = camera.rays()
        hit = image.ids >= 0
        height = directions[..., 2:]
        picture = np.where(
            height > 0, _mix(HORIZON, SKY, np.sqrt(np.clip(height, 0, 1))), _mix(HORIZON, BELOW, np.clip(-6 * height, 0, 1))
        )
        along = -(directions[hit] @ camera.axes[2])
        points = eye + directions[hit] * (image.depth[hit] / along)[:, None]
        normals = image.normals[hit].astype(np.float64)
        facing = (normals * directions[hit]).sum(1)
        normals = np.where((facing > 0)[:, None], -normals, normals)
        sun = self._sun()
        lambert = np.maximum(normals @ sun, 0.0) * self._shadow(frame, points + 1e-4 * normals)
        sky = 0.5 + 0.5 * normals[:, 2]
        half = sun - directions[hit]
        half /= np.linalg.norm(half, axis=1, keepdims=True)
        gloss = 0.10 * np.maximum((normals * half).sum(1), 0.0) ** 40 * (lambert > 0)
        light = 0.95 * lambert[:, None] * np.array([1.0, 0.95, 0.86]) + _mix((0.17, 0.16, 0.15), (0.36, 0.42, 0.50), sky[:, None])
        shade = self._shade(frame, image.ids[hit], points, normals)
        picture[hit] = self._colors[image.ids[hit]] * shade[:, None] * light + gloss[:, None]
        if self.candidate.spec.terrains:
            image = self._paint_land(image, picture, camera, sun)
        if self._layer.liquids:
            image = over(image, self._layer.cast(frame, camera), self._loose)
            wet = image.ids >= self._loose
            seen, faces = image.ids[wet] - self._loose, image.normals[wet].astype(np.float64)
            picture[wet] = tinted(picture[wet], self._layer.liquids, seen, faces, directions[wet], sun, SKY)
            pane = self._cast_solid(frame, camera)
            before = (pane.ids != image.ids) & (pane.depth < image.depth)
            picture[before] = picture[before] * (1 - GLAZE) + GLAZE * self._colors[pane.ids[before]]
            image = over(image, pane, 0, before)
        shown = np.asarray(np.round(255 * np.clip(picture, 0, 1) ** (1 / 2.2)), dtype=np.uint8)
        edges = region_edges(self.entity_ids(image)) & ~((image.ids >= len(self.parts)) & (image.ids < self._loose))
        shown[edges] = (shown[edges] * 0.45).astype(np.uint8)
        caption(shown, self._label(frame))
        return shown

    def _paint_land(self, image: IdImage, picture: F64, camera: Camera, sun: F64) -> IdImage:
        """Paint landscapes into a picture; what they hide, and the ground they carry, is no entity any more."""
        self._land = self._land or LandLayer(self.candidate)
        ground = {n: np.isin(image.ids, parts) for n, parts in self._grounds.items() if n in self._land.lands}
        depth = self._land.paint(picture, image.depth, ground, camera, sun).astype(np.float32)
        hidden = (depth < image.depth) | np.any([*ground.values(), np.zeros_like(image.ids, dtype=bool)], axis=0)
        return IdImage(np.where(hidden, -1, image.ids), depth, image.normals)

    def _shade(self, frame: int, ids: Any, points: F64, normals: F64) -> F64:
        """Share of the material's colour at points of parts, by their patterns; shape (n,)."""
        found = np.ones(len(points))
        for k in np.unique(ids):
            if k >= len(self.parts):
                continue
            look, (name, part) = self._looks[k], self.parts[k]
            if look.pattern in ("plain", "concrete"):
                continue
            own = ids == k
            back = compose(self.candidate.pose(name, frame, part.body), self._frames[k]).inverse()
            turned = back.apply(points[own] + normals[own]) - back.apply(points[own])
            extent = np.ptp(self._frames[k].inverse().apply(part.render.vertices), axis=0)
            found[own] = pattern_shade(look.pattern, back.apply(points[own]), turned, scale=look.pattern_scale, extent=extent)
        return found

    def id_view(self, frame: int, camera: Camera) -> U8:
        """One colour per entity, shaded by slope, with ids written on the larger regions."""
        image = self.cast(frame, camera)
        entity = self.entity_ids(image)
        palette = np.array([distinct_color(k) for k in range(len(self.entities))] or [(0, 0, 0)], dtype=np.float64)
        _, directions = camera.rays()
        shade = 0.55 + 0.45 * np.abs((image.normals * directions).sum(-1, keepdims=True))
        colored = palette[np.maximum(entity, 0)] * shade
        shown = np.where(entity[..., None] >= 0, colored, 236.0).astype(np.uint8)
        shown[region_edges(entity)] = (30, 30, 30)
        label_regions(shown, entity, self.entities)
        caption(shown, self._label(frame))
        return shown

    def _label(self, frame: int) -> str:
        return f"frame {frame}  t = {frame / self.candidate.spec.simulation.fps:.3f} s"


def _mix(low: tuple[float, ...], high: tuple[float, ...], share: Any) -> Any:
    return np.array(low) * (1 - share) + np.array(high) * share


def preview(
    candidate: Candidate,
    frame: int,
    *,
    shot: str | None = None,
    camera: Camera | None = None,
    width: int = 640,
    height: int = 360,
    renderer: PreviewRenderer | None = None,
) -> U8:
    """Quick shaded picture, shape (height, width, 3), with frame number and time; no path tracer needed.

    Args:
        candidate: what to show.
        frame: frame index.
        shot: id of the shot whose camera to use; default the one that covers the frame, else an automatic view.
        camera: use this camera instead (its own width and height count).
        width: pixels.
        height: pixels.
        renderer: reuse this one over many frames of the same candidate.
    """
    view = camera or camera_for(candidate, frame, shot=shot, width=width, height=height)
    return (renderer or PreviewRenderer(candidate)).preview(frame, view)


def id_view(
    candidate: Candidate,
    frame: int,
    *,
    shot: str | None = None,
    camera: Camera | None = None,
    width: int = 640,
    height: int = 360,
    renderer: PreviewRenderer | None = None,
) -> U8:
    """Picture coloured and labelled by entity; arguments as for `preview`."""
    view = camera or camera_for(candidate, frame, shot=shot, width=width, height=height)
    return (renderer or PreviewRenderer(candidate)).id_view(frame, view)
