"""Gas in pictures: laid over what is seen through it by marching along the sight, a medium of the path tracer."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np

from ....geometry.camera import Camera
from ....geometry.idcast import IdImage
from ....worlds.arrays import F64
from ....worlds.built import TriangleMesh
from ....worlds.candidate import Candidate
from ..layer import Daylight, TracedShapes, VolumeLayer
from ..particles.splat import unseen
from .boxes import THICK, GasBox, Sights, extents_of, gases_of, marched
from .medium import fogs_of
from .shading import emitted, source_of

__all__ = ["GasLayer"]

FAR = 1e9
"""[m] Behind everything."""


class GasLayer(VolumeLayer):
    """Gases as caches hold them; at the static stage there are none, and plans show the room that they are let out in."""

    quantities = ("soot_mass", "heat", "max_speed")
    thick = THICK

    def __init__(self, candidate: Candidate, entities: Sequence[str]) -> None:
        self.gases = gases_of(candidate)
        super().__init__(candidate, [gas.entity for gas in self.gases])
        self._kept: tuple[int, dict[str, GasBox]] | None = None

    def extents(self) -> list[tuple[F64, F64]]:
        """Corners (3,) of the boxes of what is seen of the gases [m]."""
        return self.candidate.memo(extents_of, lambda: extents_of(self.candidate))

    def at(self, frame: int) -> dict[str, GasBox]:
        """Boxes of the gases of which something is seen at a frame, by entity."""
        if self._kept is None or self._kept[0] != frame:
            found = {gas.entity: gas.at(frame) for gas in self.gases}
            self._kept = (frame, {e: box for e, box in found.items() if box is not None})
        return self._kept[1]

    @cached_property
    def colors(self) -> F64:
        """Linear RGB of each where it is thick and lit from all sides, shape (n, 3)."""
        albedo = np.array([gas.look.albedo for gas in self.gases]).reshape(-1, 3)
        return np.asarray(0.5 * albedo / (1.0 - 0.5 * albedo))

    def meshes(self, entity: str, frame: int) -> list[TriangleMesh]:
        """The room of an entity's source before any simulation; none of one that plans show by its depth."""
        return [] if entity in self.entities else super().meshes(entity, frame)

    def cast(self, frame: int, camera: Camera, entity: str | None = None) -> IdImage:
        """The view of what is thick of all gases, or of one, if nothing else were there; ids are indices into `entities`."""
        image = unseen(camera)
        _, directions = camera.rays()
        along = -(directions @ camera.axes[2])
        for name, box in self.at(frame).items():
            if entity not in (None, name):
                continue
            reach = self._seen(box, camera, _all(camera)).reach.reshape(along.shape) * along
            near = reach < image.depth
            image.ids[near] = self.entities.index(name)
            image.depth[near] = reach[near]
            image.normals[near] = -directions[near]
        return image

    def _seen(self, box: GasBox, camera: Camera, spans: F64, source: Any = None) -> Sights:
        """Rays of all pixels through a box, between depths along the viewing axis (height, width, 2)."""
        eye, directions = camera.rays()
        reach = spans / -(directions @ camera.axes[2])[..., None]
        return marched(box, eye[None], directions.reshape(-1, 3), reach.reshape(-1, 2), source)

    def depths(self, frame: int, camera: Camera, spans: F64, entity: str | None = None) -> F64:
        """Optical depth along the sight of each pixel; see `VolumeLayer.depths`."""
        boxes = [box for name, box in self.at(frame).items() if entity in (None, name)]
        tau = [self._seen(box, camera, spans).tau for box in boxes]
        return np.asarray(sum(tau, start=np.zeros(camera.width * camera.height))).reshape(camera.height, camera.width)

    def glowing(self, frame: int, camera: Camera, spans: F64, entity: str) -> F64:
        """Radiance of the heat of one gas along the sight of each pixel; see `VolumeLayer.glowing`."""
        box = self.at(frame).get(entity)
        if box is None or not box.hot:
            return np.zeros((camera.height, camera.width, 3))
        source = emitted(box).astype(np.float32)
        return self._seen(box, camera, spans, source).gain.reshape(camera.height, camera.width, 3)

    def laid(self, picture: F64, depth: Any, frame: int, camera: Camera, light: Daylight) -> tuple[F64, F64]:
        """A linear picture through the gas before what is there; see `VolumeLayer.laid`."""
        spans, shown = _all(camera), np.ones((camera.height, camera.width))
        spans[..., 1] = np.minimum(depth, FAR)
        for box in self._far_first(frame, camera):
            seen = self._seen(box, camera, spans, source_of(box, light))
            left = np.exp(-seen.tau).reshape(shown.shape)
            picture = picture * left[..., None] + seen.gain.reshape(picture.shape)
            shown *= left
        return picture, shown

    def _far_first(self, frame: int, camera: Camera) -> list[GasBox]:
        boxes = self.at(frame).values()
        return sorted(boxes, key=lambda box: -float(np.linalg.norm(0.5 * (box.low + box.high) - camera.position)))

    def dimmed(self, frame: int, points: F64, sun: F64) -> F64:
        """Share of sunlight that comes through the gas to points; see `VolumeLayer.dimmed`."""
        left = np.ones((len(points), 3))
        spans = np.tile(np.array([0.0, FAR]), (len(points), 1))
        for box in self.at(frame).values():
            left *= np.exp(-marched(box, points, sun[None], spans).tau[:, None] * box.look.shading)
        return left

    def traced(self, mi: Any, frame: int) -> TracedShapes:
        """Boxes of gas for Mitsuba at a frame."""
        return fogs_of(mi, self.at(frame))


def _all(camera: Camera) -> F64:
    """Depths from the eye to behind everything, shape (height, width, 2)."""
    return np.tile(np.array([0.0, FAR]), (camera.height, camera.width, 1))
