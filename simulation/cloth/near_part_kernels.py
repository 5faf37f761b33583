# mypy: ignore-errors
"""Warp kernel that finds pairs within sheets on a GPU, with a thread for each vertex and edge; on a CPU `pick_kernels.py` does."""

import warp as wp

from .near_kernels import put, reach_between, touch_edges, touch_triangle

wp.set_module_options({"enable_backward": False})

__all__ = ["near_self_parts"]


@wp.func
def swept(low: wp.vec3d, high: wp.vec3d, x: wp.vec3d, u: wp.vec3d, span: wp.float64):
    """Bounds of a vertex over a span of time, besides others."""
    far = x + span * u
    return wp.min(low, wp.min(x, far)), wp.max(high, wp.max(x, far))


@wp.kernel
def near_self_parts(
    first: wp.int32,
    bvh: wp.uint64,
    x: wp.array(dtype=wp.vec3d),
    u: wp.array(dtype=wp.vec3d),
    span: wp.array(dtype=wp.float64),
    drift: wp.array(dtype=wp.vec3d),
    faces: wp.array(dtype=wp.vec3i),
    kin: wp.array(dtype=wp.vec3i),
    owned: wp.array(dtype=wp.int32),
    spread: wp.array(dtype=wp.float64),
    reach: wp.array(dtype=wp.float64),
    room: wp.int32,
    count: wp.array(dtype=wp.int32),
    pairs: wp.array(dtype=wp.vec4i),
    kinds: wp.array(dtype=wp.vec2i),
):
    """Pairs of a sheet with itself or another: one of a triangle's own vertices or edges with other triangles or their own edges.

    `owned` holds bits: 1, 2, 4 for vertices 0, 1, 2 and 8, 16, 32 for the edges that start there. `kin` is `faces` with one number for
    all vertices that were one before a tear; what shares one of them is no pair."""
    item = first + wp.tid()
    t = item / 6
    part = item - 6 * t
    count[item] = 0
    if (owned[t] & (1 << part)) == 0:
        return
    f = faces[t]
    n = kin[t]
    far = reach[0]
    time = span[0]
    c = part % 3
    d = (c + 1) % 3
    low, high = swept(x[f[c]], x[f[c]], x[f[c]], u[f[c]] - drift[0], time)
    if part > 2:
        low, high = swept(low, high, x[f[d]], u[f[d]] - drift[0], time)
    least = wp.vec3(low)
    most = wp.vec3(high)
    wide = float(far) + 1.0e-6 * (wp.max(wp.abs(least)) + wp.max(wp.abs(most)))
    slot = wp.int32(0)
    k = wp.int32(0)
    query = wp.bvh_query_aabb(bvh, least - wp.vec3(wide, wide, wide), most + wp.vec3(wide, wide, wide))
    while wp.bvh_query_next(query, k):
        g = faces[k]
        m = kin[k]
        others = owned[k]
        near = reach_between(u, f, g, far, time, spread[t], spread[k])
        if part < 3:
            if n[c] != m[0] and n[c] != m[1] and n[c] != m[2]:
                if touch_triangle(x, f[c], g, near):
                    slot = put(slot, room, item, wp.vec4i(f[c], g[0], g[1], g[2]), 0, others, pairs, kinds)
        elif t < k:
            e = wp.vec2i(f[c], f[d])
            for j in range(3):
                if (others & (8 << j)) != 0:
                    o = wp.vec2i(g[j], g[(j + 1) % 3])
                    p = m[j]
                    q = m[(j + 1) % 3]
                    if n[c] != p and n[c] != q and n[d] != p and n[d] != q:
                        if touch_edges(x, e, o, near):
                            slot = put(slot, room, item, wp.vec4i(e[0], e[1], o[0], o[1]), 1, 0, pairs, kinds)
    count[item] = slot
