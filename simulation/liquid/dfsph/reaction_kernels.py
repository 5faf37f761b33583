# mypy: ignore-errors
"""Warp kernels of what bodies and liquid give each other: forces of the pairs, summed in lanes, and how bodies move by them."""

import warp as wp

from .boundary_kernels import Bodies, Pairs, at_corners, at_place
from .step_slots import Slot

wp.set_module_options({"enable_backward": False})

DT = wp.constant(int(Slot.DT))

PRESSED, FELT, GIVEN = 0, 1, 2
"""Force of a pair that lanes sum: of the pressure on the body, masses times accelerations of the liquid by it, and a value of its own."""
PRESSED_KIND = wp.constant(PRESSED)
FELT_KIND = wp.constant(FELT)

VERTICES = wp.constant(wp.float32(0.5))
"""Share of a row's sum of A through vertices that counts as its diagonal. Forces on one vertex hardly differ in direction."""

__all__ = [
    "FELT",
    "GIVEN",
    "PRESSED",
    "account",
    "carry",
    "finish_factors",
    "kick",
    "lanes_of",
    "reach",
    "react",
]


@wp.kernel
def carry(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3),
    pairs: Pairs,
    bodies: Bodies,
    velocity: wp.array(dtype=wp.vec3),
    spin: wp.array(dtype=wp.vec3),
    vertices: wp.array(dtype=wp.vec3),
    moving: wp.array(dtype=wp.float32),
):
    """Part of D that bodies which move (or accelerate) with `velocity` and `spin`, or whose `vertices` do, take away."""
    i = first + wp.tid()
    s = wp.float32(0.0)
    for k in range(pairs.start[i], pairs.start[i] + pairs.touched[i]):
        b = pairs.body[k]
        u = at_place(velocity[b], spin[b], x[i] - bodies.center[b])
        if bodies.deforms[b] != 0:
            u = at_corners(vertices, pairs.corner[k], pairs.share[k])
        s += wp.dot(u, pairs.slope[k])
    moving[i] = s


@wp.kernel
def kick(
    first: wp.int32,
    acceleration: wp.array(dtype=wp.vec3),
    settings: wp.array(dtype=wp.float32),
    velocity: wp.array(dtype=wp.vec3),
):
    """Velocity by the acceleration of everything but the liquid."""
    b = first + wp.tid()
    velocity[b] = velocity[b] + settings[DT] * acceleration[b]


@wp.kernel
def reach(
    first: wp.int32,
    lanes: wp.int32,
    width: wp.int32,
    x: wp.array(dtype=wp.vec3),
    volume: wp.array(dtype=wp.float32),
    pairs: Pairs,
    order: wp.array(dtype=wp.int32),
    spans: wp.array(dtype=wp.vec2i),
    bodies: Bodies,
    partial: wp.array(dtype=wp.vec2d),
):
    """Sums over the pairs of a body that bound how much all its particles together can move it."""
    t = first + wp.tid()
    b = t / lanes
    span = spans[b]
    one = wp.float64(0.0)
    two = wp.float64(0.0)
    if bodies.lightness[b] > 0.0:
        for at in range(span[0] + t % lanes, span[1], lanes):
            k = order[at]
            i = pairs.particle[k]
            turn = wp.cross(x[i] - bodies.center[b], pairs.slope[k])
            one += wp.float64(volume[i] * wp.length(pairs.slope[k]))
            two += wp.float64(volume[i] * wp.sqrt(wp.max(wp.dot(turn, bodies.turning[b] * turn), 0.0)))
    wp.tile_store(partial, wp.tile_sum(wp.tile(wp.vec2d(one, two), preserve_type=True)), offset=t / width)


@wp.kernel
def finish_factors(
    first: wp.int32,
    parts: wp.int32,
    x: wp.array(dtype=wp.vec3),
    lean: wp.array(dtype=wp.vec3),
    lightness: wp.array(dtype=wp.float32),
    pairs: Pairs,
    bodies: Bodies,
    partial: wp.array(dtype=wp.vec2d),
    bound: wp.array(dtype=wp.float32),
    least: wp.float32,
    stiffness: wp.array(dtype=wp.float32),
    firm: wp.array(dtype=wp.float32),
):
    """Diagonal of A: own acceleration, neighbours' (summed by the search), and bounds of the bodies' rows, `bound` those of vertices;
    `firm` without these, for the solve that moves none."""
    i = first + wp.tid()
    give = wp.float32(0.0)
    s = stiffness[i] + lightness[i] * wp.dot(lean[i], lean[i])
    for k in range(pairs.start[i], pairs.start[i] + pairs.touched[i]):
        b = pairs.body[k]
        if bodies.lightness[b] > 0.0:
            one = wp.float64(0.0)
            two = wp.float64(0.0)
            for t in range(parts):
                one += partial[b * parts + t][0]
                two += partial[b * parts + t][1]
            turn = wp.cross(x[i] - bodies.center[b], pairs.slope[k])
            s += 0.25 * bodies.lightness[b] * wp.length(pairs.slope[k]) * wp.float32(one)
            s += 0.25 * wp.sqrt(wp.max(wp.dot(turn, bodies.turning[b] * turn), 0.0)) * wp.float32(two)
        if bodies.deforms[b] != 0:
            own = wp.length(pairs.slope[k])
            at = pairs.corner[k]
            share = pairs.share[k]
            give += VERTICES * own * (share[0] * bound[at[0]] + share[1] * bound[at[1]] + share[2] * bound[at[2]])
    if s < least:
        s = 0.0
        give = 0.0
    stiffness[i] = s + give
    firm[i] = s


@wp.func
def pair_force(
    kind: wp.int32,
    k: wp.int32,
    i: wp.int32,
    volume: wp.array(dtype=wp.float32),
    lightness: wp.array(dtype=wp.float32),
    p: wp.array(dtype=wp.float32),
    pairs: Pairs,
    value: wp.array(dtype=wp.vec3),
):
    """Force of pair k, whose particle is i, by its kind."""
    if kind == PRESSED_KIND:
        return volume[i] * p[i] * pairs.slope[k]
    if kind == FELT_KIND:
        if lightness[i] > 0.0:
            return (volume[i] / lightness[i]) * (-lightness[i] * (p[i] * pairs.slope[k]))
        return wp.vec3(0.0, 0.0, 0.0)
    return value[k]


@wp.func
def double(v: wp.vec3):
    """A vector in double precision."""
    return wp.vec3d(wp.float64(v[0]), wp.float64(v[1]), wp.float64(v[2]))


@wp.func
def summed(values: wp.array(dtype=wp.vec3d), b: wp.int32, parts: wp.int32):
    """Sum of the parts of a body."""
    s = wp.vec3d()
    for t in range(parts):
        s += values[b * parts + t]
    return s


@wp.func
def single(v: wp.vec3d):
    """A vector in single precision."""
    return wp.vec3(wp.float32(v[0]), wp.float32(v[1]), wp.float32(v[2]))


@wp.kernel
def lanes_of(
    first: wp.int32,
    kind: wp.int32,
    lanes: wp.int32,
    width: wp.int32,
    x: wp.array(dtype=wp.vec3),
    volume: wp.array(dtype=wp.float32),
    lightness: wp.array(dtype=wp.float32),
    p: wp.array(dtype=wp.float32),
    value: wp.array(dtype=wp.vec3),
    pairs: Pairs,
    order: wp.array(dtype=wp.int32),
    spans: wp.array(dtype=wp.vec2i),
    center: wp.array(dtype=wp.vec3),
    force: wp.array(dtype=wp.vec3d),
    torque: wp.array(dtype=wp.vec3d),
):
    """Force and torque of the pairs of a body about its centre, one lane of them; `kind` is PRESSED, FELT or GIVEN."""
    t = first + wp.tid()
    b = t / lanes
    span = spans[b]
    f = wp.vec3d()
    m = wp.vec3d()
    for at in range(span[0] + t % lanes, span[1], lanes):
        k = order[at]
        i = pairs.particle[k]
        one = pair_force(kind, k, i, volume, lightness, p, pairs, value)
        f += double(one)
        m += double(wp.cross(x[i] - center[b], one))
    wp.tile_store(force, wp.tile_sum(wp.tile(f, preserve_type=True)), offset=t / width)
    wp.tile_store(torque, wp.tile_sum(wp.tile(m, preserve_type=True)), offset=t / width)


@wp.kernel
def react(
    first: wp.int32,
    parts: wp.int32,
    bodies: Bodies,
    force: wp.array(dtype=wp.vec3d),
    torque: wp.array(dtype=wp.vec3d),
    velocity: wp.array(dtype=wp.vec3),
    spin: wp.array(dtype=wp.vec3),
):
    """Sum the parts of a body; its linear and angular acceleration by them."""
    b = first + wp.tid()
    f = summed(force, b, parts)
    m = summed(torque, b, parts)
    velocity[b] = bodies.mobility[b] * single(f)
    spin[b] = bodies.turning[b] * single(m)


@wp.kernel
def account(
    first: wp.int32,
    parts: wp.int32,
    bodies: Bodies,
    force: wp.array(dtype=wp.vec3d),
    torque: wp.array(dtype=wp.vec3d),
    settings: wp.array(dtype=wp.float32),
    moves: wp.int32,
    linear: wp.array(dtype=wp.vec3d),
    angular: wp.array(dtype=wp.vec3d),
):
    """Add the impulse of one solve to a body's sums; where `moves`, to its velocity too."""
    b = first + wp.tid()
    f = summed(force, b, parts)
    m = summed(torque, b, parts)
    dt = wp.float64(settings[DT])
    linear[b] = linear[b] + dt * f
    angular[b] = angular[b] + dt * m
    if moves != 0:
        bodies.velocity[b] = bodies.velocity[b] + settings[DT] * (bodies.mobility[b] * single(f))
        bodies.spin[b] = bodies.spin[b] + settings[DT] * (bodies.turning[b] * single(m))
