# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Momentum between faces of cells and what a gas carries: weights, loads, velocities as both give way, what each face gets.

An item lies between the middles of eight cells, the lower of which is its `base`, a share `way` of a cell beyond that one's middle. A velocity at
the middle of a cell is the mean of those at its two faces, so that along each axis an item meets 3 x 2 x 2 faces. A face counts by its
`part`: its open share of a cell, 0 where it is closed; what an item gives to the faces of an axis sums up to all of it. Each face gathers from
the items of the cells about it, in their order, so that sums are the same however they are shared among threads.
"""

import warp as wp

from .box_kernels import Box, beside, count_of, has_face, index_of, is_cell, place_of, upper

wp.set_module_options({"enable_backward": False})

__all__ = ["Items", "Span", "ahead", "face_masses", "give", "loads", "look", "meet", "norms", "shares", "spread", "unfold"]


@wp.struct
class Span:
    """Elements from `low` on, `size` along each axis, that hold all faces about some items; the whole of a periodic axis."""

    low: wp.vec3i
    size: wp.vec3i


@wp.struct
class Items:
    """Items that meet a gas, sorted by base; those of cell c of the span are `starts[c]` to `starts[c + 1]`."""

    base: wp.array(dtype=wp.vec3i)
    way: wp.array(dtype=wp.vec3d)
    velocity: wp.array(dtype=wp.vec3d)
    mass: wp.array(dtype=wp.float64)
    share: wp.array(dtype=wp.float64)
    """Share of its velocity past the gas that drag takes in the time asked about."""
    inverse: wp.array(dtype=wp.vec3d)
    """One over the sum of its weights."""
    bound: wp.array(dtype=wp.vec3d)
    """Mass that the gas feels in the mean over that time [kg]."""
    starts: wp.array(dtype=wp.int32)


@wp.func
def weight(axis: int, ox: int, oy: int, oz: int, way: wp.vec3d):
    """Weight of a face some cells beyond an item's base in the velocity along its axis that the item meets."""
    found = wp.float64(1.0)
    for a in range(3):
        o = ox
        if a == 1:
            o = oy
        if a == 2:
            o = oz
        w = way[a]
        one = wp.float64(1.0) - w
        if a == axis:
            half = wp.float64(0.5)
            if o == 0:
                found = found * half * one
            elif o == 1:
                found = found * half
            else:
                found = found * half * w
        elif o == 0:
            found = found * one
        else:
            found = found * w
    return found


@wp.func
def many_along(axis: int, a: int):
    """Faces of an axis about an item along another."""
    return wp.where(a == axis, 3, 2)


@wp.func
def local_of(box: Box, span: Span, at: wp.vec3i):
    """Index of an element in a span; -1 outside it. Elements of a periodic axis repeat."""
    found = int(0)
    for a in range(3):
        x = at[a]
        if box.wraps[a] == 1:
            n = count_of(box, a)
            x = (x + n) % n
        x = x - span.low[a]
        if x < 0 or x >= span.size[a]:
            return -1
        found = found * span.size[a] + x
    return found


@wp.func
def in_span(span: Span, t: int):
    """Place of an element of a span in the box."""
    layer = span.size[1] * span.size[2]
    i = t // layer
    rest = t - i * layer
    j = rest // span.size[2]
    return span.low + wp.vec3i(i, j, rest - j * span.size[2])


@wp.func
def element_of(box: Box, at: wp.vec3i):
    """Index of an element in the box; -1 beyond it. Elements of a periodic axis repeat."""
    to = at
    for a in range(3):
        n = count_of(box, a)
        if box.wraps[a] == 1:
            to[a] = (at[a] + n) % n
        elif at[a] < 0 or at[a] > n:
            return -1
    return index_of(box, to[0], to[1], to[2])


@wp.kernel
def face_masses(
    first: wp.int32, box: Box, volume: wp.float64, air: wp.float64, expands: int, density: wp.array(dtype=float),
    room: wp.array(dtype=float), opening: wp.array(dtype=wp.vec3), mass: wp.array(dtype=wp.vec3d), part: wp.array(dtype=wp.vec3d),
):  # fmt: skip
    """Mass of gas that moves with each face [kg], half that of both its cells, and its part of a cell."""
    c = first + wp.tid()
    at = place_of(box, c)
    m = wp.vec3d()
    p = wp.vec3d()
    for axis in range(3):
        if has_face(box, at, axis) and opening[c][axis] > 0.0:
            for side in range(2):
                cell = wp.where(side == 0, c, -1)
                if side == 1:
                    cell = beside(box, at, axis, -1)
                elif not is_cell(box, at):
                    cell = -1
                if cell >= 0:
                    open_part = wp.float64(0.5) * wp.float64(room[cell])
                    rho = wp.float64(1.0)
                    if expands == 1:
                        rho = wp.float64(density[cell])
                    p[axis] = p[axis] + open_part
                    m[axis] = m[axis] + open_part * rho * volume * air
    mass[c] = m
    part[c] = p


@wp.kernel
def look(
    first: wp.int32, box: Box, base: wp.array(dtype=wp.vec3i), way: wp.array(dtype=wp.vec3d), velocity: wp.array(dtype=wp.vec3),
    kick: wp.array(dtype=wp.vec3d), ease: wp.array(dtype=wp.vec3d), since: wp.float64, warmth: wp.array(dtype=float), state: wp.array(dtype=wp.vec4),
    flow: wp.array(dtype=wp.vec3d), held: wp.array(dtype=wp.vec2d),
):  # fmt: skip
    """Velocity of the gas at items [m/s], straight between the middles of cells, with its temperature [K] and soot [kg/m^3]."""
    i = first + wp.tid()
    v = wp.vec3d()
    h = wp.vec2d()
    for o in range(8):
        to = base[i] + wp.vec3i(o // 4, (o // 2) % 2, o % 2)
        w = wp.float64(1.0)
        for a in range(3):
            if to[a] == base[i][a]:
                w = w * (wp.float64(1.0) - way[i][a])
            else:
                w = w * way[i][a]
        c = element_of(box, to)
        if w > wp.float64(0.0) and c >= 0:
            here = place_of(box, c)
            for a in range(3):
                u = upper(box, here, a)
                both = wp.float64(velocity[c][a]) + kick[c][a] + wp.float64(velocity[u][a]) + kick[u][a]
                both = both + since * (ease[c][a] + ease[u][a])
                v[a] = v[a] + wp.float64(0.5) * w * both
            h = h + w * wp.vec2d(wp.float64(warmth[c]), wp.float64(state[c][1]))
    flow[i] = v
    held[i] = h


@wp.kernel
def norms(first: wp.int32, box: Box, items: Items, part: wp.array(dtype=wp.vec3d)):
    """One over the sum of the weights of each item's open faces; 0 of one that meets none."""
    i = first + wp.tid()
    found = wp.vec3d()
    for axis in range(3):
        for ox in range(many_along(axis, 0)):
            for oy in range(many_along(axis, 1)):
                for oz in range(many_along(axis, 2)):
                    c = element_of(box, items.base[i] + wp.vec3i(ox, oy, oz))
                    if c >= 0:
                        found[axis] = found[axis] + weight(axis, ox, oy, oz, items.way[i]) * part[c][axis]
        if found[axis] > wp.float64(0.0):
            found[axis] = wp.float64(1.0) / found[axis]
    items.inverse[i] = found


@wp.kernel
def loads(
    first: wp.int32, box: Box, span: Span, items: Items, rate: wp.array(dtype=wp.float64), mass: wp.array(dtype=wp.vec3d),
    part: wp.array(dtype=wp.vec3d), load: wp.array(dtype=wp.vec3d), stiff: wp.array(dtype=wp.float64),
):  # fmt: skip
    """Mass of items over that of the gas of each face [1], and the rate at which they would stop it if they stood [1/s]."""
    t = first + wp.tid()
    at = in_span(span, t)
    c = element_of(box, at)
    found = wp.vec3d()
    most = wp.float64(0.0)
    for axis in range(3):
        stop = wp.float64(0.0)
        if c >= 0 and part[c][axis] > wp.float64(0.0):
            for ox in range(many_along(axis, 0)):
                for oy in range(many_along(axis, 1)):
                    for oz in range(many_along(axis, 2)):
                        b = local_of(box, span, at - wp.vec3i(ox, oy, oz))
                        if b >= 0:
                            for i in range(items.starts[b], items.starts[b + 1]):
                                w = weight(axis, ox, oy, oz, items.way[i]) * items.inverse[i][axis] * items.mass[i]
                                found[axis] = found[axis] + w
                                stop = stop + w * rate[i]
            over = part[c][axis] / mass[c][axis]
            found[axis] = found[axis] * over
            most = wp.max(most, stop * over)
    load[t] = found
    stiff[t] = most


@wp.func
def answering(share: wp.float64, load: wp.float64):
    """Share of its mass with which an item moves a gas in the mean over a time in which drag takes `share` of its velocity past a gas that
    would not give way, where the items of a place weigh `load` times its gas: so that both come as close as two fluids do,
    whose velocity past each other decays at (1 + load) times the rate."""
    one = wp.float64(1.0)
    if share <= wp.float64(0.0):
        return wp.float64(0.0)
    bound = wp.min(share, one - wp.float64(1.0e-12))
    rate = -wp.log(one - bound)
    if bound < wp.float64(1.0e-5):
        rate = bound + wp.float64(0.5) * bound * bound
    if load * bound < wp.float64(1.0e-6):
        if bound < wp.float64(1.0e-4):
            return wp.float64(0.5) * bound
        return one - (one - bound) * rate / bound
    kept = one - wp.exp(-rate * (one + load))
    x = rate * (one + load)
    if x < wp.float64(1.0e-5):
        kept = x - wp.float64(0.5) * x * x
    return ((one + load) * bound / kept - one) / load


@wp.kernel
def shares(first: wp.int32, box: Box, span: Span, items: Items, load: wp.array(dtype=wp.vec3d)):
    """Mass with which each item moves the gas in the mean; by the most loaded of its faces, so that none overshoots."""
    i = first + wp.tid()
    found = wp.vec3d()
    for axis in range(3):
        most = wp.float64(0.0)
        for ox in range(many_along(axis, 0)):
            for oy in range(many_along(axis, 1)):
                for oz in range(many_along(axis, 2)):
                    t = local_of(box, span, items.base[i] + wp.vec3i(ox, oy, oz))
                    if t >= 0 and weight(axis, ox, oy, oz, items.way[i]) > wp.float64(0.0):
                        most = wp.max(most, load[t][axis])
        found[axis] = items.mass[i] * answering(items.share[i], most)
    items.bound[i] = found


@wp.kernel
def ahead(
    first: wp.int32, box: Box, span: Span, items: Items, mass: wp.array(dtype=wp.vec3d), part: wp.array(dtype=wp.vec3d),
    velocity: wp.array(dtype=wp.vec3), kick: wp.array(dtype=wp.vec3d), ease: wp.array(dtype=wp.vec3d), since: wp.float64, half: wp.float64,
    mean: wp.array(dtype=wp.vec3d), change: wp.array(dtype=wp.vec3d),
):  # fmt: skip
    """Mean velocity of the gas at faces while drag goes on for twice `half` [s], and how far that is from the present one [m/s]."""
    t = first + wp.tid()
    at = in_span(span, t)
    c = element_of(box, at)
    m = wp.vec3d()
    d = wp.vec3d()
    for axis in range(3):
        if c >= 0:
            rest = half * ease[c][axis]
            now = wp.float64(velocity[c][axis]) + kick[c][axis] + since * ease[c][axis] + rest
            m[axis] = now
            d[axis] = rest
            if part[c][axis] > wp.float64(0.0):
                felt = wp.float64(0.0)
                push = wp.float64(0.0)
                for ox in range(many_along(axis, 0)):
                    for oy in range(many_along(axis, 1)):
                        for oz in range(many_along(axis, 2)):
                            b = local_of(box, span, at - wp.vec3i(ox, oy, oz))
                            if b >= 0:
                                for i in range(items.starts[b], items.starts[b + 1]):
                                    w = weight(axis, ox, oy, oz, items.way[i]) * items.inverse[i][axis] * items.bound[i][axis]
                                    felt = felt + w
                                    push = push + w * (items.velocity[i][axis] - now)
                felt = felt * part[c][axis]
                push = push * part[c][axis]
                yielded = push / (mass[c][axis] + felt)
                d[axis] = rest + yielded
                m[axis] = now + yielded
    mean[t] = m
    change[t] = d


@wp.kernel
def meet(
    first: wp.int32, box: Box, span: Span, items: Items, part: wp.array(dtype=wp.vec3d), mean: wp.array(dtype=wp.vec3d),
    change: wp.array(dtype=wp.vec3d), seen: wp.array(dtype=wp.vec3d), changed: wp.array(dtype=wp.vec3d),
):  # fmt: skip
    """Means of a velocity, and of its change, over the faces of each item."""
    i = first + wp.tid()
    s = wp.vec3d()
    d = wp.vec3d()
    for axis in range(3):
        for ox in range(many_along(axis, 0)):
            for oy in range(many_along(axis, 1)):
                for oz in range(many_along(axis, 2)):
                    at = items.base[i] + wp.vec3i(ox, oy, oz)
                    t = local_of(box, span, at)
                    c = element_of(box, at)
                    if t >= 0 and c >= 0:
                        w = weight(axis, ox, oy, oz, items.way[i]) * items.inverse[i][axis] * part[c][axis]
                        s[axis] = s[axis] + w * mean[t][axis]
                        d[axis] = d[axis] + w * change[t][axis]
    seen[i] = s
    changed[i] = d


@wp.kernel
def spread(
    first: wp.int32, box: Box, span: Span, items: Items, mass: wp.array(dtype=wp.vec3d), part: wp.array(dtype=wp.vec3d),
    mean: wp.array(dtype=wp.vec3d), rest: wp.array(dtype=wp.vec3d), sign: wp.float64, kick: wp.array(dtype=wp.vec3d),
):  # fmt: skip
    """Add what items give to faces (-1: take it back): of each pair what was foreseen, by its velocities, and of the `rest` [N s] a part by weight."""
    t = first + wp.tid()
    at = in_span(span, t)
    c = element_of(box, at)
    if c >= 0:
        k = kick[c]
        for axis in range(3):
            if part[c][axis] > wp.float64(0.0):
                total = wp.float64(0.0)
                for ox in range(many_along(axis, 0)):
                    for oy in range(many_along(axis, 1)):
                        for oz in range(many_along(axis, 2)):
                            b = local_of(box, span, at - wp.vec3i(ox, oy, oz))
                            if b >= 0:
                                for i in range(items.starts[b], items.starts[b + 1]):
                                    w = weight(axis, ox, oy, oz, items.way[i]) * items.inverse[i][axis]
                                    past = items.velocity[i][axis] - mean[t][axis]
                                    total = total + w * (items.mass[i] * items.share[i] * past + rest[i][axis])
                k[axis] = k[axis] + sign * total * part[c][axis] / mass[c][axis]
        kick[c] = k


@wp.kernel
def give(
    first: wp.int32, portion: wp.float64, mass: wp.array(dtype=wp.vec3d), kick: wp.array(dtype=wp.vec3d),
    velocity: wp.array(dtype=wp.vec3), given: wp.array(dtype=wp.vec3d), taken: wp.array(dtype=wp.vec3d),
):  # fmt: skip
    """Add a portion of the changes of velocity that faces have to get; what single precision does not take stays, and momentum is counted by
    what the velocity changed [N s]."""
    c = first + wp.tid()
    k = kick[c]
    if k[0] != wp.float64(0.0) or k[1] != wp.float64(0.0) or k[2] != wp.float64(0.0):
        was = velocity[c]
        now = was
        m = given[c]
        all_taken = taken[c]
        for axis in range(3):
            now[axis] = wp.float32(wp.float64(was[axis]) + portion * k[axis])
            got = wp.float64(now[axis]) - wp.float64(was[axis])
            k[axis] = k[axis] - got
            m[axis] = m[axis] + mass[c][axis] * got
            all_taken[axis] = all_taken[axis] + got
        velocity[c] = now
        kick[c] = k
        given[c] = m
        taken[c] = all_taken


@wp.kernel
def unfold(
    first: wp.int32, seconds: wp.float64, before: wp.array(dtype=wp.vec3), velocity: wp.array(dtype=wp.vec3),
    taken: wp.array(dtype=wp.vec3d), ease: wp.array(dtype=wp.vec3d),
):  # fmt: skip
    """Acceleration by which the flow took back what faces were given in a step [m/s^2]: pressure spreads it, and other gas comes. A face that
    has changed the other way has lost all of it, one that has changed by more none; the change that was given is forgotten."""
    c = first + wp.tid()
    e = wp.vec3d()
    for axis in range(3):
        k = taken[c][axis]
        if k != wp.float64(0.0):
            gone = wp.float64(1.0) - (wp.float64(velocity[c][axis]) - wp.float64(before[c][axis])) / k
            e[axis] = -wp.clamp(gone, wp.float64(0.0), wp.float64(1.0)) * k / seconds
    ease[c] = e
    taken[c] = wp.vec3d()
