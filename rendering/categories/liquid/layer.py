"""Liquids in pictures: cast beside the bodies, their colour laid over what is seen through them."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np

from ....geometry.camera import Camera
from ....geometry.idcast import IdCaster, IdImage
from ....worlds.arrays import F64, RigidPose
from ....worlds.built import TriangleMesh
from ....worlds.candidate import Candidate
from ..balls import joined_balls
from ..layer import LooseLayer, TracedShapes
from .meshes import Liquid, liquids_of
from .shapes import liquid_shapes

__all__ = ["LiquidLayer"]

STILL = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
MOLTEN = (0.75, 0.12, 0.015)
"""Colour of lava in previews, which know no temperature."""
THIN, STEEP = 0.45, 0.45
"""Opacity of clear liquid seen straight on, and what grazing sight adds."""


class LiquidLayer(LooseLayer):
    """Surfaces and drops, from what was made with the bake, else from the particles, else the declared volume."""

    opaque = False
    nearer = 2e-3

    def __init__(self, candidate: Candidate, entities: Sequence[str]) -> None:
        self.liquids: list[Liquid] = liquids_of(candidate)
        super().__init__(candidate, [liquid.entity for liquid in self.liquids])
        self._kept: tuple[int, list[TriangleMesh]] | None = None

    def _meshes(self, frame: int) -> list[TriangleMesh]:
        """World meshes at a frame: faces and drops, one per liquid."""
        if self._kept is None or self._kept[0] != frame:
            found = []
            for liquid in self.liquids:
                drawn = liquid.drawn(frame)
                drops, faces = joined_balls(drawn.drops, drawn.drop_radius)
                joined = np.concatenate([drawn.faces, faces + len(drawn.vertices)]).astype(np.int32)
                found.append(TriangleMesh(np.concatenate([drawn.vertices, drops]), joined))
            self._kept = (frame, found)
        return self._kept[1]

    def meshes(self, entity: str, frame: int) -> list[TriangleMesh]:
        """Faces and drops of a liquid in the world at a frame."""
        return [self._meshes(frame)[self.entities.index(entity)]]

    def cast(self, frame: int, camera: Camera, entity: str | None = None) -> IdImage:
        """The view of all liquids, or of one, if nothing else were there; ids are indices into `entities`."""
        meshes = self._meshes(frame)
        only = None if entity is None else [k for k, name in enumerate(self.entities) if name == entity]
        return IdCaster(meshes).cast(camera, [STILL] * len(meshes), only=only)

    def traced(self, mi: Any, frame: int) -> TracedShapes:
        """Mitsuba shapes at a frame."""
        return liquid_shapes(mi, self.liquids, frame)

    @cached_property
    def colors(self) -> F64:
        """Linear RGB per liquid, shape (n, 3)."""
        return np.array([MOLTEN if one.look.glows else one.look.color for one in self.liquids]).reshape(-1, 3)

    def paint(self, below: F64, ids: Any, normals: F64, directions: F64, sun: F64, sky: tuple[float, ...]) -> F64:
        """Colours over what lies below: a tint by the slant of sight, the mirrored sky, a glint of the sun; see `LooseLayer.paint`."""
        color = self.colors[ids]
        clear = np.array([liquid.look.clear for liquid in self.liquids])[ids]
        facing = (normals * directions).sum(1)
        normals = np.where((facing > 0)[:, None], -normals, normals)
        light = 0.55 + 0.45 * np.maximum(normals @ sun, 0.0)
        slant = (1 - np.minimum(np.abs(facing), 1.0)) ** 3
        opacity = np.where(clear, THIN + STEEP * slant, 1.0)
        half = sun - directions
        half /= np.linalg.norm(half, axis=1, keepdims=True)
        glint = 0.35 * np.maximum((normals * half).sum(1), 0.0) ** 60
        mirror = (0.05 + 0.5 * slant)[:, None] * np.array(sky)
        own = opacity[:, None] * color * light[:, None]
        return np.asarray(below * (1 - opacity)[:, None] + own + mirror + glint[:, None])
