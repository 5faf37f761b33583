# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Weights of the pressure system of a box, its right sides, and the velocities after it.

Unknowns are p time / (ambient density x cell) [m/s]: a face's velocity changes by their difference times its lift, 1 over its relative
density. Faces count by the share of them that is open; at open sides the pressure beyond is the ambient one, half a cell away. Rows of cells
are followed as in `sweep_kernels.py`.
"""

import warp as wp

from ..grids.columns import vec6i
from ..grids.row_kernels import LOOP
from .box_kernels import Box, count_of, index_of, row_at, run_of

wp.set_module_options({"enable_backward": False})

__all__ = ["LEAST_OPEN", "densities", "outflow", "project", "weigh"]

LEAST_OPEN = wp.constant(0.05)
"""Faces open by less are closed."""

_DENSITIES = (
    """
    const float* Q = (const float*)state.data;
    float* R = density.data;
"""
    + LOOP
    + """
    for (int c = lo; c < hi; ++c) {
        const float found = 1.0f - Q[4 * c] + load * Q[4 * c + 1];
        R[c] = found > 0.05f ? found : 0.05f;
    }
"""
)


@wp.func_native(_DENSITIES)
def density_run(lo: int, hi: int, load: float, state: wp.array(dtype=wp.vec4), density: wp.array(dtype=float)):
    """Densities of elements over that of the ambient air."""


@wp.kernel
def densities(
    first: wp.int32, span: int, elements: int, load: float, state: wp.array(dtype=wp.vec4), density: wp.array(dtype=float)
):
    """Densities of elements over that of the ambient air; `load` is what a unit of soot adds."""
    lo = (first + wp.tid()) * span
    density_run(lo, wp.min(lo + span, elements), load, state, density)


_WEIGH = (
    """
    const float* O = (const float*)opening.data + axis;
    const float* R = density.data;
    const float* W = wet.data;
    float* L = lift.data;
    float* K = weight.data;
"""
    + LOOP
    + """
    for (int k = lo; k < hi; ++k) {
        const float rho = expands == 1 ? 0.5f * (R[lower + k] + R[own + k]) : 1.0f;
        const float found = W[one + k] > 0.0f && W[other + k] > 0.0f ? factor / rho : 0.0f;
        L[own + k] = found;
        K[own + k] = found * O[3 * (own + k)];
    }
"""
)


@wp.func_native(_WEIGH)
def weigh_row(
    own: int, lower: int, one: int, other: int, lo: int, hi: int, axis: int, factor: float, expands: int,
    opening: wp.array(dtype=wp.vec3), density: wp.array(dtype=float), wet: wp.array(dtype=float), lift: wp.array(dtype=float),
    weight: wp.array(dtype=float),
):  # fmt: skip
    """Lifts and weights of the lower faces of a row of cells that both need gas in them, `one` and `other`."""


@wp.func
def beyond(box: Box, sides: vec6i, axis: int, upper_side: int):
    """Count of the face of a side: 2 where it is open, since the pressure beyond is half a cell away."""
    return 2.0 * float(sides[2 * axis + upper_side])


@wp.kernel
def weigh(
    first: wp.int32, box: Box, span: int, axis: int, sides: vec6i, expands: int, opening: wp.array(dtype=wp.vec3),
    density: wp.array(dtype=float), wet: wp.array(dtype=float), lift: wp.array(dtype=float), weight: wp.array(dtype=float),
):  # fmt: skip
    """Lifts and weights of the lower faces along an axis; `sides` is 1 where a side of the box is open."""
    at = run_of(box, span, first + wp.tid())
    own = index_of(box, at[0], at[1], 0)
    n = count_of(box, axis)
    wraps = box.wraps[axis]
    if axis < 2:
        lower = row_at(box, axis, at[0], at[1], -1)
        one = own
        other = lower
        factor = float(1.0)
        if wraps == 0 and at[axis] == 0:
            other = own
            factor = beyond(box, sides, axis, 0)
        if at[axis] == n:
            one = lower
            factor = beyond(box, sides, axis, 1)
        if wraps == 1 and (n == 1 or at[axis] == n):
            factor = 0.0
        weigh_row(own, lower, one, other, at[2], at[3], axis, factor, expands, opening, density, wet, lift, weight)
    else:
        lo = wp.max(at[2], 1)
        weigh_row(own, own - 1, own, own - 1, lo, wp.min(at[3], n), axis, 1.0, expands, opening, density, wet, lift, weight)
        if at[2] == 0:
            below = own - 1
            other = own
            factor = beyond(box, sides, axis, 0)
            if wraps == 1:
                below = own + n - 1
                other = below
                factor = wp.where(n == 1, 0.0, 1.0)
            weigh_row(own, below, own, other, 0, 1, axis, factor, expands, opening, density, wet, lift, weight)
        if at[3] == n + 1:
            factor = wp.where(wraps == 1, 0.0, beyond(box, sides, axis, 1))
            weigh_row(own, own - 1, own - 1, own - 1, n, n + 1, axis, factor, expands, opening, density, wet, lift, weight)


_OUTFLOW = (
    """
    const float* V = (const float*)velocity.data;
    const float* O = (const float*)opening.data;
    const float* G = growth.data;
    const float* R = room.data;
    const float* E = expansion.data;
    const int* N = region.data;
    const float* B = by.data;
    const float* W = wet.data;
    float* F = out.data;
"""
    + LOOP
    + """
    for (int k = lo; k < hi; ++k) {
        const int c = own + k, x = high_x + k, y = high_y + k, z = high_z + k;
        const float left = O[3 * x] * V[3 * x] - O[3 * c] * V[3 * c] + O[3 * y + 1] * V[3 * y + 1] - O[3 * c + 1] * V[3 * c + 1]
            + O[3 * z + 2] * V[3 * z + 2] - O[3 * c + 2] * V[3 * c + 2] - size * (E[c] * R[c] - G[c]) + given * B[N[c]] * R[c];
        F[c] = W[c] > 0.0f ? sign * left : 0.0f;
    }
"""
)


@wp.func_native(_OUTFLOW)
def outflow_row(
    own: int, high_x: int, high_y: int, high_z: int, lo: int, hi: int, size: float, sign: float, given: float,
    velocity: wp.array(dtype=wp.vec3), opening: wp.array(dtype=wp.vec3), growth: wp.array(dtype=float),
    room: wp.array(dtype=float), expansion: wp.array(dtype=float), region: wp.array(dtype=wp.int32), by: wp.array(dtype=float),
    wet: wp.array(dtype=float), out: wp.array(dtype=float),
):  # fmt: skip
    """As `outflow`, over a row of cells."""


@wp.kernel
def outflow(
    first: wp.int32, box: Box, span: int, size: float, sign: float, given: float, velocity: wp.array(dtype=wp.vec3),
    opening: wp.array(dtype=wp.vec3), growth: wp.array(dtype=float), room: wp.array(dtype=float), expansion: wp.array(dtype=float),
    region: wp.array(dtype=wp.int32), by: wp.array(dtype=float), wet: wp.array(dtype=float), out: wp.array(dtype=float),
):  # fmt: skip
    """Flux out of a cell, less what it should be [m/s], times a sign: what its gas makes, and what its room loses to solids that move. A
    sealed region has no room for the mean of that, by volume: `given` times what `by` tells is taken out."""
    at = run_of(box, span, first + wp.tid())
    if at[0] < box.nx and at[1] < box.ny:
        own = index_of(box, at[0], at[1], 0)
        x = row_at(box, 0, at[0], at[1], 1)
        y = row_at(box, 1, at[0], at[1], 1)
        hi = wp.min(at[3], box.nz)
        end = wp.where(box.wraps[2] == 1, wp.min(hi, box.nz - 1), hi)
        outflow_row(
            own, x, y, own + 1, at[2], end, size, sign, given, velocity, opening, growth, room, expansion, region, by, wet, out
        )  # fmt: skip
        if end < hi:
            outflow_row(
                own, x, y, own - end, end, hi, size, sign, given, velocity, opening, growth, room, expansion, region, by, wet, out
            )  # fmt: skip


_PROJECT = (
    """
    const float* O = (const float*)opening.data + axis;
    const float* S = (const float*)solid.data + axis;
    const float* L = lift.data;
    const float* X = x.data;
    float* V = (float*)velocity.data + axis;
"""
    + LOOP
    + """
    for (int k = lo; k < hi; ++k) {
        const int c = own + k;
        const float next = V[3 * c] - L[c] * (X[c] - X[lower + k]);
        V[3 * c] = O[3 * c] > 0.0f ? next : S[3 * c];
    }
"""
)


@wp.func_native(_PROJECT)
def project_row(
    own: int, lower: int, lo: int, hi: int, axis: int, lift: wp.array(dtype=float), x: wp.array(dtype=float),
    opening: wp.array(dtype=wp.vec3), solid: wp.array(dtype=wp.vec3), velocity: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Speeds of the lower faces of a row of cells after the pressure."""


@wp.kernel
def project(
    first: wp.int32, box: Box, span: int, axis: int, lift: wp.array(dtype=float), x: wp.array(dtype=float),
    opening: wp.array(dtype=wp.vec3), solid: wp.array(dtype=wp.vec3), velocity: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Subtract the pressure's gradient along an axis; closed faces move as what closes them."""
    at = run_of(box, span, first + wp.tid())
    own = index_of(box, at[0], at[1], 0)
    ends = wp.vec3i(box.nx, box.ny, box.nz)
    if box.wraps[axis] == 0:
        ends[axis] = ends[axis] + 1
    if at[0] < ends[0] and at[1] < ends[1]:
        lo = at[2]
        hi = wp.min(at[3], ends[2])
        lower = own - 1
        if axis < 2:
            lower = row_at(box, axis, at[0], at[1], -1)
        elif box.wraps[2] == 1 and lo == 0:
            project_row(own, own + box.nz - 1, 0, 1, axis, lift, x, opening, solid, velocity)
            lo = 1
        project_row(own, lower, lo, hi, axis, lift, x, opening, solid, velocity)
