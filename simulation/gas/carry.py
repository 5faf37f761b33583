"""Velocities carried by a flow, in planes of components."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ...geometry.launch import warp
from ..grids.runner import BEFORE
from . import carry_kernels as kernels
from .plane_kernels import planes

if TYPE_CHECKING:
    from ..grids.runner import Runner

__all__ = ["Carrier", "Motion", "motion"]

Motion = str | tuple[float, str, str]
"""Name of a velocity, or ratio and names of one that is extrapolated: velocity + ratio (velocity - the one before)."""

ROWS = 64
"""Own choice: rows of cells that are worth a thread of a CPU."""
NAMES = ("carrier", "source", "bend", "once", "low", "high", "better")


def motion(of: Motion) -> tuple[float, str, str]:
    """Ratio and names of a velocity."""
    return (0.0, of, of) if isinstance(of, str) else of


class Carrier:
    """MacCormack's scheme on the faces of a box.

    Args:
        run: arrays and launches.
        box: `Box` of the kernels.
        shape: its cells.
    """

    def __init__(self, run: Runner, box: Any, shape: tuple[int, int, int]) -> None:
        elements = (shape[0] + 1) * (shape[1] + 1) * (shape[2] + 1)
        self.run, self.box, self.shape = run, box, shape
        # Loops look at the element before the first one, too.
        held = (warp().zeros(3 * elements + 2 * BEFORE, dtype=warp().float32, device=run.device) for _ in NAMES)
        self._planes = {name: one[BEFORE:-BEFORE].reshape((3, elements)) for name, one in zip(NAMES, held, strict=True)}

    def __call__(self, source: tuple[float, Any, Any], carrier: tuple[float, Any, Any], cells: float, out: Any) -> None:
        """Carry a velocity by another over a time.

        Args:
            source: ratio, velocity and the one before it: what is carried is velocity + ratio (velocity - the one before).
            carrier: the flow, in the same way.
            cells: time over cell size.
            out: velocities on the device.
        """
        held = self._planes
        self._rows(planes, [*carrier, held["carrier"]])
        same = source[0] == carrier[0] and source[1] is carrier[1] and source[2] is carrier[2]
        if not same:
            self._rows(planes, [*source, held["source"]])
        way = [cells, held["carrier"], held["bend"]]
        state = [len(self.shape), *way, held["carrier" if same else "source"]]
        self._rows(kernels.bends, way)
        found = [held[name] for name in ("once", "low", "high")]
        self._rows(kernels.carry, [*state, *found])
        self._rows(kernels.correct, [*state, *found, held["better"], out])

    def _rows(self, kernel: Any, inputs: list[Any]) -> None:
        self.run.rows(self.box, self.shape, [(kernel, inputs)], grain=ROWS)
