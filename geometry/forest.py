"""Balanced binary trees of boxes over many solids at once, as flat arrays that kernels and numpy walk alike."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F64, I32
from .convex_batch import Convex, convex_of

if TYPE_CHECKING:
    from .solids import Solid

__all__ = ["Forest", "Trees", "grow"]

LEAF = 2
"""Boxes per leaf. Measured for clearance: 1 and 2 are equally fast, 4 a third slower; 2 needs half the nodes of 1."""


@dataclass(frozen=True)
class Trees:
    """Trees over groups of boxes, level by level from the roots; node g is the root of group g."""

    lower: F64
    """Least corner of each node [m], shape (nodes, 3)."""
    upper: F64
    """Greatest corner [m], shape (nodes, 3)."""
    link: I32
    """First child of each node, the second follows it; of a leaf -1 - its first place in `order`."""
    span: I32
    """Boxes in each leaf; 0 for inner nodes."""
    order: NDArray[np.intp]
    """The boxes, leaf after leaf."""
    depth: int
    """Levels below the roots."""


def grow(lower: F64, upper: F64, groups: NDArray[np.intp], *, leaf: int = LEAF) -> Trees:
    """Trees by halving each group at the median of its box centres along the axis where those spread most.

    Args:
        lower: least corners [m], shape (n, 3).
        upper: greatest corners [m], shape (n, 3).
        groups: size of each group, shape (g,), every one > 0; the boxes of a group follow one another.
        leaf: most boxes in a leaf.
    """
    center = 0.5 * (lower + upper)
    order = np.arange(len(lower))
    start, count = np.cumsum(groups) - groups, np.asarray(groups, dtype=np.intp)
    total = 0
    lows, highs, links, spans = [], [], [], []
    while len(start):
        total += len(start)
        # `start` ascends and the open ranges leave only gaps of finished leaves between them.
        place = np.repeat(start - np.concatenate([[0], np.cumsum(count)[:-1]]), count) + np.arange(count.sum())
        first = np.cumsum(count) - count
        mine = order[place]
        lows.append(np.minimum.reduceat(lower[mine], first))
        highs.append(np.maximum.reduceat(upper[mine], first))
        inner = count > leaf
        links.append(np.where(inner, total + 2 * (np.cumsum(inner) - 1), -1 - start))
        spans.append(np.where(inner, 0, count))
        order[place] = mine[_by_node(center[mine], first, count)]
        half = (count[inner] + 1) // 2
        start = np.stack([start[inner], start[inner] + half], axis=1).reshape(-1)
        count = np.stack([half, count[inner] - half], axis=1).reshape(-1)
    return Trees(
        np.concatenate(lows),
        np.concatenate(highs),
        np.concatenate(links).astype(np.int32),
        np.concatenate(spans).astype(np.int32),
        order,
        len(lows) - 1,
    )


def _by_node(center: F64, first: NDArray[np.intp], count: NDArray[np.intp]) -> NDArray[np.intp]:
    """Order of box centres within each node, along the axis on which those of the node spread most."""
    least = np.minimum.reduceat(center, first)
    spread = np.maximum.reduceat(center, first) - least
    axis = spread.argmax(axis=1)
    rows = np.arange(len(first))
    node = np.repeat(rows, count)
    wide = spread[rows, axis]
    share = (np.take_along_axis(center, axis[node][:, None], axis=1)[:, 0] - least[rows, axis][node]) / np.where(
        wide > 0, wide, 1.0
    )[node]
    # One sort for all nodes: the node before the point, the place within it (0 to 1, halved) after.
    return np.argsort(node + 0.5 * share, kind="stable")


class Forest:
    """Solids prepared for batched queries, on first use; worth keeping when the same solids are asked again."""

    def __init__(self, solids: Sequence[Solid]) -> None:
        self.solids = tuple(solids)
        self.on_device: dict[str, Any] = {}
        """Its arrays for kernels, per device."""
        self.overlaps = 0
        """Overlaps of bodies that are not convex which `clearance_batch` measured without kernels so far."""

    @cached_property
    def _groups(self) -> NDArray[np.intp]:
        return np.array([len(s.faces) for s in self.solids], dtype=np.intp)

    @cached_property
    def trees(self) -> Trees:
        """One tree over the triangles of each solid; node s is the root of solid s."""
        bounds = [s.face_bounds for s in self.solids]
        return grow(np.concatenate([b[0] for b in bounds]), np.concatenate([b[1] for b in bounds]), self._groups)

    @cached_property
    def convex(self) -> Convex:
        """The convex ones among the solids, for compiled loops."""
        return convex_of(self.solids)

    @cached_property
    def corners(self) -> F64:
        """Corners of the triangles of all solids [m], in the order of the leaves, shape (t, 3, 3)."""
        return np.ascontiguousarray(np.concatenate([s.triangles for s in self.solids])[self.trees.order])

    @cached_property
    def first_face(self) -> I32:
        """Where the triangles of each solid begin in `corners`, shape (solids + 1,)."""
        return np.concatenate([[0], np.cumsum(self._groups)]).astype(np.int32)

    @cached_property
    def face(self) -> I32:
        """Index of each of `corners` in its own solid, shape (t,)."""
        return np.asarray(self.trees.order - np.repeat(self.first_face[:-1], self._groups), dtype=np.int32)

    @cached_property
    def heads(self) -> F64:
        """One vertex of every connected component of every solid [m], shape (h, 3)."""
        return np.concatenate([s.component_heads for s in self.solids])

    @cached_property
    def first_head(self) -> I32:
        """Where the heads of each solid begin, shape (solids + 1,)."""
        return np.concatenate([[0], np.cumsum([len(s.component_heads) for s in self.solids])]).astype(np.int32)

    @cached_property
    def volume(self) -> I32:
        """0 for an open solid, 1 for one that bounds a volume, 2 where its triangles close as well, shape (solids,)."""
        return np.array([0 if not s.closed else 2 if s.is_watertight else 1 for s in self.solids], dtype=np.int32)
