# mypy: ignore-errors
"""Warp kernels of the two pressure solves: accelerated projected gradient on p >= 0, no compression where p > 0.

The first solve changes velocities so that nothing is compressed further, the second one places, so that what is too full is not
(as a separate projection of density: Kugelstadt et al. 2019; Losasso et al. 2008): errors of places never become motion.

Discrete divergence D v = sum_j V_j (v_i - v_j) . grad W_ij + walls, pressure acceleration a = -(1/rho) (p_i S_i + sum_j p_j V_j grad W_ij)
with S_i = sum_j V_j grad W_ij + walls. Weighted by volume, -D a is a symmetric positive matrix A of p, so both solves are one
convex problem with bounds (a linear complementarity problem): r = b - A p <= 0, p >= 0, p r = 0.
"""

from typing import Any

import warp as wp

from .list_kernels import KINDS, neighbour, toward
from .step_slots import Slot

wp.set_module_options({"enable_backward": False})

__all__ = ["Sums", "Totals", "accelerate", "asked", "begin", "end", "gather", "judge", "rates", "relax", "shift", "source"]

DT = wp.constant(int(Slot.DT))
COUNT = wp.constant(int(Slot.COUNT))
BETA = wp.constant(int(Slot.BETA))
NESTEROV = wp.constant(int(Slot.NESTEROV))
ERROR = wp.constant(int(Slot.ERROR))
OMEGA = wp.constant(int(Slot.OMEGA))
OPEN = wp.constant(int(Slot.OPEN))
ASKED = wp.constant(int(Slot.ASKED))
FULL = wp.constant(int(Slot.FULL))
FRESH = wp.constant(int(Slot.FRESH))
TOLERANCE = wp.constant(int(Slot.TOLERANCE))
MOST = wp.constant(int(Slot.MOST))
DONE = wp.constant(int(Slot.DONE))
MET = wp.constant(int(Slot.MET))
RESIDUAL = wp.constant(wp.float32(0.2))
"""Share of the compression asked away that may be left: keeps tall columns from sagging, whose bottom alone is compressed."""
SMALL = wp.constant(wp.float32(0.02))
"""Share of the tolerance below which that does not matter."""
SLACK = wp.constant(wp.float32(0.05))
"""Fill that may be lacking in what counts as full: to close a gap of a hundredth in one step would be noise, not flow."""
MOST_MENDED = wp.constant(wp.float32(0.02))
"""Compression that one step takes back at most: more would throw particles past each other."""
Sums = wp.types.vector(length=5, dtype=wp.float32)
Totals = wp.types.vector(length=5, dtype=wp.float64)


@wp.kernel
def rates(
    first: wp.int32,
    v: wp.array(dtype=wp.vec3),
    lean: wp.array(dtype=wp.vec3),
    count: wp.array(dtype=wp.int32),
    near: wp.array(dtype=Any),
    row: wp.int32,
    stride: wp.int32,
    unit: wp.float32,
    moving: wp.array(dtype=wp.float32),
    rate: wp.array(dtype=wp.float32),
):
    """D v: rate of the fill [1/s]; `moving` is what moving walls take away."""
    i = first + wp.tid()
    s = wp.float32(0.0)
    at = i * row
    for _k in range(count[i]):
        w = near[at]
        s += wp.dot(v[neighbour(w)], toward(w))
        at += stride
    rate[i] = wp.dot(v[i], lean[i]) - moving[i] - unit * s


@wp.kernel
def source(
    first: wp.int32,
    fill: wp.array(dtype=wp.float32),
    rate: wp.array(dtype=wp.float32),
    settings: wp.array(dtype=wp.float32),
    density_solve: wp.int32,
    b: wp.array(dtype=wp.float32),
):
    """Right side [1/s^2]: what the fill would be beyond 1 after dt, over dt^2; the velocity solve leaves compression alone.

    Both let what is not full fill up; the velocity solve takes what is nearly full for full.
    """
    i = first + wp.tid()
    dt = settings[DT]
    over = fill[i] / settings[FULL] - 1.0
    part = wp.min(over + SLACK, 0.0)
    if density_solve != 0:
        part = wp.min(over, MOST_MENDED)
    b[i] = (part / dt + rate[i]) / dt


@wp.kernel
def begin(
    first: wp.int32,
    p: wp.array(dtype=wp.float32),
    y: wp.array(dtype=wp.float32),
):
    """Start from the pressure of the last step."""
    i = first + wp.tid()
    y[i] = p[i]


@wp.kernel
def accelerate(
    first: wp.int32,
    p: wp.array(dtype=wp.float32),
    lightness: wp.array(dtype=wp.float32),
    lean: wp.array(dtype=wp.vec3),
    count: wp.array(dtype=wp.int32),
    near: wp.array(dtype=Any),
    row: wp.int32,
    stride: wp.int32,
    unit: wp.float32,
    a: wp.array(dtype=wp.vec3),
):
    """Acceleration by pressure [m/s^2]."""
    i = first + wp.tid()
    s = wp.vec3(0.0, 0.0, 0.0)
    at = i * row
    for _k in range(count[i]):
        w = near[at]
        s += p[neighbour(w)] * toward(w)
        at += stride
    a[i] = -lightness[i] * (p[i] * lean[i] + unit * s)


@wp.kernel
def relax(
    first: wp.int32,
    a: wp.array(dtype=wp.vec3),
    lean: wp.array(dtype=wp.vec3),
    count: wp.array(dtype=wp.int32),
    near: wp.array(dtype=Any),
    row: wp.int32,
    stride: wp.int32,
    unit: wp.float32,
    bodies: wp.array(dtype=wp.float32),
    stiffness: wp.array(dtype=wp.float32),
    b: wp.array(dtype=wp.float32),
    volume: wp.array(dtype=wp.float32),
    settings: wp.array(dtype=wp.float32),
    p: wp.array(dtype=wp.float32),
    y: wp.array(dtype=wp.float32),
    last_y: wp.array(dtype=wp.float32),
    last_r: wp.array(dtype=wp.float32),
    sums: wp.array(dtype=Sums),
):
    """One accelerated step; sums: compression left (r > 0), residual that is left (also r < 0 where p > 0), the sign
    that asks for a restart, and the two parts of the Rayleigh quotient of A along the last change of y.

    `bodies` is what accelerating bodies take away from D a.
    """
    i = first + wp.tid()
    s = wp.float32(0.0)
    at = i * row
    for _k in range(count[i]):
        w = near[at]
        s += wp.dot(a[neighbour(w)], toward(w))
        at += stride
    r = b[i] + wp.dot(a[i], lean[i]) - bodies[i] - unit * s
    old = p[i]
    was = y[i]
    fresh = wp.float32(0.0)
    if stiffness[i] > 0.0:
        fresh = wp.max(was + settings[OMEGA] * r / stiffness[i], 0.0)
    p[i] = fresh
    y[i] = fresh + settings[BETA] * (fresh - old)
    left = wp.max(r, 0.0)
    if was > 0.0:
        left = wp.abs(r)
    change = was - last_y[i]
    weight = volume[i] * stiffness[i]
    sums[i] = Sums(
        wp.max(r, 0.0),
        left,
        weight * (was - fresh) * (fresh - old),
        volume[i] * change * (last_r[i] - r),
        weight * change * change,
    )
    last_y[i] = was
    last_r[i] = r


@wp.kernel
def end(
    first: wp.int32,
    a: wp.array(dtype=wp.vec3),
    settings: wp.array(dtype=wp.float32),
    v: wp.array(dtype=wp.vec3),
):
    """Velocity after the pressure of the solve."""
    i = first + wp.tid()
    v[i] = v[i] + settings[DT] * a[i]


@wp.kernel
def shift(
    first: wp.int32,
    v: wp.array(dtype=wp.vec3),
    a: wp.array(dtype=wp.vec3),
    settings: wp.array(dtype=wp.float32),
    way: wp.array(dtype=wp.vec3),
):
    """Velocity of travel: a particle's own, and what the second solve asks of its place."""
    i = first + wp.tid()
    way[i] = v[i] + settings[DT] * a[i]


@wp.kernel
def asked(
    first: wp.int32,
    span: wp.int32,
    width: wp.int32,
    total: wp.int32,
    b: wp.array(dtype=wp.float32),
    partial: wp.array(dtype=Totals),
):
    """Sum of the compression that a solve is to take away."""
    t = first + wp.tid()
    start = (t / width) * span * width + t % width
    sums = Totals()
    for i in range(start, wp.min(start + span * width, total), width):
        sums += Totals(wp.float64(wp.max(b[i], 0.0)), wp.float64(0.0), wp.float64(0.0), wp.float64(0.0), wp.float64(0.0))
    wp.tile_store(partial, wp.tile_sum(wp.tile(sums, preserve_type=True)), offset=t / width)


@wp.kernel
def gather(
    first: wp.int32,
    span: wp.int32,
    width: wp.int32,
    total: wp.int32,
    values: wp.array(dtype=Sums),
    partial: wp.array(dtype=Totals),
):
    """Sums of an iteration, by blocks."""
    t = first + wp.tid()
    start = (t / width) * span * width + t % width
    sums = Totals()
    for i in range(start, wp.min(start + span * width, total), width):
        v = values[i]
        sums += Totals(wp.float64(v[0]), wp.float64(v[1]), wp.float64(v[2]), wp.float64(v[3]), wp.float64(v[4]))
    wp.tile_store(partial, wp.tile_sum(wp.tile(sums, preserve_type=True)), offset=t / width)


@wp.kernel
def judge(
    first: wp.int32,
    width: wp.int32,
    parts: wp.int32,
    partial: wp.array(dtype=Totals),
    settings: wp.array(dtype=wp.float32),
    before: wp.int32,
    going: wp.array(dtype=wp.int32),
):
    """Mean compression that is left, whether to go on, and the momentum of the next accelerated step (Nesterov, with restarts).

    `before` 1: no step has been made, and the sum is what the solve is asked to take away.
    """
    t = first + wp.tid()
    mine = Totals()
    for k in range(t, parts, width):
        mine += partial[k]
    s = wp.tile_sum(wp.tile(mine, preserve_type=True))[0]
    if t > 0:
        return
    dt = settings[DT]
    scale = dt * dt / settings[COUNT]
    if before != 0:
        settings[ASKED] = wp.float32(s[0]) * scale
        settings[FRESH] = 1.0
        going[0] = 1
        return
    error = wp.float32(s[0]) * scale
    left = wp.float32(s[1]) * scale
    settings[ERROR] = error
    settings[OPEN] = left
    settings[DONE] = settings[DONE] + 1.0
    settings[MET] = 0.0
    if error <= settings[TOLERANCE] and left <= wp.max(RESIDUAL * settings[ASKED], SMALL * settings[TOLERANCE]):
        settings[MET] = 1.0
    if settings[MET] == 1.0 or settings[DONE] >= settings[MOST] or not wp.isfinite(error):
        going[0] = 0
    t0 = settings[NESTEROV]
    if s[2] > wp.float64(0.0):
        t0 = 1.0
    if settings[FRESH] == 0.0 and s[4] > wp.float64(0.0):
        steepest = wp.float32(s[3] / s[4])
        if settings[OMEGA] * steepest > 1.0:
            settings[OMEGA] = 0.95 / steepest
            t0 = 1.0
    settings[FRESH] = 0.0
    t1 = 0.5 * (1.0 + wp.sqrt(1.0 + 4.0 * t0 * t0))
    settings[BETA] = (t0 - 1.0) / t1
    settings[NESTEROV] = t1


for _kind in KINDS:
    for _kernel in (rates, accelerate, relax):
        wp.overload(_kernel, {"near": wp.array(dtype=_kind)})
