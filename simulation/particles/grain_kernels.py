# mypy: ignore-errors
"""Warp kernels of one step of the grains: contacts, motion, census. All gather: thread i writes only its own rows.

Places are whole numbers of `unit`, so that differences of places are exact wherever grains are; velocities and spins carry what a
single-precision number leaves over. The fourth number of a place holds the bits of the radius, that of a motion those of the kind.
"""

import warp as wp

from .law_kernels import Law, touch

wp.set_module_options({"enable_backward": False})

__all__ = ["MET", "Clock", "State", "census", "close_census", "forces", "integrate", "tick"]

MET = 1 << 30
"""Bit of a neighbour in a list that is in contact."""
MET_BIT = wp.constant(wp.int32(MET))
INDEX = wp.constant(wp.int32(MET - 1))


@wp.struct
class State:
    """State that a grain carries from step to step."""

    place: wp.array(dtype=wp.vec4i)
    left: wp.array(dtype=wp.vec3)
    """Remainder of the position that `place` does not hold, in its units."""
    motion: wp.array(dtype=wp.vec4)
    spin: wp.array(dtype=wp.vec3)
    rest: wp.array(dtype=wp.vec3)
    """Remainder of the velocity that `motion` does not hold [m/s]."""
    rest_spin: wp.array(dtype=wp.vec3)
    identity: wp.array(dtype=wp.int32)
    start: wp.array(dtype=wp.vec4i)
    """Place when the lists were made."""
    air: wp.array(dtype=wp.vec4)
    """Velocity of the medium [m/s] and rate of its drag [1/s]."""
    pull: wp.array(dtype=wp.vec3)
    """Acceleration by fields [m/s^2]."""
    blown: wp.array(dtype=wp.vec3)
    """Impulse of fields per mass since the exchange began [m/s]."""


@wp.struct
class Clock:
    """Counters that steer the steps; on the device, so that steps queue up."""

    stop: wp.int32
    """Not 0: steps do nothing until the lists are made anew."""
    done: wp.int32
    """Steps since it was set."""
    travel: wp.float32
    """Greatest way since the lists were made, squared [m^2]."""
    speed: wp.float32
    """Greatest speed, squared [m^2/s^2]."""
    wrong: wp.int32
    """Place of a grain without finite velocity, or -1."""


@wp.func
def radius_of(place: wp.vec4i):
    """Radius [m]."""
    return wp.cast(place[3], wp.float32)


@wp.func
def kind_of(motion: wp.vec4):
    """Row among the kinds."""
    return wp.cast(motion[3], wp.int32)


@wp.func
def mass_of(radius: wp.float32, density: wp.float32):
    """Mass of a sphere [kg]."""
    return 4.1887902 * density * radius * radius * radius


@wp.kernel
def forces(
    first: wp.int32,
    state: State,
    count: wp.array(dtype=wp.int32),
    near: wp.array(dtype=wp.int32),
    spring: wp.array(dtype=wp.vec3),
    roll: wp.array(dtype=wp.vec3),
    row: wp.int32,
    stride: wp.int32,
    laws: wp.array2d(dtype=Law),
    density: wp.array(dtype=wp.float32),
    unit: wp.float32,
    dt: wp.array(dtype=wp.float32),
    clock: wp.array(dtype=Clock),
    rolls: wp.int32,
    force: wp.array(dtype=wp.vec3d),
    torque: wp.array(dtype=wp.vec3d),
):
    """Sum the contacts of grain i with its neighbours. Both grains of a pair reckon the same numbers, the one with the lower index first."""
    i = first + wp.tid()
    if clock[0].stop != 0:
        return
    pi = state.place[i]
    mi = state.motion[i]
    wi = state.spin[i]
    ri = radius_of(pi)
    ki = kind_of(mi)
    massi = mass_of(ri, density[ki])
    vi = wp.vec3(mi[0], mi[1], mi[2])
    f = wp.vec3d()
    t = wp.vec3d()
    step = dt[0]
    at = i * row
    for _k in range(count[i]):
        entry = near[at]
        j = entry & INDEX
        pj = state.place[j]
        rj = radius_of(pj)
        way = wp.vec3(wp.float32(pi[0] - pj[0]), wp.float32(pi[1] - pj[1]), wp.float32(pi[2] - pj[2])) * unit
        reach = ri + rj
        square = wp.length_sq(way)
        if square < reach * reach and square > 0.0:
            mj = state.motion[j]
            wj = state.spin[j]
            vj = wp.vec3(mj[0], mj[1], mj[2])
            massj = mass_of(rj, density[kind_of(mj)])
            law = laws[ki, kind_of(mj)]
            sign = wp.float32(1.0)
            if i > j:
                sign = -1.0
            d = wp.sqrt(square)
            n = way * (sign / d)
            slip = (vi - vj) * sign
            lever = ri * wi + rj * wj
            if i > j:
                lever = rj * wj + ri * wi
            slip = slip - wp.cross(lever, n)
            turn = (wi - wj) * sign
            stored = wp.vec3(0.0, 0.0, 0.0)
            wound = wp.vec3(0.0, 0.0, 0.0)
            if entry >= MET_BIT:
                stored = spring[at] * sign
                if rolls != 0:
                    wound = roll[at] * sign
            else:
                near[at] = entry | MET_BIT
            one = touch(law, n, reach - d, ri * rj / reach, massi * massj / (massi + massj), slip, turn, stored, wound, step)
            spring[at] = one.spring * sign
            if rolls != 0:
                roll[at] = one.roll * sign
            f += wp.vec3d(wp.float64(sign * one.force[0]), wp.float64(sign * one.force[1]), wp.float64(sign * one.force[2]))
            # Both levers point along n, so that the couple of the tangential force is the same way round on both.
            c = wp.cross(n, one.force) * (-ri) + one.couple * sign
            t += wp.vec3d(wp.float64(c[0]), wp.float64(c[1]), wp.float64(c[2]))
        elif entry >= MET_BIT:
            near[at] = j
        at += stride
    force[i] = f
    torque[i] = t


@wp.func
def double(v: wp.vec3):
    """A vector in double precision."""
    return wp.vec3d(wp.float64(v[0]), wp.float64(v[1]), wp.float64(v[2]))


@wp.func
def single(v: wp.vec3d):
    """A vector in single precision."""
    return wp.vec3(wp.float32(v[0]), wp.float32(v[1]), wp.float32(v[2]))


@wp.kernel
def integrate(
    first: wp.int32,
    state: State,
    force: wp.array(dtype=wp.vec3d),
    torque: wp.array(dtype=wp.vec3d),
    wall_first: wp.array(dtype=wp.int32),
    wall_count: wp.array(dtype=wp.int32),
    wall_at: wp.array(dtype=wp.int32),
    wall_force: wp.array(dtype=wp.vec3d),
    wall_torque: wp.array(dtype=wp.vec3d),
    density: wp.array(dtype=wp.float32),
    gravity: wp.vec3d,
    unit: wp.float32,
    dt: wp.array(dtype=wp.float32),
    clock: wp.array(dtype=Clock),
    blows: wp.int32,
):
    """Move grain i: velocities first, then places (leapfrog)."""
    i = first + wp.tid()
    if clock[0].stop != 0:
        return
    p = state.place[i]
    m = state.motion[i]
    r = radius_of(p)
    big = wp.float64(r)
    mass = wp.float64(4.18879020478639) * wp.float64(density[kind_of(m)]) * big * big * big
    f = force[i]
    t = torque[i]
    begin = wall_first[i]
    for k in range(wall_count[i]):
        at = wall_at[begin + k]
        f += wall_force[at]
        t += wall_torque[at]
    h = wp.float64(dt[0])
    v = wp.vec3d(wp.float64(m[0]), wp.float64(m[1]), wp.float64(m[2])) + double(state.rest[i])
    v += (f / mass + gravity) * h
    if blows != 0:
        wind = state.air[i]
        rate = wp.float64(wind[3]) * h
        was = v
        v += double(state.pull[i]) * h
        v = (v + rate * wp.vec3d(wp.float64(wind[0]), wp.float64(wind[1]), wp.float64(wind[2]))) / (wp.float64(1.0) + rate)
        state.blown[i] = state.blown[i] + single(v - was)
    w = double(state.spin[i]) + double(state.rest_spin[i])
    w += t * (h / (wp.float64(0.4) * mass * big * big))
    sv = single(v)
    sw = single(w)
    state.rest[i] = single(v - double(sv))
    state.rest_spin[i] = single(w - double(sw))
    state.motion[i] = wp.vec4(sv[0], sv[1], sv[2], m[3])
    state.spin[i] = sw
    way = double(state.left[i]) + v * (h / wp.float64(unit))
    x = wp.floor(way[0] + wp.float64(0.5))
    y = wp.floor(way[1] + wp.float64(0.5))
    z = wp.floor(way[2] + wp.float64(0.5))
    state.left[i] = single(way - wp.vec3d(x, y, z))
    state.place[i] = wp.vec4i(p[0] + wp.int32(x), p[1] + wp.int32(y), p[2] + wp.int32(z), p[3])


@wp.kernel
def census(
    first: wp.int32,
    span: wp.int32,
    width: wp.int32,
    total: wp.int32,
    state: State,
    unit: wp.float32,
    clock: wp.array(dtype=Clock),
    partial: wp.array2d(dtype=wp.float32),
):
    """Greatest way since the lists were made, greatest speed, and one more than the place of a grain that is not finite."""
    t = first + wp.tid()
    start = (t / width) * span * width + t % width
    travel = wp.float32(0.0)
    speed = wp.float32(0.0)
    wrong = wp.float32(0.0)
    if clock[0].stop == 0:
        for i in range(start, wp.min(start + span * width, total), width):
            p = state.place[i]
            q = state.start[i]
            way = wp.vec3(wp.float32(p[0] - q[0]), wp.float32(p[1] - q[1]), wp.float32(p[2] - q[2])) * unit
            travel = wp.max(travel, wp.length_sq(way))
            m = state.motion[i]
            square = m[0] * m[0] + m[1] * m[1] + m[2] * m[2]
            if not wp.isfinite(square):
                wrong = wp.float32(i + 1)
            else:
                speed = wp.max(speed, square)
    wp.tile_store(partial[0], wp.tile_max(wp.tile(travel)), offset=t / width)
    wp.tile_store(partial[1], wp.tile_max(wp.tile(speed)), offset=t / width)
    wp.tile_store(partial[2], wp.tile_max(wp.tile(wrong)), offset=t / width)


@wp.kernel
def close_census(
    first: wp.int32, width: wp.int32, parts: wp.int32, partial: wp.array2d(dtype=wp.float32), result: wp.array(dtype=wp.float32)
):
    """The same of all blocks."""
    t = first + wp.tid()
    for c in range(3):
        s = wp.float32(0.0)
        for k in range(t, parts, width):
            s = wp.max(s, partial[c, k])
        wp.tile_store(result, wp.tile_max(wp.tile(s)), offset=c)


@wp.kernel
def tick(
    first: wp.int32,
    result: wp.array(dtype=wp.float32),
    drift: wp.array(dtype=wp.float32),
    most: wp.float32,
    clock: wp.array(dtype=Clock),
):
    """Count the step; stop all further ones where lists are used up. `drift` is the greatest way of bodies, squared."""
    if first + wp.tid() > 0 or clock[0].stop != 0:
        return
    now = clock[0]
    now.done += 1
    now.travel = wp.max(result[0], drift[0])
    now.speed = wp.max(now.speed, result[1])
    now.wrong = wp.int32(result[2]) - 1
    if now.travel > most or result[2] > 0.0:
        now.stop = 1
    clock[0] = now
