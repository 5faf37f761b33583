"""Projection of a gas: a pressure that gives every cell the outflow which its expansion asks for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...geometry.launch import warp
from ..grids import columns, multigrid
from . import pressure_kernels as kernels

if TYPE_CHECKING:
    from ..grids.runner import Runner

__all__ = ["Flow", "Projection"]


class Flow(NamedTuple):
    """Fields of a flow: arrays on the device, one element per cell and its lower faces."""

    velocity: Any
    """Speeds of faces [m/s]; a projection changes them."""
    solid: Any
    """Velocities of what closes them [m/s]."""
    expansion: Any
    """Volume that cells make per volume and second [1/s]."""
    state: Any
    """Concentrations, for densities."""
    cell: float
    """Size of a cell [m]."""
    load: float
    """Density that a unit of soot adds, relative to the air's."""


SWEEPS = 2
"""Measured (`bench gas`): the residual falls by a decade per two iterations, which one sweep misses at 128^3."""


class Projection:
    """The pressure system of a box with fixed solids.

    Args:
        run: arrays and launches.
        shape: cells along each axis.
        box: `Box` of the kernels.
        sides: of the six sides, 1 where open.
        room: open share of each cell's volume, per element.
        opening: open share of each element's lower faces.
    """

    def __init__(self, run: Runner, shape: tuple[int, int, int], box: Any, sides: Any, room: Any, opening: Any) -> None:
        wp = warp()
        self.run, self.box, self.sides, self.room, self.opening = run, box, sides, room, opening
        nx, ny, nz = shape
        total = nx * ny * nz
        self.elements = (nx + 1) * (ny + 1) * (nz + 1)
        self.grid = columns.Columns()
        self.grid.nx, self.grid.ny, self.grid.nz = nx, ny, nz
        self.grid.low = run.upload("gas/low", np.zeros(nx * ny + 1, np.int32), wp.int32)
        self.grid.start = run.upload("gas/start", np.arange(nx * ny + 1, dtype=np.int32) * nz, wp.int32)
        self.grid.column = run.upload("gas/column", np.repeat(np.arange(nx * ny, dtype=np.int32), nz), wp.int32)
        red, wet = run.array("gas/red", total + 1, wp.int32), run.array("gas/wet", total + 1, wp.int32)
        run(kernels.mark, total, [self.grid, box, room, red, wet])
        self.row, cell, rows, reds = multigrid.number(run, run.array, total, red, wet)
        self.fine = multigrid.rows_of(run.array, self.grid, total, self.row, rows, reds)
        self.element = run.array("gas/element", rows, wp.int32)
        self.pressure = run.array("gas/pressure", rows, wp.float32)
        self.right = run.array("gas/right", rows, wp.float32)
        run(kernels.link, rows, [self.grid, box, cell, self.row, self.fine.link, self.element])
        self.sealed = not any(self.sides[n] for n in range(6))
        self._solver: multigrid.Solver | None = None
        self.levels: list[multigrid.Level] = []
        self.shared = 0.0
        """Mean outflow that a closed box cannot give [m/s]: it changes the pressure of all its gas instead."""

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

    def __call__(self, flow: Flow, *, expands: bool, bound: float, cap: int) -> multigrid.Solution:
        """Make the flow through each cell what its expansion asks for.

        Args:
            flow: its velocity is changed.
            expands: whether densities count.
            bound: largest residual [m/s].
            cap: most iterations.
        """
        run, rows = self.run, self.rows
        assert self._solver is not None
        inputs = [self.box, flow.cell, self.element, flow.velocity, self.opening, flow.solid, self.room, flow.expansion]
        run(kernels.gather, rows, [*inputs, self.right])
        self.shared = 0.0
        if self.sealed:
            self.shared = float(run.read(self.right, rows).astype(np.float64).mean())
            run(kernels.shift, rows, [self.shared, self.right])
        found = self._solver(self.right, self.pressure, bound, cap)
        inputs = [self.grid, self.box, self.sides, flow.load, int(expands), self.row, self.pressure, self.opening, flow.solid]
        run(kernels.project, self.elements, [*inputs, flow.state, flow.velocity])
        return found

    def residual(self, flow: Flow) -> float:
        """Largest difference between the flux out of a cell and what it should be [m/s]."""
        run, rows = self.run, self.rows
        many = -(-rows // run.block)
        out = run.array("gas/divergence", many, warp().float64)
        inputs = [rows, run.block, self.box, flow.cell, self.element, flow.velocity, self.opening, flow.solid, self.room]
        run(kernels.divergence, many, [*inputs, flow.expansion, self.shared, out], grain=16)
        return float(run.read(out, many).max())
