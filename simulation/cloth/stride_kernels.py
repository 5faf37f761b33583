# mypy: ignore-errors
"""Warp kernels of steps in which nothing is met."""

import warp as wp

from .contact_kernels import at_shares, closing, stands, way_between
from .near_kernels import is_edges, shares

wp.set_module_options({"enable_backward": False})

__all__ = ["meets", "overlooked", "reckon"]

SPARE = wp.constant(wp.float64(0.5))
"""Share of the distance of contact that contacts may turn things to each other besides what they do already."""
KEPT = wp.constant(wp.float64(0.1))
"""Share of the distance of contact: farther apart than this beyond it, what two things gave each other before says nothing."""


@wp.func
def fastest(u: wp.array(dtype=wp.vec3d), q: wp.vec4i, kind: wp.vec2i):
    """Greatest speed of a vertex of one thing against one of the other [m/s]."""
    a = u[q[0]]
    fast = wp.max(wp.length(u[q[2]] - a), wp.length(u[q[3]] - a))
    b = u[q[1]]
    if is_edges(kind):
        return wp.max(fast, wp.max(wp.length(u[q[2]] - b), wp.length(u[q[3]] - b)))
    return wp.max(fast, wp.length(b - a))


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
    c = shares(x, q, kinds[p])
    fast = fastest(u, q, kinds[p])
    apart = wp.length(at_shares(x, q, c))
    wanted[p] = wp.float64(-2.0e30)
    if apart - clock[0] * fast <= radius[q[0]] + radius[q[2]]:
        met[0] = 1


@wp.kernel
def reckon(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3d),
    u: wp.array(dtype=wp.vec3d),
    radius: wp.array(dtype=wp.float64),
    pairs: wp.array(dtype=wp.vec4i),
    kinds: wp.array(dtype=wp.vec2i),
    clock: wp.array(dtype=wp.float64),
    share: wp.array(dtype=wp.vec4d),
    normal: wp.array(dtype=wp.vec4d),
    wanted: wp.array(dtype=wp.float64),
    impulse: wp.array(dtype=wp.vec3d),
    slack: wp.array(dtype=wp.float64),
):
    """Nearest points of each pair as in `meet`, with what is wanted of all that could come within their shells in this step; the others
    are left alone (-2e30)."""
    p = first + wp.tid()
    q = pairs[p]
    c = shares(x, q, kinds[p])
    fast = fastest(u, q, kinds[p])
    way = way_between(x, q, c)
    touch = radius[q[0]] + radius[q[2]]
    gap = way[3] - touch
    dt = clock[0]
    slack[p] = gap
    share[p] = c
    normal[p] = way
    if gap > KEPT * touch:
        impulse[p] = wp.vec3d()
    aim = closing(gap, dt)
    if gap > dt * fast + SPARE * touch:
        aim = wp.float64(-2.0e30)
    elif not stands(c, kinds[p]):
        aim = wp.float64(-1.0e30)
    wanted[p] = aim


@wp.kernel
def overlooked(
    first: wp.int32,
    u: wp.array(dtype=wp.vec3d),
    pairs: wp.array(dtype=wp.vec4i),
    kinds: wp.array(dtype=wp.vec2i),
    clock: wp.array(dtype=wp.float64),
    slack: wp.array(dtype=wp.float64),
    wanted: wp.array(dtype=wp.float64),
    met: wp.array(dtype=wp.int32),
):
    """Take back into account (-1e30) what was left alone and could come within its shells with the velocities as they have become."""
    p = first + wp.tid()
    if wanted[p] > wp.float64(-1.5e30):
        return
    q = pairs[p]
    if slack[p] <= clock[0] * fastest(u, q, kinds[p]):
        wanted[p] = wp.float64(-1.0e30)
        met[0] = 1
