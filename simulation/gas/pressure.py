"""Projection of a gas: a pressure that gives every cell the outflow which its expansion asks for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...geometry.launch import warp
from ..grids import columns, multigrid
from . import pressure_kernels as kernels

if TYPE_CHECKING:
    from ..grids.runner import Runner
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
    state: Any
    """Concentrations, for densities."""
    cell: float
    """Size of a cell [m]."""
    load: float
    """Density that a unit of soot adds, relative to the air's."""


SWEEPS = 2
"""Measured (`bench gas`): the residual falls by a decade per two iterations, which one sweep misses at 128^3."""


class Projection:
    """The pressure system of a box between solids as they stand.

    Args:
        run: arrays and launches.
        shape: cells along each axis.
        box: `Box` of the kernels.
        sides: of the six sides, 1 where open.
        wet: per element, above 0 where there is gas within the step.
        room: open share of each cell's volume at its end.
        opening: open share of each element's lower faces.
        regions: of the gas.
    """

    def __init__(
        self,
        run: Runner,
        shape: tuple[int, int, int],
        box: Any,
        sides: Any,
        *,
        wet: Any,
        room: Any,
        opening: Any,
        regions: Regions,
    ) -> None:
        wp = warp()
        self.run, self.box, self.sides, self.room, self.opening, self.regions = run, box, sides, room, opening, regions
        nx, ny, nz = shape
        total = nx * ny * nz
        self.elements = (nx + 1) * (ny + 1) * (nz + 1)
        self.grid = columns.Columns()
        self.grid.nx, self.grid.ny, self.grid.nz = nx, ny, nz
        self.grid.low = run.upload("gas/low", np.zeros(nx * ny + 1, np.int32), wp.int32)
        self.grid.start = run.upload("gas/start", np.arange(nx * ny + 1, dtype=np.int32) * nz, wp.int32)
        self.grid.column = run.upload("gas/column", np.repeat(np.arange(nx * ny, dtype=np.int32), nz), wp.int32)
        red, marked = run.array("gas/red", total + 1, wp.int32), run.array("gas/wet", total + 1, wp.int32)
        run(kernels.mark, total, [self.grid, box, wet, red, marked])
        self.row, cell, rows, reds = multigrid.number(run, run.array, total, red, marked)
        self.fine = multigrid.rows_of(run.array, self.grid, total, self.row, rows, reds)
        self.element = run.array("gas/element", rows, wp.int32)
        self.pressure = run.array("gas/pressure", rows, wp.float32)
        self.right = run.array("gas/right", rows, wp.float32)
        run(kernels.link, rows, [self.grid, box, cell, self.row, self.fine.link, self.element])
        self._solver: multigrid.Solver | None = None
        self.levels: list[multigrid.Level] = []
        self.asked = np.zeros(len(regions.sealed))
        """Mean outflow that sealed regions cannot give [m/s]: it changes the pressure of all their gas instead."""
        self._asked = run.upload("gas/asked", self.asked.astype(np.float32), wp.float32)
        self._region_of_row = np.zeros(0, np.int32)
        if regions.sealed.any():
            self._region_of_row = regions.number[run.read(self.element, rows)]

    @property
    def rows(self) -> int:
        """Cells with gas."""
        return self.fine.rows

    def weigh(self, state: Any, load: float, *, expands: bool) -> None:
        """Take over the densities of the gas; without expansion they never change."""
        if self._solver is not None and not expands:
            return
        fine = self.fine
        inputs = [self.box, self.sides, load, int(expands), self.element, fine.link, self.opening, state]
        self.run(kernels.weigh, fine.rows, [*inputs, fine.coefficient, fine.diagonal])
        if self._solver is None:
            self.levels = multigrid.hierarchy(self.run, fine)
            self._solver = multigrid.Solver(self.run, self.levels, sweeps=SWEEPS)
        else:
            multigrid.refresh(self.run, self.levels)

    def __call__(self, flow: Flow, *, expands: bool, bound: float, cap: int, share: float = 0.0) -> multigrid.Solution:
        """Make the flow through each cell what its expansion asks for.

        Args:
            flow: its velocity is changed.
            expands: whether densities count.
            bound: largest residual [m/s].
            cap: most iterations.
            share: a residual that is this share of the largest before, or less, is small enough too.
        """
        run, rows = self.run, self.rows
        assert self._solver is not None
        inputs = [self.box, flow.cell, self.element, flow.velocity, self.opening, flow.growth, self.room, flow.expansion]
        run(kernels.gather, rows, [*inputs, self.right])
        if len(self._region_of_row):
            self._share()
        if share > 0.0 and rows:
            bound = max(bound, share * float(np.abs(run.read(self.right, rows)).max()))
        found = self._solver(self.right, self.pressure, bound, cap)
        inputs = [self.grid, self.box, self.sides, flow.load, int(expands), self.row, self.pressure, self.opening, flow.solid]
        run(kernels.project, self.elements, [*inputs, flow.state, flow.velocity])
        return found

    def _share(self) -> None:
        """Let sealed regions' gas take up by its pressure what their right sides have in excess."""
        run, regions, rows = self.run, self.regions, self.rows
        right = run.read(self.right, rows).astype(np.float64)
        sums = np.bincount(self._region_of_row, right, len(regions.sealed))
        # Rounding alone would be an endless pressure where nothing is left at the end.
        self.asked = np.where(regions.sealed & (regions.volume > 0.0), sums / np.maximum(regions.volume, 1e-30), 0.0)
        self._asked = run.upload("gas/asked", self.asked.astype(np.float32), warp().float32)
        run(kernels.shift, rows, [self.element, regions.numbers, self.room, self._asked, self.right])

    @property
    def taken(self) -> list[Any]:
        """Region of each element, and what sealed regions take up by their pressure [m/s], on the device."""
        return [self.regions.numbers, self._asked]

    def residual(self, flow: Flow) -> float:
        """Largest difference between the flux out of a cell and what it should be [m/s]."""
        run, rows = self.run, self.rows
        many = -(-rows // run.block)
        out = run.array("gas/divergence", many, warp().float64)
        inputs = [rows, run.block, self.box, flow.cell, self.element, flow.velocity, self.opening, flow.growth, self.room]
        run(kernels.divergence, many, [*inputs, flow.expansion, self.regions.numbers, self._asked, out], grain=16)
        return float(run.read(out, many).max())
