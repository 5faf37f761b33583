"""Landscapes as the spatial checks see them: their surface, the water over it, trunks and boulders, and grounds cut from them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...worlds.arrays import F64
from ...worlds.landscape import SavedLandscape, open_landscape
from ...worlds.spec import HeightField, StemField
from ...worlds.stems import Stems, stems_of

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.spec import WorldSpec

__all__ = ["Land", "Patch", "land_of", "lands", "patches", "solid_stems", "stem_triangles", "surface_triangles"]

SIDES = 24
"""Sides of the prisms that stand for trunks: 0.9 % of the radius within the circle."""


class Patch(NamedTuple):
    """A ground entity cut from a landscape, as a rectangle in the world [m]."""

    entity: str
    part: str
    low: F64
    """Shape (2,)."""
    high: F64


@dataclass(frozen=True, eq=False)
class Land:
    """One landscape. Its lattice points are the middles of its cells; between them each square is cut from south-west to
    north-east."""

    name: str
    saved: SavedLandscape

    @cached_property
    def height(self) -> F64:
        """Ground at the lattice points [m], NaN where there is no land, shape (rows, cols)."""
        return self.saved.field("height")

    @cached_property
    def water(self) -> F64:
        """Level of the water at the lattice points [m], -inf where there is none."""
        level = self.saved.field("water_level")
        return np.where(np.isfinite(level), level, -np.inf)

    @cached_property
    def stems(self) -> Stems:
        """Trunks and boulders."""
        return stems_of(self.saved)

    @property
    def cell(self) -> float:
        """Distance of lattice points [m]."""
        return self.saved.cell

    @cached_property
    def low(self) -> F64:
        """South-west lattice point [m], shape (2,)."""
        rows, cols = self.height.shape
        return -0.5 * self.cell * np.array([cols - 1, rows - 1])

    @property
    def high(self) -> F64:
        """North-east lattice point [m], shape (2,)."""
        return -self.low

    def places(self, points: F64) -> tuple[np.ndarray, F64]:
        """South-west lattice point (row, column) of the square of each point and the share of it, shapes (n, 2); -1 outside."""
        local = (points[:, 1::-1] - self.low[::-1]) / self.cell
        last = np.array(self.height.shape) - 2
        index = np.clip(np.floor(local).astype(np.int64), 0, last)
        outside = (local < -1e-9).any(axis=1) | (local > last + 1 + 1e-9).any(axis=1)
        index[outside] = -1
        return index, np.clip(local - index, 0.0, 1.0)

    def depths_at(self, points: F64) -> F64:
        """Depth of the water below its surface down to the heights of points, shape (n, 3) [m]; 0 where there is none.

        There is water where the nearest lattice point has some; its level is taken between all near ones that have.
        """
        index, (v, u) = self._squares(points)
        weight = np.stack([(1 - v) * (1 - u), (1 - v) * u, v * (1 - u), v * u])
        level = np.stack(self._corners(self.water, index))
        wet = np.isfinite(level)
        share = np.where(wet, weight, 0.0)
        surface = np.where(wet, level, 0.0)
        between = (share * surface).sum(axis=0) / np.maximum(share.sum(axis=0), 1e-300)
        nearest = np.take_along_axis(wet, weight.argmax(axis=0)[None], axis=0)[0] & (index[:, 0] >= 0)
        return np.where(nearest, np.maximum(between - points[:, 2], 0.0), 0.0)

    def heights_at(self, points: F64) -> F64:
        """Height of the ground at points [m], shape (n,); NaN off the land."""
        index, (v, u) = self._squares(points)
        a, b, d, e = self._corners(self.height, index)
        found = a + np.where(u >= v, (b - a) * u + (e - b) * v, (e - d) * u + (d - a) * v)
        return np.where(index[:, 0] >= 0, found, np.nan)

    def _squares(self, points: F64) -> tuple[np.ndarray, F64]:
        index, share = self.places(points)
        return index, share.T

    def _corners(self, values: F64, index: np.ndarray) -> tuple[F64, F64, F64, F64]:
        row, col = np.maximum(index, 0).T
        return values[row, col], values[row, col + 1], values[row + 1, col], values[row + 1, col + 1]


@lru_cache(maxsize=2)
def _opened(path: Path, written: int, name: str) -> Land:
    return Land(name, SavedLandscape(path))


def land_of(candidate: Candidate, name: str) -> Land:
    """A landscape of the candidate.

    Raises:
        EvidenceError: it is not built from its present specification.
    """
    saved = open_landscape(candidate.folder, candidate.spec, name)
    return _opened(saved.path, saved.path.stat().st_mtime_ns, name)


def lands(candidate: Candidate) -> tuple[Land, ...]:
    """All landscapes.

    Raises:
        EvidenceError: one is not built from its present specification.
    """
    return tuple(land_of(candidate, name) for name in candidate.spec.terrains)


def patches(spec: WorldSpec, name: str) -> tuple[Patch, ...]:
    """Ground entities cut from a landscape."""
    found = []
    for entity, contract in spec.entities.items():
        for part_name, part in contract.parts.items():
            shape = part.shape
            if isinstance(shape, HeightField) and shape.file is not None and shape.file.startswith(f"{name}-"):
                center = np.array(contract.pose.position[:2]) + np.array(part.pose.position[:2])
                half = 0.5 * np.array(shape.size)
                found.append(Patch(entity, part_name, center - half, center + half))
    return tuple(found)


def solid_stems(spec: WorldSpec, name: str) -> tuple[tuple[str, str], ...]:
    """Entities and parts that are trunks and boulders of a landscape."""
    return tuple(
        (entity, part_name)
        for entity, contract in spec.entities.items()
        for part_name, part in contract.parts.items()
        if isinstance(part.shape, StemField) and part.shape.file.startswith(f"{name}-stems-")
    )


def surface_triangles(land: Land, low: F64, high: F64, covered: tuple[Patch, ...]) -> F64:
    """The landscape's own surface in a rectangle, without the squares that grounds cover, shape (t, 3, 3)."""
    rows, cols = land.height.shape
    first = np.clip(np.floor((low - land.low) / land.cell).astype(int), 0, [cols - 2, rows - 2])
    last = np.clip(np.ceil((high - land.low) / land.cell).astype(int), 1, [cols - 1, rows - 1])
    if (last <= first).any() or (high < land.low).any() or (low > land.high).any():
        return np.zeros((0, 3, 3))
    z = land.height[first[1] : last[1] + 1, first[0] : last[0] + 1]
    x, y = (land.low[k] + land.cell * np.arange(first[k], last[k] + 1) for k in (0, 1))
    point = np.stack([*np.meshgrid(x, y), z], axis=-1)
    keep = np.isfinite(z[:-1, :-1] + z[:-1, 1:] + z[1:, :-1] + z[1:, 1:])
    for patch in covered:
        east = (x[:-1] >= patch.low[0]) & (x[1:] <= patch.high[0])
        north = (y[:-1] >= patch.low[1]) & (y[1:] <= patch.high[1])
        keep &= ~(north[:, None] & east[None])
    a, b, d, e = point[:-1, :-1][keep], point[:-1, 1:][keep], point[1:, :-1][keep], point[1:, 1:][keep]
    return np.concatenate([np.stack([a, b, e], axis=1), np.stack([a, e, d], axis=1)])


def stem_triangles(stems: Stems, sink: float = 0.3) -> F64:
    """Walls and tops of prisms in place of trunks and boulders, `sink` [m] into the ground, shape (t, 3, 3)."""
    turn = 2 * np.pi * np.arange(SIDES) / SIDES
    ring = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    flat = stems.foot[:, None, :2] + stems.radius[:, None, None] * ring
    count = len(stems.radius)
    level = [stems.foot[:, 2] - sink, stems.foot[:, 2] + stems.top]
    lower, upper = (np.concatenate([flat, np.broadcast_to(z[:, None, None], (count, SIDES, 1))], axis=2) for z in level)
    lower_next, upper_next = np.roll(lower, -1, axis=1), np.roll(upper, -1, axis=1)
    middle = np.broadcast_to(upper.mean(axis=1, keepdims=True), upper.shape)
    faces = [(lower, lower_next, upper_next), (lower, upper_next, upper), (middle, upper, upper_next)]
    return np.concatenate([np.stack(corners, axis=2).reshape(-1, 3, 3) for corners in faces])
