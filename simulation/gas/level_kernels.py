# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Multigrid on whole boxes of cells: a face's weight couples the cells on both sides; beyond the box, and in cells without gas, unknowns
are 0. Coarse cells are blocks of 2 x 2 x 2; their weights are half the sums over faces.

Sweeps are red-black: a cell reads only cells of the other colour. Rows are followed as in `sweep_kernels.py`; a row's loop works out all
its cells and keeps those of one colour, which is faster than to leave every other one out.
"""

import warp as wp

from ..grids.row_kernels import LOOP
from .box_kernels import Box, index_of, near, row_at, run_of

wp.set_module_options({"enable_backward": False})

__all__ = ["collect", "invert", "multiply", "relax", "residuals", "rest", "return_up", "start_red"]

_PULL = """
#define GAS_PULL(V) \\
    X[own + k] * V[low_x + k] + X[high_x + k] * V[high_x + k] + Y[own + k] * V[low_y + k] + Y[high_y + k] * V[high_y + k] \\
        + Z[own + k] * V[low_z + k] + Z[high_z + k] * V[high_z + k]
    const float* X = wx.data;
    const float* Y = wy.data;
    const float* Z = wz.data;
    const float* D = inverse.data;
"""
_RELAX = (
    _PULL
    + """
    const float* B = right.data;
    float* V = x.data;
#if defined(__clang__)
    // A processor waits to read what it has just written beside: a piece of a row is worked out apart, then written.
    float next[64];
    for (int from = lo; from < hi; from += 64) {
        const int many = hi - from < 64 ? hi - from : 64;
"""
    + LOOP
    + """
        for (int n = 0; n < many; ++n) {
            const int k = from + n;
            next[n] = (B[own + k] + GAS_PULL(V)) * D[own + k];
        }
"""
    + LOOP
    + """
        for (int n = 0; n < many; ++n) {
            const int kept = -((from + n + colour) & 1);
            int before, after;
            __builtin_memcpy(&before, V + own + from + n, 4);
            __builtin_memcpy(&after, next + n, 4);
            after = (before & kept) | (after & ~kept);
            __builtin_memcpy(V + own + from + n, &after, 4);
        }
    }
#else
    for (int k = lo; k < hi; ++k)
        if (((k + colour) & 1) == 0)
            V[own + k] = (B[own + k] + GAS_PULL(V)) * D[own + k];
#endif
"""
)
_MULTIPLY = (
    _PULL
    + """
    const float* V = x.data;
    const float* B = right.data;
    float* O = out.data;
"""
    + LOOP
    + """
    for (int k = lo; k < hi; ++k) {
        // Differences, so that a pressure which is the same everywhere is none, to the last bit: sealed gas has no other.
        const float here = V[own + k];
        const float found = X[own + k] * (here - V[low_x + k]) + X[high_x + k] * (here - V[high_x + k])
            + Y[own + k] * (here - V[low_y + k]) + Y[high_y + k] * (here - V[high_y + k])
            + Z[own + k] * (here - V[low_z + k]) + Z[high_z + k] * (here - V[high_z + k]);
        // A cell without open faces is held by the least sum of weights.
        const float alone = D[own + k] > 5.0e3f ? here / D[own + k] : 0.0f;
        O[own + k] = with_right * B[own + k] + sign * (found + alone);
    }
"""
)


@wp.func_native(_RELAX)
def relax_row(
    own: int, low_x: int, high_x: int, low_y: int, high_y: int, low_z: int, high_z: int, lo: int, hi: int, colour: int,
    wx: wp.array(dtype=float), wy: wp.array(dtype=float), wz: wp.array(dtype=float), inverse: wp.array(dtype=float),
    right: wp.array(dtype=float), x: wp.array(dtype=float),
):  # fmt: skip
    """Half a sweep over the cells of a row from `lo` to `hi` for which k + colour is even; the others are elements before those around."""


@wp.func_native(_MULTIPLY)
def multiply_row(
    own: int, low_x: int, high_x: int, low_y: int, high_y: int, low_z: int, high_z: int, lo: int, hi: int, with_right: float,
    sign: float, wx: wp.array(dtype=float), wy: wp.array(dtype=float), wz: wp.array(dtype=float), inverse: wp.array(dtype=float),
    right: wp.array(dtype=float), x: wp.array(dtype=float), out: wp.array(dtype=float),
):  # fmt: skip
    """with_right times the right side + sign times A x, over the cells of a row."""


@wp.func
def relax_cells(
    box: Box, i: int, j: int, start: int, stop: int, colour: int, wx: wp.array(dtype=float), wy: wp.array(dtype=float),
    wz: wp.array(dtype=float), inverse: wp.array(dtype=float), right: wp.array(dtype=float), x: wp.array(dtype=float),
):  # fmt: skip
    """Half a sweep over a run of cells."""
    own = index_of(box, i, j, 0)
    a = row_at(box, 0, i, j, -1)
    b = row_at(box, 0, i, j, 1)
    d = row_at(box, 1, i, j, -1)
    e = row_at(box, 1, i, j, 1)
    turn = colour + i + j
    lo = start
    hi = wp.where(stop < box.nz, stop, box.nz)
    if box.wraps[2] == 1:
        last = box.nz - 1
        if lo == 0:
            relax_row(own, a, b, d, e, own + last, own + near(box.nz, 1, 1), 0, 1, turn, wx, wy, wz, inverse, right, x)
            lo = 1
        if hi == box.nz and last > 0 and hi > lo:
            relax_row(own, a, b, d, e, own - 1, own - last, last, last + 1, turn, wx, wy, wz, inverse, right, x)
            hi = last
    relax_row(own, a, b, d, e, own - 1, own + 1, lo, hi, turn, wx, wy, wz, inverse, right, x)


@wp.func
def multiply_cells(
    box: Box, i: int, j: int, start: int, stop: int, with_right: float, sign: float, wx: wp.array(dtype=float),
    wy: wp.array(dtype=float), wz: wp.array(dtype=float), inverse: wp.array(dtype=float), right: wp.array(dtype=float),
    x: wp.array(dtype=float), out: wp.array(dtype=float),
):  # fmt: skip
    """with_right times the right side + sign times A x, over a run of cells."""
    own = index_of(box, i, j, 0)
    a = row_at(box, 0, i, j, -1)
    b = row_at(box, 0, i, j, 1)
    d = row_at(box, 1, i, j, -1)
    e = row_at(box, 1, i, j, 1)
    lo = start
    hi = wp.where(stop < box.nz, stop, box.nz)
    if box.wraps[2] == 1:
        last = box.nz - 1
        if lo == 0:
            multiply_row(
                own, a, b, d, e, own + last, own + near(box.nz, 1, 1), 0, 1, with_right, sign, wx, wy, wz, inverse, right, x, out
            )  # fmt: skip
            lo = 1
        if hi == box.nz and last > 0 and hi > lo:
            multiply_row(
                own, a, b, d, e, own - 1, own - last, last, last + 1, with_right, sign, wx, wy, wz, inverse, right, x, out
            )  # fmt: skip
            hi = last
    multiply_row(own, a, b, d, e, own - 1, own + 1, lo, hi, with_right, sign, wx, wy, wz, inverse, right, x, out)


@wp.kernel
def relax(
    first: wp.int32, box: Box, span: int, colour: int, wx: wp.array(dtype=float), wy: wp.array(dtype=float),
    wz: wp.array(dtype=float), inverse: wp.array(dtype=float), right: wp.array(dtype=float), x: wp.array(dtype=float),
):  # fmt: skip
    """Half a sweep over the cells of one colour."""
    at = run_of(box, span, first + wp.tid())
    if at[0] < box.nx and at[1] < box.ny:
        relax_cells(box, at[0], at[1], at[2], at[3], colour, wx, wy, wz, inverse, right, x)


@wp.kernel
def rest(
    first: wp.int32, box: Box, sweeps: int, wx: wp.array(dtype=float), wy: wp.array(dtype=float), wz: wp.array(dtype=float),
    inverse: wp.array(dtype=float), right: wp.array(dtype=float), x: wp.array(dtype=float),
):  # fmt: skip
    """Sweeps down and up on few cells by one thread: what as many `relax` do, without their launches."""
    for n in range(4 * sweeps + first):
        colour = int(0)
        if (n % 2 == 1) == (n < 2 * sweeps):
            colour = 1
        for i in range(box.nx):
            for j in range(box.ny):
                relax_cells(box, i, j, 0, box.nz, colour, wx, wy, wz, inverse, right, x)


@wp.kernel
def multiply(
    first: wp.int32, box: Box, span: int, wx: wp.array(dtype=float), wy: wp.array(dtype=float), wz: wp.array(dtype=float),
    inverse: wp.array(dtype=float), right: wp.array(dtype=float), x: wp.array(dtype=float), out: wp.array(dtype=float),
):  # fmt: skip
    """A x."""
    at = run_of(box, span, first + wp.tid())
    if at[0] < box.nx and at[1] < box.ny:
        multiply_cells(box, at[0], at[1], at[2], at[3], 0.0, 1.0, wx, wy, wz, inverse, right, x, out)


@wp.kernel
def residuals(
    first: wp.int32, box: Box, span: int, wx: wp.array(dtype=float), wy: wp.array(dtype=float), wz: wp.array(dtype=float),
    inverse: wp.array(dtype=float), right: wp.array(dtype=float), x: wp.array(dtype=float), out: wp.array(dtype=float),
):  # fmt: skip
    """Right side - A x."""
    at = run_of(box, span, first + wp.tid())
    if at[0] < box.nx and at[1] < box.ny:
        multiply_cells(box, at[0], at[1], at[2], at[3], 1.0, -1.0, wx, wy, wz, inverse, right, x, out)


_START = (
    """
    const float* B = right.data;
    const float* D = inverse.data;
    float* V = x.data;
"""
    + LOOP
    + """
    for (int k = lo; k < hi; ++k)
        V[own + k] = ((k + colour) & 1) == 0 ? B[own + k] * D[own + k] : 0.0f;
"""
)


@wp.func_native(_START)
def start_row(
    own: int, lo: int, hi: int, colour: int, inverse: wp.array(dtype=float), right: wp.array(dtype=float),
    x: wp.array(dtype=float),
):  # fmt: skip
    """The first half sweep from zero over the cells of a row."""


@wp.kernel
def start_red(
    first: wp.int32, box: Box, span: int, inverse: wp.array(dtype=float), right: wp.array(dtype=float), x: wp.array(dtype=float)
):
    """The first half sweep from zero, over red cells."""
    at = run_of(box, span, first + wp.tid())
    if at[0] < box.nx and at[1] < box.ny:
        start_row(
            index_of(box, at[0], at[1], 0), at[2], wp.where(at[3] < box.nz, at[3], box.nz), at[0] + at[1], inverse, right, x
        )


_COLLECT = (
    """
    const float* A = left.data + first_row;
    const float* B = left.data + second_row;
    const float* C = left.data + third_row;
    const float* D = left.data + fourth_row;
    float* R = right.data + own;
"""
    + LOOP
    + """
    for (int k = lo; k < hi; ++k)
        R[k] = (A[2 * k] + A[2 * k + 1] + B[2 * k] + B[2 * k + 1]) + (C[2 * k] + C[2 * k + 1] + D[2 * k] + D[2 * k + 1]);
"""
)


@wp.func_native(_COLLECT)
def collect_row(
    own: int, first_row: int, second_row: int, third_row: int, fourth_row: int, lo: int, hi: int, left: wp.array(dtype=float),
    right: wp.array(dtype=float),
):  # fmt: skip
    """Sums of residuals in a row of blocks, from four rows of cells."""


@wp.kernel
def collect(first: wp.int32, box: Box, span: int, fine: Box, left: wp.array(dtype=float), right: wp.array(dtype=float)):
    """Sum of the residuals in a block. Beyond the last cells, where a block has fewer, they are 0."""
    at = run_of(box, span, first + wp.tid())
    if at[0] < box.nx and at[1] < box.ny:
        i = 2 * at[0]
        j = 2 * at[1]
        collect_row(
            index_of(box, at[0], at[1], 0), index_of(fine, i, j, 0), index_of(fine, i, j + 1, 0), index_of(fine, i + 1, j, 0),
            index_of(fine, i + 1, j + 1, 0), at[2], wp.min(at[3], box.nz), left, right,
        )  # fmt: skip


_RETURN = (
    """
    const float* C = coarse.data;
    float* V = x.data;
"""
    + LOOP
    + """
    for (int k = lo; k < hi; ++k)
        V[own + k] += C[parent + (k >> 1)];
"""
)


@wp.func_native(_RETURN)
def return_row(own: int, parent: int, lo: int, hi: int, coarse: wp.array(dtype=float), x: wp.array(dtype=float)):
    """Add corrections of blocks to the cells of a row."""


@wp.kernel
def return_up(first: wp.int32, box: Box, span: int, coarse_box: Box, coarse: wp.array(dtype=float), x: wp.array(dtype=float)):
    """Add the blocks' correction; the black half sweep that follows reads only red cells."""
    at = run_of(box, span, first + wp.tid())
    if at[0] < box.nx and at[1] < box.ny:
        parent = index_of(coarse_box, at[0] // 2, at[1] // 2, 0)
        return_row(index_of(box, at[0], at[1], 0), parent, at[2], wp.where(at[3] < box.nz, at[3], box.nz), coarse, x)


_INVERT = (
    """
    const float* X = wx.data;
    const float* Y = wy.data;
    const float* Z = wz.data;
    float* D = inverse.data;
"""
    + LOOP
    + """
    for (int k = lo; k < hi; ++k) {
        const float total = X[own + k] + X[high_x + k] + Y[own + k] + Y[high_y + k] + Z[own + k] + Z[high_z + k];
        D[own + k] = 1.0f / (total > least ? total : least);
    }
"""
)


@wp.func_native(_INVERT)
def invert_row(
    own: int, high_x: int, high_y: int, high_z: int, lo: int, hi: int, least: float, wx: wp.array(dtype=float),
    wy: wp.array(dtype=float), wz: wp.array(dtype=float), inverse: wp.array(dtype=float),
):  # fmt: skip
    """1 over the sums of the weights around the cells of a row."""


@wp.kernel
def invert(
    first: wp.int32, box: Box, span: int, least: float, wx: wp.array(dtype=float), wy: wp.array(dtype=float),
    wz: wp.array(dtype=float), inverse: wp.array(dtype=float),
):  # fmt: skip
    """1 over the sums of the weights around cells."""
    at = run_of(box, span, first + wp.tid())
    if at[0] < box.nx and at[1] < box.ny:
        own = index_of(box, at[0], at[1], 0)
        x = row_at(box, 0, at[0], at[1], 1)
        y = row_at(box, 1, at[0], at[1], 1)
        hi = wp.min(at[3], box.nz)
        end = wp.where(box.wraps[2] == 1, wp.min(hi, box.nz - 1), hi)
        invert_row(own, x, y, own + 1, at[2], end, least, wx, wy, wz, inverse)
        if end < hi:
            invert_row(own, x, y, own - end, end, hi, least, wx, wy, wz, inverse)
