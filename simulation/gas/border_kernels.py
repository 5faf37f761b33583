# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Fluxes that a sweep carries out through the sides of a box, added up per face in float64."""

import warp as wp

from .box_kernels import Box, count_of, index_of

wp.set_module_options({"enable_backward": False})

__all__ = ["leave"]


@wp.kernel
def leave(
    first: wp.int32, box: Box, axis: int, elements: int, through: wp.array(dtype=float), moved: wp.array(dtype=float), offset: int,
    out: wp.array2d(dtype=wp.float64),
):  # fmt: skip
    """Amounts and volume out through the faces of both sides along an axis, one thread per face, added to `out` from row `offset` on."""
    n = first + wp.tid()
    second = (axis + 1) % 3
    third = (axis + 2) % 3
    across = count_of(box, third)
    layer = count_of(box, second) * across
    upper_side = n // layer
    rest = n - upper_side * layer
    face = wp.vec3i(0, 0, 0)
    face[second] = rest // across
    face[third] = rest - face[second] * across
    sign = float(-1.0)
    if upper_side == 1:
        face[axis] = count_of(box, axis)
        sign = 1.0
    f = index_of(box, face[0], face[1], face[2])
    for k in range(4):
        out[offset + n, k] = out[offset + n, k] + wp.float64(sign * moved[k * elements + f])
    out[offset + n, 4] = out[offset + n, 4] + wp.float64(sign * through[f])
