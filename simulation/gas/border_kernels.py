# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Faces of the sides of a box, and fluxes that a sweep carries out through them, added up per face in float64."""

import warp as wp

from .box_kernels import Box, count_of, index_of, run_of

wp.set_module_options({"enable_backward": False})

__all__ = ["leave", "side_of"]


@wp.func
def side_of(box: Box, axis: int, n: int):
    """Face of both sides along an axis by its number in their order, and which side it is in (0 the lower, 1 the upper one)."""
    second = (axis + 1) % 3
    third = (axis + 2) % 3
    across = count_of(box, third)
    layer = count_of(box, second) * across
    upper_side = n // layer
    rest = n - upper_side * layer
    face = wp.vec3i(0, 0, 0)
    face[axis] = upper_side * count_of(box, axis)
    face[second] = rest // across
    face[third] = rest - face[second] * across
    return wp.vec4i(face[0], face[1], face[2], upper_side)


@wp.func
def add(
    box: Box, axis: int, at: wp.vec3i, planes: int, elements: int, through: wp.array(dtype=float), moved: wp.array(dtype=float),
    out: wp.array2d(dtype=wp.float64),
):  # fmt: skip
    """Add what passes a face of a side along an axis to its row of sums, if the side is open."""
    upper_side = int(at[axis] > 0)
    if box.opens[2 * axis + upper_side] == 1:
        second = (axis + 1) % 3
        third = (axis + 2) % 3
        n = box.starts[axis] + (upper_side * count_of(box, second) + at[second]) * count_of(box, third) + at[third]
        f = index_of(box, at[0], at[1], at[2])
        sign = float(2 * upper_side - 1)
        for k in range(planes):
            out[n, k] = out[n, k] + wp.float64(sign * moved[k * elements + f])
        out[n, 4] = out[n, 4] + wp.float64(sign * through[f])


@wp.kernel
def leave(
    first: wp.int32, box: Box, span: int, planes: int, elements: int, x: wp.array(dtype=float), y: wp.array(dtype=float),
    z: wp.array(dtype=float), moved_x: wp.array(dtype=float), moved_y: wp.array(dtype=float), moved_z: wp.array(dtype=float),
    out: wp.array2d(dtype=wp.float64),
):  # fmt: skip
    """Amounts and volume out through the faces of all sides, added to rows of `out`, which are in the order of `Box.beyond`."""
    at = run_of(box, span, first + wp.tid())
    i = at[0]
    j = at[1]
    end = wp.min(at[3], box.nz)
    if j < box.ny and (i == 0 or i == box.nx):
        for k in range(at[2], end):
            add(box, 0, wp.vec3i(i, j, k), planes, elements, x, moved_x, out)
    if i < box.nx and (j == 0 or j == box.ny):
        for k in range(at[2], end):
            add(box, 1, wp.vec3i(i, j, k), planes, elements, y, moved_y, out)
    if i < box.nx and j < box.ny:
        if at[2] == 0:
            add(box, 2, wp.vec3i(i, j, 0), planes, elements, z, moved_z, out)
        if at[3] == box.nz + 1:
            add(box, 2, wp.vec3i(i, j, box.nz), planes, elements, z, moved_z, out)
