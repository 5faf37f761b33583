# mypy: ignore-errors
"""Warp kernels that find what comes near: vertices and triangles, edges and edges, of sheets and of solids."""

from typing import Any

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = [
    "boxes",
    "comes_to_edge",
    "comes_to_triangle",
    "is_edges",
    "mark",
    "near_ones",
    "near_solids",
    "put",
    "reach_between",
    "shares",
    "touch_edges",
    "touch_triangle",
]


@wp.func
def on_triangle(p: Any, a: Any, b: Any, c: Any):
    """Barycentric place of the point of a triangle that is nearest to p (Ericson 2005, Real-Time Collision Detection, 5.1.5)."""
    zero = p.dtype(0.0)
    one = p.dtype(1.0)
    ab = b - a
    ac = c - a
    ap = p - a
    d1 = wp.dot(ab, ap)
    d2 = wp.dot(ac, ap)
    if d1 <= zero and d2 <= zero:
        return wp.vector(one, zero, zero)
    bp = p - b
    d3 = wp.dot(ab, bp)
    d4 = wp.dot(ac, bp)
    if d3 >= zero and d4 <= d3:
        return wp.vector(zero, one, zero)
    vc = d1 * d4 - d3 * d2
    if vc <= zero and d1 >= zero and d3 <= zero:
        s = d1 / (d1 - d3)
        return wp.vector(one - s, s, zero)
    cp = p - c
    d5 = wp.dot(ab, cp)
    d6 = wp.dot(ac, cp)
    if d6 >= zero and d5 <= d6:
        return wp.vector(zero, zero, one)
    vb = d5 * d2 - d1 * d6
    if vb <= zero and d2 >= zero and d6 <= zero:
        s = d2 / (d2 - d6)
        return wp.vector(one - s, zero, s)
    va = d3 * d6 - d5 * d4
    if va <= zero and d4 - d3 >= zero and d5 - d6 >= zero:
        s = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        return wp.vector(zero, one - s, s)
    down = va + vb + vc
    return wp.vector(va / down, vb / down, vc / down)


@wp.func
def on_segments(p0: Any, p1: Any, q0: Any, q1: Any):
    """Places along two segments at which they are nearest (Ericson 2005, 5.1.9)."""
    zero = p0.dtype(0.0)
    one = p0.dtype(1.0)
    d = p1 - p0
    e = q1 - q0
    r = p0 - q0
    a = wp.dot(d, d)
    b = wp.dot(d, e)
    c = wp.dot(d, r)
    f = wp.dot(e, r)
    g = wp.dot(e, e)
    down = a * g - b * b
    s = zero
    if down > p0.dtype(1.0e-12) * a * g:
        s = wp.clamp((b * f - c * g) / down, zero, one)
    t = (b * s + f) / g
    if t < zero:
        t = zero
        s = wp.clamp(-c / a, zero, one)
    elif t > one:
        t = one
        s = wp.clamp((b - c) / a, zero, one)
    return wp.vector(s, t)


@wp.func
def is_edges(kind: wp.vec2i):
    """True if a pair is of two edges, not of a vertex and a triangle."""
    return kind[0] % 4 == 1 or kind[0] % 4 == 3


@wp.func
def shares(x: wp.array(dtype=wp.vec3d), q: wp.vec4i, kind: wp.vec2i):
    """Signed shares of a pair's vertices in its nearest points."""
    one = wp.float64(1.0)
    if is_edges(kind):
        s = on_segments(x[q[0]], x[q[1]], x[q[2]], x[q[3]])
        return wp.vec4d(one - s[0], s[0], s[1] - one, -s[1])
    w = on_triangle(x[q[0]], x[q[1]], x[q[2]], x[q[3]])
    return wp.vec4d(one, -w[0], -w[1], -w[2])


@wp.kernel
def boxes(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3d),
    u: wp.array(dtype=wp.vec3d),
    span: wp.array(dtype=wp.float64),
    drift: wp.array(dtype=wp.vec3d),
    faces: wp.array(dtype=wp.vec3i),
    lower: wp.array(dtype=wp.vec3),
    upper: wp.array(dtype=wp.vec3),
    spread: wp.array(dtype=wp.float64),
):
    """Bounds of triangles over a span of time, seen from what goes with `drift`, widened by more than float32 leaves out; how far their
    vertices go from the first one in that time."""
    t = first + wp.tid()
    f = faces[t]
    a = wp.vec3(x[f[0]])
    b = wp.vec3(x[f[1]])
    c = wp.vec3(x[f[2]])
    low = wp.min(wp.min(a, b), c)
    high = wp.max(wp.max(a, b), c)
    if span[0] > wp.float64(0.0):
        a = wp.vec3(x[f[0]] + span[0] * (u[f[0]] - drift[0]))
        b = wp.vec3(x[f[1]] + span[0] * (u[f[1]] - drift[0]))
        c = wp.vec3(x[f[2]] + span[0] * (u[f[2]] - drift[0]))
        low = wp.min(low, wp.min(wp.min(a, b), c))
        high = wp.max(high, wp.max(wp.max(a, b), c))
    reach = 1.0e-6 * (wp.max(wp.abs(low)) + wp.max(wp.abs(high)))
    lower[t] = low - wp.vec3(reach, reach, reach)
    upper[t] = high + wp.vec3(reach, reach, reach)
    fast = wp.max(wp.length(u[f[1]] - u[f[0]]), wp.length(u[f[2]] - u[f[0]]))
    spread[t] = span[0] * fast


@wp.func
def put(
    slot: wp.int32,
    room: wp.int32,
    t: wp.int32,
    pair: wp.vec4i,
    kind: wp.int32,
    owned: wp.int32,
    pairs: wp.array(dtype=wp.vec4i),
    kinds: wp.array(dtype=wp.vec2i),
):
    """Keep a pair if there is room, with its kind and what its triangle stands for; the next slot."""
    if slot < room:
        pairs[t * room + slot] = pair
        kinds[t * room + slot] = wp.vec2i(kind, owned)
    return slot + 1


@wp.func
def reach_between(
    u: wp.array(dtype=wp.vec3d),
    f: wp.vec3i,
    g: wp.vec3i,
    least: wp.float64,
    span: wp.float64,
    own: wp.float64,
    others: wp.float64,
):
    """Distance within which two triangles must be to come within `least` in a span of time: the motion of their first vertices against
    each other, and how far their others go from these."""
    if span > wp.float64(0.0):
        return least + span * wp.length(u[f[0]] - u[g[0]]) + own + others
    return least


@wp.func
def touch_triangle(x: wp.array(dtype=wp.vec3d), i: wp.int32, f: wp.vec3i, reach: wp.float64):
    """True if vertex i is within reach of a triangle."""
    p = x[i]
    a = x[f[0]]
    b = x[f[1]]
    c = x[f[2]]
    low = wp.min(a, wp.min(b, c))
    high = wp.max(a, wp.max(b, c))
    for k in range(3):
        if p[k] < low[k] - reach or p[k] > high[k] + reach:
            return False
    w = on_triangle(p, a, b, c)
    r = p - w[0] * a - w[1] * b - w[2] * c
    return wp.dot(r, r) < reach * reach


@wp.func
def touch_edges(x: wp.array(dtype=wp.vec3d), e: wp.vec2i, g: wp.vec2i, reach: wp.float64):
    """True if two edges are within reach of each other."""
    a = x[e[0]]
    b = x[e[1]]
    c = x[g[0]]
    d = x[g[1]]
    for k in range(3):
        if wp.max(a[k], b[k]) + reach < wp.min(c[k], d[k]) or wp.max(c[k], d[k]) + reach < wp.min(a[k], b[k]):
            return False
    s = on_segments(a, b, c, d)
    r = a + s[0] * (b - a) - c - s[1] * (d - c)
    return wp.dot(r, r) < reach * reach


@wp.func
def comes_within(r: wp.vec3, closing: float, far: float, span: float):
    """True if two convex things at `r` from each other come within `far` in a span of time, in which they close by `closing` along it:
    what their nearest points are apart along that direction, all others are at least."""
    d = wp.length(r)
    return d < far + span * wp.max(closing, 0.0) / wp.max(d, 1.0e-30)


@wp.func
def comes_to_triangle(
    x: wp.array(dtype=wp.vec3d),
    u: wp.array(dtype=wp.vec3d),
    i: wp.int32,
    f: wp.vec3i,
    near: float,
    far: float,
    span: float,
):
    """True if vertex i may come within `far` of a triangle in a span of time, which it does not if it is farther than `near` now.
    Seen from the vertex single precision is enough."""
    o = x[i]
    a = wp.vec3(x[f[0]] - o)
    b = wp.vec3(x[f[1]] - o)
    c = wp.vec3(x[f[2]] - o)
    low = wp.min(a, wp.min(b, c))
    high = wp.max(a, wp.max(b, c))
    for k in range(3):
        if low[k] > near or high[k] < -near:
            return False
    w = on_triangle(wp.vec3(), a, b, c)
    r = -(w[0] * a + w[1] * b + w[2] * c)
    v = u[i]
    fast = wp.max(wp.dot(wp.vec3(u[f[0]] - v), r), wp.max(wp.dot(wp.vec3(u[f[1]] - v), r), wp.dot(wp.vec3(u[f[2]] - v), r)))
    return comes_within(r, fast, far, span)


@wp.func
def comes_to_edge(
    x: wp.array(dtype=wp.vec3d),
    u: wp.array(dtype=wp.vec3d),
    e: wp.vec2i,
    g: wp.vec2i,
    near: float,
    far: float,
    span: float,
):
    """True if two edges may come within `far` of each other in a span of time, which they do not if they are farther than `near` now.
    Seen from one of their ends single precision is enough."""
    o = x[e[0]]
    a = wp.vec3()
    b = wp.vec3(x[e[1]] - o)
    c = wp.vec3(x[g[0]] - o)
    d = wp.vec3(x[g[1]] - o)
    for k in range(3):
        if wp.max(a[k], b[k]) + near < wp.min(c[k], d[k]) or wp.max(c[k], d[k]) + near < wp.min(a[k], b[k]):
            return False
    s = on_segments(a, b, c, d)
    r = s[0] * b - c - s[1] * (d - c)
    v = u[e[0]]
    own = wp.min(0.0, wp.dot(wp.vec3(u[e[1]] - v), r))
    return comes_within(r, wp.max(wp.dot(wp.vec3(u[g[0]] - v), r), wp.dot(wp.vec3(u[g[1]] - v), r)) - own, far, span)


@wp.kernel
def mark(
    first: wp.int32,
    bvh: wp.uint64,
    moved: wp.array(dtype=wp.int32),
    faces: wp.array(dtype=wp.vec3i),
    lower: wp.array(dtype=wp.vec3),
    upper: wp.array(dtype=wp.vec3),
    reach: wp.array(dtype=wp.float64),
    due: wp.array(dtype=wp.int32),
):
    """Triangles of moved vertices are due to look for pairs, with all that are near them."""
    t = first + wp.tid()
    f = faces[t]
    if moved[f[0]] == 0 and moved[f[1]] == 0 and moved[f[2]] == 0:
        return
    wide = float(reach[0])
    due[t] = 1
    k = wp.int32(0)
    query = wp.bvh_query_aabb(bvh, lower[t] - wp.vec3(wide, wide, wide), upper[t] + wp.vec3(wide, wide, wide))
    while wp.bvh_query_next(query, k):
        due[k] = 1


@wp.kernel
def near_ones(
    first: wp.int32,
    bvh: wp.uint64,
    lower: wp.array(dtype=wp.vec3),
    upper: wp.array(dtype=wp.vec3),
    reach: wp.array(dtype=wp.float64),
    due: wp.array(dtype=wp.int32),
    room: wp.int32,
    count: wp.array(dtype=wp.int32),
    others: wp.array(dtype=wp.int32),
):
    """Triangles whose bounds are within reach of those of each triangle that is due."""
    t = first + wp.tid()
    if due[t] == 0:
        return
    wide = float(reach[0])
    slot = wp.int32(0)
    k = wp.int32(0)
    query = wp.bvh_query_aabb(bvh, lower[t] - wp.vec3(wide, wide, wide), upper[t] + wp.vec3(wide, wide, wide))
    while wp.bvh_query_next(query, k):
        if k != t:
            if slot < room:
                others[t * room + slot] = k
            slot = slot + 1
    count[t] = slot


@wp.func
def tied(holder: wp.array(dtype=wp.int32), f: wp.vec3i, body: wp.int32):
    """True if a triangle hangs on a body."""
    return holder[f[0]] == body or holder[f[1]] == body or holder[f[2]] == body


@wp.kernel
def near_solids(
    first: wp.int32,
    bvh: wp.uint64,
    x: wp.array(dtype=wp.vec3d),
    u: wp.array(dtype=wp.vec3d),
    span: wp.array(dtype=wp.float64),
    faces: wp.array(dtype=wp.vec3i),
    owned: wp.array(dtype=wp.int32),
    holder: wp.array(dtype=wp.int32),
    lower: wp.array(dtype=wp.vec3),
    upper: wp.array(dtype=wp.vec3),
    spread: wp.array(dtype=wp.float64),
    solid_faces: wp.array(dtype=wp.vec3i),
    solid_owned: wp.array(dtype=wp.int32),
    solid_body: wp.array(dtype=wp.int32),
    solid_spread: wp.array(dtype=wp.float64),
    reach: wp.array(dtype=wp.float64),
    room: wp.int32,
    count: wp.array(dtype=wp.int32),
    pairs: wp.array(dtype=wp.vec4i),
    kinds: wp.array(dtype=wp.vec2i),
):
    """Pairs of a sheet's triangle with solids' triangles; the sheet's vertices come first. Kinds: 2 + 4 * body a vertex of the sheet,
    3 + 4 * body two edges, 4 + 4 * body a vertex of the solid."""
    t = first + wp.tid()
    f = faces[t]
    mine = owned[t]
    far = reach[1]
    wide = float(far)
    time = span[0]
    slot = wp.int32(0)
    k = wp.int32(0)
    query = wp.bvh_query_aabb(bvh, lower[t] - wp.vec3(wide, wide, wide), upper[t] + wp.vec3(wide, wide, wide))
    while wp.bvh_query_next(query, k):
        g = solid_faces[k]
        body = solid_body[k]
        if not tied(holder, f, body):
            others = solid_owned[k]
            near = reach_between(u, f, g, far, time, spread[t], solid_spread[k])
            for c in range(3):
                if (mine & (1 << c)) != 0 and touch_triangle(x, f[c], g, near):
                    slot = put(slot, room, t, wp.vec4i(f[c], g[0], g[1], g[2]), 4 * body + 2, others, pairs, kinds)
                if (others & (1 << c)) != 0 and touch_triangle(x, g[c], f, near):
                    slot = put(slot, room, t, wp.vec4i(g[c], f[0], f[1], f[2]), 4 * body + 4, mine, pairs, kinds)
                if (mine & (8 << c)) != 0:
                    e = wp.vec2i(f[c], f[(c + 1) % 3])
                    for d in range(3):
                        if (others & (8 << d)) != 0:
                            o = wp.vec2i(g[d], g[(d + 1) % 3])
                            if touch_edges(x, e, o, near):
                                slot = put(slot, room, t, wp.vec4i(e[0], e[1], o[0], o[1]), 4 * body + 3, 0, pairs, kinds)
    count[t] = slot
