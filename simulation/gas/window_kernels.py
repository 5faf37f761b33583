# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Where in a box gas is, or air is fast, row of cells by row of cells."""

import warp as wp

from .box_kernels import Box, place_of

wp.set_module_options({"enable_backward": False})

__all__ = ["extents"]


@wp.kernel
def extents(
    first: wp.int32, box: Box, least: wp.vec4, quick: float, state: wp.array(dtype=wp.vec4), velocity: wp.array(dtype=wp.vec3),
    out: wp.array2d(dtype=wp.int32),
):  # fmt: skip
    """First cell of each row along z that holds more than the least of a quantity, or whose lower faces are quicker than `quick`, and the one
    behind the last; as many cells as it has and 0 where there is none."""
    row = first + wp.tid()
    own = row * (box.nz + 1)
    at = place_of(box, own)
    low = box.nz
    high = int(0)
    if at[0] < box.nx and at[1] < box.ny:
        for k in range(box.nz):
            q = state[own + k]
            v = velocity[own + k]
            found = wp.abs(v[0]) > quick or wp.abs(v[1]) > quick or wp.abs(v[2]) > quick
            for n in range(4):
                if wp.abs(q[n]) > least[n]:
                    found = True
            if found:
                low = wp.min(low, k)
                high = k + 1
    out[row, 0] = low
    out[row, 1] = high
