# mypy: ignore-errors
"""Warp kernels that let no displacement cross the plane between two near things, and then move."""

import warp as wp

from .contact_kernels import QUANTA, listed, place_of
from .near_kernels import is_edges

wp.set_module_options({"enable_backward": False})

__all__ = ["bound", "move", "reached", "stride"]

SHARE = wp.constant(wp.float64(0.8))
"""Share of the way to the plane between two things that one step may take."""
KEEP = wp.constant(wp.float64(0.05))
"""Share of the distance of contact: nearer than this nothing comes nearer still."""

THOUSANDTHS = wp.constant(wp.float64(1000.0))
"""In which it is told how far vertices strayed."""
MANY = wp.constant(wp.float64(1.0e9))
"""Most that are told of."""


@wp.kernel
def bound(
    first: wp.int32,
    stride: wp.int32,
    book: wp.array(dtype=wp.int64),
    front: wp.int32,
    rear: wp.int32,
    sheets: wp.int32,
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
    part: wp.array(dtype=wp.float64),
    sums: wp.array(dtype=wp.int64),
):
    """Share `part` of the displacement of each of the `sheets` vertices in this step after which it is still on its side of the plane
    between the pair, which moves along with both (after `divide and truncate`, Chen et al. 2025). Where a solid carries the plane on over
    it, nothing, and the velocity with which it goes along in `sums` [quanta]. Pairs that are left alone bound nothing."""
    for row in range(first + wp.tid(), listed(book, front, rear), stride):
        p = place_of(row, book, front)
        if wanted[p] < wp.float64(-1.5e30):
            continue
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
            i = q[k]
            if i < sheets and inverse[i] > zero:
                out = one
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
                            out = wp.clamp((carried - SHARE * away) / rise, zero, one)
                        else:
                            out = zero
                            along = QUANTA * side * (carried - SHARE * away) / dt
                            for j in range(3):
                                wp.atomic_add(sums, 3 * i + j, wp.int64(wp.rint(along * n[j])))
                else:
                    least = side * drift - SHARE * wp.max(away - keep, zero)
                    if rise < least and rise < zero:
                        out = wp.clamp(least / rise, zero, one)
                if out < one:
                    wp.atomic_min(part, i, out)


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
    sheets: wp.int32,
    carries: wp.int32,
    clock: wp.array(dtype=wp.float64),
    mass: wp.array(dtype=wp.float64),
    inverse: wp.array(dtype=wp.float64),
    anchor: wp.array(dtype=wp.vec3d),
    plan: wp.array(dtype=wp.vec3d),
    allowed: wp.array(dtype=wp.float64),
    u: wp.array(dtype=wp.vec3d),
    x: wp.array(dtype=wp.vec3d),
    v: wp.array(dtype=wp.vec3d),
    held_back: wp.array(dtype=wp.vec3d),
    part: wp.array(dtype=wp.float64),
    sums: wp.array(dtype=wp.int64),
    many: wp.array(dtype=wp.int32),
    book: wp.array(dtype=wp.int64),
):
    """Move with the velocity, as far as all planes allow, and forget these. The book keeps how far one strayed from its plan at most, if more
    than half of what is allowed, in thousandths of that. Nothing presses any more. Vertices of solids, after those of the
    sheets, are carried where they move."""
    i = first + wp.tid()
    dt = clock[0]
    many[i] = 0
    if i == 0:
        book[5] = wp.int64(0)
    speed = u[i]
    if i >= sheets:
        if carries != 0:
            x[i] = x[i] + dt * speed
        return
    share = part[i]
    if share < wp.float64(1.0):
        if inverse[i] > wp.float64(0.0):
            along = wp.vec3d(wp.float64(sums[3 * i]), wp.float64(sums[3 * i + 1]), wp.float64(sums[3 * i + 2])) / QUANTA
            speed = share * speed + along
            held_back[i] = held_back[i] + mass[i] * (speed - u[i])
        for j in range(3):
            sums[3 * i + j] = wp.int64(0)
        part[i] = wp.float64(1.0)
    new = x[i] + dt * speed
    strayed = wp.length(new - anchor[i] - clock[2] * plan[i]) / allowed[0]
    if strayed > wp.float64(0.5):
        wp.atomic_max(book, 2, wp.int64(wp.min(wp.ceil(strayed * THOUSANDTHS), MANY)))
    v[i] = speed
    x[i] = new
