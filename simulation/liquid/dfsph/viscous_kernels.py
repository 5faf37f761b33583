# mypy: ignore-errors
"""Warp kernels of viscosity, friction at walls and heat.

Viscous force between two particles along their connection (Monaghan 2005, the operator of Weiler et al. 2018): momentum and
angular momentum are kept, and weighted by mass the operator is symmetric, so the implicit step is solved by conjugate gradients.
"""

from typing import Any

import warp as wp

from .boundary_kernels import Bodies, Pairs, wall_speed
from .list_kernels import KINDS, neighbour, toward
from .step_slots import Slot

wp.set_module_options({"enable_backward": False})

__all__ = ["blend", "conduct", "direct", "dots", "rub", "steer", "thicken", "update", "warm"]

DT = wp.constant(int(Slot.DT))
PAIR = wp.constant(wp.float32(11.8))
"""10 of the continuum, times what lists of 30 neighbours lack: measured, liquid that has flowed then has 1.02 to 1.08 of its
viscosity and a lattice sheared along its rows 0.92 to 0.95."""
ALPHA = wp.constant(0)
BETA = wp.constant(1)
FIRST = wp.constant(0)
LEFT = wp.constant(1)
DONE = wp.constant(2)
SHARE = wp.constant(3)
MOST = wp.constant(4)
"""Places in the ledger of a solve: squared residual at first and now, iterations, squared tolerance, iterations at most."""


@wp.kernel
def thicken(
    first: wp.int32,
    fluid: wp.array(dtype=wp.int32),
    temperature: wp.array(dtype=wp.float32),
    thickness: wp.array(dtype=wp.vec3),
    viscosity: wp.array(dtype=wp.float32),
):
    """Dynamic viscosity at each particle's temperature (Arrhenius); `thickness`: viscosity, activation, temperature of a fluid."""
    i = first + wp.tid()
    t = thickness[fluid[i]]
    mu = t[0]
    if t[1] != 0.0:
        mu = mu * wp.exp(wp.clamp(t[1] * (1.0 / temperature[i] - 1.0 / t[2]), -30.0, 30.0))
    viscosity[i] = mu


@wp.kernel
def direct(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3),
    v: wp.array(dtype=wp.vec3),
    viscosity: wp.array(dtype=wp.float32),
    lightness: wp.array(dtype=wp.float32),
    count: wp.array(dtype=wp.int32),
    near: wp.array(dtype=Any),
    row: wp.int32,
    stride: wp.int32,
    unit: wp.float32,
    h: wp.float32,
    pairs: Pairs,
    bodies: Bodies,
    walls: wp.float32,
    settings: wp.array(dtype=wp.float32),
    out: wp.array(dtype=wp.vec3),
):
    """v - dt (viscous acceleration at v); `walls` 1: with the walls' velocities, 0: the linear part alone."""
    i = first + wp.tid()
    mu = viscosity[i]
    s = wp.vec3(0.0, 0.0, 0.0)
    at = i * row
    for _k in range(count[i]):
        w = near[at]
        j = neighbour(w)
        way = x[i] - x[j]
        both = mu + viscosity[j]
        if both > 0.0:
            part = 2.0 * PAIR * mu * viscosity[j] / both * wp.dot(v[i] - v[j], way) / (wp.dot(way, way) + 0.01 * h * h)
            s += part * toward(w)
        at += stride
    s = unit * s
    for k in range(pairs.start[i], pairs.start[i] + pairs.touched[i]):
        wall = walls * wall_speed(pairs, bodies, k, x[i])
        s -= mu * pairs.drag[k] * (v[i] - wall)
    out[i] = v[i] - settings[DT] * lightness[i] * s


@wp.kernel
def rub(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3),
    v: wp.array(dtype=wp.vec3),
    volume: wp.array(dtype=wp.float32),
    viscosity: wp.array(dtype=wp.float32),
    pairs: Pairs,
    bodies: Bodies,
    sign: wp.float32,
    force: wp.array(dtype=wp.vec3),
):
    """Friction force of each pair on the body [N] at the particle's velocity v, times `sign`."""
    i = first + wp.tid()
    for k in range(pairs.start[i], pairs.start[i] + pairs.touched[i]):
        wall = wall_speed(pairs, bodies, k, x[i])
        force[k] = sign * volume[i] * viscosity[i] * pairs.drag[k] * (v[i] - wall)


@wp.kernel
def blend(
    first: wp.int32,
    one: wp.array(dtype=wp.vec3),
    two: wp.array(dtype=wp.vec3),
    a: wp.float32,
    b: wp.float32,
    out: wp.array(dtype=wp.vec3),
):
    """Weighted sum of two fields."""
    i = first + wp.tid()
    out[i] = a * one[i] + b * two[i]


@wp.kernel
def dots(
    first: wp.int32,
    span: wp.int32,
    width: wp.int32,
    total: wp.int32,
    volume: wp.array(dtype=wp.float32),
    lightness: wp.array(dtype=wp.float32),
    one: wp.array(dtype=wp.vec3),
    two: wp.array(dtype=wp.vec3),
    partial: wp.array(dtype=wp.float64),
):
    """Products of two fields weighted by mass, by blocks."""
    t = first + wp.tid()
    start = (t / width) * span * width + t % width
    s = wp.float64(0.0)
    for i in range(start, wp.min(start + span * width, total), width):
        if lightness[i] > 0.0:
            s += wp.float64(volume[i] / lightness[i] * wp.dot(one[i], two[i]))
    wp.tile_store(partial, wp.tile_sum(wp.tile(s)), offset=t / width)


@wp.kernel
def steer(
    first: wp.int32,
    width: wp.int32,
    parts: wp.int32,
    partial: wp.array(dtype=wp.float64),
    part: wp.int32,
    ledger: wp.array(dtype=wp.float64),
    scalars: wp.array(dtype=wp.float32),
    going: wp.array(dtype=wp.int32),
):
    """Scalar step of conjugate gradients after a product: 0 remember the first residual, 1 the length of a step, 2 the next direction."""
    t = first + wp.tid()
    mine = wp.float64(0.0)
    for k in range(t, parts, width):
        mine += partial[k]
    s = wp.tile_sum(wp.tile(mine))[0]
    if t > 0:
        return
    if part == 0:
        ledger[FIRST] = s
        ledger[LEFT] = s
    if part == 1:
        scalars[ALPHA] = wp.float32(ledger[LEFT] / s)
    if part == 2:
        scalars[BETA] = wp.float32(s / ledger[LEFT])
        ledger[LEFT] = s
        ledger[DONE] = ledger[DONE] + wp.float64(1.0)
    if part != 1:
        going[0] = 1
        if ledger[LEFT] <= ledger[SHARE] * ledger[FIRST] or ledger[DONE] >= ledger[MOST] or not wp.isfinite(s):
            going[0] = 0


@wp.kernel
def update(
    first: wp.int32,
    scalars: wp.array(dtype=wp.float32),
    direction: wp.array(dtype=wp.vec3),
    image: wp.array(dtype=wp.vec3),
    v: wp.array(dtype=wp.vec3),
    rest: wp.array(dtype=wp.vec3),
):
    """One step of conjugate gradients."""
    i = first + wp.tid()
    v[i] = v[i] + scalars[ALPHA] * direction[i]
    rest[i] = rest[i] - scalars[ALPHA] * image[i]


@wp.kernel
def warm(
    first: wp.int32,
    scalars: wp.array(dtype=wp.float32),
    rest: wp.array(dtype=wp.vec3),
    direction: wp.array(dtype=wp.vec3),
):
    """Next direction of conjugate gradients."""
    i = first + wp.tid()
    direction[i] = rest[i] + scalars[BETA] * direction[i]


@wp.kernel
def conduct(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3),
    fluid: wp.array(dtype=wp.int32),
    density: wp.array(dtype=wp.float32),
    heat: wp.array(dtype=wp.vec2),
    temperature: wp.array(dtype=wp.float32),
    count: wp.array(dtype=wp.int32),
    near: wp.array(dtype=Any),
    row: wp.int32,
    stride: wp.int32,
    unit: wp.float32,
    h: wp.float32,
    dt: wp.float32,
    out: wp.array(dtype=wp.float32),
):
    """Temperature after dt of conduction (Cleary and Monaghan 1999); `heat`: conductivity, capacity per mass of a fluid."""
    i = first + wp.tid()
    own = heat[fluid[i]]
    s = wp.float32(0.0)
    at = i * row
    for _k in range(count[i]):
        w = near[at]
        j = neighbour(w)
        way = x[i] - x[j]
        other = heat[fluid[j]]
        both = own[0] + other[0]
        if both > 0.0:
            s += (
                4.0
                * own[0]
                * other[0]
                / both
                * (temperature[i] - temperature[j])
                * unit
                * wp.dot(way, toward(w))
                / (wp.dot(way, way) + 0.01 * h * h)
            )
        at += stride
    out[i] = temperature[i] + dt * s / (density[fluid[i]] * own[1])


for _kind in KINDS:
    for _kernel in (direct, conduct):
        wp.overload(_kernel, {"near": wp.array(dtype=_kind)})
