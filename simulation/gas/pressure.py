"""Projection of a gas: a pressure that gives every cell the outflow which its expansion asks for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...geometry.launch import warp
from . import pressure_kernels as kernels

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..grids.multigrid import Solution
    from .levels import Level, Levels
    from .regions import Regions

__all__ = ["Flow", "Projection"]


class Flow(NamedTuple):
    """Fields of a flow: arrays on the device, one element per cell and its lower faces."""

    velocity: Any
    """Speeds of faces [m/s]; a projection changes them."""
    solid: Any
    """Velocities of what closes them [m/s]."""
    expansion: Any
    """Volume that cells make per volume and second [1/s]."""
    growth: Any
    """Room that solids leave free in cells, as shares of them per second [1/s]."""
    cell: float
    """Size of a cell [m]."""


ROWS = 256
"""Own choice: rows of cells worth a thread of a CPU."""


class Projection:
    """The pressure system of a box between solids as they stand.

    Args:
        levels: of the box.
        sides: of the six sides, 1 where open.
        wet: per element, above 0 where there is gas within the step.
        room: open share of each cell's volume at its end.
        opening: open share of each element's lower faces.
        regions: of the gas.
    """

    def __init__(self, levels: Levels, sides: Any, *, wet: Any, room: Any, opening: Any, regions: Regions) -> None:
        run = levels.run
        self.run, self.box, self.shape, self.elements = run, levels.box, levels.shape, levels.elements
        self.sides, self.regions, self._levels = sides, regions, levels
        self.wet, self.room, self.opening = wet, room, opening
        self.pressure, self.right = (run.field(f"gas/{name}", self.elements) for name in ("pressure", "right"))
        self.lifts = [run.field(f"gas/lift/{axis}", self.elements) for axis in range(3)]
        self._weighed = False
        self.asked = np.zeros(len(regions.sealed))
        """Mean outflow that sealed regions cannot give [m/s]: it changes the pressure of all their gas instead."""
        self._asked = run.upload("gas/asked", self.asked.astype(np.float32), warp().float32)

    @property
    def levels(self) -> list[Level]:
        """Levels of the solver, the finest first."""
        return self._levels.all

    def _rows(self, calls: Sequence[tuple[Any, list[Any]]]) -> None:
        """Run kernels over runs of cells along z one after the other, in slices of layers that none looks beyond for what another writes."""
        self.run.rows(self.box, self.shape, calls, grain=ROWS)

    def weigh(self, density: Any, *, expands: bool, coarser: bool = True) -> None:
        """Take over the densities of the gas; without expansion they never change. `coarser`: in coarser levels too, which need not be as new."""
        if self._weighed and not expands:
            return
        fine = self._levels.fine
        known = [self.sides, int(expands), self.opening, density, self.wet]
        self._rows([(kernels.weigh, [axis, *known, self.lifts[axis], fine.weights[axis]]) for axis in range(3)])
        self._levels.refresh(coarser=coarser or not self._weighed)
        self._weighed = True

    def __call__(self, flow: Flow, *, bound: float, cap: int, share: float = 0.0) -> Solution:
        """Make the flow through each cell what its expansion asks for.

        Args:
            flow: its velocity is changed.
            bound: largest residual [m/s].
            cap: most iterations.
            share: a residual that is this share of the largest before, or less, is small enough too.
        """
        assert self._weighed
        self._outflow(flow, -1.0, 0.0, self.right)
        if self.regions.sealed.any():
            self._share()
            self._outflow(flow, -1.0, 1.0, self.right)
        if share > 0.0:
            bound = max(bound, share * self._levels.largest(self.right))
        found = self._levels.solve(self.right, self.pressure, bound, cap)
        known = [self.pressure, self.opening, flow.solid, flow.velocity]
        self._rows([(kernels.project, [axis, self.lifts[axis], *known]) for axis in range(3)])
        return found

    def _outflow(self, flow: Flow, sign: float, given: float, out: Any) -> None:
        """Difference between the flux out of each cell and what it should be, times a sign."""
        fields = [flow.velocity, self.opening, flow.growth, self.room, flow.expansion]
        self._rows([(kernels.outflow, [flow.cell, sign, given, *fields, *self.taken, self.wet, out])])

    def _share(self) -> None:
        """Let sealed regions' gas take up by its pressure what their right sides have in excess."""
        regions = self.regions
        sums = regions.sums(self.run.read(self.right, self.elements))
        # Rounding alone would be an endless pressure where nothing is left at the end.
        self.asked = np.where(regions.sealed & (regions.volume > 0.0), sums / np.maximum(regions.volume, 1e-30), 0.0)
        self._asked = self.run.upload("gas/asked", self.asked.astype(np.float32), warp().float32)

    @property
    def taken(self) -> list[Any]:
        """Region of each element, and what sealed regions take up by their pressure [m/s], on the device."""
        return [self.regions.numbers, self._asked]

    def residual(self, flow: Flow) -> float:
        """Largest difference between the flux out of a cell and what it should be [m/s]."""
        self._outflow(flow, 1.0, 1.0, self.right)
        return self._levels.largest(self.right)
