# mypy: ignore-errors
"""Warp kernels of contacts: impulses that share a vertex's mass among its contacts."""

import warp as wp

from .near_kernels import is_edges, shares

wp.set_module_options({"enable_backward": False})

__all__ = ["at_shares", "closing", "crowd", "lean", "meet", "press", "tell", "way_between", "yield_to"]

PUSH = wp.constant(wp.float64(0.1))
"""Share of an overlap of the contact shells that one step takes back."""
FASTEST = wp.constant(wp.float64(0.2))
"""[m/s] at most with which it does."""


@wp.func
def stands(c: wp.vec4d, kind: wp.vec2i):
    """True if a pair is the one of several with the same nearest points that counts: edges where they meet inside both, a triangle inside
    itself or at edges and corners that it stands for."""
    zero = wp.float64(0.0)
    if is_edges(kind):
        return c[0] > zero and c[1] > zero and c[2] < zero and c[3] < zero
    a = c[1] < zero
    b = c[2] < zero
    d = c[3] < zero
    bit = wp.int32(0)
    if a and b and d:
        return True
    if a and b:
        bit = 8
    elif b and d:
        bit = 16
    elif a and d:
        bit = 32
    elif a:
        bit = 1
    elif b:
        bit = 2
    else:
        bit = 4
    return (kind[1] & bit) != 0


@wp.func
def at_shares(values: wp.array(dtype=wp.vec3d), q: wp.vec4i, c: wp.vec4d):
    """Sum of the values of a pair's vertices by their signed shares: what its nearest points have against each other."""
    return c[0] * values[q[0]] + c[1] * values[q[1]] + c[2] * values[q[2]] + c[3] * values[q[3]]


@wp.func
def way_between(x: wp.array(dtype=wp.vec3d), q: wp.vec4i, c: wp.vec4d):
    """Direction from the second to the first thing of a pair at its nearest points, and their distance [m]."""
    r = at_shares(x, q, c)
    d = wp.length(r)
    n = r / wp.max(d, wp.float64(1.0e-30))
    return wp.vec4d(n[0], n[1], n[2], d)


@wp.func
def closing(gap: wp.float64, dt: wp.float64):
    """Relative speed away from each other that leaves no gap after a step, and takes back only a part of an overlap [m/s]."""
    aim = -gap / dt
    if gap < wp.float64(0.0):
        aim = wp.min(PUSH * aim, FASTEST)
    return aim


@wp.func
def went(i: wp.int32, sheets: wp.int32, v: wp.array(dtype=wp.vec3d), u: wp.array(dtype=wp.vec3d)):
    """Velocity with which a vertex went in the last step."""
    if i < sheets:
        return v[i]
    return u[i]


@wp.kernel
def meet(
    first: wp.int32,
    sheets: wp.int32,
    x: wp.array(dtype=wp.vec3d),
    v: wp.array(dtype=wp.vec3d),
    u: wp.array(dtype=wp.vec3d),
    radius: wp.array(dtype=wp.float64),
    pairs: wp.array(dtype=wp.vec4i),
    kinds: wp.array(dtype=wp.vec2i),
    clock: wp.array(dtype=wp.float64),
    share: wp.array(dtype=wp.vec4d),
    normal: wp.array(dtype=wp.vec4d),
    wanted: wp.array(dtype=wp.float64),
    impulse: wp.array(dtype=wp.vec3d),
    slack: wp.array(dtype=wp.float64),
):
    """Nearest points of each pair: signed shares of its vertices, direction from the second to the first thing with their distance, and
    the relative velocity along it that is wanted where they would come within their shells in this step (else -1e30).

    `slack` is how far apart their shells are at least [m]. While they cannot have closed it, the pair is left alone (-2e30)."""
    p = first + wp.tid()
    q = pairs[p]
    left = slack[p]
    if left > wp.float64(0.0):
        va = went(q[0], sheets, v, u)
        fast = wp.max(
            wp.length(went(q[1], sheets, v, u) - va),
            wp.max(wp.length(went(q[2], sheets, v, u) - va), wp.length(went(q[3], sheets, v, u) - va)),
        )
        # Of two edges both ends of the first move against those of the second.
        away = wp.float64(2.0) * fast * clock[0]
        left -= away
        if left > wp.float64(2.0) * away + wp.float64(0.25) * (radius[q[0]] + radius[q[2]]):
            slack[p] = left
            wanted[p] = wp.float64(-2.0e30)
            return
    c = shares(x, q, kinds[p])
    way = way_between(x, q, c)
    n = wp.vec3d(way[0], way[1], way[2])
    gap = way[3] - radius[q[0]] - radius[q[2]]
    speed = wp.dot(n, at_shares(u, q, c))
    aim = closing(gap, clock[0])
    if speed >= aim or not stands(c, kinds[p]):
        aim = wp.float64(-1.0e30)
    slack[p] = gap
    share[p] = c
    normal[p] = way
    wanted[p] = aim
    impulse[p] = wp.vec3d()


@wp.kernel
def crowd(
    first: wp.int32,
    start: wp.array(dtype=wp.int32),
    end: wp.array(dtype=wp.int32),
    items: wp.array(dtype=wp.int32),
    wanted: wp.array(dtype=wp.float64),
    inverse: wp.array(dtype=wp.float64),
    split: wp.array(dtype=wp.float64),
):
    """Inverse mass of each vertex [1/kg] times the contacts that share it (mass splitting: Tonge et al. 2012,
    doi:10.1145/2185520.2185601)."""
    i = first + wp.tid()
    n = wp.int32(0)
    for k in range(start[i], end[i]):
        if wanted[items[k] / 4] > wp.float64(-1.0e29):
            n += 1
    split[i] = inverse[i] * wp.float64(n)


@wp.kernel
def press(
    first: wp.int32,
    u: wp.array(dtype=wp.vec3d),
    split: wp.array(dtype=wp.float64),
    pairs: wp.array(dtype=wp.vec4i),
    kinds: wp.array(dtype=wp.vec2i),
    friction: wp.array(dtype=wp.float64),
    share: wp.array(dtype=wp.vec4d),
    normal: wp.array(dtype=wp.vec4d),
    wanted: wp.array(dtype=wp.float64),
    impulse: wp.array(dtype=wp.vec3d),
    change: wp.array(dtype=wp.vec3d),
):
    """Impulse of each contact on its first thing so far, and its change: the wanted relative velocity, then Coulomb's friction against
    the one that is left across it."""
    p = first + wp.tid()
    zero = wp.float64(0.0)
    if wanted[p] < wp.float64(-1.0e29):
        change[p] = wp.vec3d()
        return
    q = pairs[p]
    c = share[p]
    n = wp.vec3d(normal[p][0], normal[p][1], normal[p][2])
    ease = c[0] * c[0] * split[q[0]] + c[1] * c[1] * split[q[1]] + c[2] * c[2] * split[q[2]] + c[3] * c[3] * split[q[3]]
    if ease <= zero:
        change[p] = wp.vec3d()
        return
    rate = at_shares(u, q, c)
    along = wp.dot(rate, n)
    old = impulse[p]
    before = wp.dot(old, n)
    after = wp.max(before + (wanted[p] - along) / ease, zero)
    across = (old - before * n) - (rate - along * n) / ease
    most = friction[kinds[p][0] / 4] * after
    if kinds[p][0] > 1:
        most = friction[(kinds[p][0] - 2) / 4 + 1] * after
    length = wp.length(across)
    if length > most:
        across = across * (most / length)
    new = after * n + across
    impulse[p] = new
    change[p] = new - old


@wp.kernel
def yield_to(
    first: wp.int32,
    start: wp.array(dtype=wp.int32),
    end: wp.array(dtype=wp.int32),
    items: wp.array(dtype=wp.int32),
    wanted: wp.array(dtype=wp.float64),
    share: wp.array(dtype=wp.vec4d),
    change: wp.array(dtype=wp.vec3d),
    inverse: wp.array(dtype=wp.float64),
    u: wp.array(dtype=wp.vec3d),
):
    """Velocity of each vertex after the changes of its contacts' impulses."""
    i = first + wp.tid()
    w = inverse[i]
    if w == wp.float64(0.0):
        return
    total = wp.vec3d()
    for k in range(start[i], end[i]):
        item = items[k]
        p = item / 4
        if wanted[p] > wp.float64(-1.0e29):
            total += share[p][item - 4 * p] * change[p]
    u[i] = u[i] + w * total


@wp.kernel
def tell(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3d),
    pairs: wp.array(dtype=wp.vec4i),
    kinds: wp.array(dtype=wp.vec2i),
    share: wp.array(dtype=wp.vec4d),
    wanted: wp.array(dtype=wp.float64),
    impulse: wp.array(dtype=wp.vec3d),
    center: wp.array(dtype=wp.vec3d),
    velocity: wp.array(dtype=wp.vec3d),
    clock: wp.array(dtype=wp.float64),
    given: wp.array(dtype=wp.vec3d),
    turned: wp.array(dtype=wp.vec3d),
):
    """Add what each contact with a solid gave to it, and about its centre of mass."""
    p = first + wp.tid()
    kind = kinds[p][0]
    if kind < 2 or wanted[p] < wp.float64(-1.0e29):
        return
    b = (kind - 2) / 4
    q = pairs[p]
    c = share[p]
    own = impulse[p]
    place = wp.vec3d()
    if kind % 4 == 0:
        place = x[q[0]]
    else:
        own = -own
        for k in range(4):
            if c[k] < wp.float64(0.0):
                place -= c[k] * x[q[k]]
    given[p] = given[p] + own
    turned[p] = turned[p] + wp.cross(place - center[b] - clock[1] * velocity[b], own)


@wp.kernel
def lean(
    first: wp.int32,
    held: wp.array(dtype=wp.int32),
    start: wp.array(dtype=wp.int32),
    end: wp.array(dtype=wp.int32),
    items: wp.array(dtype=wp.int32),
    wanted: wp.array(dtype=wp.float64),
    share: wp.array(dtype=wp.vec4d),
    impulse: wp.array(dtype=wp.vec3d),
    reaction: wp.array(dtype=wp.vec3d),
):
    """Contacts' impulses on held vertices, which what holds them feels."""
    i = held[first + wp.tid()]
    total = wp.vec3d()
    for k in range(start[i], end[i]):
        item = items[k]
        p = item / 4
        if wanted[p] > wp.float64(-1.0e29):
            total += share[p][item - 4 * p] * impulse[p]
    reaction[i] = reaction[i] + total
