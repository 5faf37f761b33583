# mypy: ignore-errors
"""Warp kernels of a step beside the solves: forces, motion, who leaves, and what is reported."""

import warp as wp

from .shape_kernels import cell_of, wrapped
from .step_slots import Slot

wp.set_module_options({"enable_backward": False, "max_unroll": 4})  # `packing` looks into 125 cells

__all__ = ["Tally", "census", "close_census", "fall", "leave", "lighten", "packing", "travel"]

DT = wp.constant(int(Slot.DT))
TIME = wp.constant(int(Slot.TIME))
FULL = wp.constant(int(Slot.FULL))
OPEN = wp.constant(1)
LOST = wp.constant(2)


Tally = wp.types.vector(length=6, dtype=wp.float64)


@wp.func
def together(mean: wp.float64, worst: wp.float64, fast: wp.float64, wrong: wp.float64, leavers: wp.float64, pushed: wp.float64):
    """Sum of a census over the threads of a block."""
    return Tally(
        wp.tile_sum(wp.tile(mean))[0],
        wp.tile_max(wp.tile(worst))[0],
        wp.tile_max(wp.tile(fast))[0],
        wp.tile_max(wp.tile(wrong))[0],
        wp.tile_sum(wp.tile(leavers))[0],
        wp.tile_sum(wp.tile(pushed))[0],
    )


@wp.kernel
def lighten(
    first: wp.int32,
    fluid: wp.array(dtype=wp.int32),
    held: wp.array(dtype=wp.float32),
    density: wp.array(dtype=wp.float32),
    settings: wp.array(dtype=wp.float32),
    pressure: wp.array(dtype=wp.float32),
    gravity: wp.vec3,
    pressed: wp.float32,
    lightness: wp.array(dtype=wp.float32),
    lift: wp.array(dtype=wp.vec3),
):
    """1/density of each particle; 0 while an inflow still holds it. Its lift: what bears it up at rest, from a pressure of `pressed`
    over its density on [m^2/s^2] in full."""
    i = first + wp.tid()
    one = 1.0 / density[fluid[i]]
    if settings[TIME] < held[i]:
        one = 0.0
    lightness[i] = one
    lift[i] = -wp.min(pressure[i] * one / pressed, 1.0) * gravity


@wp.kernel
def fall(
    first: wp.int32,
    lightness: wp.array(dtype=wp.float32),
    gravity: wp.vec3,
    settings: wp.array(dtype=wp.float32),
    v: wp.array(dtype=wp.vec3),
):
    """Gravity on what is not held."""
    i = first + wp.tid()
    if lightness[i] > 0.0:
        v[i] = v[i] + settings[DT] * gravity


@wp.kernel
def travel(
    first: wp.int32,
    v: wp.array(dtype=wp.vec3),
    settings: wp.array(dtype=wp.float32),
    x: wp.array(dtype=wp.vec3),
):
    """Move with the velocity of the end of the step."""
    i = first + wp.tid()
    x[i] = x[i] + settings[DT] * v[i]


@wp.struct
class Box:
    """An outflow: inside where all local coordinates are below the half sizes."""

    center: wp.vec3
    rotation: wp.mat33
    half: wp.vec3


@wp.kernel
def leave(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3),
    low: wp.vec3,
    high: wp.vec3,
    low_closed: wp.vec3,
    high_closed: wp.vec3,
    margin: wp.float32,
    outflows: wp.int32,
    boxes: wp.array(dtype=Box),
    leaving: wp.array(dtype=wp.int32),
):
    """0 stays, 1 left through an open side, 2 lost through a closed one, 3 + k taken by outflow k."""
    i = first + wp.tid()
    xi = x[i]
    code = wp.int32(0)
    for a in range(3):
        if xi[a] < low[a]:
            if low_closed[a] == 0.0:
                code = OPEN
            elif xi[a] < low[a] - margin:
                code = LOST
        if xi[a] > high[a]:
            if high_closed[a] == 0.0:
                code = OPEN
            elif xi[a] > high[a] + margin:
                code = LOST
    if code == 0:
        for k in range(outflows):
            y = wp.transpose(boxes[k].rotation) * (xi - boxes[k].center)
            z = boxes[k].half
            if code == 0 and wp.abs(y[0]) <= z[0] and wp.abs(y[1]) <= z[1] and wp.abs(y[2]) <= z[2]:
                code = 3 + k
    leaving[i] = code


@wp.kernel
def census(
    first: wp.int32,
    span: wp.int32,
    width: wp.int32,
    total: wp.int32,
    x: wp.array(dtype=wp.vec3),
    v: wp.array(dtype=wp.vec3),
    p: wp.array(dtype=wp.float32),
    lightness: wp.array(dtype=wp.float32),
    fill: wp.array(dtype=wp.float32),
    leaving: wp.array(dtype=wp.int32),
    settings: wp.array(dtype=wp.float32),
    out: wp.array(dtype=Tally),
):
    """Sum and largest of compression, largest squared speed, a particle that is not finite or -1, leavers, sum of (pressure / density)^2."""
    t = first + wp.tid()
    start = (t / width) * span * width + t % width
    mean = wp.float64(0.0)
    worst = wp.float64(0.0)
    fast = wp.float64(0.0)
    wrong = wp.float64(-1.0)
    leavers = wp.float64(0.0)
    pushed = wp.float64(0.0)
    for i in range(start, wp.min(start + span * width, total), width):
        over = wp.max(fill[i] / settings[FULL] - 1.0, 0.0)
        mean += wp.float64(over)
        worst = wp.max(worst, wp.float64(over))
        v2 = wp.dot(v[i], v[i])
        fast = wp.max(fast, wp.float64(v2))
        if not (wp.isfinite(v2) and wp.isfinite(wp.dot(x[i], x[i])) and wp.isfinite(fill[i])):
            wrong = wp.float64(i)
        push = wp.float64(p[i] * lightness[i])
        pushed += push * push
        if leaving[i] != 0:
            leavers += wp.float64(1.0)
    found = together(mean, worst, fast, wrong, leavers, pushed)
    if t % width == 0:
        out[t / width] = found


@wp.kernel
def close_census(first: wp.int32, width: wp.int32, parts: wp.int32, partial: wp.array(dtype=Tally), out: wp.array(dtype=Tally)):
    """The same of all blocks."""
    t = first + wp.tid()
    mean = wp.float64(0.0)
    worst = wp.float64(0.0)
    fast = wp.float64(0.0)
    wrong = wp.float64(-1.0)
    leavers = wp.float64(0.0)
    pushed = wp.float64(0.0)
    for k in range(t, parts, width):
        one = partial[k]
        mean += one[0]
        worst = wp.max(worst, one[1])
        fast = wp.max(fast, one[2])
        wrong = wp.max(wrong, one[3])
        leavers += one[4]
        pushed += one[5]
    found = together(mean, worst, fast, wrong, leavers, pushed)
    if t == 0:
        out[0] = found


@wp.kernel
def packing(
    first: wp.int32,
    step: wp.int32,
    x: wp.array(dtype=wp.vec3),
    volume: wp.array(dtype=wp.float32),
    span: wp.array(dtype=wp.vec2i),
    low: wp.vec3,
    inverse: wp.float32,
    size: wp.vec3i,
    domain_low: wp.vec3,
    domain_high: wp.vec3,
    h: wp.float32,
    fill: wp.array(dtype=wp.float32),
    out: wp.array(dtype=wp.vec3),
):
    """Write for every `step`-th particle the liquid per volume within twice the support (Wendland C2), how uneven it lies, and its fill."""
    t = first + wp.tid()
    i = t * step
    xi = x[i]
    wide = 2.0 * h
    total = wp.float32(0.0)
    lean = wp.vec3(0.0, 0.0, 0.0)
    for a in range(3):
        if xi[a] - domain_low[a] < wide or domain_high[a] - xi[a] < wide:
            out[t] = wp.vec3(0.0, 1.0e3, 0.0)
            return
    c = cell_of(xi, low, inverse)
    for dz in range(-2, 3):
        for dy in range(-2, 3):
            line = (wrapped(c[2] + dz, size[2]) * size[1] + wrapped(c[1] + dy, size[1])) * size[0]
            for dx in range(-2, 3):
                s = span[line + wrapped(c[0] + dx, size[0])]
                for j in range(s[0], s[1]):
                    way = xi - x[j]
                    q = wp.length(way) / wide
                    if q < 1.0:
                        u = 1.0 - q
                        total += volume[j] * u * u * u * u * (4.0 * q + 1.0)
                        lean += volume[j] * u * u * u * way
    scale = 21.0 / (6.2831853 * wide * wide * wide)
    out[t] = wp.vec3(total * scale, 20.0 * wp.length(lean) * scale / wide, fill[i])
