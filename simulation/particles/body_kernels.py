# mypy: ignore-errors
"""Warp kernels of the bodies that grains meet: what each gets, how it gives way, and how far it has gone."""

import warp as wp

from .grain_kernels import Clock
from .wall_kernels import Bodies, Pairs

wp.set_module_options({"enable_backward": False})

__all__ = ["farthest", "move_bodies", "settle"]


@wp.func
def turned_by(rotation: wp.quatd, angle: wp.vec3d):
    """A rotation followed by a small one about world axes."""
    size = wp.length(angle)
    half = wp.float64(0.5)
    s = half
    if size > wp.float64(1.0e-12):
        s = wp.sin(half * size) / size
    step = wp.quatd(angle[0] * s, angle[1] * s, angle[2] * s, wp.cos(half * size))
    return wp.normalize(step * rotation)


@wp.kernel
def move_bodies(
    first: wp.int32,
    width: wp.int32,
    span: wp.array(dtype=wp.vec2i),
    pairs: Pairs,
    bodies: Bodies,
    dt: wp.array(dtype=wp.float32),
    clock: wp.array(dtype=Clock),
):
    """Sum what the grains give to each body, and let it give way; `width` threads for each body."""
    t = first + wp.tid()
    b = t / width
    run = span[b]
    fx = wp.float64(0.0)
    fy = wp.float64(0.0)
    fz = wp.float64(0.0)
    tx = wp.float64(0.0)
    ty = wp.float64(0.0)
    tz = wp.float64(0.0)
    for q in range(run[0] + t % width, run[1], width):
        f = pairs.force[q]
        c = pairs.turn[q]
        fx -= f[0]
        fy -= f[1]
        fz -= f[2]
        tx += c[0]
        ty += c[1]
        tz += c[2]
    sx = wp.tile_sum(wp.tile(fx))
    sy = wp.tile_sum(wp.tile(fy))
    sz = wp.tile_sum(wp.tile(fz))
    ux = wp.tile_sum(wp.tile(tx))
    uy = wp.tile_sum(wp.tile(ty))
    uz = wp.tile_sum(wp.tile(tz))
    if t % width != 0 or clock[0].stop != 0:
        return
    f = wp.vec3d(sx[0], sy[0], sz[0])
    c = wp.vec3d(ux[0], uy[0], uz[0])
    h = wp.float64(dt[0])
    bodies.impulse[b] = bodies.impulse[b] + f * h
    bodies.twist[b] = bodies.twist[b] + c * h
    v = bodies.velocity[b]
    w = bodies.spin[b]
    if bodies.lightness[b] > wp.float64(0.0):
        v += (bodies.mobility[b] * f + bodies.acceleration[b]) * h
        w += (bodies.turning[b] * c) * h
        bodies.velocity[b] = v
        bodies.spin[b] = w
    arm = bodies.center[b] - bodies.position[b]
    local = wp.quat_rotate_inv(bodies.rotation[b], arm)
    bodies.rotation[b] = turned_by(bodies.rotation[b], w * h)
    center = bodies.center[b] + v * h
    bodies.center[b] = center
    bodies.position[b] = center - wp.quat_rotate(bodies.rotation[b], local)
    bodies.drift[b] = bodies.drift[b] + (wp.length(v) + wp.length(w) * bodies.reach[b]) * h


@wp.kernel
def settle(
    first: wp.int32, width: wp.int32, pairs: Pairs, span: wp.array(dtype=wp.vec2i), reaction: wp.array2d(dtype=wp.float64)
):
    """Add up what the grains got from each body since the sums were taken, its work last; begin anew. `width` threads for each body."""
    t = first + wp.tid()
    b = t / width
    run = span[b]
    fx = wp.float64(0.0)
    fy = wp.float64(0.0)
    fz = wp.float64(0.0)
    tx = wp.float64(0.0)
    ty = wp.float64(0.0)
    tz = wp.float64(0.0)
    work = wp.float64(0.0)
    for q in range(run[0] + t % width, run[1], width):
        f = pairs.given[q]
        c = pairs.twisted[q]
        fx += f[0]
        fy += f[1]
        fz += f[2]
        tx += c[0]
        ty += c[1]
        tz += c[2]
        work += pairs.worked[q]
        pairs.given[q] = wp.vec3d()
        pairs.twisted[q] = wp.vec3d()
        pairs.worked[q] = wp.float64(0.0)
    sx = wp.tile_sum(wp.tile(fx))
    sy = wp.tile_sum(wp.tile(fy))
    sz = wp.tile_sum(wp.tile(fz))
    ux = wp.tile_sum(wp.tile(tx))
    uy = wp.tile_sum(wp.tile(ty))
    uz = wp.tile_sum(wp.tile(tz))
    sw = wp.tile_sum(wp.tile(work))
    if t % width == 0:
        reaction[b, 6] = reaction[b, 6] + sw[0]
        reaction[b, 0] = reaction[b, 0] + sx[0]
        reaction[b, 1] = reaction[b, 1] + sy[0]
        reaction[b, 2] = reaction[b, 2] + sz[0]
        reaction[b, 3] = reaction[b, 3] + ux[0]
        reaction[b, 4] = reaction[b, 4] + uy[0]
        reaction[b, 5] = reaction[b, 5] + uz[0]


@wp.kernel
def farthest(first: wp.int32, number: wp.int32, bodies: Bodies, drift: wp.array(dtype=wp.float32)):
    """Greatest way of a body's surface since the lists were made, squared."""
    if first + wp.tid() > 0:
        return
    most = wp.float64(0.0)
    for b in range(number):
        most = wp.max(most, bodies.drift[b])
    drift[0] = wp.float32(most * most)
