# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Solids and liquid on faces: velocities that walls prescribe, friction, openings of inflows and outflows.

Lengths are in cells. Owners are rows of boundaries, then of inflows; -1 is the domain.
"""

import warp as wp

from ...grids.columns import Columns, place_of, vec6i
from .cut_kernels import value_at
from .distance_kernels import FAR, Walls, wall_speed

wp.set_module_options({"enable_backward": False, "max_unroll": 3})

__all__ = ["constrain", "face_center", "open_mouths", "rub", "take_out"]

LEAST = wp.constant(0.02)
"""As `grid_kernels.LEAST_OPEN`."""


@wp.func
def face_center(at: wp.vec3i, axis: int):
    """Centre of a cell's lower face."""
    x = wp.vec3(float(at[0]) + 0.5, float(at[1]) + 0.5, float(at[2]) + 0.5)
    x[axis] = x[axis] - 0.5
    return x


@wp.kernel
def open_mouths(
    first: wp.int32, grid: Columns, count: int, base: int, center: wp.array(dtype=wp.vec3), rotation: wp.array(dtype=wp.mat33),
    half: wp.array(dtype=wp.vec3), near: wp.array(dtype=vec6i), lower: wp.vec3, upper: wp.vec3, solids: int,
    solid: wp.array(dtype=float), opening: wp.array(dtype=wp.vec3), face_owner: wp.array(dtype=wp.vec3i),
):  # fmt: skip
    """Faces in the opening of an inflow have its speed, those of the domain's closed sides too where no solid is behind them.

    The third component of `half` is 1 for a disc, -1 for one that is shut.
    """
    c = first + wp.tid()
    at = place_of(grid, c)
    share = opening[c]
    who = face_owner[c]
    for axis in range(3):
        x = face_center(at, axis)
        free = share[axis] > LEAST
        k = float(at[axis])
        inner = int(-1)
        if k <= lower[axis] and k + 1.0 > lower[axis]:
            inner = c
        elif k >= upper[axis] and k - 1.0 < upper[axis]:
            inner = near[c][2 * axis]
        if inner >= 0:
            free = solids == 0
            if solids == 1:
                free = solid[inner] >= 0.0
        for m in range(count):
            h = half[m]
            if h[2] >= 0.0:
                y = wp.transpose(rotation[m]) * (x - center[m])
                inside = wp.abs(y[0]) <= h[0] and wp.abs(y[1]) <= h[1]
                if h[2] > 0.5:
                    inside = (y[0] / h[0]) * (y[0] / h[0]) + (y[1] / h[1]) * (y[1] / h[1]) <= 1.0
                if inside and y[2] >= -1.0 and y[2] <= 0.51 and free:
                    share[axis] = 0.0
                    who[axis] = base + m
    opening[c] = share
    face_owner[c] = who


@wp.kernel
def constrain(
    first: wp.int32, grid: Columns, near: wp.array(dtype=vec6i), lower: wp.vec3, upper: wp.vec3, sides: vec6i, solids: int,
    solid: wp.array(dtype=float), opening: wp.array(dtype=wp.vec3), face_owner: wp.array(dtype=wp.vec3i), walls: Walls,
    was: wp.array(dtype=wp.vec3), ratio: float, thick: int, friction: wp.array(dtype=float),
    now: wp.array(dtype=wp.vec3), drift: wp.array(dtype=wp.vec3),
    now_out: wp.array(dtype=wp.vec3), drift_out: wp.array(dtype=wp.vec3), given: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Closed faces: what moves into the solid is taken away, what slips along it stays; `thick` liquid sticks by the wall's friction.

    `given` is what a face gives to particles beside their own velocity: now - ratio was.
    """
    c = first + wp.tid()
    at = place_of(grid, c)
    u = now[c]
    d = drift[c]
    for axis in range(3):
        k = float(at[axis])
        if (k <= lower[axis] and sides[2 * axis] == 0) or (k >= upper[axis] and sides[2 * axis + 1] == 0):
            u[axis] = 0.0
            d[axis] = 0.0
            if face_owner[c][axis] >= 0:
                u[axis] = wall_speed(walls, face_owner[c][axis], face_center(at, axis))[axis]
                d[axis] = u[axis]
        elif solids == 1 and opening[c][axis] < LEAST and near[c][2 * axis] >= 0:
            o = near[c][2 * axis]
            normal = wp.vec3()
            v = wp.vec3()
            e = wp.vec3()
            for b in range(3):
                if b == axis:
                    normal[b] = solid[c] - solid[o]
                    v[b] = now[c][b]
                    e[b] = drift[c][b]
                else:
                    low = near[c][2 * b]
                    high = near[c][2 * b + 1]
                    olow = near[o][2 * b]
                    ohigh = near[o][2 * b + 1]
                    normal[b] = 0.25 * (
                        value_at(solid, high) + value_at(solid, ohigh) - value_at(solid, low) - value_at(solid, olow)
                    )
                    count = float(2.0)
                    sv = now[c][b] + now[o][b]
                    se = drift[c][b] + drift[o][b]
                    if high >= 0:
                        sv += now[high][b]
                        se += drift[high][b]
                        count += 1.0
                    if ohigh >= 0:
                        sv += now[ohigh][b]
                        se += drift[ohigh][b]
                        count += 1.0
                    v[b] = sv / count
                    e[b] = se / count
            normal = wp.normalize(normal)
            w = wall_speed(walls, face_owner[c][axis], face_center(at, axis))
            u[axis] = v[axis] - wp.min(wp.dot(v - w, normal), 0.0) * normal[axis]
            d[axis] = e[axis] - wp.min(wp.dot(e - w, normal), 0.0) * normal[axis]
            if thick == 1 and face_owner[c][axis] >= 0:
                depth = wp.clamp(-0.5 * (solid[c] + solid[o]), 0.0, 0.5)
                stick = friction[face_owner[c][axis]] / (1.0 - depth)
                u[axis] = u[axis] + stick * (w[axis] - u[axis])
                d[axis] = d[axis] + stick * (w[axis] - d[axis])
    now_out[c] = u
    drift_out[c] = d
    given[c] = u - ratio * was[c]


@wp.kernel
def rub(
    first: wp.int32, grid: Columns, near: wp.array(dtype=vec6i), lower: wp.vec3, upper: wp.vec3, sides: vec6i, solids: int,
    solid: wp.array(dtype=float), rate: float, now: wp.array(dtype=wp.vec3), now_out: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Friction of walls on the cells beside them, implicit: u / (1 + rate |u|)."""
    c = first + wp.tid()
    at = place_of(grid, c)
    u = now[c]
    v = u
    for axis in range(3):
        o = near[c][2 * axis]
        x = face_center(at, axis)
        d = float(FAR)
        if solids == 1:
            d = solid[c]
            if o >= 0:
                d = 0.5 * (d + solid[o])
        for side in range(3):
            if side != axis:
                if sides[2 * side] == 0:
                    d = wp.min(d, x[side] - lower[side])
                if sides[2 * side + 1] == 0:
                    d = wp.min(d, upper[side] - x[side])
        if d > 0.0 and d < 1.0:
            speed = wp.length(u)
            if o >= 0:
                speed = 0.5 * (speed + wp.length(now[o]))
            v[axis] = u[axis] / (1.0 + rate * speed)
    now_out[c] = v


@wp.kernel
def take_out(
    first: wp.int32, count: int, center: wp.array(dtype=wp.vec3), rotation: wp.array(dtype=wp.mat33), half: wp.array(dtype=wp.vec3),
    position: wp.array(dtype=wp.vec4), left: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Particles inside an outflow are marked with 2 + its number; they and those that left have no volume any more."""
    p = first + wp.tid()
    x = position[p]
    gone = left[p]
    for m in range(count):
        y = wp.transpose(rotation[m]) * (wp.vec3(x[0], x[1], x[2]) - center[m])
        if gone == 0 and wp.abs(y[0]) <= half[m][0] and wp.abs(y[1]) <= half[m][1] and wp.abs(y[2]) <= half[m][2]:
            gone = 2 + m
    left[p] = gone
    if gone > 0:
        position[p] = wp.vec4(x[0], x[1], x[2], 0.0)
