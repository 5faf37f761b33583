"""Sums of what leaves a box through its open sides."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ...geometry.launch import warp
from ...worlds.arrays import F64

if TYPE_CHECKING:
    from ..grids.runner import Runner

__all__ = ["Border", "side_faces"]


def side_faces(shape: tuple[int, int, int]) -> tuple[tuple[int, int, int], F64]:
    """Where the faces of each axis begin in the order of `Box.beyond`, and the middles of all of them [cells], shape (n, 3)."""
    found: list[F64] = []
    starts = []
    for axis in range(3):
        second, third = (axis + 1) % 3, (axis + 2) % 3
        starts.append(sum(map(len, found)))
        for side in (0, 1):
            middles = np.zeros((shape[second], shape[third], 3))
            middles[..., axis] = side * shape[axis]
            middles[..., second] = np.arange(shape[second])[:, None] + 0.5
            middles[..., third] = np.arange(shape[third])[None, :] + 0.5
            found.append(middles.reshape(-1, 3))
    return (starts[0], starts[1], starts[2]), np.concatenate(found)


class Border:
    """The faces of a box's sides; nothing leaves through those that are not open.

    Args:
        run: the device.
        shape: cells along each axis.
    """

    def __init__(self, run: Runner, shape: tuple[int, int, int]) -> None:
        self.faces = [2 * shape[(a + 1) % 3] * shape[(a + 2) % 3] for a in range(3)]
        self.elements = (shape[0] + 1) * (shape[1] + 1) * (shape[2] + 1)
        self._out = warp().zeros((sum(self.faces), 5), dtype=warp().float64, device=run.device)

    def counting(self, planes: int, throughs: Sequence[Any], moved: Sequence[Any]) -> tuple[Any, list[Any]]:
        """Kernel over rows of cells, with its parameters, that adds what sweeps along all axes take out: volumes through lower faces, and the
        first amounts that they take along (planes)."""
        from .border_kernels import leave

        return leave, [planes, self.elements, *throughs, *moved, self._out]

    def take(self) -> F64:
        """(5,) four amounts and the volume that have left since the last call, less what came in [cells]."""
        return np.asarray(self._taken().sum(axis=0))

    def by_side(self) -> F64:
        """(6, 5) the same through each side, x-, x+, y-, y+, z-, z+, of a box without periodic axes."""
        ends = np.cumsum([n // 2 for n in self.faces for _ in range(2)])
        return np.array([part.sum(axis=0) for part in np.split(self._taken(), ends[:-1])])

    def _taken(self) -> F64:
        found: F64 = np.array(self._out.numpy(), dtype=np.float64)
        self._out.zero_()
        return found
