# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Sparse grid of columns: only cells near liquid exist, one run of cells along z for each column (i, j).

A column's cells follow one another in memory, and so do the particles, which are sorted by column.
"""

import warp as wp

from ...grids.columns import NONE, Columns, vec6i
from .distance_kernels import Moving

wp.set_module_options({"enable_backward": False})

RIM = wp.constant(3.0)
"""As `solids.RIM`."""

__all__ = [
    "count_cells", "cover", "deal", "dilate", "find_bases", "find_heads", "find_keys", "find_ranges", "find_wide", "link", "stack", "tally",
]  # fmt: skip


@wp.func
def column_of(x: wp.vec4, nx: int, ny: int):
    """Column of a particle; removed ones (volume 0) come after all columns."""
    c = wp.clamp(int(wp.floor(x[0])), 0, nx - 1) * ny + wp.clamp(int(wp.floor(x[1])), 0, ny - 1)
    if x[3] <= 0.0:
        c = nx * ny
    return c


@wp.kernel
def find_keys(
    first: wp.int32, position: wp.array(dtype=wp.vec4), nx: int, ny: int, keys: wp.array(dtype=wp.int32),
    order: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Column of each particle."""
    p = first + wp.tid()
    order[p] = p
    keys[p] = column_of(position[p], nx, ny)


@wp.kernel
def find_heads(first: wp.int32, keys: wp.array(dtype=wp.int32), count: int, columns: int, head: wp.array(dtype=wp.int32)):
    """First particle of each column, of sorted keys."""
    p = first + wp.tid()
    here = keys[p]
    before = int(-1)
    if p > 0:
        before = keys[p - 1]
    for c in range(before + 1, here + 1):
        head[c] = p
    if p == count - 1:
        for c in range(here + 1, columns + 1):
            head[c] = count


@wp.kernel
def tally(
    first: wp.int32, count: int, part: int, position: wp.array(dtype=wp.vec4), nx: int, ny: int, keys: wp.array(dtype=wp.int32),
    tallies: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Particles of each column in one part of all particles."""
    s = first + wp.tid()
    base = s * (nx * ny + 1)
    for c in range(base, base + nx * ny + 1):
        tallies[c] = 0
    for p in range(s * part, wp.min((s + 1) * part, count)):
        c = column_of(position[p], nx, ny)
        keys[p] = c
        tallies[base + c] = tallies[base + c] + 1


@wp.kernel
def stack(first: wp.int32, parts: int, columns: int, tallies: wp.array(dtype=wp.int32), head: wp.array(dtype=wp.int32)):
    """Where each column's particles of each part begin, by one thread."""
    total = int(first)
    for c in range(columns + 1):
        head[c] = total
        for s in range(parts):
            n = s * (columns + 1) + c
            many = tallies[n]
            tallies[n] = total
            total += many


@wp.kernel
def deal(
    first: wp.int32, count: int, part: int, columns: int, keys: wp.array(dtype=wp.int32), tallies: wp.array(dtype=wp.int32),
    order: wp.array(dtype=wp.int32),
):  # fmt: skip
    """The order of the particles by columns, those of a column as they were."""
    s = first + wp.tid()
    for p in range(s * part, wp.min((s + 1) * part, count)):
        n = s * (columns + 1) + keys[p]
        order[tallies[n]] = p
        tallies[n] = tallies[n] + 1


@wp.kernel
def find_ranges(
    first: wp.int32, head: wp.array(dtype=wp.int32), position: wp.array(dtype=wp.vec4), nz: int, low: wp.array(dtype=wp.int32),
    high: wp.array(dtype=wp.int32), room: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Lowest and highest cell of each column that holds particles; `room` for their sums (`transfer_kernels`)."""
    c = first + wp.tid()
    a = int(NONE)
    b = int(-1)
    for p in range(head[c], head[c + 1]):
        k = wp.clamp(int(wp.floor(position[p][2])), 0, nz - 1)
        a = wp.min(a, k)
        b = wp.max(b, k)
    low[c] = a
    high[c] = b
    room[c] = wp.max(b - a + 2, 0)


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


@wp.func
def edges(moving: Moving, m: int, axis: int):
    """First and last cell of a body along an axis, from its box."""
    return wp.vec2i(int(wp.floor(moving.box_low[m][axis] + RIM)), int(wp.floor(moving.box_high[m][axis] - RIM)))


@wp.kernel
def find_wide(
    first: wp.int32, moving: Moving, free: wp.array(dtype=wp.int32), reach: int, low: wp.array(dtype=wp.int32),
    high: wp.array(dtype=wp.int32), nx: int, ny: int, wide: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Freely moving bodies that particles are beside, and under whose middle none need be near: 1."""
    m = first + wp.tid()
    x = edges(moving, m, 0)
    y = edges(moving, m, 1)
    z = edges(moving, m, 2)
    found = int(0)
    if free[moving.row[m]] == 1 and wp.min(x[1] - x[0], y[1] - y[0]) >= 2 * reach:
        for i in range(wp.max(x[0] - 1, 0), wp.min(x[1] + 2, nx)):
            for j in range(wp.max(y[0] - 1, 0), wp.min(y[1] + 2, ny)):
                c = i * ny + j
                if low[c] <= z[1] + 1 and high[c] >= z[0] - 1:
                    found = 1
    wide[m] = found


@wp.kernel
def cover(
    first: wp.int32, moving: Moving, wide: wp.array(dtype=wp.int32), ny: int, low: wp.array(dtype=wp.int32),
    high: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Lengthen columns over wide bodies in the liquid, so that there are cells in the gaps under them."""
    c = first + wp.tid()
    i = c // ny
    j = c - i * ny
    for m in range(moving.count):
        if wide[m] == 1:
            x = edges(moving, m, 0)
            y = edges(moving, m, 1)
            if i >= x[0] and i <= x[1] and j >= y[0] and j <= y[1]:
                z = edges(moving, m, 2)
                low[c] = wp.min(low[c], wp.max(z[0], 0))
                high[c] = wp.max(high[c], z[1])


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


@wp.func
def cells_of(grid: Columns, i: int, j: int):
    """First and last z of a column's cells, and what makes an index of z."""
    r = wp.vec3i(0, -1, 0)
    if i >= 0 and j >= 0 and i < grid.nx and j < grid.ny:
        c = i * grid.ny + j
        r = wp.vec3i(grid.low[c], grid.low[c] + grid.start[c + 1] - grid.start[c] - 1, grid.start[c] - grid.low[c])
    return r


@wp.func
def in_column(r: wp.vec3i, k: int):
    """Index of a cell of a column, -1 where it does not exist."""
    n = int(-1)
    if k >= r[0] and k <= r[1]:
        n = r[2] + k
    return n


@wp.kernel
def link(first: wp.int32, grid: Columns, near: wp.array(dtype=vec6i)):
    """Neighbours of each cell of a column towards -x, +x, -y, +y, -z, +z; -1 where none exists."""
    column = first + wp.tid()
    i = column // grid.ny
    j = column - i * grid.ny
    own = cells_of(grid, i, j)
    if own[1] < own[0]:
        return
    a = cells_of(grid, i - 1, j)
    b = cells_of(grid, i + 1, j)
    c = cells_of(grid, i, j - 1)
    d = cells_of(grid, i, j + 1)
    for k in range(own[0], own[1] + 1):
        near[own[2] + k] = vec6i(
            in_column(a, k), in_column(b, k), in_column(c, k), in_column(d, k), in_column(own, k - 1), in_column(own, k + 1)
        )
