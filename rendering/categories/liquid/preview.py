"""Liquids over a cast picture: whose face is in front where, and how its colour lies over what is seen through it."""

from __future__ import annotations

from typing import Any

import numpy as np

from ....geometry.camera import Camera
from ....geometry.idcast import IdCaster, IdImage
from ....worlds.arrays import F64, RigidPose
from ....worlds.built import TriangleMesh
from ....worlds.candidate import Candidate
from .meshes import Liquid, joined_balls, liquids_of

__all__ = ["LiquidLayer", "over", "tinted"]

STILL = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
MOLTEN = (0.75, 0.12, 0.015)
"""Colour of lava in previews, which know no temperature."""
THIN, STEEP = 0.45, 0.45
"""Opacity of clear liquid seen straight on, and what grazing sight adds."""


class LiquidLayer:
    """The liquids of a candidate, cast beside its solids."""

    def __init__(self, candidate: Candidate) -> None:
        self.liquids: list[Liquid] = liquids_of(candidate)
        self._kept: tuple[int, list[TriangleMesh]] | None = None

    def meshes(self, frame: int) -> list[TriangleMesh]:
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

    def cast(self, frame: int, camera: Camera, entity: str | None = None) -> IdImage:
        """What would be seen of all liquids, or of one, if nothing else were there; ids are indices into `liquids`."""
        meshes = self.meshes(frame)
        only = None if entity is None else [k for k, liquid in enumerate(self.liquids) if liquid.entity == entity]
        return IdCaster(meshes).cast(camera, [STILL] * len(meshes), only=only)


def over(solid: IdImage, liquid: IdImage, first: int, front: Any = None) -> IdImage:
    """The second cast over the first where `front` says, default where it is nearer; its ids count from `first`."""
    if front is None:
        front = (liquid.ids >= 0) & (liquid.depth < solid.depth)
    return IdImage(
        np.where(front, liquid.ids + first, solid.ids).astype(np.int32),
        np.where(front, liquid.depth, solid.depth),
        np.where(front[..., None], liquid.normals, solid.normals),
    )


def tinted(below: F64, liquids: list[Liquid], ids: Any, normals: F64, directions: F64, sun: F64, sky: tuple[float, ...]) -> F64:
    """Colours of liquids over what lies below them.

    Args:
        below: linear RGB behind (n, 3).
        liquids: of the candidate.
        ids: which of them is seen (n,).
        normals: of their faces (n, 3).
        directions: of sight (n, 3).
        sun: unit vector towards it.
        sky: colour that they mirror.
    """
    color = np.array([MOLTEN if liquid.look.glows else liquid.look.color for liquid in liquids])[ids]
    clear = np.array([liquid.look.clear for liquid in liquids])[ids]
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
