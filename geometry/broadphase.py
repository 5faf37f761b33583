"""Broad phase: bounding boxes over time and the pairs of bodies that ever come close."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F64, rotation_matrix

__all__ = ["aabb_of", "candidate_pairs"]

CHUNK = 4_000_000
"""Elements of a temporary array; bounds memory to tens of megabytes."""


def aabb_of(vertices: F64, positions: F64, quaternions: F64) -> tuple[F64, F64]:
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


def candidate_pairs(lo: F64, hi: F64, margin: float) -> list[tuple[int, int]]:
    """Pairs (i < j) whose boxes come within `margin` on every axis in at least one frame, sorted.

    Sort and sweep over the boxes of the whole time span, then a check frame by frame.

    Args:
        lo: least corners [m], shape (bodies, frames, 3).
        hi: greatest corners [m], same shape.
        margin: gap [m] per axis up to which a pair counts.
    """
    if len(lo) < 2:
        return []
    span_lo, span_hi = lo.min(axis=1), hi.max(axis=1) + margin
    orders = [np.argsort(span_lo[:, axis], kind="stable") for axis in range(3)]
    reach = [
        np.searchsorted(span_lo[order, axis], span_hi[order, axis], side="right") - np.arange(len(lo)) - 1
        for axis, order in enumerate(orders)
    ]
    axis = int(np.argmin([r.sum() for r in reach]))
    order, count = orders[axis], np.maximum(reach[axis], 0)
    found: list[NDArray[np.intp]] = []
    total = np.cumsum(count)
    start = 0
    while start < len(lo):
        budget = (total[start - 1] if start else 0) + CHUNK
        stop = max(start + 1, int(np.searchsorted(total, budget, side="right")))
        own = np.repeat(np.arange(start, stop), count[start:stop])
        first = np.cumsum(count[start:stop]) - count[start:stop]
        other = own + 1 + np.arange(len(own)) - np.repeat(first, count[start:stop])
        i, j = order[own], order[other]
        meet = ((span_lo[i] <= span_hi[j]) & (span_lo[j] <= span_hi[i])).all(axis=1)
        found.append(_ever(lo, hi, margin, np.stack([i[meet], j[meet]], axis=1)))
        start = stop
    pairs = np.sort(np.concatenate(found), axis=1)
    pairs = pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
    return [(int(i), int(j)) for i, j in pairs]


def _ever(lo: F64, hi: F64, margin: float, pairs: NDArray[np.intp]) -> NDArray[np.intp]:
    """Those of `pairs`, shape (k, 2), that meet in some frame."""
    if lo.shape[1] == 1:
        return pairs
    keep = np.empty(len(pairs), dtype=bool)
    step = max(1, CHUNK // (3 * lo.shape[1]))
    for s in range(0, len(pairs), step):
        i, j = pairs[s : s + step].T
        gap = np.maximum(lo[i] - hi[j], lo[j] - hi[i]).max(axis=2)
        keep[s : s + step] = gap.min(axis=1) <= margin
    return pairs[keep]
