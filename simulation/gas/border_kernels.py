# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Fluxes that a sweep carries out through the sides of a box, added up per face in float64."""

import warp as wp

from .box_kernels import Box, count_of, index_of
from .transport_kernels import flux

wp.set_module_options({"enable_backward": False})

__all__ = ["leave"]


@wp.kernel
def leave(
    first: wp.int32, box: Box, axis: int, cells: float, velocity: wp.array(dtype=wp.vec3),
    opening: wp.array(dtype=wp.vec3), amount: wp.array(dtype=wp.vec4), volume: wp.array(dtype=float), offset: int,
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
    at = wp.vec3i(0, 0, 0)
    at[second] = rest // across
    at[third] = rest - at[second] * across
    face = at
    inner = at
    if upper_side == 1:
        face[axis] = count_of(box, axis)
        inner[axis] = face[axis] - 1
    f = index_of(box, face[0], face[1], face[2])
    c = index_of(box, inner[0], inner[1], inner[2])
    through = cells * velocity[f][axis] * opening[f][axis]
    below = c
    above = int(-1)
    sign = float(1.0)
    if upper_side == 0:
        below = int(-1)
        above = c
        sign = -1.0
    moved = flux(box, axis, below, above, inner, inner, through, amount, volume, opening)
    for k in range(4):
        out[offset + n, k] = out[offset + n, k] + wp.float64(sign * moved[k])
    out[offset + n, 4] = out[offset + n, 4] + wp.float64(sign * through)
