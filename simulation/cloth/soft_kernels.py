# mypy: ignore-errors
"""Warp kernels of contacts with solids that deform: what each of their vertices got."""

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = ["tell_vertices"]


@wp.kernel
def tell_vertices(
    first: wp.int32,
    sheets: wp.int32,
    pairs: wp.array(dtype=wp.vec4i),
    kinds: wp.array(dtype=wp.vec2i),
    share: wp.array(dtype=wp.vec4d),
    wanted: wp.array(dtype=wp.float64),
    impulse: wp.array(dtype=wp.vec3d),
    u: wp.array(dtype=wp.vec3d),
    felt: wp.array(dtype=wp.vec3d),
    worked: wp.array(dtype=wp.float64),
):
    """Add what each contact with a solid gave to that one's vertices, in the order of the pair's, and its work on them; `sheets`
    vertices are no solid's."""
    p = first + wp.tid()
    if kinds[p][0] < 2 or wanted[p] < wp.float64(-1.0e29):
        return
    q = pairs[p]
    c = share[p]
    for k in range(4):
        if q[k] >= sheets:
            felt[4 * p + k] = felt[4 * p + k] + c[k] * impulse[p]
            worked[p] = worked[p] + c[k] * wp.dot(impulse[p], u[q[k]])
