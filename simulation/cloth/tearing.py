"""Tears: where sheets are pulled harder than they are strong, edges between their triangles open.

A vertex tears when the tension around it, the largest over all directions of the mean over its triangles by area, exceeds the
strength. What opens are the edges at it that lie across that direction: one where it lies on a rim or at the end of a tear already,
else two, to both sides (after the separation planes of O'Brien and Hodgins 1999, doi:10.1145/311535.311550, without cutting
triangles). Masses belong to triangles, so that nothing is lost.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...worlds.arrays import F64, I32
from ...worlds.categories.cloth.tears import Flags, Seams, following, welded

if TYPE_CHECKING:
    from .mesh import Sheet

__all__ = ["Tear", "Tearing", "tensions"]

ALIGNED = 0.75
"""Own choice: cosine of an edge to the tension above which it does not open; in a grid of squares one edge is always below."""


class Tear(NamedTuple):
    """One vertex that tore."""

    corner: int
    """One of its corners before."""
    point: F64
    """[m]"""
    tension: float
    """[N/m]"""
    sides: I32
    """Sides that opened, with their mates (k, 2)."""
    triangles: I32
    """Those around it before (m,)."""
    places: F64
    """Where their corners were (m, 3, 3) [m]."""


class _Stress(NamedTuple):
    """Tension of the triangles, per length at rest [N/m]."""

    warp: F64
    """Its directions (t, 3)."""
    weft: F64
    values: F64
    """Along warp and weft, and between them (t, 3)."""


def _stress(sheet: Sheet, x: F64) -> _Stress:
    p, q = x[sheet.faces[:, 1]] - x[sheet.faces[:, 0]], x[sheet.faces[:, 2]] - x[sheet.faces[:, 0]]
    r = sheet.inverse_rest[:, :, None]
    u, v = r[:, 0] * p + r[:, 1] * q, r[:, 2] * p + r[:, 3] * q
    lu, lv = np.linalg.norm(u, axis=1), np.linalg.norm(v, axis=1)
    u, v = u / np.maximum(lu, 1e-30)[:, None], v / np.maximum(lv, 1e-30)[:, None]
    values = sheet.modulus[:, :3] * np.stack([lu - 1.0, lv - 1.0, (u * v).sum(axis=1)], axis=1)
    return _Stress(u, v, values)


def tensions(sheet: Sheet, x: F64, least: float) -> tuple[I32, F64, F64]:
    """Vertices around which the tension exceeds `least` [N/m]: which (k,), the tension (k,), its direction (k, 3)."""
    stress = _stress(sheet, x)
    n1, n2, n12 = stress.values.T
    most = 0.5 * (n1 + n2) + np.sqrt(0.25 * (n1 - n2) ** 2 + n12**2)
    none = np.empty(0, dtype=np.int32), np.empty(0), np.empty((0, 3))
    if most.max() <= least:
        return none
    corner, count = sheet.faces.ravel(), len(x)
    whole = np.bincount(corner, np.repeat(sheet.area, 3), minlength=count)
    # The largest eigenvalue of a mean is at most the mean of the largest eigenvalues.
    bound = np.bincount(corner, np.repeat(sheet.area * most, 3), minlength=count) / whole
    which = np.flatnonzero(bound > least).astype(np.int32)
    if len(which) == 0:
        return none
    number = np.full(count, -1)
    number[which] = np.arange(len(which))
    row = number[corner]
    triangle = (np.arange(len(corner)) // 3)[row >= 0]
    u, v, n = stress.warp[triangle], stress.weft[triangle], stress.values[triangle, :, None, None]
    across = u[:, :, None] * v[:, None, :]
    tensor = (
        n[:, 0] * u[:, :, None] * u[:, None, :]
        + n[:, 1] * v[:, :, None] * v[:, None, :]
        + n[:, 2] * (across + across.swapaxes(1, 2))
    )
    total = np.zeros((len(which), 3, 3))
    np.add.at(total, row[row >= 0], sheet.area[triangle, None, None] * tensor)
    value, direction = np.linalg.eigh(total / whole[which, None, None])
    over = value[:, 2] > least
    return which[over], value[over, 2], direction[over, :, 2]


@dataclass
class Tearing:
    """Tears of one sheet.

    Attributes:
        seams: how it hangs together when whole.
        strength: [N/m].
        opened: sides that are open, with their mates, shape (3 t,).
    """

    seams: Seams
    strength: float
    opened: Flags

    def weld(self) -> I32:
        """Vertex of the sheet at each corner, shape (3 t,)."""
        return welded(self.seams, self.opened)

    def tear(self, sheet: Sheet, x: F64) -> list[Tear]:
        """Open what is pulled too hard with its vertices at x (n, 3) [m]: the worst first, no two neighbours at once, and but one where
        there was no tear before, for it relieves the others."""
        which, tension, direction = tensions(sheet, x, self.strength)
        found: list[Tear] = []
        done, begun = np.zeros(len(x), dtype=bool), False
        for k in np.argsort(-tension, kind="stable").tolist():
            vertex = int(which[k])
            corners = np.flatnonzero(sheet.faces.ravel() == vertex).astype(np.int32)
            around = sheet.faces[corners // 3]
            tip = bool(self.opened[3 * (corners // 3)[:, None] + np.arange(3)].any())
            if done[around].any() or (begun and not tip):
                continue
            sides = self._across(corners, x, sheet.faces.ravel(), direction[k])
            if len(sides) == 0:
                continue
            pairs = np.stack([sides, self.seams.mate[sides]], axis=1)
            self.opened[pairs] = True
            done[vertex], begun = True, begun or not tip
            found.append(Tear(int(corners[0]), x[vertex].copy(), float(tension[k]), pairs, corners // 3, x[around]))
        return found

    def _across(self, corners: I32, x: F64, vertices: I32, direction: F64) -> I32:
        """Sides from a vertex, that begin at some of its corners, which open under a tension along `direction`."""
        inner = corners[(self.seams.mate[corners] >= 0) & ~self.opened[corners]]
        if len(inner) == 0:
            return inner
        edges = x[vertices[following(inner)]] - x[vertices[inner]]
        edges /= np.linalg.norm(edges, axis=1)[:, None]
        along = np.abs(edges @ direction)
        first = int(np.argmin(along))
        chosen = [first]
        if len(inner) == len(corners):
            opposite = np.flatnonzero(edges @ edges[first] < 0.0)
            chosen += [int(opposite[np.argmin(along[opposite])])] if len(opposite) else []
        if len(chosen) < 1 + (len(inner) == len(corners)) or along[chosen].max() > ALIGNED:
            return inner[:0]
        return inner[chosen]
