"""Fill a volume with the markers of a grid: one in each cell of a lattice, as many in cells that a surface cuts as their open share.

Nothing is pushed off surfaces, as `filling.py` does for particles that press on walls: it would crowd shallow water.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from .filling import Filling, PlacedSolid, blocked_share, boxes_meet

__all__ = ["fill_markers"]

JITTER = 0.25
"""Largest random offset from the middle of a cell, in cells: breaks the lattice without clumps."""


def fill_markers(own: PlacedSolid, solids: Sequence[PlacedSolid], spacing: float, seed: int) -> Filling:
    """Markers inside `own` and outside `solids`; each stands for about spacing^3, all of them for the free volume.

    Whether a cell that a surface cuts has a marker is drawn: it has where a random point of the cell is free. None lies in a solid.
    """
    low, high = own.box
    counts = _counts(high - low, spacing)
    step = (high - low) / counts
    axes = [low[k] + step[k] * (np.arange(counts[k]) + 0.5) for k in range(3)]
    near = [s for s in solids if boxes_meet(s.box, (low - spacing, high + spacing))]
    free = own.inside_lattice(axes)
    blocked = blocked_share(own, near, axes, step) if near else 0.0
    for solid in near:
        free &= ~solid.inside_lattice(axes)
    random = np.random.default_rng(seed)
    cut = _cut(free)
    inner, center = _points(axes, free & ~cut), _points(axes, cut)
    inner += 2.0 * JITTER * step * random.uniform(-0.5, 0.5, inner.shape)
    offset = step * random.uniform(-0.5, 0.5, center.shape)
    drawn, calm = center + offset, center + 2.0 * JITTER * offset
    edge = np.where(_free(calm, own, near)[:, None], calm, drawn)[_free(drawn, own, near)]
    position = np.concatenate([inner, edge])
    volume = abs(own.solid.volume) * (1.0 - blocked)
    return Filling(position, volume / max(len(position), 1), blocked)


def _free(points: F64, own: PlacedSolid, solids: Sequence[PlacedSolid]) -> NDArray[np.bool_]:
    found = own.inside(points)
    for solid in solids:
        found &= ~solid.inside(points)
    return found


def _counts(size: F64, spacing: float) -> NDArray[np.intp]:
    """Cells along each axis of a box, so that one has about spacing^3; the shortest axis, which is the coarsest, first."""
    counts, left = np.ones(3, dtype=np.intp), spacing**3
    for rank, axis in enumerate(np.argsort(size, kind="stable")):
        wanted = left ** (1.0 / (3 - rank))
        counts[axis] = max(1, round(float(size[axis]) / wanted))
        left /= float(size[axis]) / counts[axis]
    return counts


def _cut(free: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Cells beside which the middle of a cell is free and that of another is not; beyond the lattice none is."""
    from scipy.ndimage import binary_dilation, binary_erosion

    around: Any = np.ones((3, 3, 3), dtype=bool)
    return np.asarray(binary_dilation(free, around) & ~binary_erosion(free, around))


def _points(axes: Sequence[F64], cells: NDArray[np.bool_]) -> F64:
    return np.column_stack([axis[k] for axis, k in zip(axes, np.nonzero(cells), strict=True)])
