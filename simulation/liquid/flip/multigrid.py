"""Pressure solve: conjugate gradients, preconditioned by one multigrid cycle."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ....geometry.launch import warp
from . import column_kernels as columns
from . import grid_kernels as cells
from . import multigrid_kernels as kernels
from .run import Runner

__all__ = ["Level", "Solution", "hierarchy", "solve"]

FEWEST = 128
"""Rows below which no coarser level is made."""
DEPTH = 10
BOTTOM = 8
"""Sweeps down and up on the coarsest level."""


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
    """Of the finer level's rows: their row here."""


@dataclass(frozen=True)
class Solution:
    """How a solve ended: iterations, largest residual [as the right side], and whether the cap stopped it."""

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
    run(
        kernels.coarse_rows,
        rows,
        [children, parent, fine.link, fine.coefficient, fine.diagonal, level.link, level.coefficient, level.diagonal],
    )
    return level


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
        array("coefficient", rows, cells.vec6),
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
    run(cells.number_rows, total, [wet, red, wet_before, red_before, reds, row, cell])
    return row, cell, rows, reds


def _bottom(run: Runner, level: Level, system: list[Any]) -> None:
    """Sweeps on the coarsest level, red and black, then black and red."""
    if run.device == "cpu":
        run(kernels.settle, 1, [BOTTOM, level.rows, level.reds, *system])
        return
    for n in range(4 * BOTTOM):
        if (n % 2 == 1) == (n < 2 * BOTTOM):
            run(kernels.relax, level.rows - level.reds, [level.reds, *system])
        else:
            run(kernels.relax, level.reds, [0, *system])


def _cycle(run: Runner, levels: list[Level]) -> None:
    """One V-cycle from `right` to `x` of the finest level, symmetric."""
    last = len(levels) - 1
    for depth, level in enumerate(levels):
        system = [level.link, level.coefficient, level.diagonal, level.right, level.x]
        run(kernels.start_red, level.rows, [level.right, level.diagonal, level.reds, level.x], grain=65536)
        run(kernels.relax, level.rows - level.reds, [level.reds, *system])
        if depth == last:
            _bottom(run, level, system)
        else:
            coarse = levels[depth + 1]
            run(
                kernels.restrict,
                coarse.rows,
                [coarse.children, level.reds, *system, coarse.right],
                grain=1024,
            )
    for depth in range(last - 1, -1, -1):
        level, coarse = levels[depth], levels[depth + 1]
        system = [level.link, level.coefficient, level.diagonal, level.right, level.x]
        run(kernels.return_up, level.reds, [coarse.parent, coarse.x, level.x], grain=65536)
        run(kernels.relax, level.rows - level.reds, [level.reds, *system])
        run(kernels.relax, level.reds, [0, *system])


def solve(
    run: Runner, levels: list[Level], right: Any, x: Any, bound: float, cap: int, more: Callable[[Any, Any], float] | None = None
) -> Solution:
    """Solve the finest level's system from x = 0 until no residual exceeds `bound`.

    `levels[0].right` is overwritten: it holds the residual. `more(p, ap)` adds further terms of the matrix to A p and returns what
    they add to p A p.
    """
    wp = warp()
    fine = levels[0]
    rows = fine.rows
    blocks = -(-rows // run.block)
    p, ap = run.array("p", rows, wp.float32), run.array("ap", rows, wp.float32)
    sums = run.array("sums", blocks, wp.float64)
    grain = max(1, 4096 // run.block)
    x.zero_()
    p.zero_()
    residual = fine.right
    wp.copy(residual, right, count=rows)
    largest = float(np.abs(run.read(residual, rows)).max()) if rows else 0.0
    before = 0.0
    for iteration in range(cap):
        if largest <= bound:
            return Solution(iteration, largest, False)
        _cycle(run, levels)
        run(kernels.inner, blocks, [rows, run.block, residual, fine.x, sums], grain=grain)
        now = float(run.read(sums, blocks).sum())
        beta = now / before if before > 0.0 else 0.0
        before = now
        run(kernels.copy_direction, rows, [beta, fine.x, p], grain=65536)
        run(kernels.multiply, blocks, [rows, run.block, fine.link, fine.coefficient, fine.diagonal, p, ap, sums], grain=grain)
        along = float(run.read(sums, blocks).sum())
        if more is not None:
            along += more(p, ap)
        if not along > 0.0:
            break
        run(kernels.update, blocks, [rows, run.block, now / along, p, ap, x, residual, sums], grain=grain)
        largest = float(run.read(sums, blocks).max())
    return Solution(cap, largest, largest > bound)
