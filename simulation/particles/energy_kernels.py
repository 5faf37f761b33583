# mypy: ignore-errors
"""Warp kernels of the elastic energy that contacts hold: by their depths, and by the springs along and about them."""

import warp as wp

from .grain_kernels import INDEX, MET_BIT, State, kind_of, radius_of
from .law_kernels import Law
from .wall_kernels import SLOTS, Bodies, Pairs, point_of

wp.set_module_options({"enable_backward": False})

__all__ = ["grain_energy", "wall_energy"]

SLOT_COUNT = wp.constant(SLOTS)


@wp.func
def held(law: Law, depth: wp.float32, before: wp.float32, radius: wp.float32, spring: wp.vec3, roll: wp.vec3):
    """Energy of a contact by its depth, and of its springs by the depth `before`, at which they were set [J].

    That is the work against Hertz's force less that of the pull; and T^2 / 2 k, C^2 / 2 k. Where a contact slides, its spring also bears
    what the dashpot has beyond friction (`law_kernels.touch`); it can give back what friction lets it bear alone.
    """
    deep = 0.53333333 * law.young * wp.sqrt(radius * depth) * depth * depth - law.pull * radius * depth
    wound = wp.float32(0.0)
    if before > 0.0:
        a = wp.sqrt(radius * before)
        side = 8.0 * law.shear * a
        borne = wp.min(wp.length(spring), law.friction * 1.33333333 * law.young * a * before)
        wound = borne * borne / (2.0 * side)
        if law.rolling > 0.0:
            wound += wp.length_sq(roll) / (2.0 * side * radius * radius)
    return wp.vec2(deep, wound)


@wp.kernel
def grain_energy(
    first: wp.int32,
    state: State,
    count: wp.array(dtype=wp.int32),
    near: wp.array(dtype=wp.int32),
    spring: wp.array(dtype=wp.vec3),
    roll: wp.array(dtype=wp.vec3),
    row: wp.int32,
    stride: wp.int32,
    laws: wp.array2d(dtype=Law),
    unit: wp.float32,
    rolls: wp.int32,
    dt: wp.array(dtype=wp.float32),
    energy: wp.array2d(dtype=wp.float32),
):
    """Half of what the contacts of grain i with its neighbours hold, in the present places; springs were set a step ago."""
    i = first + wp.tid()
    pi = state.place[i]
    ri = radius_of(pi)
    mi = state.motion[i]
    ki = kind_of(mi)
    total = wp.vec2(0.0, 0.0)
    at = i * row
    for _k in range(count[i]):
        entry = near[at]
        j = entry & INDEX
        pj = state.place[j]
        rj = radius_of(pj)
        way = wp.vec3(wp.float32(pi[0] - pj[0]), wp.float32(pi[1] - pj[1]), wp.float32(pi[2] - pj[2])) * unit
        gap = wp.length(way)
        depth = ri + rj - gap
        if depth > 0.0:
            stored = wp.vec3(0.0, 0.0, 0.0)
            wound = wp.vec3(0.0, 0.0, 0.0)
            if entry >= MET_BIT:
                stored = spring[at]
                if rolls != 0:
                    wound = roll[at]
            mj = state.motion[j]
            parting = wp.dot(wp.vec3(mi[0] - mj[0], mi[1] - mj[1], mi[2] - mj[2]), way) / wp.max(gap, 1.0e-12)
            total += held(laws[ki, kind_of(mj)], depth, depth + parting * dt[0], ri * rj / (ri + rj), stored, wound)
        at += stride
    energy[i, 0] = 0.5 * total[0]
    energy[i, 1] = 0.5 * total[1]


@wp.kernel
def wall_energy(
    first: wp.int32,
    state: State,
    bodies: Bodies,
    pairs: Pairs,
    laws: wp.array2d(dtype=Law),
    unit: wp.float64,
    dt: wp.array(dtype=wp.float32),
    energy: wp.array2d(dtype=wp.float32),
):
    """Elastic energy of the contacts of a pair: their depths at the last step, and how they went on over it."""
    q = first + wp.tid()
    p = state.place[pairs.grain[q]]
    m = state.motion[pairs.grain[q]]
    b = pairs.body[q]
    law = laws[b, kind_of(m)]
    arm = point_of(p, unit) - bodies.center[b]
    there = bodies.velocity[b] + wp.cross(bodies.spin[b], arm)
    slip = wp.vec3(m[0] - wp.float32(there[0]), m[1] - wp.float32(there[1]), m[2] - wp.float32(there[2]))
    if bodies.soft[b] != 0:
        # How fast it gives way is a matter of its vertices.
        slip = wp.vec3(0.0, 0.0, 0.0)
    total = wp.vec2(0.0, 0.0)
    for k in range(SLOT_COUNT):
        before = pairs.depth[q, k]
        if before > 0.0:
            depth = before - wp.dot(slip, pairs.way[q, k]) * dt[0]
            if depth > 0.0:
                total += held(law, depth, before, radius_of(p), pairs.spring[q, k], pairs.roll[q, k])
    energy[q, 0] = total[0]
    energy[q, 1] = total[1]
