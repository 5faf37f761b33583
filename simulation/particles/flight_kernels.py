# mypy: ignore-errors
"""Warp kernels of particles that fly alone: what a straight way meets first."""

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = ["meet"]


@wp.kernel
def meet(
    first: wp.int32,
    number: wp.int32,
    mesh: wp.array(dtype=wp.uint64),
    here: wp.array(dtype=wp.vec3d),
    turned: wp.array(dtype=wp.quatd),
    there: wp.array(dtype=wp.vec3d),
    turning: wp.array(dtype=wp.quatd),
    start: wp.array(dtype=wp.vec3d),
    end: wp.array(dtype=wp.vec3d),
    radius: wp.array(dtype=wp.float64),
    share: wp.array(dtype=wp.float32),
    body: wp.array(dtype=wp.int32),
    normal: wp.array(dtype=wp.vec3d),
):
    """First surface on the way of particle i as each body sees it: share of the way, body (-1: none), normal in its frame."""
    i = first + wp.tid()
    best = wp.float32(2.0)
    which = wp.int32(-1)
    n = wp.vec3d()
    for b in range(number):
        p = wp.quat_rotate_inv(turned[b], start[i] - here[b])
        q = wp.quat_rotate_inv(turning[b], end[i] - there[b])
        way = q - p
        length = wp.length(way)
        if length > wp.float64(0.0):
            d = way / length
            lo = wp.vec3(wp.float32(p[0]), wp.float32(p[1]), wp.float32(p[2]))
            ray = wp.vec3(wp.float32(d[0]), wp.float32(d[1]), wp.float32(d[2]))
            reach = length + radius[i]
            hit = wp.mesh_query_ray(mesh[b], lo, ray, wp.float32(reach))
            if hit.result and wp.dot(hit.normal, ray) < 0.0:
                s = wp.float32((wp.float64(hit.t) - radius[i]) / length)
                if s < best:
                    best = wp.max(s, 0.0)
                    which = b
                    n = wp.normalize(wp.vec3d(wp.float64(hit.normal[0]), wp.float64(hit.normal[1]), wp.float64(hit.normal[2])))
    share[i] = best
    body[i] = which
    normal[i] = n
