# mypy: ignore-errors
"""Warp kernels that list which grains are near which bodies, and the triangles that they may meet. Pairs stand body by body."""

import warp as wp

from .grain_kernels import State, radius_of, single
from .wall_kernels import SLOTS, Bodies, Pairs, point_of

wp.set_module_options({"enable_backward": False})

__all__ = ["carry", "enlist", "near_walls", "place_pairs", "runs_of", "triangles"]

SLOT_COUNT = wp.constant(SLOTS)


@wp.kernel
def near_walls(
    first: wp.int32,
    state: State,
    bodies: Bodies,
    number: wp.int32,
    unit: wp.float64,
    skin: wp.float64,
    most: wp.int32,
    found: wp.array2d(dtype=wp.int32),
    count: wp.array(dtype=wp.int32),
):
    """Bodies that grain i may meet before the lists are made anew. `count` goes beyond `most` where there are more."""
    i = first + wp.tid()
    p = state.place[i]
    x = point_of(p, unit)
    reach = wp.float64(radius_of(p)) + skin
    n = wp.int32(0)
    for b in range(number):
        near = wp.length(x - bodies.center[b]) < reach + bodies.reach[b]
        if near:
            local = single(wp.quat_rotate_inv(bodies.rotation[b], x - bodies.position[b]))
            r = wp.float32(reach)
            query = wp.mesh_query_aabb(bodies.mesh[b], local - wp.vec3(r, r, r), local + wp.vec3(r, r, r))
            f = wp.int32(0)
            touched = wp.int32(0)
            while wp.mesh_query_aabb_next(query, f):
                touched = 1
            if touched != 0:
                if n < most:
                    found[i, n] = b
                n += 1
    count[i] = n


@wp.kernel
def enlist(
    first: wp.int32,
    start: wp.array(dtype=wp.int32),
    count: wp.array(dtype=wp.int32),
    found: wp.array2d(dtype=wp.int32),
    most: wp.int32,
    key: wp.array(dtype=wp.int32),
    value: wp.array(dtype=wp.int32),
    grain: wp.array(dtype=wp.int32),
):
    """Pairs of grain i, by grains: key is the body, value the number of the pair."""
    i = first + wp.tid()
    n = wp.min(count[i], most)
    for k in range(n):
        e = start[i] + k
        key[e] = found[i, k]
        value[e] = e
        grain[e] = i


@wp.kernel
def place_pairs(
    first: wp.int32,
    key: wp.array(dtype=wp.int32),
    value: wp.array(dtype=wp.int32),
    grain: wp.array(dtype=wp.int32),
    pairs: Pairs,
    at: wp.array(dtype=wp.int32),
):
    """Pairs in the order of their bodies, and where those of a grain went."""
    q = first + wp.tid()
    e = value[q]
    at[e] = q
    pairs.grain[q] = grain[e]
    pairs.body[q] = key[q]


@wp.kernel
def triangles(
    first: wp.int32,
    state: State,
    bodies: Bodies,
    pairs: Pairs,
    unit: wp.float64,
    skin: wp.float64,
    room: wp.int32,
):
    """Triangles that a pair may meet. `count` goes beyond `room` where the list was too short."""
    q = first + wp.tid()
    p = state.place[pairs.grain[q]]
    b = pairs.body[q]
    local = single(wp.quat_rotate_inv(bodies.rotation[b], point_of(p, unit) - bodies.position[b]))
    r = radius_of(p) + wp.float32(skin)
    query = wp.mesh_query_aabb(bodies.mesh[b], local - wp.vec3(r, r, r), local + wp.vec3(r, r, r))
    f = wp.int32(0)
    n = wp.int32(0)
    while wp.mesh_query_aabb_next(query, f):
        if n < room:
            # In ascending order, so that no other order of the search changes anything.
            k = n
            while k > 0 and pairs.triangle[q, wp.max(k - 1, 0)] > f:
                pairs.triangle[q, k] = pairs.triangle[q, k - 1]
                k -= 1
            pairs.triangle[q, k] = f
        n += 1
    pairs.count[q] = n


@wp.kernel
def carry(
    first: wp.int32,
    index: wp.array(dtype=wp.int32),
    old_start: wp.array(dtype=wp.int32),
    old_count: wp.array(dtype=wp.int32),
    old_at: wp.array(dtype=wp.int32),
    old: Pairs,
    fresh: Pairs,
    known: wp.int32,
):
    """Take over the history of a pair's contacts from the old lists; `index` tells the old place of a grain."""
    q = first + wp.tid()
    for s in range(SLOT_COUNT):
        fresh.way[q, s] = wp.vec3(0.0, 0.0, 0.0)
        fresh.spring[q, s] = wp.vec3(0.0, 0.0, 0.0)
        fresh.roll[q, s] = wp.vec3(0.0, 0.0, 0.0)
        fresh.depth[q, s] = 0.0
    fresh.force[q] = wp.vec3d()
    fresh.torque[q] = wp.vec3d()
    fresh.turn[q] = wp.vec3d()
    fresh.given[q] = wp.vec3d()
    fresh.twisted[q] = wp.vec3d()
    fresh.worked[q] = wp.float64(0.0)
    if known != 0:
        before = index[fresh.grain[q]]
        for k in range(old_count[before]):
            e = old_at[old_start[before] + k]
            if old.body[e] == fresh.body[q]:
                for s in range(SLOT_COUNT):
                    fresh.way[q, s] = old.way[e, s]
                    fresh.spring[q, s] = old.spring[e, s]
                    fresh.roll[q, s] = old.roll[e, s]
                    fresh.depth[q, s] = old.depth[e, s]


@wp.kernel
def runs_of(first: wp.int32, total: wp.int32, pairs: Pairs, span: wp.array(dtype=wp.vec2i)):
    """First and past-the-last pair of each body that has any."""
    q = first + wp.tid()
    b = pairs.body[q]
    if q == 0 or pairs.body[q - 1] != b:
        # The end is searched in halves: pairs of one body stand together.
        low = q
        high = total
        while high - low > 1:
            middle = (low + high) / 2
            if pairs.body[middle] == b:
                low = middle
            else:
                high = middle
        span[b] = wp.vec2i(q, high)
