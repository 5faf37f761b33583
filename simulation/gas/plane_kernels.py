# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Velocities taken apart into planes of components, shape (3, elements), and put together again."""

import warp as wp

from ..grids.row_kernels import LOOP
from .box_kernels import Box, index_of, run_of

wp.set_module_options({"enable_backward": False})

__all__ = ["join_row", "planes"]

_PLANES = (
    """
    const float* N = (const float*)now.data;
    const float* B = (const float*)before.data;
    float* X = out.data;
    float* Y = X + plane;
    float* Z = Y + plane;
"""
    + LOOP
    + """
    for (int c = lo; c < hi; ++c) {
        X[c] = N[3 * c] + ratio * (N[3 * c] - B[3 * c]);
        Y[c] = N[3 * c + 1] + ratio * (N[3 * c + 1] - B[3 * c + 1]);
        Z[c] = N[3 * c + 2] + ratio * (N[3 * c + 2] - B[3 * c + 2]);
    }
"""
)
_JOIN = (
    """
    const float* X = better.data;
    const float* Y = X + plane;
    const float* Z = Y + plane;
    float* O = (float*)out.data;
"""
    + LOOP
    + """
    for (int c = lo; c < hi; ++c) {
        O[3 * c] = X[c];
        O[3 * c + 1] = Y[c];
        O[3 * c + 2] = Z[c];
    }
"""
)


@wp.func_native(_PLANES)
def plane_run(
    lo: int, hi: int, plane: int, ratio: float, now: wp.array(dtype=wp.vec3), before: wp.array(dtype=wp.vec3),
    out: wp.array2d(dtype=float),
):  # fmt: skip
    """As `planes`, over elements that follow each other."""


@wp.func_native(_JOIN)
def join_row(lo: int, hi: int, plane: int, better: wp.array2d(dtype=float), out: wp.array(dtype=wp.vec3)):
    """Velocities of elements, of their planes."""


@wp.kernel
def planes(
    first: wp.int32, box: Box, span: int, ratio: float, now: wp.array(dtype=wp.vec3), before: wp.array(dtype=wp.vec3),
    out: wp.array2d(dtype=float),
):  # fmt: skip
    """Components of now + ratio (now - before), a velocity that is extrapolated or reflected, in planes."""
    at = run_of(box, span, first + wp.tid())
    own = index_of(box, at[0], at[1], 0)
    plane_run(own + at[2], own + at[3], (box.nx + 1) * (box.ny + 1) * (box.nz + 1), ratio, now, before, out)
