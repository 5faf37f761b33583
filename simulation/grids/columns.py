# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Columns of cells: of each column (i, j) of a grid one run of cells along z exists, one after the other in memory."""

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = ["NONE", "Columns", "cell_at", "place_of", "vec6", "vec6i"]

vec6 = wp.types.vector(length=6, dtype=wp.float32)
vec6i = wp.types.vector(length=6, dtype=wp.int32)
NONE = wp.constant(1 << 30)


@wp.struct
class Columns:
    """Where the cells of each column lie: cell (i, j, k) is start[i ny + j] + k - low[i ny + j]."""

    nx: wp.int32
    ny: wp.int32
    nz: wp.int32
    low: wp.array(dtype=wp.int32)
    start: wp.array(dtype=wp.int32)
    column: wp.array(dtype=wp.int32)
    base: wp.array(dtype=wp.int32)
    """start - low, so that cell (i, j, k) of an existing column is base + k."""


@wp.func
def cell_at(grid: Columns, i: wp.int32, j: wp.int32, k: wp.int32):
    """Index of a cell, -1 where it does not exist."""
    if i < 0 or j < 0 or i >= grid.nx or j >= grid.ny:
        return -1
    c = i * grid.ny + j
    s = grid.start[c]
    kk = k - grid.low[c]
    if kk < 0 or kk >= grid.start[c + 1] - s:
        return -1
    return s + kk


@wp.func
def place_of(grid: Columns, c: wp.int32):
    """Indices (i, j, k) of a cell."""
    col = grid.column[c]
    return wp.vec3i(col // grid.ny, col - (col // grid.ny) * grid.ny, c - grid.start[col] + grid.low[col])
