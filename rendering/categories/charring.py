"""Solids and cloth that burn beside a gas, in pictures: black as far as their gas has left them, and cloth gone where it is consumed (R99, R100).

The record is the cache of the gas: what is left of each piece of surface. Nothing of it is made up here but the shade of char.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry.inside import nearest_faces
from ...geometry.solids import Solid
from ...worlds.arrays import F64, I64
from ...worlds.built import TriangleMesh
from ...worlds.cache import Cache
from ...worlds.candidate import Candidate
from ...worlds.categories.gas.burning import burning_sheets, flammable_parts

__all__ = ["CHAR", "Charred", "Charring", "blackened"]

BLACK = 0.3
"""[1] Own choice: share of what can become gas that has, from which on a surface is black."""
CHAR = (0.018, 0.016, 0.015)
"""Linear RGB of char (a few percent: Modest, Radiative Heat Transfer, table B.2)."""
NEAR = 4
"""Pieces that a corner takes its char from."""
ALIKE = 0.5
"""Least cosine between the normals of a corner and of a piece on its side."""


def blackened(share: F64) -> F64:
    """Blackness of surfaces, 0..1, by the share of what can become gas that has."""
    return np.clip(share / BLACK, 0.0, 1.0)


class _Found(NamedTuple):
    """Pieces of one part at frame 0."""

    face: I64
    """Visible triangle of each, shape (k,)."""
    point: F64
    """[m], shape (k, 3)."""
    normal: F64
    """Shape (k, 3)."""


@dataclass(frozen=True, eq=False)
class Charred:
    """One part that burns."""

    candidate: Candidate
    cache: Cache
    entity: str
    part: str
    rows: NDArray[np.intp]
    """Its pieces among those of the cache."""
    sheet: bool
    """It is cloth, which is gone where it is consumed."""
    _kept: dict[int, F64] = field(default_factory=dict)

    @cached_property
    def faces(self) -> NDArray[np.int64]:
        """Visible triangles of the part, shape (m, 3)."""
        own = next(p for p in self.candidate.entity(self.entity).parts if p.part == self.part)
        return np.asarray(own.render.faces, dtype=np.int64)

    @cached_property
    def _first(self) -> dict[str, F64]:
        data = self.cache.read(0, ("burning_left", "burning_area", "burning_point"))
        return {name: np.asarray(values, dtype=np.float64)[self.rows] for name, values in data.items()}

    @cached_property
    def _found(self) -> _Found:
        place = self.candidate.surface(self.entity, self.part, 0)
        across = np.cross(place[self.faces[:, 1]] - place[self.faces[:, 0]], place[self.faces[:, 2]] - place[self.faces[:, 0]])
        size = np.linalg.norm(across, axis=1)
        real = np.flatnonzero(size > 0.0)  # A solid leaves out the others.
        solid = Solid.from_mesh(TriangleMesh(place, self.faces[real].astype(np.int32)), closed=False)
        point = self._first["burning_point"]
        face = real[nearest_faces(solid, point)[2]]
        return _Found(face.astype(np.int64), point, across[face] / size[face, None])

    def shares(self, frame: int) -> F64:
        """Share of what can become gas that has, of each piece at a frame, shape (k,)."""
        frame = min(frame, self.cache.index.frames - 1)
        if frame not in self._kept:
            left = np.asarray(self.cache.read(frame, ("burning_left",))["burning_left"], dtype=np.float64)[self.rows]
            self._kept.clear()
            self._kept[frame] = 1.0 - left / np.maximum(self._first["burning_left"], 1e-300)
        return self._kept[frame]

    def by_face(self, frame: int) -> F64:
        """The same of each visible triangle, shape (m,)."""
        area, count = self._first["burning_area"], len(self.faces)
        face = self._found.face
        whole = np.bincount(face, area, minlength=count)
        return np.bincount(face, area * self.shares(frame), minlength=count) / np.maximum(whole, 1e-300)

    def gone(self, frame: int) -> NDArray[np.bool_]:
        """Visible triangles of cloth all of whose pieces are consumed, shape (m,)."""
        if not self.sheet:
            return np.zeros(len(self.faces), dtype=bool)
        face, there = self._found.face, np.bincount(self._found.face, minlength=len(self.faces)) > 0
        whole = np.bincount(face, self.shares(frame) < 1.0, minlength=len(self.faces)) > 0
        return there & ~whole

    def near(self, points: F64, normals: F64) -> tuple[I64, F64]:
        """Pieces about points (v, 3) of its surface at frame 0 with normals (v, 3), and their weights, each (v, NEAR); rows sum to 1 or 0."""
        from scipy.spatial import cKDTree

        found = self._found
        count = min(NEAR, len(found.point))
        gap, at = (a.reshape(len(points), count) for a in cKDTree(found.point).query(points, k=count))
        facing = np.einsum("vkx,vx->vk", found.normal[at], normals)
        facing = np.abs(facing) if self.sheet else facing
        weight = np.where(facing > ALIKE, 1.0 / (gap + 1e-3) ** 2, 0.0)
        total = weight.sum(axis=1, keepdims=True)
        return at.astype(np.int64), np.where(total > 0.0, weight / np.maximum(total, 1e-300), 0.0)

    def at(self, points: F64, frame: int) -> F64:
        """Blackness of points (v, 3) of its surface at a frame, where that is then, shape (v,)."""
        from scipy.spatial import cKDTree

        index = min(frame, self.cache.index.frames - 1)
        place = np.asarray(self.cache.read(index, ("burning_point",))["burning_point"], dtype=np.float64)[self.rows]
        return blackened(self.shares(frame)[cKDTree(place).query(points)[1]])


class Charring:
    """All that burns in a candidate.

    Args:
        candidate: with the caches of its gases; without, nothing burns.
    """

    def __init__(self, candidate: Candidate) -> None:
        self.parts: dict[tuple[str, str], Charred] = {}
        for solver, cache in sorted(candidate.gas_caches.items()):
            named = flammable_parts(candidate.spec, solver)
            if not named:
                continue
            number = np.asarray(cache.read(0, ("burning_part",))["burning_part"])
            sheets = burning_sheets(candidate.spec, solver)
            for k, (entity, part) in enumerate((e, p) for e, parts in named.items() for p in parts):
                rows = np.flatnonzero(number == k)
                if len(rows):
                    self.parts.setdefault((entity, part), Charred(candidate, cache, entity, part, rows, entity in sheets))

    def of(self, entity: str, part: str) -> Charred | None:
        """The char of a part; None where nothing of it burns."""
        return self.parts.get((entity, part))
