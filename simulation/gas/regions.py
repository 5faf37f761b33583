"""Regions of a box: gas that is connected through open faces, and the pressure of each.

Flow much slower than sound leaves the pressure of a region uniform but for what moves the gas. Gas that has a way to an open side has the
ambient pressure. In a sealed region the volume that heat, sources and solids ask for has no room, so that its pressure p rises:
dp/dt = gamma p k, with k the volume asked for per volume and time (A. Majda and J. Sethian, Combustion Science and Technology 42 (1985) 185,
doi:10.1080/00102208508960376). Heat Q per time in a volume V gives k = (gamma - 1) Q / (gamma p V), so that dp/dt = (gamma - 1) Q / V.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.launch import warp
from ...physics.combustion import HEAT_RATIO
from ...worlds.arrays import F64

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..grids.runner import Runner
    from .settings import Side
    from .solids import Solids

__all__ = ["Regions", "label"]

LEAST_LEFT = 0.01
"""Share of a region's volume that solids leave it at least in a step, so that its pressure stays finite."""


def label(
    room: NDArray[np.float32], opening: NDArray[np.float32], sides: Sequence[Side]
) -> tuple[NDArray[np.int32], NDArray[np.bool_]]:
    """Region of each element, -1 where there is no room; and of each region, whether it is sealed.

    Args:
        room: (nx + 1, ny + 1, nz + 1) open share of cells.
        opening: (nx + 1, ny + 1, nz + 1, 3) open share of lower faces.
        sides: x-, x+, y-, y+, z-, z+.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    shape = tuple(n - 1 for n in room.shape)
    inner = tuple(slice(0, n) for n in shape)
    number = np.full(room.shape, -1, np.int32)
    wet = room[inner] > 0.0
    number[inner][wet] = np.arange(int(wet.sum()), dtype=np.int32)
    pairs, vented = [], []
    for axis in range(3):
        cells, faces = number[inner], opening[..., axis]
        below = np.roll(cells, 1, axis=axis)
        joined = (faces[inner] > 0.0) & (cells >= 0) & (below >= 0)
        if sides[2 * axis] != "periodic":
            joined[(slice(None),) * axis + (0,)] = False
            for upper, place in ((0, 0), (1, shape[axis])):
                if sides[2 * axis + upper] == "open":
                    at = faces[(slice(None),) * axis + (place,)][tuple(slice(0, n) for a, n in enumerate(shape) if a != axis)]
                    beside = np.take(cells, place - upper, axis=axis)
                    vented.append(beside[(at > 0.0) & (beside >= 0)])
        pairs.append(np.stack([below[joined], cells[joined]]))
    count = int(wet.sum())
    a, b = np.concatenate(pairs, axis=1)
    many, found = connected_components(coo_array((np.ones(len(a), bool), (a, b)), shape=(count, count)), directed=False)
    sealed = np.ones(many, bool)
    sealed[found[np.concatenate([np.zeros(0, np.int32), *vented])]] = False
    number[inner][wet] = found
    return number, sealed


@dataclass
class Regions:
    """Regions of a box and their pressures over the ambient one."""

    number: NDArray[np.int32]
    """(elements,) region of each element, -1 where there is no room."""
    sealed: NDArray[np.bool_]
    """(n,)"""
    volume: F64
    """(n,) open volume at the end of the step [cells]."""
    ratio: F64
    """(n,) pressure over the ambient one."""
    numbers: Any
    """`number` on the device, 0 where there is no room."""
    ratios: Any
    """`ratio` on the device."""

    @classmethod
    def find(
        cls, run: Runner, solids: Solids, end: NDArray[np.float32], sides: Sequence[Side],
        before: tuple[Regions, NDArray[np.float32]] | None = None,
    ) -> Regions:  # fmt: skip
        """The regions between solids.

        Args:
            run: the device.
            solids: as they are in the mean over a step.
            end: (nx + 1, ny + 1, nz + 1) room of cells at its end.
            sides: of the box.
            before: regions until now, and the room that cells had: what joins mixes by volume; what is vented takes the ambient pressure.
        """
        number, sealed = label(solids.room, solids.opening, sides)
        flat, many = number.ravel(), len(sealed)
        inside = flat >= 0
        volume = np.asarray(np.bincount(flat[inside], end.ravel()[inside].astype(np.float64), many), np.float64)
        ratio = np.ones(many)
        if before is not None:
            old, held = before[0], before[1].ravel().astype(np.float64)
            both = inside & (old.number >= 0)
            weight = np.bincount(flat[both], held[both], many)
            total = np.bincount(flat[both], held[both] * old.ratio[old.number[both]], many)
            ratio = np.where(sealed & (weight > 0.0), total / np.maximum(weight, 1e-30), 1.0)
        wp = warp()
        numbers = run.upload("gas/region", np.maximum(flat, 0), wp.int32)
        return cls(flat, sealed, volume, ratio, numbers, run.upload("gas/ratio", ratio.astype(np.float32), wp.float32))

    def compress(self, run: Runner, asked: F64, seconds: float, grown: F64) -> None:
        """Pressures after a step.

        Args:
            run: the device.
            asked: (n,) volume per volume and time that sealed regions cannot give [1/s], what solids take included.
            seconds: of the step.
            grown: (n,) volume [cells] that solids have left free within it, negative where they took some.
        """
        if not self.sealed.any():
            return
        made = asked * seconds + grown / np.maximum(self.volume, 1e-30)
        start = self.volume - grown
        squeezed = start / np.maximum(self.volume, np.maximum(LEAST_LEFT * start, 1e-30))
        shut = self.sealed & (start > 0.0) & (self.volume > 0.0)
        self.set(run, np.where(shut, self.ratio * (1.0 + HEAT_RATIO * made) * squeezed**HEAT_RATIO, 1.0))

    def sums(self, amounts: NDArray[np.float32]) -> F64:
        """(n,) sums of an amount of elements over regions."""
        inside = self.number >= 0
        found = np.bincount(self.number[inside], amounts.ravel()[inside].astype(np.float64), len(self.sealed))
        return np.asarray(found, np.float64)

    def set(self, run: Runner, ratio: F64) -> None:
        """Take over pressures."""
        self.ratio = np.asarray(ratio, float)
        self.ratios = run.upload("gas/ratio", self.ratio.astype(np.float32), warp().float32)
