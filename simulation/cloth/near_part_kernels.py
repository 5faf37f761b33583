# mypy: ignore-errors
"""Warp kernels that find pairs within sheets on a GPU: triangles near each other first, then what of them is; on a CPU `pick_kernels.py` does."""

import warp as wp

from .near_kernels import comes_to_edge, comes_to_triangle, reach_between

wp.set_module_options({"enable_backward": False})

__all__ = ["LANES", "later_ones", "pick_pairs"]

WIDE = wp.constant(1.00001)
"""Factor on what is near, for what single precision leaves out."""
LANES = 32
"""Threads that share the triangles near one."""


@wp.kernel
def later_ones(
    first: wp.int32,
    bvh: wp.uint64,
    lower: wp.array(dtype=wp.vec3),
    upper: wp.array(dtype=wp.vec3),
    reach: wp.array(dtype=wp.float64),
    room: wp.int32,
    count: wp.array(dtype=wp.int32),
    others: wp.array(dtype=wp.int32),
    book: wp.array(dtype=wp.int64),
):
    """Triangles of greater number whose bounds are within reach of those of each; the book keeps the greatest number of them beyond `room`."""
    t = first + wp.tid()
    wide = float(reach[0])
    slot = wp.int32(0)
    k = wp.int32(0)
    query = wp.bvh_query_aabb(bvh, lower[t] - wp.vec3(wide, wide, wide), upper[t] + wp.vec3(wide, wide, wide))
    while wp.bvh_query_next(query, k):
        if k > t:
            if slot < room:
                others[t * room + slot] = k
            slot = slot + 1
    count[t] = slot
    if slot > room:
        wp.atomic_max(book, 4, wp.int64(slot))


@wp.func
def apart(i: wp.int32, m: wp.vec3i):
    """True if a vertex is none of three."""
    return i != m[0] and i != m[1] and i != m[2]


@wp.func
def written(
    p: wp.int32,
    pair: wp.vec4i,
    kind: wp.vec2i,
    pairs: wp.array(dtype=wp.vec4i),
    kinds: wp.array(dtype=wp.vec2i),
    slack: wp.array(dtype=wp.float64),
):
    """Write a pair, of which it is not known how far it is apart; the next place."""
    pairs[p] = pair
    kinds[p] = kind
    slack[p] = wp.float64(0.0)
    return p + 1


@wp.kernel
def pick_pairs(
    first: wp.int32,
    lanes: wp.int32,
    room: wp.int32,
    begin: wp.int32,
    most: wp.int32,
    x: wp.array(dtype=wp.vec3d),
    u: wp.array(dtype=wp.vec3d),
    span: wp.array(dtype=wp.float64),
    faces: wp.array(dtype=wp.vec3i),
    kin: wp.array(dtype=wp.vec3i),
    owned: wp.array(dtype=wp.int32),
    spread: wp.array(dtype=wp.float64),
    reach: wp.array(dtype=wp.float64),
    count: wp.array(dtype=wp.int32),
    others: wp.array(dtype=wp.int32),
    pairs: wp.array(dtype=wp.vec4i),
    kinds: wp.array(dtype=wp.vec2i),
    slack: wp.array(dtype=wp.float64),
    book: wp.array(dtype=wp.int64),
):
    """Pairs of a sheet with itself or another, of triangles near each other, into `most` places from `begin` on in any order; the book
    counts them. `lanes` threads share what is near one triangle.

    `owned` holds bits: 1, 2, 4 for vertices 0, 1, 2 and 8, 16, 32 for the edges that start there. `kin` is `faces` with one number for
    all vertices that were one before a tear; what shares one of them is no pair."""
    i = first + wp.tid()
    t = i / lanes
    f = faces[t]
    n = kin[t]
    mine = owned[t]
    far = float(reach[0]) * WIDE
    time = float(span[0])
    # Three looks at each other triangle, one for each of its corners and edges and of this one's; a loop of three would be unrolled.
    three = wp.int32(3)
    for s in range(i - t * lanes, three * wp.min(count[t], room), lanes):
        k = others[t * room + s / three]
        c = s % three
        d = (c + 1) % three
        g = faces[k]
        m = kin[k]
        theirs = owned[k]
        near = WIDE * float(reach_between(u, f, g, reach[0], span[0], spread[t], spread[k]))
        hits = wp.int32(0)
        found = wp.int32(0)
        if (mine & (1 << c)) != 0 and apart(n[c], m):
            if comes_to_triangle(x, u, f[c], g, near, far, time):
                hits = hits | 8
                found = found + 1
        if (theirs & (1 << c)) != 0 and apart(m[c], n):
            if comes_to_triangle(x, u, g[c], f, near, far, time):
                hits = hits | 16
                found = found + 1
        if (mine & (8 << c)) != 0:
            for j in range(three):
                h = (j + 1) % three
                if (theirs & (8 << j)) != 0 and n[c] != m[j] and n[c] != m[h] and n[d] != m[j] and n[d] != m[h]:
                    if comes_to_edge(x, u, wp.vec2i(f[c], f[d]), wp.vec2i(g[j], g[h]), near, far, time):
                        hits = hits | (1 << j)
                        found = found + 1
        if found > 0:
            place = wp.int32(wp.atomic_add(book, 1, wp.int64(found)))
            if place + found <= most:
                p = begin + place
                if (hits & 8) != 0:
                    p = written(p, wp.vec4i(f[c], g[0], g[1], g[2]), wp.vec2i(0, theirs), pairs, kinds, slack)
                if (hits & 16) != 0:
                    p = written(p, wp.vec4i(g[c], f[0], f[1], f[2]), wp.vec2i(0, mine), pairs, kinds, slack)
                for j in range(three):
                    if (hits & (1 << j)) != 0:
                        p = written(p, wp.vec4i(f[c], f[d], g[j], g[(j + 1) % three]), wp.vec2i(1, 0), pairs, kinds, slack)
