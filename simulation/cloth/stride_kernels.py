# mypy: ignore-errors
"""Warp kernels of steps in which nothing is met."""

import warp as wp

from .near_kernels import on_segments, on_triangle

wp.set_module_options({"enable_backward": False})

__all__ = ["meets"]


@wp.kernel
def meets(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3d),
    u: wp.array(dtype=wp.vec3d),
    radius: wp.array(dtype=wp.float64),
    pairs: wp.array(dtype=wp.vec4i),
    kinds: wp.array(dtype=wp.vec2i),
    clock: wp.array(dtype=wp.float64),
    wanted: wp.array(dtype=wp.float64),
    met: wp.array(dtype=wp.int32),
):
    """Say where two things could come within their shells in this step, however their vertices move against each other; leave the pairs
    alone in it (-2e30)."""
    p = first + wp.tid()
    q = pairs[p]
    one = wp.float64(1.0)
    edges = kinds[p][0] % 4 == 1 or kinds[p][0] % 4 == 3
    a = u[q[0]]
    fast = wp.max(wp.length(u[q[2]] - a), wp.length(u[q[3]] - a))
    c = wp.vec4d()
    if edges:
        s = on_segments(x[q[0]], x[q[1]], x[q[2]], x[q[3]])
        c = wp.vec4d(one - s[0], s[0], s[1] - one, -s[1])
        b = u[q[1]]
        fast = wp.max(fast, wp.max(wp.length(u[q[2]] - b), wp.length(u[q[3]] - b)))
    else:
        w = on_triangle(x[q[0]], x[q[1]], x[q[2]], x[q[3]])
        c = wp.vec4d(one, -w[0], -w[1], -w[2])
        fast = wp.max(fast, wp.length(u[q[1]] - a))
    apart = wp.length(c[0] * x[q[0]] + c[1] * x[q[1]] + c[2] * x[q[2]] + c[3] * x[q[3]])
    wanted[p] = wp.float64(-2.0e30)
    if apart - clock[0] * fast <= radius[q[0]] + radius[q[2]]:
        met[0] = 1
