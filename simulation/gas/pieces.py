"""Surfaces that may burn, cut into pieces: of solids, of bodies that move, of cloth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64

if TYPE_CHECKING:
    from ...worlds.built import TriangleMesh
    from ...worlds.categories.gas.models import Flammable

__all__ = ["STANDS", "CutSheet", "Pieces", "cut_into_pieces", "cut_sheet"]

STANDS = -1
"""Carrier of what never moves."""


@dataclass(frozen=True)
class Pieces:
    """Pieces of surface that may burn."""

    part: NDArray[np.int32]
    """Number of the part of each, shape (n,)."""
    point: F64
    """Middle [m], shape (n, 3): in the frame of the body that carries it; in the world of what stands; of cloth at rest."""
    normal: F64
    """Outward, shape (n, 3), likewise; of cloth its side that counts as the front."""
    area: F64
    """[m^2], shape (n,); of cloth at rest."""
    depth: F64
    """Material below it [m], shape (n,): volume over area of its part; thickness of cloth."""
    density: F64
    """[kg/m^3], shape (n,)."""
    kind: tuple[Flammable, ...]
    """Flammability of each part."""
    carrier: NDArray[np.int64]
    """Row of what carries it among the boundaries of the surround, `STANDS` of what stands, shape (n,)."""
    corner: NDArray[np.int64]
    """Vertices of the triangle that a piece of cloth is cut from, shape (n, 3)."""
    weight: F64
    """Shares of these vertices in its middle, shape (n, 3)."""
    thin: NDArray[np.bool_]
    """True of cloth, which gas and flames meet from both sides, shape (n,)."""

    def of(self, name: str) -> F64:
        """Burning of each piece: a field of `Flammable`, shape (n,)."""
        return np.array([getattr(k, name) for k in self.kind], dtype=np.float64)[self.part]


class CutSheet(NamedTuple):
    """Pieces of a sheet."""

    point: F64
    """Middles [m], shape (n, 3)."""
    normal: F64
    """Shape (n, 3)."""
    area: F64
    """[m^2], shape (n,)."""
    face: NDArray[np.int64]
    """Triangle that each is cut from, shape (n,)."""
    weight: F64
    """Shares of that triangle's corners in its middle, shape (n, 3)."""


def cut_into_pieces(mesh: TriangleMesh, widest: float) -> tuple[F64, F64, F64]:
    """Middles (n, 3), outward normals (n, 3) and areas (n,) of the triangles of a surface, halved until no edge is longer than `widest` [m]."""
    corner = _halved(np.asarray(mesh.vertices, dtype=np.float64)[mesh.faces], widest)
    kept, normal, area = _sized(corner)
    return corner[kept].mean(axis=1), normal, area


def cut_sheet(vertices: F64, faces: NDArray[np.int32], widest: float) -> CutSheet:
    """Pieces of the triangles of a sheet at rest, likewise."""
    count = len(faces)
    own = np.broadcast_to(np.eye(3), (count, 3, 3))
    number = np.broadcast_to(np.arange(count, dtype=np.float64)[:, None, None], (count, 3, 1))
    corner = _halved(np.concatenate([np.asarray(vertices, dtype=np.float64)[faces], own, number], axis=2), widest)
    kept, normal, area = _sized(corner)
    middle = corner[kept].mean(axis=1)
    face = np.round(middle[:, 6]).astype(np.int64)
    return CutSheet(middle[:, :3], normal, area, face, middle[:, 3:6])


def _halved(corner: F64, widest: float) -> F64:
    """Corners (m, 3, 3 + k) of triangles, halved at their longest edges; what stands behind the places is halved along."""
    done: list[F64] = []
    while len(corner):
        place = corner[..., :3]
        edge = np.linalg.norm(np.roll(place, -1, axis=1) - place, axis=2)
        longest = edge.argmax(axis=1)
        fine = edge.max(axis=1) <= widest
        done.append(corner[fine])
        some, k = corner[~fine], longest[~fine]
        row = np.arange(len(some))
        a, b, c = some[row, k], some[row, (k + 1) % 3], some[row, (k + 2) % 3]
        middle = 0.5 * (a + b)
        corner = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
    return np.concatenate(done)


def _sized(corner: F64) -> tuple[NDArray[np.bool_], F64, F64]:
    """Triangles that have an area, and the normals and areas of these."""
    across = np.cross(corner[:, 1, :3] - corner[:, 0, :3], corner[:, 2, :3] - corner[:, 0, :3])
    size = np.linalg.norm(across, axis=1)
    kept = size > 0.0
    return kept, across[kept] / size[kept, None], 0.5 * size[kept]
