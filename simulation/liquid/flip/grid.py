"""The sparse grid of one step, around the columns that hold particles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ....geometry.launch import warp
from ...grids import columns
from ...grids import multigrid_kernels as blocks
from ...grids.runner import Runner
from . import column_kernels as kernels

__all__ = ["Grid", "build"]


@dataclass
class Grid:
    """The sparse grid of one step."""

    columns: Any
    cells: int
    near: Any
    head: Any
    """First particle of each column."""
    low: Any
    """Lowest cell of each column that holds particles."""
    room: Any
    """First place of each column in the sums of its particles."""
    places: int


def build(run: Runner, head: Any, position: Any, shape: tuple[int, ...], reach: int, moving: Any, free: Any) -> Grid:
    """Columns of cells around particles that are sorted by column, wide enough for particles to move `reach` - 1 cells.

    Args:
        run: arrays and launches.
        head: first particle of each column.
        position: of the particles.
        shape: cells of the domain.
        reach: by which columns are widened [cells].
        moving: boundaries that move (`distance_kernels.Moving`).
        free: for each boundary, 1 if forces move it; columns hold the cells under wide ones too.
    """
    wp = warp()
    nx, ny, nz = shape
    many = nx * ny
    low, high = run.array("particles/low", many, wp.int32), run.array("particles/high", many, wp.int32)
    count, room = run.array("particles/count", many + 1, wp.int32), run.array("particles/room", many + 1, wp.int32)
    run(kernels.find_ranges, many, [head, position, nz, low, high, count], grain=256)
    count[many : many + 1].zero_()
    places = run.scan(count, room, many + 1)
    run.swap("low", "low/before")
    run.swap("start", "start/before")
    low2, high2 = run.array("low2", many + 1, wp.int32), run.array("high2", many + 1, wp.int32)
    wide, tall = run.array("low", many + 1, wp.int32), run.array("high", many + 1, wp.int32)
    run(kernels.dilate, many, [low, high, nx, ny, 0, reach, low2, high2])
    run(kernels.dilate, many, [low2, high2, nx, ny, 1, reach, wide, tall])
    if moving.count:
        afloat = run.array("bodies/wide", moving.count, wp.int32)
        run(kernels.find_wide, moving.count, [moving, free, reach, low, high, nx, ny, afloat])
        run(kernels.cover, many, [moving, afloat, ny, wide, tall])
    count, start = run.array("count", many + 1, wp.int32), run.array("start", many + 1, wp.int32)
    run(kernels.count_cells, many + 1, [nz, reach, many, wide, tall, count])
    total = run.scan(count, start, many + 1)
    grid = columns.Columns()
    grid.nx, grid.ny, grid.nz = nx, ny, nz
    grid.low, grid.start = wide, start
    grid.column = run.array("column", total, wp.int32)
    run(blocks.name_columns, many, [grid, grid.column])
    grid.base = run.array("base", many, wp.int32)
    run(kernels.find_bases, many, [grid, grid.base], grain=16384)
    near = run.array("near", total, columns.vec6i)
    run(kernels.link, many, [grid, near], grain=256)
    return Grid(grid, total, near, head, low, room, places)
