"""Pictures without a path tracer: a shaded preview and a view coloured by entity."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..geometry.camera import Camera
from ..geometry.idcast import IdCaster, IdImage
from ..worlds.arrays import F32, F64, U8, compose
from ..worlds.built import TriangleMesh
from ..worlds.candidate import Candidate
from .categories.charring import CHAR, Charring
from .categories.layer import Daylight, LooseLayer, VolumeLayer, over
from .categories.registry import layers_of
from .drawing import caption, distinct_color, label_regions, region_edges
from .land.preview import LandLayer
from .land.scenery import cut_from, is_stems
from .panes import LAYERS, PANE, Glass, glazed
from .shades import pattern_shade
from .views import active, camera_for, focus_bounds, pattern_frame

__all__ = ["PreviewRenderer", "id_view", "preview"]

SHADOW_PIXELS = 640
"""Side of the sun's depth picture."""
SUN_DISTANCE = 30.0
"""Distance of the sun's eye in focus diagonals; far enough that its rays are nearly parallel."""
SKY, HORIZON, BELOW = (0.30, 0.48, 0.78), (0.74, 0.80, 0.86), (0.42, 0.40, 0.38)
"""Background colours, linear RGB."""
SUNLIGHT, ABOVE, UNDER = 0.95 * np.array([1.0, 0.95, 0.86]), (0.36, 0.42, 0.50), (0.17, 0.16, 0.15)
"""Radiance of a white sheet that faces the sun, the sky, the ground; linear RGB."""


class PreviewRenderer:
    """Casts ids at one candidate; reusable over its frames. Instances are parts."""

    def __init__(self, candidate: Candidate) -> None:
        self.candidate = candidate
        self._layers = layers_of(candidate)
        self._bodies = self._layers.parts
        self.parts = [(entity, part) for _, entity, part in self._bodies]
        loose = sorted(self._layers.loose, key=lambda layer: not layer.opaque)
        starts = np.cumsum([len(self.parts), *(len(layer.entities) for layer in loose)]).tolist()
        pairs = list(zip(loose, starts, strict=False))
        self._opaque = [(layer, first) for layer, first in pairs if layer.opaque]
        self._clear = [(layer, first) for layer, first in pairs if not layer.opaque]
        self._volumes = [layer for layer, _ in self._clear if isinstance(layer, VolumeLayer)]
        self._first_clear = len(self.parts) + sum(len(layer.entities) for layer, _ in self._opaque)
        self._land: LandLayer | None = None
        self._grounds: dict[str, list[int]] = {}
        for k, (name, _) in enumerate(self.parts):
            land = cut_from(candidate, name)
            if land is not None:
                self._grounds.setdefault(land, []).append(k)
        owners = [*(name for name, _ in self.parts), *(name for layer in loose for name in layer.entities)]
        self.entities = sorted(set(owners))
        self._charring = Charring(candidate)
        self._burning = {
            k: c for k, (name, part) in enumerate(self.parts) if (c := self._charring.of(name, part.part)) is not None
        }
        # Triangles of cloth that burns have corners of their own, so that each can be gone.
        own = {k for k, charred in self._burning.items() if charred.sheet}
        self._caster = IdCaster([_loosened(part.render) if k in own else part.render for k, (_, part) in enumerate(self.parts)])
        self._soft = [k for k, (layer, name, _) in enumerate(self._bodies) if layer.bends(name)]
        index = {name: k for k, name in enumerate(self.entities)}
        self._entity_of = np.array([index[name] for name in owners], dtype=np.int32)
        self._looks = [candidate.spec.materials[part.material].appearance for _, part in self.parts]
        self._colors = self._part_colors()
        self._panes = [k for k, look in enumerate(self._looks) if look.transmission >= PANE]
        self._glass = Glass(
            self._colors[: len(self.parts)],
            np.array([look.roughness for look in self._looks]),
            np.array([look.transmission for look in self._looks]),
        )
        self._stems = [k for k, (name, part) in enumerate(self.parts) if is_stems(candidate, name, part.part)]
        self._frames = [pattern_frame(candidate, name, part) for name, part in self.parts]

    def _part_colors(self) -> F32:
        """Linear RGB by id of parts and of opaque loose matter, shape (n, 3)."""
        tones = np.array([layer.tone(name, part.part) for layer, name, part in self._bodies], dtype=np.float32)
        colors = np.array([look.color for look in self._looks], dtype=np.float32).reshape(-1, 3) * tones[:, None]
        return np.concatenate([colors, *(layer.colors.astype(np.float32) for layer, _ in self._opaque)])

    def _shaped(self, frame: int) -> IdCaster:
        """The caster with deforming parts in the shape of a frame."""
        parts = self.parts
        shapes = {k: self.candidate.shape(parts[k][0], parts[k][1].part, frame) for k in self._soft}
        for k, charred in self._burning.items():
            if charred.sheet and k in shapes:
                corner = shapes[k][charred.faces]
                gone = charred.gone(frame)
                corner[gone] = corner[gone][:, :1]
                shapes[k] = corner.reshape(-1, 3)
        return self._caster.reshaped(shapes)

    def cast(self, frame: int, camera: Camera) -> IdImage:
        """Ids of parts and after them of loose matter, depth and normals; entities that do not exist at the frame are left out."""
        image = self._cast_opaque(frame, camera, stems=True)
        for layer, first in self._clear:
            seen = layer.cast(frame, camera)
            # Panes hide nothing that one can see through them.
            shown = (seen.ids >= 0) & (seen.depth < self._cast_opaque(frame, camera, panes=False, stems=True).depth)
            image = over(image, seen, first, shown)
        return image

    def _cast_panes(self, frame: int, camera: Camera) -> list[IdImage]:
        """Parts of glass, the nearest at each pixel first; each further picture leaves out the parts that those before show."""
        poses = [self.candidate.pose(name, frame, part.body) for name, part in self.parts]
        left = [k for k in self._panes if active(self.candidate, self.parts[k][0], frame)]
        found: list[IdImage] = []
        while left and len(found) < LAYERS:
            seen = self._shaped(frame).cast(camera, poses, only=left)
            shown = set(np.unique(seen.ids).tolist()) - {-1}
            if not shown:
                break
            found.append(seen)
            left = [k for k in left if k not in shown]
        return found

    def _cast_opaque(self, frame: int, camera: Camera, *, panes: bool = True, stems: bool = False) -> IdImage:
        """Bodies and opaque loose matter; pictures leave out the stems of plants, which the layer of land draws."""
        poses = [self.candidate.pose(name, frame, part.body) for name, part in self.parts]
        left_out = {*(() if panes else self._panes), *(() if stems else self._stems)}
        shown = [k for k, (name, _) in enumerate(self.parts) if k not in left_out and active(self.candidate, name, frame)]
        seen = self._shaped(frame).cast(camera, poses, only=None if len(shown) == len(self.parts) else shown)
        for layer, first in self._opaque:
            seen = over(seen, layer.cast(frame, camera), first)
        return seen

    def mask(self, frame: int, camera: Camera, entity: str) -> Any:
        """Pixels that an entity would cover if nothing stood before it, shape (height, width)."""
        layer = self._layers.of.get(entity)
        if isinstance(layer, LooseLayer):
            return layer.cast(frame, camera, entity).ids >= 0
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

    def _daylight(self, frame: int) -> Daylight:
        """Light at a frame, with the shadows of what is opaque: soft at their edges, none outside the sun's picture."""
        box = focus_bounds(self.candidate)
        size = max(box.diagonal, 1e-6)
        distance = SUN_DISTANCE * size
        fov = 2 * math.degrees(math.atan(0.62 / SUN_DISTANCE))
        eye = Camera(box.center + distance * self._sun(), box.center, fov, SHADOW_PIXELS, SHADOW_PIXELS)
        nearest = self._cast_opaque(frame, eye, panes=False).depth
        bias = 2.0 * 1.24 * size / SHADOW_PIXELS

        def share(points: F64) -> F32:
            pixels, depth = eye.project(points)
            lit = np.zeros(len(points), dtype=np.float32)
            for dx, dy in ((-0.7, -0.3), (0.3, -0.7), (0.7, 0.3), (-0.3, 0.7)):
                column = np.floor(pixels[:, 0] + dx).astype(np.int64)
                row = np.floor(pixels[:, 1] + dy).astype(np.int64)
                inside = (column >= 0) & (column < SHADOW_PIXELS) & (row >= 0) & (row < SHADOW_PIXELS)
                hidden = inside & (nearest[np.where(inside, row, 0), np.where(inside, column, 0)] < depth - bias)
                lit += np.where(hidden, 0.0, 0.25).astype(np.float32)
            return lit

        return Daylight(self._sun(), SUNLIGHT, np.array(ABOVE), np.array(UNDER), share)

    def preview(self, frame: int, camera: Camera) -> U8:
        """Hemisphere light, sun with shadows, dark lines where entities meet, frame number and time."""
        image = self._cast_opaque(frame, camera, panes=False)
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
        day = self._daylight(frame)
        sun = day.sun
        lambert = np.maximum(normals @ sun, 0.0) * day.share(points + 1e-4 * normals)
        direct = lambert[:, None] * SUNLIGHT
        for volume in self._volumes:
            direct = direct * volume.dimmed(frame, points, sun)
        sky = 0.5 + 0.5 * normals[:, 2]
        half = sun - directions[hit]
        half /= np.linalg.norm(half, axis=1, keepdims=True)
        gloss = 0.10 * np.maximum((normals * half).sum(1), 0.0) ** 40 * (lambert > 0)
        light = direct + _mix(UNDER, ABOVE, sky[:, None])
        shade = self._shade(frame, image.ids[hit], points, normals)
        picture[hit] = (
            self._burnt(frame, image.ids[hit], points, self._colors[image.ids[hit]] * shade[:, None]) * light + gloss[:, None]
        )
        if self.candidate.spec.terrains:
            image = self._paint_land(image, picture, camera, sun)
        seen = np.ones(hit.shape)
        if self._clear:
            image = self._paint_clear(image, picture, seen, camera, (frame, day))
        image = self._paint_panes(image, picture, camera, (frame, day))
        shown = np.asarray(np.round(255 * np.clip(picture, 0, 1) ** (1 / 2.2)), dtype=np.uint8)
        edges = region_edges(self.entity_ids(image)) & ~((image.ids >= len(self.parts)) & (image.ids < self._first_clear))
        shown[edges] = (shown[edges] * 0.45 ** seen[edges][:, None]).astype(np.uint8)
        caption(shown, self._label(frame))
        return shown

    def _paint_land(self, image: IdImage, picture: F64, camera: Camera, sun: F64) -> IdImage:
        """Paint landscapes into a picture; what they hide, and the ground they carry, is no entity any more."""
        self._land = self._land or LandLayer(self.candidate)
        ground = {n: np.isin(image.ids, parts) for n, parts in self._grounds.items() if n in self._land.lands}
        depth = self._land.paint(picture, image.depth, ground, camera, sun).astype(np.float32)
        hidden = (depth < image.depth) | np.any([*ground.values(), np.zeros_like(image.ids, dtype=bool)], axis=0)
        return IdImage(np.where(hidden, -1, image.ids), depth, image.normals)

    def _paint_clear(self, image: IdImage, picture: F64, seen: F64, camera: Camera, when: tuple[int, Daylight]) -> IdImage:
        """Paint matter that one sees through into a picture; `seen` is left of what is behind."""
        frame, day = when
        _, directions = camera.rays()
        for layer, first in self._clear:
            if isinstance(layer, VolumeLayer):
                continue
            image = over(image, layer.cast(frame, camera), first)
            own = (image.ids >= first) & (image.ids < first + len(layer.entities))
            numbers, faces = image.ids[own] - first, image.normals[own].astype(np.float64)
            picture[own] = layer.paint(picture[own], numbers, faces, directions[own], day.sun, SKY)
        for volume in self._volumes:
            picture[:], left = volume.laid(picture, image.depth, frame, camera, day)
            seen *= left
        return image

    def _paint_panes(self, image: IdImage, picture: F64, camera: Camera, when: tuple[int, Daylight]) -> IdImage:
        """Paint glass over what stands behind it, the farthest layer first."""
        frame, day = when
        layers = self._cast_panes(frame, camera)
        if not layers:
            return image
        _, directions = camera.rays()
        behind = image.depth
        for pane in reversed(layers):
            before = (pane.ids >= 0) & (pane.depth < behind)
            faces = pane.normals[before].astype(np.float64)
            picture[before] = glazed(
                picture[before], self._glass, pane.ids[before], faces, directions[before], day.sun, np.array(HORIZON)
            )
            image = over(image, pane, 0, before & (pane.depth < image.depth))
        return image

    def _burnt(self, frame: int, ids: Any, points: F64, colors: F64) -> F64:
        """Colours (n, 3) at points of parts, black where they have burnt."""
        for k, charred in self._burning.items():
            own = ids == k
            if own.any():
                share = charred.at(points[own], frame)[:, None]
                colors[own] = colors[own] * (1.0 - share) + np.array(CHAR) * share
        return colors

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
        return f"frame {frame}  t = {frame / self.candidate.spec.simulation.fps:.3f} s{self._layers.note}"


def _loosened(mesh: TriangleMesh) -> TriangleMesh:
    """The mesh with corners of its own for each triangle."""
    count = len(mesh.faces)
    return TriangleMesh(mesh.vertices[mesh.faces].reshape(-1, 3), np.arange(3 * count, dtype=np.int32).reshape(count, 3))


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
