# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Weights of faces of blocks of 2 x 2 x 2 cells, which a multigrid level takes over from the one below (`level_kernels.py`)."""

import warp as wp

from ..grids.row_kernels import LOOP
from .box_kernels import Box, count_of, index_of, run_of

wp.set_module_options({"enable_backward": False})

__all__ = ["coarse_weights"]

_COARSE = (
    """
    const float* A = weight.data + a;
    const float* B = weight.data + b;
    const float* C = weight.data + c;
    const float* D = weight.data + d;
    float* O = out.data + own;
"""
    + LOOP
    + """
    for (int k = lo; k < hi; ++k)
        O[k] = ((0.5f * of_a * A[2 * k] + 0.5f * of_b * B[2 * k]) + 0.5f * of_c * C[2 * k]) + 0.5f * of_d * D[2 * k];
"""
)


@wp.func_native(_COARSE)
def coarse_row(
    own: int, a: int, b: int, c: int, d: int, of_a: float, of_b: float, of_c: float, of_d: float, lo: int, hi: int,
    weight: wp.array(dtype=float), out: wp.array(dtype=float),
):  # fmt: skip
    """Half the sums of four faces, those that are there."""


@wp.func
def coarse_piece(
    own: int, axis: int, rows: wp.vec4i, x: wp.vec2, y: wp.vec2, here: int, lo: int, hi: int, weight: wp.array(dtype=float),
    out: wp.array(dtype=float),
):  # fmt: skip
    """Weights of a row of blocks from four `rows` of cells, whose places along z are twice theirs and `here`; `x` and `y` are 1 for the first
    and the second cell of a block along these where they are there."""
    if axis == 0:
        coarse_row(
            own, rows[0] + here, rows[0] + here + 1, rows[1] + here, rows[1] + here + 1, x[0] * y[0], x[0] * y[0], x[0] * y[1],
            x[0] * y[1], lo, hi, weight, out,
        )  # fmt: skip
    if axis == 1:
        coarse_row(
            own, rows[0] + here, rows[2] + here, rows[0] + here + 1, rows[2] + here + 1, x[0] * y[0], x[1] * y[0], x[0] * y[0],
            x[1] * y[0], lo, hi, weight, out,
        )  # fmt: skip
    if axis == 2:
        coarse_row(
            own, rows[0] + here, rows[1] + here, rows[2] + here, rows[3] + here, x[0] * y[0], x[0] * y[1], x[1] * y[0], x[1] * y[1],
            lo, hi, weight, out,
        )  # fmt: skip


@wp.kernel
def coarse_weights(
    first: wp.int32, coarse: Box, span: int, fine: Box, axis: int, weight: wp.array(dtype=float), out: wp.array(dtype=float)
):
    """Weights of the lower faces of blocks along an axis."""
    at = run_of(coarse, span, first + wp.tid())
    own = index_of(coarse, at[0], at[1], 0)
    i = wp.min(2 * at[0], fine.nx)
    j = wp.min(2 * at[1], fine.ny)
    after_i = wp.min(i + 1, fine.nx)
    after_j = wp.min(j + 1, fine.ny)
    rows = wp.vec4i(
        index_of(fine, i, j, 0), index_of(fine, i, after_j, 0), index_of(fine, after_i, j, 0), index_of(fine, after_i, after_j, 0)
    )
    # The last blocks along an axis may have fewer cells; along their own axis faces there are those of the side.
    x = wp.vec2(float(axis == 0 or 2 * at[0] <= fine.nx), float(2 * at[0] < fine.nx))
    y = wp.vec2(float(axis == 1 or 2 * at[1] <= fine.ny), float(2 * at[1] < fine.ny))
    none = wp.vec2(0.0, 0.0)
    if coarse.wraps[axis] == 1 and (count_of(coarse, axis) == 1 or at[axis] == count_of(coarse, axis)) and axis < 2:
        x = none
    if axis == 2 and coarse.wraps[2] == 1 and coarse.nz == 1:
        x = none
    end = wp.min(at[3], coarse.nz)
    if at[2] < end:
        coarse_piece(own, axis, rows, x, y, 0, at[2], end, weight, out)
    if at[3] > coarse.nz:
        if axis != 2 or coarse.wraps[2] == 1:
            x = none
        coarse_piece(own, axis, rows, x, y, fine.nz - 2 * coarse.nz, coarse.nz, coarse.nz + 1, weight, out)
