"""Broad phase: bounding boxes over time, and which bodies come close at which frames.

Time is cut into short blocks, so that a body's box over a block stays near the body. Boxes over a block are met through
a tree over them (many) or pair by pair (few), then frame by frame: near linear in bodies, frames and meetings.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F64, I32, rotation_matrix
from .forest import Trees, grow

__all__ = ["Meetings", "aabb_of", "candidate_pairs", "meetings", "turned_boxes"]

CHUNK = 4_000_000
"""Elements of a temporary array; bounds memory to tens of megabytes."""
FEW = 64
"""Own choice, measured: up to this many boxes all pairs are compared over all frames at once."""
BLOCK = 16
"""Frames met together. Own choice: two thirds of a second at 24 frames per second."""
FRONTIER = 400_000
"""Pairs of nodes expanded at once."""

Ints = NDArray[np.intp]
Boxes = tuple[F64, F64]


class Meetings(NamedTuple):
    """Pairs of bodies with first < second and the frames at which they are near, sorted by pair, then frame."""

    first: I32
    second: I32
    frame: I32


def aabb_of(vertices: F64, positions: F64, quaternions: F64) -> Boxes:
    """World bounding box of a rigid body at every frame: least and greatest corners [m], shape (frames, 3) each.

    Args:
        vertices: vertices in the body's frame [m], shape (n, 3).
        positions: shape (frames, 3) [m].
        quaternions: unit quaternions, shape (frames, 4).
    """
    positions, quaternions = np.asarray(positions, dtype=np.float64), np.asarray(quaternions, dtype=np.float64)
    frames = len(positions)
    turned = np.ones(frames, dtype=bool)
    turned[1:] = (quaternions[1:] != quaternions[:-1]).any(axis=1)
    lo, hi = np.empty((frames, 3)), np.empty((frames, 3))
    where = np.flatnonzero(turned)
    step = max(1, CHUNK // max(1, 3 * len(vertices)))
    for i in range(0, len(where), step):
        block = where[i : i + step]
        # (frames * 3, 3) @ (3, n): one matrix product for all frames of the block.
        moved = (rotation_matrix(quaternions[block]).reshape(-1, 3) @ vertices.T).reshape(len(block), 3, -1)
        lo[block], hi[block] = moved.min(axis=2), moved.max(axis=2)
    last = np.maximum.accumulate(np.where(turned, np.arange(frames), 0))
    return lo[last] + positions, hi[last] + positions


def turned_boxes(center: F64, half: F64, radius: F64, positions: F64, quaternions: F64) -> Boxes:
    """World boxes that hold the local boxes of n moving bodies, shape (n, frames, 3) each; looser than `aabb_of`.

    Args:
        center: of the local boxes [m], shape (n, 3).
        half: half their extents [m], shape (n, 3).
        radius: of spheres about `center` that hold the bodies [m], shape (n,).
        positions: shape (n, frames, 3) [m].
        quaternions: unit quaternions, shape (n, frames, 4).
    """
    turn = rotation_matrix(quaternions)
    middle = np.einsum("nfij,nj->nfi", turn, center) + positions
    reach = np.minimum(np.einsum("nfij,nj->nfi", np.abs(turn), half), radius[:, None, None])
    return middle - reach, middle + reach


def meetings(
    boxes: Callable[[slice], Boxes], frames: int, margin: float, *, still: NDArray[np.bool_] | None = None, few: bool = False
) -> Meetings:
    """Pairs whose boxes come within `margin` on every axis, with the frames at which they do.

    Args:
        boxes: least and greatest corners [m] of all n bodies over a range of frames, shape (n, k, 3) each.
        frames: number of frames.
        margin: gap [m] per axis up to which a pair counts.
        still: bodies that never move, shape (n,): pairs of two of them are left out. None keeps all pairs.
        few: whether there are so few bodies that one block takes all frames.
    """
    found: list[I32] = []
    block = max(1, frames) if few else BLOCK
    for start in range(0, frames, block):
        low, high = boxes(slice(start, min(start + block, frames)))
        pairs = _near(low.min(axis=1), high.max(axis=1) + margin, still)
        step = max(1, CHUNK // (3 * max(1, low.shape[1])))
        for s in range(0, len(pairs), step):
            some = pairs[s : s + step]
            i, j = some.T
            gap = np.maximum(low[i] - high[j], low[j] - high[i]).max(axis=2)
            row, frame = np.nonzero(gap <= margin)
            found.append(np.concatenate([some[row], frame[:, None] + start], axis=1).astype(np.int32))
    all_of = np.concatenate([np.empty((0, 3), dtype=np.int32), *found])
    first, second, frame = all_of[np.lexsort((all_of[:, 2], all_of[:, 1], all_of[:, 0]))].T
    return Meetings(first, second, frame)


def candidate_pairs(lo: F64, hi: F64, margin: float) -> list[tuple[int, int]]:
    """Pairs (i < j) whose boxes come within `margin` on every axis in at least one frame, sorted.

    Args:
        lo: least corners [m], shape (bodies, frames, 3).
        hi: greatest corners [m], same shape.
        margin: gap [m] per axis up to which a pair counts.
    """
    if len(lo) < 2:
        return []
    met = meetings(lambda part: (lo[:, part], hi[:, part]), lo.shape[1], margin, few=len(lo) <= FEW)
    pairs = np.unique(np.stack([met.first, met.second], axis=1), axis=0)
    return [(int(i), int(j)) for i, j in pairs]


def _near(low: F64, high: F64, still: NDArray[np.bool_] | None) -> Ints:
    """Pairs (i < j) with low_i <= high_j and low_j <= high_i on every axis, shape (k, 2)."""
    count = len(low)
    if count <= FEW:
        pairs = np.stack(np.triu_indices(count, 1), axis=1)
        if still is not None:
            pairs = pairs[~(still[pairs[:, 0]] & still[pairs[:, 1]])]
        return pairs[((low[pairs[:, 0]] <= high[pairs[:, 1]]) & (low[pairs[:, 1]] <= high[pairs[:, 0]])).all(axis=1)]
    # Empty boxes (a broken pose) meet nothing and would only blow up the tree.
    there = np.flatnonzero((low <= high).all(axis=1))
    calm = np.zeros(len(there), dtype=bool) if still is None else still[there]
    index = np.concatenate([there[~calm], there[calm]])
    groups = np.array([n for n in (np.count_nonzero(~calm), np.count_nonzero(calm)) if n])
    if len(groups) == 0 or calm.all():
        return np.empty((0, 2), dtype=np.intp)
    trees = grow(low[index], high[index], groups)
    roots = [[0, 0], [0, 1]] if len(groups) == 2 else [[0, 0]]
    pairs = np.concatenate([np.empty((0, 2), dtype=np.intp), *_meet(trees, low[index], high[index], np.array(roots))])
    return np.sort(index[pairs], axis=1)


def _meet(trees: Trees, low: F64, high: F64, roots: Ints) -> Iterator[Ints]:
    """Walk pairs of nodes that overlap, breadth first in bounded portions; yields pairs of boxes."""
    waiting = [roots]
    while waiting:
        pairs = waiting.pop()
        if len(pairs) > FRONTIER:
            waiting += [pairs[FRONTIER:], pairs[:FRONTIER]]
            continue
        p, q = pairs.T
        meet = ((trees.lower[p] <= trees.upper[q]) & (trees.lower[q] <= trees.upper[p])).all(axis=1)
        p, q = p[meet], q[meet]
        leaf_p, leaf_q = trees.span[p] > 0, trees.span[q] > 0
        ends = leaf_p & leaf_q
        if ends.any():
            yield _boxes_of(trees, p[ends], q[ends], low, high)
        same = (p == q) & ~leaf_p
        # Of two different nodes the one with children and the larger box is opened.
        size_p, size_q = (np.square(trees.upper[n] - trees.lower[n]).sum(axis=1) for n in (p, q))
        open_p = ~ends & ~same & (leaf_q | (~leaf_p & (size_p >= size_q)))
        open_q = ~ends & ~same & ~open_p
        child, first, second = trees.link[p[same]], trees.link[p[open_p]], trees.link[q[open_q]]
        parts = [
            *((child + a, child + b) for a, b in ((0, 0), (0, 1), (1, 1))),
            *((first + k, q[open_p]) for k in (0, 1)),
            *((p[open_q], second + k) for k in (0, 1)),
        ]
        following = np.concatenate([np.stack(part, axis=1) for part in parts])
        if len(following):
            waiting.append(following.astype(np.intp))


def _boxes_of(trees: Trees, p: Ints, q: Ints, low: F64, high: F64) -> Ints:
    """Pairs of overlapping boxes, one in leaf p and one in leaf q of each row, each pair once."""
    wide, deep = trees.span[p], trees.span[q]
    row = np.repeat(np.arange(len(p)), wide * deep)
    number = np.arange(len(row)) - np.repeat(np.cumsum(wide * deep) - wide * deep, wide * deep)
    m, n = np.divmod(number, deep[row])
    place_p, place_q = m - 1 - trees.link[p[row]], n - 1 - trees.link[q[row]]
    once = (p[row] != q[row]) | (place_p < place_q)
    i, j = trees.order[place_p[once]], trees.order[place_q[once]]
    meet = ((low[i] <= high[j]) & (low[j] <= high[i])).all(axis=1)
    return np.stack([i[meet], j[meet]], axis=1)
