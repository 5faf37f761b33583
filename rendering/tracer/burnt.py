"""Parts that burn in a batch of the path tracer: how black each corner is, and which triangles are gone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64, I64
from ..categories.charring import Charred, blackened
from .surfaces import Surface

if TYPE_CHECKING:
    from ...worlds.built import BuiltPart
    from ...worlds.candidate import Candidate

__all__ = ["BurntPart", "burnt_part", "burnt_surface"]

Cut = Callable[[Surface, NDArray[np.bool_], float], Surface]
"""Halves the chosen triangles of a surface until none is longer than a length [m]."""
FINE = 1.0
"""[cells of the gas] Widest triangle on which char is drawn."""


@dataclass(frozen=True)
class BurntPart:
    """The corners of one part that burns."""

    charred: Charred
    rows: slice
    """Rows of the batch."""
    face: I64
    """Visible triangle that each row is a corner of, of cloth; of solids empty."""
    near: tuple[I64, F64]
    """Pieces about each row of solids, and their weights; of cloth empty."""

    def char(self, frame: int) -> F64:
        """Blackness of each of its rows at a frame."""
        if self.charred.sheet:
            return blackened(self.charred.by_face(frame))[self.face]
        at, weight = self.near
        return blackened(np.einsum("vk,vk->v", weight, self.charred.shares(frame)[at]))

    def hole(self, frame: int, positions: F64) -> None:
        """Draw triangles that are gone together to their first corner."""
        if self.charred.sheet:
            own = positions[self.rows]
            gone = self.charred.gone(frame)[self.face]
            own[gone] = np.repeat(own[::3], 3, axis=0)[gone]


def burnt_surface(candidate: Candidate, charred: Charred, surface: Surface, finely: Cut) -> Surface:
    """The surface of a part so that its char can be drawn: cloth with corners of its own for each triangle, a solid cut by `finely`."""
    if charred.sheet:
        at = surface.faces.reshape(-1)
        faces = np.arange(len(at), dtype=np.int32).reshape(-1, 3)
        return replace(surface, positions=surface.positions[at], normals=surface.normals[at], uv=surface.uv[at], faces=faces)
    cell = candidate.spec.entities[charred.cache.index.bodies[0]].physics.flow_cell
    return finely(surface, np.ones(len(surface.faces), dtype=bool), FINE * cell)


def burnt_part(candidate: Candidate, charred: Charred, part: BuiltPart, surface: Surface, start: int) -> BurntPart:
    """A part whose `surface`, as `burnt_surface` made it, stands in a batch from row `start` on."""
    from scipy.spatial import cKDTree

    rows, none = slice(start, start + len(surface.positions)), np.zeros(0, dtype=np.int64)
    if charred.sheet:
        middle = part.render.vertices[charred.faces].mean(axis=1)
        face = cKDTree(middle).query(surface.positions[surface.faces].mean(axis=1))[1].astype(np.int64)
        return BurntPart(charred, rows, np.repeat(face, 3), (none, np.zeros(0)))
    pose = candidate.pose(charred.entity, 0, part.body)
    origin = pose.apply(np.zeros((1, 3)))
    near = charred.near(pose.apply(surface.positions), pose.apply(surface.normals) - origin)
    return BurntPart(charred, rows, none, near)
