# mypy: ignore-errors
"""Warp kernels at the end of a step with contacts on a CPU (`grips.py`): what solids got, and the move, cut so that nothing crosses.

Corners of pairs are listed by vertex, so that sums have one order.
"""

import warp as wp

from .bound_kernels import KEEP, SHARE
from .near_kernels import is_edges

wp.set_module_options({"enable_backward": False})

__all__ = ["bound", "by_vertex", "move", "starts", "tell"]


@wp.kernel
def by_vertex(
    first: wp.int32,
    vertices: wp.int32,
    pairs: wp.array(dtype=wp.vec4i),
    key: wp.array(dtype=wp.int32),
    item: wp.array(dtype=wp.int32),
):
    """Keys that sort the corners of all pairs by vertex, those that are not among the first `vertices` last."""
    i = first + wp.tid()
    key[i] = wp.min(pairs[i / 4][i % 4], vertices)
    item[i] = i


@wp.kernel
def starts(first: wp.int32, count: wp.int32, key: wp.array(dtype=wp.int32), start: wp.array(dtype=wp.int32)):
    """Where each vertex' corners begin among the sorted."""
    i = first + wp.tid()
    start[i] = wp.lower_bound(key, 0, count, i)


@wp.kernel
def tell(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3d),
    pairs: wp.array(dtype=wp.vec4i),
    kinds: wp.array(dtype=wp.vec2i),
    share: wp.array(dtype=wp.vec4d),
    wanted: wp.array(dtype=wp.float64),
    impulse: wp.array(dtype=wp.vec3d),
    center: wp.array(dtype=wp.vec3d),
    velocity: wp.array(dtype=wp.vec3d),
    clock: wp.array(dtype=wp.float64),
    given: wp.array(dtype=wp.vec3d),
    turned: wp.array(dtype=wp.vec3d),
):
    """Add what each contact with a solid gave to it, and about its centre of mass."""
    p = first + wp.tid()
    kind = kinds[p][0]
    if kind < 2 or wanted[p] < wp.float64(-1.0e29):
        return
    b = (kind - 2) / 4
    q = pairs[p]
    c = share[p]
    own = impulse[p]
    place = wp.vec3d()
    if kind % 4 == 0:
        place = x[q[0]]
    else:
        own = -own
        for k in range(4):
            if c[k] < wp.float64(0.0):
                place -= c[k] * x[q[k]]
    given[p] = given[p] + own
    turned[p] = turned[p] + wp.cross(place - center[b] - clock[1] * velocity[b], own)


@wp.kernel
def bound(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3d),
    u: wp.array(dtype=wp.vec3d),
    inverse: wp.array(dtype=wp.float64),
    radius: wp.array(dtype=wp.float64),
    pairs: wp.array(dtype=wp.vec4i),
    kinds: wp.array(dtype=wp.vec2i),
    share: wp.array(dtype=wp.vec4d),
    normal: wp.array(dtype=wp.vec4d),
    wanted: wp.array(dtype=wp.float64),
    clock: wp.array(dtype=wp.float64),
    limit: wp.array(dtype=wp.vec4d),
):
    """Share of each vertex's displacement in this step after which it is still on its side of the plane between the pair, which moves
    along with both (after `divide and truncate`, Chen et al. 2025). Below 0: how far [m] a solid carries the plane on over it. Nothing of
    pairs that are left alone."""
    p = first + wp.tid()
    if wanted[p] < wp.float64(-1.5e30):
        return
    q = pairs[p]
    c = share[p]
    n = wp.vec3d(normal[p][0], normal[p][1], normal[p][2])
    d = normal[p][3]
    dt = clock[0]
    half = wp.float64(0.5)
    one = wp.float64(1.0)
    zero = wp.float64(0.0)
    middle = zero
    both = zero
    for k in range(4):
        middle += half * wp.abs(c[k]) * wp.dot(x[q[k]] - x[q[0]], n)
        both += half * wp.abs(c[k]) * dt * wp.dot(u[q[k]], n)
    edges = is_edges(kinds[p])
    led = zero
    solid = kinds[p][0] > 1
    keep = KEEP * (radius[q[0]] + radius[q[2]])
    free = SHARE * wp.float64(0.25) * wp.max(d - wp.float64(2.0) * keep, zero)
    drift = wp.clamp(both, -free, free)
    out = wp.vec4d(one, one, one, one)
    if solid:
        # The solid is the first thing where one of its vertices meets a triangle, else the second.
        for k in range(4):
            a = dt * wp.dot(u[q[k]], n)
            if kinds[p][0] % 4 == 0:
                if k == 0:
                    led = wp.min(led, a)
            elif k > 1 or (k == 1 and not edges):
                led = wp.max(led, a)
    for k in range(4):
        if inverse[q[k]] > zero:
            # Distance from the plane, and displacement away from it, on this vertex's side.
            side = one
            if k > 1 or (k == 1 and not edges):
                side = -one
            away = side * (wp.dot(x[q[k]] - x[q[0]], n) - middle)
            rise = side * dt * wp.dot(u[q[k]], n)
            if solid:
                away = wp.max(away + half * d - keep, zero)
                carried = side * led
                if rise < carried - SHARE * away:
                    if carried <= SHARE * away:
                        out[k] = wp.clamp((carried - SHARE * away) / rise, zero, one)
                    else:
                        out[k] = -(carried - SHARE * away)
            else:
                least = side * drift - SHARE * wp.max(away - keep, zero)
                if rise < least and rise < zero:
                    out[k] = wp.clamp(least / rise, zero, one)
    limit[p] = out


@wp.kernel
def move(
    first: wp.int32,
    clock: wp.array(dtype=wp.float64),
    start: wp.array(dtype=wp.int32),
    end: wp.array(dtype=wp.int32),
    items: wp.array(dtype=wp.int32),
    kinds: wp.array(dtype=wp.vec2i),
    wanted: wp.array(dtype=wp.float64),
    limit: wp.array(dtype=wp.vec4d),
    normal: wp.array(dtype=wp.vec4d),
    mass: wp.array(dtype=wp.float64),
    inverse: wp.array(dtype=wp.float64),
    anchor: wp.array(dtype=wp.vec3d),
    plan: wp.array(dtype=wp.vec3d),
    budget: wp.array(dtype=wp.float64),
    u: wp.array(dtype=wp.vec3d),
    x: wp.array(dtype=wp.vec3d),
    v: wp.array(dtype=wp.vec3d),
    held_back: wp.array(dtype=wp.vec3d),
    over: wp.array(dtype=wp.int32),
):
    """Move with the velocity, as far as all planes allow and as far as the lists of pairs hold."""
    i = first + wp.tid()
    dt = clock[0]
    old = x[i]
    speed = u[i]
    if inverse[i] > wp.float64(0.0):
        part = wp.float64(1.0)
        for k in range(start[i], end[i]):
            item = items[k]
            p = item / 4
            if wanted[p] > wp.float64(-1.5e30):
                part = wp.min(part, limit[p][item - 4 * p])
        if part < wp.float64(1.0):
            speed = wp.max(part, wp.float64(0.0)) * speed
            for k in range(start[i], end[i]):
                item = items[k]
                p = item / 4
                c = limit[p][item - 4 * p]
                if wanted[p] > wp.float64(-1.5e30) and c < wp.float64(0.0):
                    side = wp.float64(1.0)
                    if kinds[p][0] % 4 == 0:
                        side = wp.float64(-1.0)
                    speed += side * (-c / dt) * wp.vec3d(normal[p][0], normal[p][1], normal[p][2])
            held_back[i] = held_back[i] + mass[i] * (speed - u[i])
    new = old + dt * speed
    moved = new - anchor[i]
    gone = wp.length(moved - (clock[2] + dt) * plan[i])
    still = wp.length(moved)
    if gone > budget[0] or still > budget[1]:
        over[0] = 1
        if gone > budget[2] or still > budget[3]:
            over[1] = 1
    v[i] = speed
    x[i] = new
