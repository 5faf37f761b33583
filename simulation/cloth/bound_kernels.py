# mypy: ignore-errors
"""Warp kernels that let no displacement cross the plane between two near things, and then move."""

import warp as wp

from .near_kernels import is_edges

wp.set_module_options({"enable_backward": False})

__all__ = ["bound", "move", "reached", "stride"]

SHARE = wp.constant(wp.float64(0.8))
"""Share of the way to the plane between two things that one step may take."""
KEEP = wp.constant(wp.float64(0.05))
"""Share of the distance of contact: nearer than this nothing comes nearer still."""


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
def reached(
    first: wp.int32,
    clock: wp.array(dtype=wp.float64),
    anchor: wp.array(dtype=wp.vec3d),
    plan: wp.array(dtype=wp.vec3d),
    budget: wp.array(dtype=wp.float64),
    x: wp.array(dtype=wp.vec3d),
    u: wp.array(dtype=wp.vec3d),
    share: wp.array(dtype=wp.float64),
):
    """Write the distance of each vertex from its expected place in this step, over the distance for which the lists of pairs hold."""
    i = first + wp.tid()
    moved = x[i] - anchor[i] + clock[0] * u[i]
    gone = wp.length(moved - (clock[2] + clock[0]) * plan[i])
    share[i] = wp.max(gone / budget[2], wp.length(moved) / budget[3])


@wp.kernel
def stride(
    first: wp.int32,
    clock: wp.array(dtype=wp.float64),
    u: wp.array(dtype=wp.vec3d),
    x: wp.array(dtype=wp.vec3d),
    v: wp.array(dtype=wp.vec3d),
):
    """Move with the velocity where nothing is in the way."""
    i = first + wp.tid()
    x[i] = x[i] + clock[0] * u[i]
    v[i] = u[i]


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
