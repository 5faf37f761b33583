"""Triangles with a tree over them, and room for the pairs that they find."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ...geometry.launch import warp
from ...worlds.arrays import I32
from ..passes import Passes
from . import near_kernels as near

__all__ = ["Slots", "Surface", "Surfaces", "ownership"]


class Surfaces(NamedTuple):
    """The triangles that can meet."""

    faces: I32
    """Triangles of the sheets, shape (m, 3)."""
    sheet_vertices: int
    """Number of vertices that are the sheets'; the others are the solids'."""
    solid_faces: I32
    """Triangles of all solids, indices among all vertices."""
    solid_body: I32
    """Row of each of those triangles."""
    holder: I32
    """Row of the body that holds each vertex; -1: the world, -2: nothing."""
    kin: I32
    """A number for each vertex of the sheets, the same for those that were one before a tear."""


def ownership(faces: I32) -> I32:
    """For each triangle bits of the vertices (1, 2, 4) and of the edges from vertex c to the next (8, 16, 32) that it stands for."""
    owned = np.zeros(len(faces), dtype=np.int32)
    flat = faces.ravel()
    _, first = np.unique(flat, return_index=True)
    np.bitwise_or.at(owned, first // 3, (1 << (first % 3)).astype(np.int32))
    ends = np.sort(np.stack([flat, np.roll(faces, -1, axis=1).ravel()], axis=1), axis=1)
    _, first = np.unique(ends[:, 0].astype(np.int64) * (int(flat.max(initial=0)) + 1) + ends[:, 1], return_index=True)
    np.bitwise_or.at(owned, first // 3, (8 << (first % 3)).astype(np.int32))
    return owned


class Surface:
    """Triangles with their bounds and a tree over them."""

    def __init__(self, faces: I32, device: str) -> None:
        wp = warp()
        self.count = len(faces)
        self.faces = wp.array(np.ascontiguousarray(faces, dtype=np.int32), dtype=wp.vec3i, device=device)
        self.owned = wp.array(ownership(faces), dtype=wp.int32, device=device)
        self.lower = wp.zeros(self.count, dtype=wp.vec3, device=device)
        self.upper = wp.zeros(self.count, dtype=wp.vec3, device=device)
        self.spread = wp.zeros(self.count, dtype=wp.float64, device=device)
        self.tree: Any = None

    def fit(self, passes: Passes, name: str, x: Any, u: Any, span: Any, drift: Any) -> None:
        """Take bounds of the triangles over a span of time, seen from what goes with `drift`, and bring the tree to them."""
        passes(name, near.boxes, self.count, [x, u, span, drift, self.faces, self.lower, self.upper, self.spread])()
        if self.tree is None:
            self.tree = warp().Bvh(self.lower, self.upper)
        else:
            self.tree.refit()


class Slots:
    """Room for what each triangle finds."""

    def __init__(self, device: str, count: int, room: int, *, bare: bool = False) -> None:
        self.count, self.room, self.device, self._bare = count, room, device, bare
        self._make()

    def _make(self) -> None:
        wp = warp()
        self.found, self.before = (wp.zeros(self.count, dtype=wp.int32, device=self.device) for _ in range(2))
        if self._bare:
            self.others = wp.zeros(self.count * self.room, dtype=wp.int32, device=self.device)
            return
        self.pairs = wp.zeros(self.count * self.room, dtype=wp.vec4i, device=self.device)
        self.kinds = wp.zeros(self.count * self.room, dtype=wp.vec2i, device=self.device)

    def fits(self) -> bool:
        """True if all found room; if not there is more from now on."""
        most = int(self.found.numpy().max(initial=0))
        if most > self.room:
            self.widen(most)
            return False
        return True

    def widen(self, most: int) -> None:
        """Have more room than for so many."""
        self.room = int(1.5 * most) + 1
        self._make()

    def total(self) -> int:
        """Number of pairs found; where each triangle's begin among them is known from then on."""
        warp().utils.array_scan(self.found, self.before, inclusive=False)
        return int(self.before[-1:].numpy()[0]) + int(self.found[-1:].numpy()[0])
