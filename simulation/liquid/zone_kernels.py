# mypy: ignore-errors
"""Warp kernels of zones that make and take in waves: the motion that is aimed at, its force, and the pull towards it."""

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = ["Zones", "pull_cells", "pull_particles"]

DT = wp.constant(0)
STRENGTH = wp.constant(1)


@wp.struct
class Zones:
    """Sides -x, +x, -y, +y; widths are 0 where a side has no zone. Places are relative to the engine's origin [m]."""

    low: wp.vec2
    high: wp.vec2
    generate: wp.vec4
    absorb: wp.vec4
    level: wp.float32
    depth: wp.float32
    rate: wp.float32
    """Rate of the pull at the side [1/s]."""
    count: wp.int32


@wp.func
def share(q: wp.float32):
    """Share of the full pull at a distance of q zone widths from the side: 1 at it, 0 from the inner end on."""
    p = wp.clamp(1.0 - q, 0.0, 1.0)
    return (wp.exp(p * p) - 1.0) / 1.7182818


@wp.func
def distance(z: Zones, x: wp.vec3, side: wp.int32):
    d = x[side // 2] - z.low[side // 2]
    if side % 2 == 1:
        d = z.high[side // 2] - x[side // 2]
    return wp.max(d, 0.0)


@wp.func
def ramps(z: Zones, x: wp.vec3, axis: wp.int32):
    """Along one axis: s, its first and its second derivative; s rises from 0 at a side that makes waves to 1 at its zone's end."""
    s = wp.vec3(1.0, 0.0, 0.0)
    for end in range(2):
        side = 2 * axis + end
        width = z.generate[side]
        if width > 0.0:
            q = wp.min(distance(z, x, side) / width, 1.0)
            sign = 1.0 - 2.0 * wp.float32(end)
            f = q * q * q * (10.0 + q * (6.0 * q - 15.0))
            df = sign * 30.0 * q * q * (q - 1.0) * (q - 1.0) / width
            ddf = 60.0 * q * (q - 1.0) * (2.0 * q - 1.0) / (width * width)
            s = wp.vec3(s[0] * f, s[1] * f + s[0] * df, s[2] * f + 2.0 * s[1] * df + s[0] * ddf)
    return s


@wp.struct
class Aim:
    """Motion that a zone draws towards, and the force that this motion needs beside gravity and pressure."""

    velocity: wp.vec3
    force: wp.vec3


@wp.func
def aim(z: Zones, x: wp.vec3, state: wp.array(dtype=wp.float32), wave: wp.array(dtype=wp.vec4), pace: wp.array(dtype=wp.vec4)):
    """The sea with its stream function psi brought to 0 at the sides that make it, so that nothing flows through them.

    Of each wave, with s from 0 to 1 and t the direction of travel: u = s u_sea t and w = s w_sea - (grad s . t) psi are free of
    divergence and lift the surface to s a cos + (grad s . t) a / k sin. The force per mass that this needs beside the pressure
    of that surface is horizontal: a omega^2 / k C [(grad s + (grad s . t) t) cos + (hess s t) / k sin], with
    C = cosh(k (z + d)) / sinh(k d). The drift of waves is returned evenly over the depth. Above still water all is as at it.
    """
    sx = ramps(z, x, 0)
    sy = ramps(z, x, 1)
    s = sx[0] * sy[0]
    grad = wp.vec2(sx[1] * sy[0], sx[0] * sy[1])
    below = wp.min(x[2] - z.level, 0.0)
    height = wp.max(below + z.depth, 0.0)
    found = Aim()
    strength = state[STRENGTH]
    for c in range(z.count):
        one = wave[c]  # kx, ky, phase now, amplitude
        how = pace[c]  # k, omega, 1 - exp(-2 k depth), drift returned [m/s]
        k = how[0]
        up = wp.exp(k * below) / how[2]
        back = wp.exp(-2.0 * k * height)
        angle = one[0] * x[0] + one[1] * x[1] + one[2]
        cosine = wp.cos(angle)
        sine = wp.sin(angle)
        t = wp.vec2(one[0], one[1]) / k
        speed = one[3] * how[1]
        turn = wp.dot(grad, t)
        level = up * (1.0 + back)
        u = s * speed * level * cosine - strength * s * s * how[3]
        w = speed * up * (1.0 - back) * (s * sine - turn / k * cosine) + strength * 2.0 * s * turn * how[3] * height
        found.velocity = found.velocity + wp.vec3(u * t[0], u * t[1], w)
        bend = wp.vec2(sx[2] * sy[0] * t[0] + sx[1] * sy[1] * t[1], sx[1] * sy[1] * t[0] + sx[0] * sy[2] * t[1])
        f = speed * how[1] / k * level * ((grad + turn * t) * cosine + bend * (sine / k))
        found.force = found.force + wp.vec3(f[0], f[1], 0.0)
    found.velocity = strength * found.velocity
    found.force = strength * found.force
    return found


@wp.func
def pulled(
    z: Zones,
    x: wp.vec3,
    v: wp.vec3,
    state: wp.array(dtype=wp.float32),
    wave: wp.array(dtype=wp.vec4),
    pace: wp.array(dtype=wp.vec4),
):
    """Velocity after the force and the implicit pull of one step."""
    made = wp.float32(0.0)
    taken = wp.float32(0.0)
    for side in range(4):
        d = distance(z, x, side)
        if z.generate[side] > 0.0:
            made = wp.max(made, share(d / z.generate[side]))
        if z.absorb[side] > 0.0:
            taken = wp.max(taken, share(d / z.absorb[side]))
    if made > 0.0:
        f = made * z.rate * state[DT]
        sea = aim(z, x, state, wave, pace)
        v = (v + state[DT] * sea.force + f * sea.velocity) / (1.0 + f)
    if taken > 0.0:
        v = v / (1.0 + taken * z.rate * state[DT])
    return v


@wp.func
def passed(mass: wp.float32, v: wp.vec3, after: wp.vec3):
    """Momentum and energy that a mass takes up from one velocity to another."""
    dv = after - v
    work = wp.float64(0.5 * wp.dot(dv, after + v))
    return wp.float64(mass) * wp.vec4d(wp.float64(dv[0]), wp.float64(dv[1]), wp.float64(dv[2]), work)


@wp.kernel
def pull_particles(
    first: wp.int32,
    count: wp.int32,
    block: wp.int32,
    z: Zones,
    state: wp.array(dtype=wp.float32),
    wave: wp.array(dtype=wp.vec4),
    pace: wp.array(dtype=wp.vec4),
    x: wp.array(dtype=wp.vec3),
    volume: wp.array(dtype=wp.float32),
    lightness: wp.array(dtype=wp.float32),
    velocity: wp.array(dtype=wp.vec3),
    given: wp.array(dtype=wp.vec4d),
):
    """Pull a block of particles [m]; momentum and energy that it gave. What an inflow holds (lightness 0) is left alone."""
    b = first + wp.tid()
    total = wp.vec4d()
    for i in range(b * block, wp.min((b + 1) * block, count)):
        if lightness[i] > 0.0:
            v = velocity[i]
            after = pulled(z, x[i], v, state, wave, pace)
            dv = after - v
            if wp.dot(dv, dv) > 0.0:
                velocity[i] = after
                total = total + passed(volume[i] / lightness[i], v, after)
    given[b] = total


@wp.kernel
def pull_cells(
    first: wp.int32,
    count: wp.int32,
    block: wp.int32,
    z: Zones,
    state: wp.array(dtype=wp.float32),
    wave: wp.array(dtype=wp.vec4),
    pace: wp.array(dtype=wp.vec4),
    cell: wp.float32,
    mass: wp.float32,
    place: wp.array(dtype=wp.vec4),
    velocity: wp.array(dtype=wp.vec4),
    given: wp.array(dtype=wp.vec4d),
):
    """The same for marker particles: places and volumes in cells, mass [kg] of a full one; removed ones have no volume."""
    b = first + wp.tid()
    total = wp.vec4d()
    for i in range(b * block, wp.min((b + 1) * block, count)):
        p = place[i]
        if p[3] > 0.0:
            u = velocity[i]
            v = wp.vec3(u[0], u[1], u[2])
            after = pulled(z, cell * wp.vec3(p[0], p[1], p[2]), v, state, wave, pace)
            dv = after - v
            if wp.dot(dv, dv) > 0.0:
                velocity[i] = wp.vec4(after[0], after[1], after[2], u[3])
                total = total + passed(mass * p[3], v, after)
    given[b] = total
