"""Triangles with a tree over them, room for the pairs that they find, and lists of the corners of pairs at each vertex."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ...geometry.launch import warp
from ...worlds.arrays import I32
from ..passes import Pass, Passes
from . import list_kernels as lists
from . import near_kernels as near

__all__ = ["Corners", "Slots", "Surface", "Surfaces", "ownership"]


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

    def __init__(self, passes: Passes, count: int, room: int, *, bare: bool = False) -> None:
        self.count, self.room, self.passes, self.device, self._bare = count, room, passes, passes.device, bare
        self._most = warp().zeros(1, dtype=warp().int32, device=self.device)
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
        if self.device == "cpu":
            most = int(self.found.numpy().max(initial=0))
        else:
            self._most.zero_()
            self.passes("widest", lists.widest, self.count, [self.found, self._most])()
            most = int(self._most.numpy()[0])
        if most <= self.room:
            return True
        self.room = int(1.5 * most) + 1
        self._make()
        return False

    def total(self) -> int:
        """Number of pairs found; where each triangle's begin among them is known from then on."""
        warp().utils.array_scan(self.found, self.before, inclusive=False)
        return int(self.before[-1:].numpy()[0]) + int(self.found[-1:].numpy()[0])


class Corners:
    """Corners of some of the pairs at each vertex, listed anew in every step of a GPU.

    Args:
        passes: where its kernels are kept.
        name: of its passes.
        count: vertices.
        room: corners at each.
    """

    def __init__(self, passes: Passes, name: str, count: int, room: int) -> None:
        self.passes, self.name, self.count, self.room = passes, name, count, room
        self.grow(1)

    def grow(self, factor: int) -> None:
        """Have more room."""
        wp, device = warp(), self.passes.device
        self.room *= factor
        self.start = wp.array(self.room * np.arange(self.count, dtype=np.int32), dtype=wp.int32, device=device)
        self.end = wp.zeros(self.count, dtype=wp.int32, device=device)
        self._any, self.items = (wp.zeros(self.room * self.count, dtype=wp.int32, device=device) for _ in range(2))

    @property
    def lists(self) -> tuple[Any, Any, Any]:
        """Where each vertex' corners begin and end, and the corners."""
        return self.start, self.end, self.items

    def made(self, kernel: Any, pairs: int, inputs: list[Any], over: Any) -> list[Pass]:
        """Passes that make the lists of what a kernel picks among the pairs."""
        p, name = self.passes, self.name
        return [
            p(name + "_none", lists.none_yet, self.count, [self.start, self.end]),
            p(name, kernel, pairs, [self.count, self.room, *inputs, self.end, self._any]),
            p(
                name + "_order",
                lists.order,
                self.room * self.count,
                [self.room, self.start, self.end, self._any, self.items, over],
            ),
        ]
