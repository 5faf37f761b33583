# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Sparse grid of columns: only cells near liquid exist, one run of cells along z for each column (i, j).

A column's cells follow one another in memory, and so do the particles, which are sorted by cell.
"""

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = ["Columns", "cell_at", "count_cells", "dilate", "find_bases", "find_heads", "find_keys", "find_ranges", "link", "vec6i"]

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


@wp.kernel
def find_keys(
    first: wp.int32, position: wp.array(dtype=wp.vec4), nx: int, ny: int, nz: int,
    keys: wp.array(dtype=wp.int32), order: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Number of the cell of each particle in the full box; removed particles (volume 0) come last."""
    p = first + wp.tid()
    x = position[p]
    i = wp.clamp(int(wp.floor(x[0])), 0, nx - 1)
    j = wp.clamp(int(wp.floor(x[1])), 0, ny - 1)
    k = wp.clamp(int(wp.floor(x[2])), 0, nz - 1)
    order[p] = p
    keys[p] = (i * ny + j) * nz + k
    if x[3] <= 0.0:
        keys[p] = nx * ny * nz


@wp.kernel
def find_heads(
    first: wp.int32, keys: wp.array(dtype=wp.int32), count: int, nz: int, columns: int, head: wp.array(dtype=wp.int32)
):
    """First particle of each column."""
    p = first + wp.tid()
    here = keys[p] // nz
    before = int(-1)
    if p > 0:
        before = keys[p - 1] // nz
    for c in range(before + 1, here + 1):
        head[c] = p
    if p == count - 1:
        for c in range(here + 1, columns + 1):
            head[c] = count


@wp.kernel
def find_ranges(
    first: wp.int32, head: wp.array(dtype=wp.int32), keys: wp.array(dtype=wp.int32), nz: int,
    low: wp.array(dtype=wp.int32), high: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Lowest and highest cell of each column that holds particles."""
    c = first + wp.tid()
    a = head[c]
    b = head[c + 1]
    low[c] = NONE
    high[c] = -1
    if b > a:
        low[c] = keys[a] - c * nz
        high[c] = keys[b - 1] - c * nz


@wp.kernel
def dilate(
    first: wp.int32, low: wp.array(dtype=wp.int32), high: wp.array(dtype=wp.int32), nx: int, ny: int, along: int, reach: int,
    low_out: wp.array(dtype=wp.int32), high_out: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Widen by the ranges of columns up to `reach` away along x (0) or y (1)."""
    c = first + wp.tid()
    i = c // ny
    j = c - i * ny
    a = int(NONE)
    b = int(-1)
    for s in range(-reach, reach + 1):
        if along == 0:
            if i + s >= 0 and i + s < nx:
                a = wp.min(a, low[c + s * ny])
                b = wp.max(b, high[c + s * ny])
        else:
            if j + s >= 0 and j + s < ny:
                a = wp.min(a, low[c + s])
                b = wp.max(b, high[c + s])
    low_out[c] = a
    high_out[c] = b


@wp.kernel
def count_cells(
    first: wp.int32, nz: int, reach: int, columns: int, low: wp.array(dtype=wp.int32), high: wp.array(dtype=wp.int32),
    count: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Cells of each column, widened by `reach` along z."""
    c = first + wp.tid()
    count[c] = 0
    if c < columns:
        if high[c] >= 0:
            low[c] = wp.max(low[c] - reach, 0)
            count[c] = wp.min(high[c] + reach, nz - 1) - low[c] + 1
        else:
            low[c] = 0


@wp.kernel
def find_bases(first: wp.int32, grid: Columns, base: wp.array(dtype=wp.int32)):
    """start - low of each column."""
    c = first + wp.tid()
    base[c] = grid.start[c] - grid.low[c]


@wp.kernel
def link(first: wp.int32, grid: Columns, near: wp.array(dtype=vec6i)):
    """Neighbours of each cell towards -x, +x, -y, +y, -z, +z; -1 where none exists."""
    c = first + wp.tid()
    at = place_of(grid, c)
    n = vec6i()
    n[0] = cell_at(grid, at[0] - 1, at[1], at[2])
    n[1] = cell_at(grid, at[0] + 1, at[1], at[2])
    n[2] = cell_at(grid, at[0], at[1] - 1, at[2])
    n[3] = cell_at(grid, at[0], at[1] + 1, at[2])
    n[4] = cell_at(grid, at[0], at[1], at[2] - 1)
    n[5] = cell_at(grid, at[0], at[1], at[2] + 1)
    near[c] = n
