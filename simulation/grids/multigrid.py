"""Pressure solve: conjugate gradients, preconditioned by one multigrid cycle."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from ...geometry.launch import warp
from ..passes import Pass
from . import columns
from . import multigrid_kernels as kernels
from .runner import Runner

__all__ = ["Level", "Solution", "Solver", "hierarchy", "refresh"]

FEWEST = 128
"""Rows below which no coarser level is made."""
DEPTH = 10
BOTTOM = 8
"""Sweeps down and up on the coarsest level."""
SOME = 8192
"""Rows of a sweep worth a thread: some 40 microseconds."""


@dataclass
class Level:
    """Rows of one level and how they belong to the next finer one."""

    grid: Any
    """`Columns` of the level."""
    cells: int
    row: Any
    """Row of each cell, -1 without."""
    rows: int
    reds: int
    link: Any
    coefficient: Any
    diagonal: Any
    right: Any
    x: Any
    children: Any = None
    parent: Any = None
    """Row of this level for each row of the finer one."""


@dataclass(frozen=True)
class Solution:
    """End of a solve: iterations, largest residual [as the right side], and whether the cap stopped it."""

    iterations: int
    residual: float
    capped: bool


def hierarchy(run: Runner, fine: Level) -> list[Level]:
    """Levels from the given one down to a few rows."""
    levels = [fine]
    while levels[-1].rows > FEWEST and len(levels) < DEPTH:
        coarse = _coarser(run, levels[-1], len(levels))
        if coarse.rows >= 0.8 * levels[-1].rows:
            break
        levels.append(coarse)
    return levels


def _coarser(run: Runner, fine: Level, depth: int) -> Level:
    wp = warp()
    nx, ny, nz = ((n + 1) // 2 for n in (fine.grid.nx, fine.grid.ny, fine.grid.nz))
    many = nx * ny

    def array(name: str, count: int, dtype: Any) -> Any:
        return run.array(f"{name}/{depth}", count, dtype)

    grid = columns.Columns()
    grid.nx, grid.ny, grid.nz = nx, ny, nz
    grid.low = array("low", many + 1, wp.int32)
    count = array("count", many + 1, wp.int32)
    grid.start = array("start", many + 1, wp.int32)
    run(kernels.coarse_columns, many + 1, [fine.grid, ny, many, grid.low, count])
    total = run.scan(count, grid.start, many + 1)
    grid.column = array("column", total, wp.int32)
    run(kernels.name_columns, many, [grid, grid.column])
    red, wet = array("red", total + 1, wp.int32), array("wet", total + 1, wp.int32)
    run(kernels.mark_blocks, total, [grid, fine.grid, fine.row, red, wet])
    row, cell, rows, reds = number(run, array, total, red, wet)
    children, parent = array("children", rows, kernels.vec8i), array("parent", fine.rows, wp.int32)
    run(kernels.join_blocks, rows, [grid, fine.grid, cell, fine.row, children, parent])
    level = rows_of(array, grid, total, row, rows, reds)
    level.children, level.parent = children, parent
    _couple(run, fine, level)
    return level


def _couple(run: Runner, fine: Level, level: Level) -> None:
    """Couplings of a level from those of the next finer one."""
    inputs = [level.children, level.parent, fine.link, fine.coefficient, fine.diagonal]
    run(kernels.coarse_rows, level.rows, [*inputs, level.link, level.coefficient, level.diagonal])


def refresh(run: Runner, levels: list[Level]) -> None:
    """Couplings of all coarser levels anew, after those of the finest one changed but not its cells."""
    for fine, coarse in pairwise(levels):
        _couple(run, fine, coarse)


def rows_of(array: Any, grid: Any, total: int, row: Any, rows: int, reds: int) -> Level:
    """A level with room for its rows."""
    wp = warp()
    return Level(
        grid,
        total,
        row,
        rows,
        reds,
        array("link", rows, columns.vec6i),
        array("coefficient", rows, columns.vec6),
        array("diagonal", rows, wp.float32),
        array("right", rows, wp.float32),
        array("x", rows, wp.float32),
    )


def number(run: Runner, array: Any, total: int, red: Any, wet: Any) -> tuple[Any, Any, int, int]:
    """Rows of marked cells: row of each cell, cell of each row, number of rows and of red ones."""
    wp = warp()
    wet[total : total + 1].zero_()
    red[total : total + 1].zero_()
    wet_before, red_before = array("wet_before", total + 1, wp.int32), array("red_before", total + 1, wp.int32)
    rows = run.scan(wet, wet_before, total + 1)
    reds = run.scan(red, red_before, total + 1)
    row, cell = array("row", total, wp.int32), array("cell", rows, wp.int32)
    run(kernels.number_rows, total, [wet, red, wet_before, red_before, reds, row, cell])
    return row, cell, rows, reds


class Solver:
    """Launches of one system, prepared once: a solve repeats them in each iteration.

    Args:
        run: arrays and launches.
        levels: of `hierarchy`.
        sweeps: over each level on the way down, and as many on the way up.
    """

    def __init__(self, run: Runner, levels: list[Level], *, sweeps: int = 1) -> None:
        self.run, self.levels, self.sweeps = run, levels, sweeps
        wp, fine = warp(), levels[0]
        rows = self.rows = fine.rows
        self.blocks = -(-rows // run.block)
        self.p, self.ap = run.array("p", rows, wp.float32), run.array("ap", rows, wp.float32)
        self.sums = run.array("sums", self.blocks, wp.float64)
        many = [rows, run.block]
        grain = max(1, 16384 // run.block)
        self._cycle = self._prepare_cycle()
        self._inner = run.prepare(kernels.inner, self.blocks, [*many, fine.right, fine.x, self.sums], grain=grain)
        self._direct = run.prepare(kernels.copy_direction, rows, [0.0, fine.x, self.p], grain=32768)
        system = [fine.link, fine.coefficient, fine.diagonal]
        self._multiply = run.prepare(
            kernels.multiply, self.blocks, [*many, *system, self.p, self.ap, self.sums], grain=max(1, 8192 // run.block)
        )

    def _prepare_cycle(self) -> list[Pass]:
        """One V-cycle from `right` to `x` of the finest level, symmetric."""
        run, levels = self.run, self.levels
        last = len(levels) - 1
        calls = []
        for depth, level in enumerate(levels):
            system = [level.link, level.coefficient, level.diagonal, level.right, level.x]
            calls.append(run.prepare(kernels.start_red, level.reds, [level.right, level.diagonal, level.x], grain=32768))
            black = run.prepare(kernels.relax, level.rows - level.reds, [level.reds, *system], grain=SOME)
            red = run.prepare(kernels.relax, level.reds, [0, *system], grain=SOME)
            calls += [black, *[red, black] * (self.sweeps - 1)]
            if depth == last:
                calls += self._prepare_bottom(level, system)
            else:
                coarse = levels[depth + 1]
                inputs = [coarse.children, level.reds, *system, coarse.right]
                calls.append(run.prepare(kernels.restrict, coarse.rows, inputs, grain=SOME // 4))
        for depth in range(last - 1, -1, -1):
            level, coarse = levels[depth], levels[depth + 1]
            system = [level.link, level.coefficient, level.diagonal, level.right, level.x]
            calls.append(run.prepare(kernels.return_up, level.reds, [coarse.parent, coarse.x, level.x], grain=32768))
            black = run.prepare(kernels.relax, level.rows - level.reds, [level.reds, *system], grain=SOME)
            calls += [black, run.prepare(kernels.relax, level.reds, [0, *system], grain=SOME)] * self.sweeps
        return calls

    def _prepare_bottom(self, level: Level, system: list[Any]) -> list[Pass]:
        """Sweeps on the coarsest level, red and black, then black and red."""
        run = self.run
        if run.device == "cpu":
            return [run.prepare(kernels.settle, 1, [BOTTOM, level.rows, level.reds, *system])]
        red = run.prepare(kernels.relax, level.reds, [0, *system])
        black = run.prepare(kernels.relax, level.rows - level.reds, [level.reds, *system])
        return [black if (n % 2 == 1) == (n < 2 * BOTTOM) else red for n in range(4 * BOTTOM)]

    def __call__(self, right: Any, x: Any, bound: float, cap: int, more: Callable[[Any, Any], float] | None = None) -> Solution:
        """Solve the finest level's system from x = 0 until no residual exceeds `bound`.

        `levels[0].right` is overwritten: it holds the residual. `more(p, ap)` adds further terms of the matrix to A p and returns what
        they add to p A p.
        """
        run, rows, sums = self.run, self.rows, self.sums
        residual = self.levels[0].right
        x.zero_()
        self.p.zero_()
        warp().copy(residual, right, count=rows)
        inputs = [rows, run.block, 0.0, self.p, self.ap, x, residual, sums]
        update = run.prepare(kernels.update, self.blocks, inputs, grain=max(1, 16384 // run.block))
        largest = float(np.abs(run.read(residual, rows)).max()) if rows else 0.0
        before = 0.0
        for iteration in range(cap):
            if largest <= bound:
                return Solution(iteration, largest, False)
            for call in self._cycle:
                call()
            self._inner()
            now = float(run.read(sums, self.blocks).sum())
            self._direct({1: now / before if before > 0.0 else 0.0})
            before = now
            self._multiply()
            along = float(run.read(sums, self.blocks).sum())
            if more is not None:
                along += more(self.p, self.ap)
            if not along > 0.0:
                break
            update({3: now / along})
            largest = float(run.read(sums, self.blocks).max())
        return Solution(cap, largest, largest > bound)
