# mypy: ignore-errors
"""Warp kernels of contacts on a GPU: impulses that share a vertex's mass among its contacts.

What many pairs add up, at vertices and bodies, are whole numbers of quanta, so that sums do not depend on who came first.
"""

import warp as wp

from .near_kernels import is_edges, shares

wp.set_module_options({"enable_backward": False})

__all__ = ["add_up", "at_shares", "closing", "give_way", "lean", "meet", "press", "stands", "tell", "way_between"]

PUSH = wp.constant(wp.float64(0.1))
"""Share of an overlap of the contact shells that one step takes back."""
FASTEST = wp.constant(wp.float64(0.2))
"""[m/s] at most with which it does."""
QUANTA = wp.constant(wp.float64(2.0**48))
"""Quanta of speed in 1 m/s, in which changes of velocities add up: rounding is 2e-15 m/s, and 32 km/s have room."""
FINE = wp.constant(wp.float64(2.0**40))
"""Parts of a quantum in which `add_up` counts the rest; eight million of its terms have room."""


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


@wp.func
def listed(book: wp.array(dtype=wp.int64), front: wp.int32, rear: wp.int32):
    """Number of pairs in the lists: `front` places are for those with solids, `rear` after them for those within sheets."""
    return wp.min(wp.int32(book[0]), front) + wp.min(wp.int32(book[1]), rear)


@wp.func
def place_of(row: wp.int32, book: wp.array(dtype=wp.int64), front: wp.int32):
    """Place of a pair of the lists."""
    solids = wp.min(wp.int32(book[0]), front)
    if row < solids:
        return row
    return front + row - solids


@wp.kernel
def meet(
    first: wp.int32,
    stride: wp.int32,
    book: wp.array(dtype=wp.int64),
    front: wp.int32,
    rear: wp.int32,
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
    many: wp.array(dtype=wp.int32),
    pressing: wp.array(dtype=wp.int32),
):
    """Nearest points of each pair: signed shares of its vertices, direction from the second to the first thing with their distance, and
    the relative velocity along it that is wanted where they would come within their shells in this step (else -1e30).

    `slack` is how far apart their shells are at least [m]. While they cannot have closed it, the pair is left alone (-2e30). `many` counts
    the pairs that press at each vertex, and `pressing` lists these, whose number is in the book. The clock goes on by the step."""
    if first + wp.tid() == 0:
        clock[1] = clock[1] + clock[0]
        clock[2] = clock[2] + clock[0]
    for row in range(first + wp.tid(), listed(book, front, rear), stride):
        p = place_of(row, book, front)
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
                continue
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
        if aim > wp.float64(-1.0e29):
            pressing[wp.int32(wp.atomic_add(book, 5, wp.int64(1)))] = p
            for k in range(4):
                wp.atomic_add(many, q[k], 1)


@wp.kernel
def press(
    first: wp.int32,
    stride: wp.int32,
    book: wp.array(dtype=wp.int64),
    pressing: wp.array(dtype=wp.int32),
    inverse: wp.array(dtype=wp.float64),
    many: wp.array(dtype=wp.int32),
    u: wp.array(dtype=wp.vec3d),
    pairs: wp.array(dtype=wp.vec4i),
    kinds: wp.array(dtype=wp.vec2i),
    friction: wp.array(dtype=wp.float64),
    share: wp.array(dtype=wp.vec4d),
    normal: wp.array(dtype=wp.vec4d),
    wanted: wp.array(dtype=wp.float64),
    impulse: wp.array(dtype=wp.vec3d),
    sums: wp.array(dtype=wp.int64),
):
    """Impulse of each contact on its first thing so far: the wanted relative velocity, then Coulomb's friction against the one that is
    left across it. A vertex' mass is shared by its contacts (mass splitting: Tonge et al. 2012, doi:10.1145/2185520.2185601); what
    changes its velocity is added to `sums` [quanta]."""
    for row in range(first + wp.tid(), wp.int32(book[5]), stride):
        p = pressing[row]
        zero = wp.float64(0.0)
        q = pairs[p]
        c = share[p]
        n = wp.vec3d(normal[p][0], normal[p][1], normal[p][2])
        ease = zero
        for k in range(4):
            ease += c[k] * c[k] * (inverse[q[k]] * wp.float64(many[q[k]]))
        if ease <= zero:
            continue
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
        for k in range(4):
            i = q[k]
            w = inverse[i]
            if w > zero:
                change = QUANTA * w * c[k] * (new - old)
                for m in range(3):
                    wp.atomic_add(sums, 3 * i + m, wp.int64(wp.rint(change[m])))


@wp.kernel
def give_way(first: wp.int32, sums: wp.array(dtype=wp.int64), u: wp.array(dtype=wp.vec3d)):
    """Velocity of each vertex after the changes of its contacts' impulses, which are forgotten."""
    i = first + wp.tid()
    a = sums[3 * i]
    b = sums[3 * i + 1]
    c = sums[3 * i + 2]
    none = wp.int64(0)
    if a != none or b != none or c != none:
        u[i] = u[i] + wp.vec3d(wp.float64(a), wp.float64(b), wp.float64(c)) / QUANTA
        for j in range(3):
            sums[3 * i + j] = none


@wp.func
def add_up(sums: wp.array(dtype=wp.int64), at: wp.int32, value: wp.float64, quantum: wp.float64):
    """Add to sum `at`, in whole quanta and fine parts of one."""
    scaled = value / quantum
    whole = wp.floor(scaled)
    wp.atomic_add(sums, 2 * at, wp.int64(whole))
    wp.atomic_add(sums, 2 * at + 1, wp.int64(wp.rint((scaled - whole) * FINE)))


@wp.func
def summed(sums: wp.array(dtype=wp.int64), at: wp.int32, quantum: wp.float64):
    """Value of sum `at`."""
    return quantum * (wp.float64(sums[2 * at]) + wp.float64(sums[2 * at + 1]) / FINE)


@wp.kernel
def tell(
    first: wp.int32,
    stride: wp.int32,
    book: wp.array(dtype=wp.int64),
    pressing: wp.array(dtype=wp.int32),
    sheets: wp.int32,
    held: wp.int32,
    soft: wp.int32,
    quantum: wp.float64,
    x: wp.array(dtype=wp.vec3d),
    u: wp.array(dtype=wp.vec3d),
    inverse: wp.array(dtype=wp.float64),
    pairs: wp.array(dtype=wp.vec4i),
    kinds: wp.array(dtype=wp.vec2i),
    share: wp.array(dtype=wp.vec4d),
    impulse: wp.array(dtype=wp.vec3d),
    center: wp.array(dtype=wp.vec3d),
    velocity: wp.array(dtype=wp.vec3d),
    clock: wp.array(dtype=wp.float64),
    given: wp.array(dtype=wp.int64),
    felt: wp.array(dtype=wp.int64),
    leaned: wp.array(dtype=wp.int64),
):
    """Add up what each contact gave, in quanta [N s]: to a solid, about its centre of mass and its work there (7 sums of a body in
    `given`), to vertices of solids that deform where there are such (`soft`), and to held vertices where there are some (`held`)."""
    for row in range(first + wp.tid(), wp.int32(book[5]), stride):
        p = pressing[row]
        kind = kinds[p][0]
        q = pairs[p]
        c = share[p]
        own = impulse[p]
        if held != 0:
            for k in range(4):
                if q[k] < sheets and inverse[q[k]] == wp.float64(0.0):
                    for j in range(3):
                        add_up(leaned, 3 * q[k] + j, c[k] * own[j], quantum)
        if kind < 2:
            continue
        b = (kind - 2) / 4
        if soft != 0:
            for k in range(4):
                if q[k] >= sheets:
                    for j in range(3):
                        add_up(felt, 3 * (q[k] - sheets) + j, c[k] * own[j], quantum)
                    add_up(given, 7 * b + 6, c[k] * wp.dot(own, u[q[k]]), quantum)
        place = wp.vec3d()
        if kind % 4 == 0:
            place = x[q[0]]
        else:
            own = -own
            for k in range(4):
                if c[k] < wp.float64(0.0):
                    place -= c[k] * x[q[k]]
        turned = wp.cross(place - center[b] - (clock[1] - clock[0]) * velocity[b], own)
        for j in range(3):
            add_up(given, 7 * b + j, own[j], quantum)
            add_up(given, 7 * b + 3 + j, turned[j], quantum)


@wp.kernel
def lean(
    first: wp.int32,
    quantum: wp.float64,
    held: wp.array(dtype=wp.int32),
    leaned: wp.array(dtype=wp.int64),
    reaction: wp.array(dtype=wp.vec3d),
):
    """Contacts' impulses on held vertices, which what holds them feels."""
    i = held[first + wp.tid()]
    felt = wp.vec3d(summed(leaned, 3 * i, quantum), summed(leaned, 3 * i + 1, quantum), summed(leaned, 3 * i + 2, quantum))
    reaction[i] = reaction[i] + felt
    for j in range(6):
        leaned[6 * i + j] = wp.int64(0)
