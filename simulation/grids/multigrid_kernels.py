# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Multigrid on rows of the cells of a fluid, and the vector work of conjugate gradients around it.

Coarse cells are blocks of 2 x 2 x 2 that hold rows; their couplings are half the sums over faces, which is what coarser cells
of the same fluid would have. Sweeps are red-black: a row reads only rows of the other colour.
"""

import warp as wp

from .columns import NONE, Columns, cell_at, place_of, vec6, vec6i

wp.set_module_options({"enable_backward": False})

__all__ = [
    "coarse_columns", "coarse_rows", "copy_direction", "inner", "mark_blocks", "multiply", "name_columns", "number_rows", "relax",
    "restrict", "return_up", "settle", "start_red", "update", "vec8i",
]  # fmt: skip

vec8i = wp.types.vector(length=8, dtype=wp.int32)


@wp.kernel
def coarse_columns(
    first: wp.int32, fine: Columns, ny: int, columns: int, low: wp.array(dtype=wp.int32), count: wp.array(dtype=wp.int32)
):
    """Range of each column of blocks."""
    c = first + wp.tid()
    a = int(NONE)
    b = int(-1)
    if c < columns:
        i = c // ny
        j = c - i * ny
        for s in range(4):
            ii = 2 * i + s // 2
            jj = 2 * j + s % 2
            if ii < fine.nx and jj < fine.ny:
                f = ii * fine.ny + jj
                cells = fine.start[f + 1] - fine.start[f]
                if cells > 0:
                    a = wp.min(a, fine.low[f] // 2)
                    b = wp.max(b, (fine.low[f] + cells - 1) // 2)
    count[c] = wp.max(b - a + 1, 0)
    low[c] = a
    if b < 0:
        low[c] = 0
        count[c] = 0


@wp.kernel
def name_columns(first: wp.int32, grid: Columns, column: wp.array(dtype=wp.int32)):
    """Column of each cell."""
    c = first + wp.tid()
    for cell in range(grid.start[c], grid.start[c + 1]):
        column[cell] = c


@wp.kernel
def mark_blocks(
    first: wp.int32, grid: Columns, fine: Columns, fine_row: wp.array(dtype=wp.int32), red: wp.array(dtype=wp.int32),
    wet: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Mark the blocks that hold rows of the finer level, and those that are red."""
    c = first + wp.tid()
    at = place_of(grid, c)
    w = int(0)
    for s in range(8):
        f = cell_at(fine, 2 * at[0] + s // 4, 2 * at[1] + (s // 2) % 2, 2 * at[2] + s % 2)
        if f >= 0:
            if fine_row[f] >= 0:
                w = 1
    wet[c] = w
    red[c] = w * (1 - ((at[0] + at[1] + at[2]) & 1))


@wp.kernel
def number_rows(
    first: wp.int32, wet: wp.array(dtype=wp.int32), red: wp.array(dtype=wp.int32), wet_before: wp.array(dtype=wp.int32),
    red_before: wp.array(dtype=wp.int32), reds: int, row: wp.array(dtype=wp.int32), cell: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Row of each marked cell, red ones (even i + j + k) first; -1 elsewhere."""
    c = first + wp.tid()
    r = int(-1)
    if wet[c] == 1:
        if red[c] == 1:
            r = red_before[c]
        else:
            r = reds + wet_before[c] - red_before[c]
        cell[r] = c
    row[c] = r


@wp.kernel
def join_blocks(
    first: wp.int32, grid: Columns, fine: Columns, cell: wp.array(dtype=wp.int32), fine_row: wp.array(dtype=wp.int32),
    children: wp.array(dtype=vec8i), parent: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Rows of the finer level in each block."""
    r = first + wp.tid()
    at = place_of(grid, cell[r])
    blocks = vec8i()
    for s in range(8):
        blocks[s] = -1
        f = cell_at(fine, 2 * at[0] + s // 4, 2 * at[1] + (s // 2) % 2, 2 * at[2] + s % 2)
        if f >= 0:
            q = fine_row[f]
            if q >= 0:
                blocks[s] = q
                parent[q] = r
    children[r] = blocks


@wp.kernel
def coarse_rows(
    first: wp.int32, children: wp.array(dtype=vec8i), parent: wp.array(dtype=wp.int32), fine_link: wp.array(dtype=vec6i),
    fine_coefficient: wp.array(dtype=vec6), fine_diagonal: wp.array(dtype=float),
    link: wp.array(dtype=vec6i), coefficient: wp.array(dtype=vec6), diagonal: wp.array(dtype=float),
):  # fmt: skip
    """Couplings of a block."""
    r = first + wp.tid()
    blocks = children[r]
    links = vec6i()
    k = vec6()
    total = float(0.0)
    for s in range(8):
        q = blocks[s]
        if q >= 0:
            total += fine_diagonal[q]
            fl = fine_link[q]
            fk = fine_coefficient[q]
            for side in range(6):
                if fk[side] > 0.0:
                    other = parent[fl[side]]
                    if other == r:
                        total -= fk[side]
                    else:
                        links[side] = other
                        k[side] = k[side] + 0.5 * fk[side]
    link[r] = links
    coefficient[r] = k
    diagonal[r] = wp.max(0.5 * total, 1.0e-4)


@wp.func
def pull(links: vec6i, k: vec6, x: wp.array(dtype=float)):
    """Sum over the neighbours of a row."""
    return (
        k[0] * x[links[0]] + k[1] * x[links[1]] + k[2] * x[links[2]] + k[3] * x[links[3]] + k[4] * x[links[4]] + k[5] * x[links[5]]
    )  # fmt: skip


@wp.kernel
def start_red(first: wp.int32, right: wp.array(dtype=float), diagonal: wp.array(dtype=float), x: wp.array(dtype=float)):
    """The first half sweep from zero, over red rows; the black half that follows reads only those."""
    r = first + wp.tid()
    x[r] = right[r] / diagonal[r]


@wp.kernel
def relax(
    first: wp.int32, offset: int, link: wp.array(dtype=vec6i), coefficient: wp.array(dtype=vec6), diagonal: wp.array(dtype=float),
    right: wp.array(dtype=float), x: wp.array(dtype=float),
):  # fmt: skip
    """Half a sweep over the rows from `offset` on, all of one colour."""
    r = offset + first + wp.tid()
    x[r] = (right[r] + pull(link[r], coefficient[r], x)) / diagonal[r]


@wp.kernel
def settle(
    first: wp.int32, sweeps: int, rows: int, reds: int, link: wp.array(dtype=vec6i), coefficient: wp.array(dtype=vec6),
    diagonal: wp.array(dtype=float), right: wp.array(dtype=float), x: wp.array(dtype=float),
):  # fmt: skip
    """Sweeps down and up on few rows by one thread: what as many `relax` do, without their launches."""
    for n in range(4 * sweeps + first):
        low = int(0)
        high = reds
        if (n % 2 == 1) == (n < 2 * sweeps):
            low = reds
            high = rows
        for r in range(low, high):
            x[r] = (right[r] + pull(link[r], coefficient[r], x)) / diagonal[r]


@wp.kernel
def restrict(
    first: wp.int32, children: wp.array(dtype=vec8i), reds: int, link: wp.array(dtype=vec6i), coefficient: wp.array(dtype=vec6),
    diagonal: wp.array(dtype=float), right: wp.array(dtype=float), x: wp.array(dtype=float), coarse_right: wp.array(dtype=float),
):  # fmt: skip
    """Sum of a block's residuals. Black ones are zero after their half sweep."""
    r = first + wp.tid()
    blocks = children[r]
    total = float(0.0)
    for s in range(8):
        q = blocks[s]
        if q >= 0 and q < reds:
            total += right[q] - diagonal[q] * x[q] + pull(link[q], coefficient[q], x)
    coarse_right[r] = total


@wp.kernel
def return_up(first: wp.int32, parent: wp.array(dtype=wp.int32), coarse: wp.array(dtype=float), x: wp.array(dtype=float)):
    """Add the blocks' correction to the red rows; the black half sweep that follows reads only those."""
    r = first + wp.tid()
    x[r] = x[r] + coarse[parent[r]]


@wp.kernel
def multiply(
    first: wp.int32, rows: int, block: int, link: wp.array(dtype=vec6i), coefficient: wp.array(dtype=vec6),
    diagonal: wp.array(dtype=float), p: wp.array(dtype=float), ap: wp.array(dtype=float), sums: wp.array(dtype=wp.float64),
):  # fmt: skip
    """A p, and p A p summed over blocks of rows."""
    b = first + wp.tid()
    total = wp.float64(0.0)
    for r in range(b * block, wp.min((b + 1) * block, rows)):
        y = diagonal[r] * p[r] - pull(link[r], coefficient[r], p)
        ap[r] = y
        total += wp.float64(y * p[r])
    sums[b] = total


@wp.kernel
def inner(
    first: wp.int32, rows: int, block: int, a: wp.array(dtype=float), b: wp.array(dtype=float), sums: wp.array(dtype=wp.float64)
):
    """a b summed over blocks of rows."""
    n = first + wp.tid()
    total = wp.float64(0.0)
    for r in range(n * block, wp.min((n + 1) * block, rows)):
        total += wp.float64(a[r] * b[r])
    sums[n] = total


@wp.kernel
def update(
    first: wp.int32, rows: int, block: int, alpha: float, p: wp.array(dtype=float), ap: wp.array(dtype=float),
    x: wp.array(dtype=float), r: wp.array(dtype=float), largest: wp.array(dtype=wp.float64),
):  # fmt: skip
    """x += alpha p, r -= alpha A p; largest residual of each block of rows."""
    n = first + wp.tid()
    top = float(0.0)
    for i in range(n * block, wp.min((n + 1) * block, rows)):
        x[i] = x[i] + alpha * p[i]
        v = r[i] - alpha * ap[i]
        r[i] = v
        top = wp.max(top, wp.abs(v))
    largest[n] = wp.float64(top)


@wp.kernel
def copy_direction(first: wp.int32, beta: float, z: wp.array(dtype=float), p: wp.array(dtype=float)):
    """The next direction, z + beta p."""
    r = first + wp.tid()
    p[r] = z[r] + beta * p[r]
