# mypy: ignore-errors
"""Warp kernels of grains against surfaces of bodies, in double precision: which are near, contacts, and what bodies get.

A pair is a grain and a body that it is near. Pairs stand body by body; each keeps up to `SLOTS` contacts with what they store,
known again by their direction. Of a surface's triangles, those act whose inside is nearest; edges and corners act where no
such face lies over them.
"""

import warp as wp

from .grain_kernels import Clock, State, double, kind_of, mass_of, radius_of, single
from .law_kernels import Law, touch

wp.set_module_options({"enable_backward": False})

__all__ = [
    "SLOTS",
    "Bodies",
    "Pairs",
    "carry",
    "enlist",
    "farthest",
    "move_bodies",
    "near_walls",
    "place_pairs",
    "runs_of",
    "settle",
    "triangles",
    "walls",
]

SLOTS = 4
SLOT_COUNT = wp.constant(SLOTS)
Rows = wp.types.matrix(shape=(SLOTS, 3), dtype=wp.float64)
Stored = wp.types.matrix(shape=(SLOTS, 3), dtype=wp.float32)
Depths = wp.types.vector(length=SLOTS, dtype=wp.float64)
SAME = wp.constant(wp.float64(0.94))
"""Cosine between the directions of two contacts that count as one."""
AGAIN = wp.constant(wp.float64(0.7))
"""Cosine between the directions of a contact before and now."""


@wp.struct
class Bodies:
    """Bodies that grains meet, one row each."""

    position: wp.array(dtype=wp.vec3d)
    """Of the frame's origin, relative to that of the places [m]."""
    rotation: wp.array(dtype=wp.quatd)
    center: wp.array(dtype=wp.vec3d)
    velocity: wp.array(dtype=wp.vec3d)
    spin: wp.array(dtype=wp.vec3d)
    lightness: wp.array(dtype=wp.float64)
    """1 / mass; 0 where the body does not react."""
    ease: wp.array(dtype=wp.mat33d)
    """Inverse inertia, world axes."""
    acceleration: wp.array(dtype=wp.vec3d)
    impulse: wp.array(dtype=wp.vec3d)
    twist: wp.array(dtype=wp.vec3d)
    """Given since the exchange began, about the centre."""
    reach: wp.array(dtype=wp.float64)
    """Farthest point of the surface from the centre [m]."""
    drift: wp.array(dtype=wp.float64)
    """Way of the surface since the lists were made, at most [m]."""
    closed: wp.array(dtype=wp.int32)
    mesh: wp.array(dtype=wp.uint64)
    offset: wp.array(dtype=wp.int32)
    """First triangle of each body."""


@wp.struct
class Pairs:
    """Grains near bodies."""

    grain: wp.array(dtype=wp.int32)
    body: wp.array(dtype=wp.int32)
    count: wp.array(dtype=wp.int32)
    """Triangles."""
    triangle: wp.array2d(dtype=wp.int32)
    way: wp.array2d(dtype=wp.vec3)
    """Directions of the contacts at the last step; zero where there is none."""
    spring: wp.array2d(dtype=wp.vec3)
    roll: wp.array2d(dtype=wp.vec3)
    force: wp.array(dtype=wp.vec3d)
    """On the grain."""
    torque: wp.array(dtype=wp.vec3d)
    """On the grain."""
    turn: wp.array(dtype=wp.vec3d)
    """On the body, about its centre."""
    given: wp.array(dtype=wp.vec3d)
    """Impulse on the grain since the sums were taken [N s]."""
    twisted: wp.array(dtype=wp.vec3d)
    """Angular impulse on the grain about the body's centre since then [N m s]."""


@wp.func
def point_of(p: wp.vec4i, unit: wp.float64):
    """A place [m] relative to the origin of the places."""
    return wp.vec3d(wp.float64(p[0]) * unit, wp.float64(p[1]) * unit, wp.float64(p[2]) * unit)


@wp.kernel
def near_walls(
    first: wp.int32,
    state: State,
    bodies: Bodies,
    number: wp.int32,
    unit: wp.float64,
    skin: wp.float64,
    most: wp.int32,
    found: wp.array2d(dtype=wp.int32),
    count: wp.array(dtype=wp.int32),
):
    """Bodies that grain i may meet before the lists are made anew. `count` goes beyond `most` where there are more."""
    i = first + wp.tid()
    p = state.place[i]
    x = point_of(p, unit)
    reach = wp.float64(radius_of(p)) + skin
    n = wp.int32(0)
    for b in range(number):
        near = wp.length(x - bodies.center[b]) < reach + bodies.reach[b]
        if near:
            local = single(wp.quat_rotate_inv(bodies.rotation[b], x - bodies.position[b]))
            r = wp.float32(reach)
            query = wp.mesh_query_aabb(bodies.mesh[b], local - wp.vec3(r, r, r), local + wp.vec3(r, r, r))
            f = wp.int32(0)
            touched = wp.int32(0)
            while wp.mesh_query_aabb_next(query, f):
                touched = 1
            if touched != 0:
                if n < most:
                    found[i, n] = b
                n += 1
    count[i] = n


@wp.kernel
def enlist(
    first: wp.int32,
    start: wp.array(dtype=wp.int32),
    count: wp.array(dtype=wp.int32),
    found: wp.array2d(dtype=wp.int32),
    most: wp.int32,
    key: wp.array(dtype=wp.int32),
    value: wp.array(dtype=wp.int32),
    grain: wp.array(dtype=wp.int32),
):
    """Pairs of grain i, by grains: key is the body, value the number of the pair."""
    i = first + wp.tid()
    n = wp.min(count[i], most)
    for k in range(n):
        e = start[i] + k
        key[e] = found[i, k]
        value[e] = e
        grain[e] = i


@wp.kernel
def place_pairs(
    first: wp.int32,
    key: wp.array(dtype=wp.int32),
    value: wp.array(dtype=wp.int32),
    grain: wp.array(dtype=wp.int32),
    pairs: Pairs,
    at: wp.array(dtype=wp.int32),
):
    """Pairs in the order of their bodies, and where those of a grain went."""
    q = first + wp.tid()
    e = value[q]
    at[e] = q
    pairs.grain[q] = grain[e]
    pairs.body[q] = key[q]


@wp.kernel
def triangles(
    first: wp.int32,
    state: State,
    bodies: Bodies,
    pairs: Pairs,
    unit: wp.float64,
    skin: wp.float64,
    room: wp.int32,
):
    """Triangles that a pair may meet. `count` goes beyond `room` where the list was too short."""
    q = first + wp.tid()
    p = state.place[pairs.grain[q]]
    b = pairs.body[q]
    local = single(wp.quat_rotate_inv(bodies.rotation[b], point_of(p, unit) - bodies.position[b]))
    r = radius_of(p) + wp.float32(skin)
    query = wp.mesh_query_aabb(bodies.mesh[b], local - wp.vec3(r, r, r), local + wp.vec3(r, r, r))
    f = wp.int32(0)
    n = wp.int32(0)
    while wp.mesh_query_aabb_next(query, f):
        if n < room:
            # In ascending order, so that no other order of the search changes anything.
            k = n
            while k > 0 and pairs.triangle[q, wp.max(k - 1, 0)] > f:
                pairs.triangle[q, k] = pairs.triangle[q, k - 1]
                k -= 1
            pairs.triangle[q, k] = f
        n += 1
    pairs.count[q] = n


@wp.kernel
def carry(
    first: wp.int32,
    index: wp.array(dtype=wp.int32),
    old_start: wp.array(dtype=wp.int32),
    old_count: wp.array(dtype=wp.int32),
    old_at: wp.array(dtype=wp.int32),
    old: Pairs,
    fresh: Pairs,
    known: wp.int32,
):
    """What the contacts of a pair stored in the old lists; `index` tells the old place of a grain."""
    q = first + wp.tid()
    for s in range(SLOT_COUNT):
        fresh.way[q, s] = wp.vec3(0.0, 0.0, 0.0)
        fresh.spring[q, s] = wp.vec3(0.0, 0.0, 0.0)
        fresh.roll[q, s] = wp.vec3(0.0, 0.0, 0.0)
    fresh.force[q] = wp.vec3d()
    fresh.torque[q] = wp.vec3d()
    fresh.turn[q] = wp.vec3d()
    fresh.given[q] = wp.vec3d()
    fresh.twisted[q] = wp.vec3d()
    if known != 0:
        before = index[fresh.grain[q]]
        for k in range(old_count[before]):
            e = old_at[old_start[before] + k]
            if old.body[e] == fresh.body[q]:
                for s in range(SLOT_COUNT):
                    fresh.way[q, s] = old.way[e, s]
                    fresh.spring[q, s] = old.spring[e, s]
                    fresh.roll[q, s] = old.roll[e, s]


@wp.func
def nearest(p: wp.vec3d, a: wp.vec3d, b: wp.vec3d, c: wp.vec3d):
    """Nearest point of a triangle, and 1 in a fourth place where it lies inside (Ericson 2005, 5.1.5)."""
    zero = wp.float64(0.0)
    one = wp.float64(1.0)
    ab = b - a
    ac = c - a
    ap = p - a
    d1 = wp.dot(ab, ap)
    d2 = wp.dot(ac, ap)
    if d1 <= zero and d2 <= zero:
        return wp.vec4d(a[0], a[1], a[2], zero)
    bp = p - b
    d3 = wp.dot(ab, bp)
    d4 = wp.dot(ac, bp)
    if d3 >= zero and d4 <= d3:
        return wp.vec4d(b[0], b[1], b[2], zero)
    vc = d1 * d4 - d3 * d2
    if vc <= zero and d1 >= zero and d3 <= zero:
        e = a + ab * (d1 / (d1 - d3))
        return wp.vec4d(e[0], e[1], e[2], zero)
    cp = p - c
    d5 = wp.dot(ab, cp)
    d6 = wp.dot(ac, cp)
    if d6 >= zero and d5 <= d6:
        return wp.vec4d(c[0], c[1], c[2], zero)
    vb = d5 * d2 - d1 * d6
    if vb <= zero and d2 >= zero and d6 <= zero:
        e = a + ac * (d2 / (d2 - d6))
        return wp.vec4d(e[0], e[1], e[2], zero)
    va = d3 * d6 - d5 * d4
    if va <= zero and (d4 - d3) >= zero and (d5 - d6) >= zero:
        e = b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)))
        return wp.vec4d(e[0], e[1], e[2], zero)
    scale = one / (va + vb + vc)
    e = a + ab * (vb * scale) + ac * (vc * scale)
    return wp.vec4d(e[0], e[1], e[2], one)


@wp.func
def row_of(m: Rows, k: wp.int32):
    """A row of a matrix."""
    return wp.vec3d(m[k, 0], m[k, 1], m[k, 2])


@wp.func
def kept_of(m: Stored, k: wp.int32):
    """A row of a matrix."""
    return wp.vec3(m[k, 0], m[k, 1], m[k, 2])


@wp.struct
class Contacts:
    """Places where a sphere meets a surface, in the body's frame."""

    normal: Rows
    point: Rows
    depth: Depths
    number: wp.int32
    faces: wp.int32
    """How many of them are on faces."""


@wp.func
def lies_under(found: Contacts, c: wp.vec3d, big: wp.float64):
    """Whether a point of an edge belongs to a face that acts already."""
    under = wp.int32(0)
    for s in range(found.faces):
        if wp.abs(wp.dot(row_of(found.normal, s), c - row_of(found.point, s))) < wp.float64(1.0e-3) * big:
            under = 1
    return under


@wp.func
def joined(found: Contacts, n: wp.vec3d, c: wp.vec3d, deep: wp.float64):
    """The contacts with one more; of two in about the same direction, the deeper one stays."""
    at = found.number
    for s in range(found.number):
        if wp.dot(row_of(found.normal, s), n) > SAME:
            at = s
            if deep <= found.depth[s]:
                at = SLOT_COUNT
    if at < SLOT_COUNT:
        for a in range(3):
            found.normal[at, a] = n[a]
            found.point[at, a] = c[a]
        found.depth[at] = deep
        if at == found.number:
            found.number += 1
    return found


@wp.func
def contacts_of(
    q: wp.int32,
    local: wp.vec3d,
    big: wp.float64,
    pairs: Pairs,
    first: wp.int32,
    closed: wp.int32,
    vertex: wp.array(dtype=wp.vec3d),
    corner: wp.array(dtype=wp.int32),
):
    """Where the sphere of a pair meets its body's triangles: faces first, then edges and corners that no such face lies over."""
    found = Contacts()
    zero = wp.float64(0.0)
    for stage in range(2):
        for k in range(pairs.count[q]):
            f = 3 * (first + pairs.triangle[q, k])
            va = vertex[corner[f]]
            vb = vertex[corner[f + 1]]
            vc = vertex[corner[f + 2]]
            e = nearest(local, va, vb, vc)
            c = wp.vec3d(e[0], e[1], e[2])
            away = local - c
            gap = wp.length(away)
            face = e[3] > zero
            if gap < big and gap > zero and face == (stage == 0):
                n = away / gap
                before = closed == 0 or wp.dot(n, wp.cross(vb - va, vc - va)) >= zero
                if before and (face or lies_under(found, c, big) == 0):
                    found = joined(found, n, c, big - gap)
        if stage == 0:
            found.faces = found.number
    return found


@wp.func
def slot_like(q: wp.int32, pairs: Pairs, n: wp.vec3):
    """Contact of the last step in about this direction; -1 where there was none."""
    best = wp.float32(AGAIN)
    own = wp.int32(-1)
    for s in range(SLOT_COUNT):
        alike = wp.dot(pairs.way[q, s], n)
        if alike > best:
            best = alike
            own = s
    return own


@wp.kernel
def walls(
    first: wp.int32,
    total: wp.array(dtype=wp.int32),
    state: State,
    bodies: Bodies,
    pairs: Pairs,
    vertex: wp.array(dtype=wp.vec3d),
    corner: wp.array(dtype=wp.int32),
    laws: wp.array2d(dtype=Law),
    density: wp.array(dtype=wp.float32),
    unit: wp.float64,
    dt: wp.array(dtype=wp.float32),
    clock: wp.array(dtype=Clock),
):
    """Contacts of one pair over one step; `laws` are of bodies and kinds."""
    q = first + wp.tid()
    if clock[0].stop != 0 or q >= total[0]:
        return
    i = pairs.grain[q]
    b = pairs.body[q]
    p = state.place[i]
    m = state.motion[i]
    w = state.spin[i]
    r = radius_of(p)
    turned = bodies.rotation[b]
    center = bodies.center[b]
    local = wp.quat_rotate_inv(turned, point_of(p, unit) - bodies.position[b])
    found = contacts_of(q, local, wp.float64(r), pairs, bodies.offset[b], bodies.closed[b], vertex, corner)
    force = wp.vec3d()
    torque = wp.vec3d()
    turn = wp.vec3d()
    spring = Stored()
    roll = Stored()
    for k in range(found.number):
        n = single(wp.quat_rotate(turned, row_of(found.normal, k)))
        own = slot_like(q, pairs, n)
        if own >= 0:
            kept = pairs.spring[q, own]
            wound = pairs.roll[q, own]
            for a in range(3):
                spring[k, a] = kept[a]
                roll[k, a] = wound[a]
    speed = wp.vec3(m[0], m[1], m[2])
    kind = kind_of(m)
    law = laws[b, kind]
    mass = mass_of(r, density[kind])
    for k in range(SLOT_COUNT):
        n = wp.vec3(0.0, 0.0, 0.0)
        if k < found.number:
            n = single(wp.quat_rotate(turned, row_of(found.normal, k)))
            arm = bodies.position[b] + wp.quat_rotate(turned, row_of(found.point, k)) - center
            slip = speed - single(bodies.velocity[b] + wp.cross(bodies.spin[b], arm)) - wp.cross(r * w, n)
            one = touch(
                law, n, wp.float32(found.depth[k]), r, mass, slip, w - single(bodies.spin[b]), kept_of(spring, k),
                kept_of(roll, k), dt[0],
            )  # fmt: skip
            given = double(one.force)
            force += given
            torque += double(wp.cross(n, one.force) * (-r) + one.couple)
            turn -= wp.cross(arm, given) + double(one.couple)
            pairs.spring[q, k] = one.spring
            pairs.roll[q, k] = one.roll
        pairs.way[q, k] = n
    pairs.force[q] = force
    pairs.torque[q] = torque
    pairs.turn[q] = turn
    pairs.given[q] = pairs.given[q] + force * wp.float64(dt[0])
    pairs.twisted[q] = pairs.twisted[q] - turn * wp.float64(dt[0])


@wp.func
def turned_by(rotation: wp.quatd, angle: wp.vec3d):
    """A rotation followed by a small one about world axes."""
    size = wp.length(angle)
    half = wp.float64(0.5)
    s = half
    if size > wp.float64(1.0e-12):
        s = wp.sin(half * size) / size
    step = wp.quatd(angle[0] * s, angle[1] * s, angle[2] * s, wp.cos(half * size))
    return wp.normalize(step * rotation)


@wp.kernel
def move_bodies(
    first: wp.int32,
    width: wp.int32,
    span: wp.array(dtype=wp.vec2i),
    pairs: Pairs,
    bodies: Bodies,
    dt: wp.array(dtype=wp.float32),
    clock: wp.array(dtype=Clock),
):
    """Sum what the grains give to each body, and let it give way; `width` threads for each body."""
    t = first + wp.tid()
    b = t / width
    run = span[b]
    fx = wp.float64(0.0)
    fy = wp.float64(0.0)
    fz = wp.float64(0.0)
    tx = wp.float64(0.0)
    ty = wp.float64(0.0)
    tz = wp.float64(0.0)
    for q in range(run[0] + t % width, run[1], width):
        f = pairs.force[q]
        c = pairs.turn[q]
        fx -= f[0]
        fy -= f[1]
        fz -= f[2]
        tx += c[0]
        ty += c[1]
        tz += c[2]
    sx = wp.tile_sum(wp.tile(fx))
    sy = wp.tile_sum(wp.tile(fy))
    sz = wp.tile_sum(wp.tile(fz))
    ux = wp.tile_sum(wp.tile(tx))
    uy = wp.tile_sum(wp.tile(ty))
    uz = wp.tile_sum(wp.tile(tz))
    if t % width != 0 or clock[0].stop != 0:
        return
    f = wp.vec3d(sx[0], sy[0], sz[0])
    c = wp.vec3d(ux[0], uy[0], uz[0])
    h = wp.float64(dt[0])
    bodies.impulse[b] = bodies.impulse[b] + f * h
    bodies.twist[b] = bodies.twist[b] + c * h
    v = bodies.velocity[b]
    w = bodies.spin[b]
    if bodies.lightness[b] > wp.float64(0.0):
        v += (f * bodies.lightness[b] + bodies.acceleration[b]) * h
        w += (bodies.ease[b] * c) * h
        bodies.velocity[b] = v
        bodies.spin[b] = w
    arm = bodies.center[b] - bodies.position[b]
    local = wp.quat_rotate_inv(bodies.rotation[b], arm)
    bodies.rotation[b] = turned_by(bodies.rotation[b], w * h)
    center = bodies.center[b] + v * h
    bodies.center[b] = center
    bodies.position[b] = center - wp.quat_rotate(bodies.rotation[b], local)
    bodies.drift[b] = bodies.drift[b] + (wp.length(v) + wp.length(w) * bodies.reach[b]) * h


@wp.kernel
def settle(
    first: wp.int32, number: wp.int32, pairs: Pairs, span: wp.array(dtype=wp.vec2i), reaction: wp.array2d(dtype=wp.float64)
):
    """Add up what the grains got from each body since the sums were taken, and begin anew."""
    b = first + wp.tid()
    run = span[b]
    for q in range(run[0], run[1]):
        f = pairs.given[q]
        c = pairs.twisted[q]
        for a in range(3):
            reaction[b, a] = reaction[b, a] + f[a]
            reaction[b, a + 3] = reaction[b, a + 3] + c[a]
        pairs.given[q] = wp.vec3d()
        pairs.twisted[q] = wp.vec3d()


@wp.kernel
def runs_of(first: wp.int32, total: wp.int32, pairs: Pairs, span: wp.array(dtype=wp.vec2i)):
    """First and past-the-last pair of each body that has any."""
    q = first + wp.tid()
    b = pairs.body[q]
    if q == 0 or pairs.body[q - 1] != b:
        # The end is searched in halves: pairs of one body stand together.
        low = q
        high = total
        while high - low > 1:
            middle = (low + high) / 2
            if pairs.body[middle] == b:
                low = middle
            else:
                high = middle
        span[b] = wp.vec2i(q, high)


@wp.kernel
def farthest(first: wp.int32, number: wp.int32, bodies: Bodies, drift: wp.array(dtype=wp.float32)):
    """Greatest way of a body's surface since the lists were made, squared."""
    if first + wp.tid() > 0:
        return
    most = wp.float64(0.0)
    for b in range(number):
        most = wp.max(most, bodies.drift[b])
    drift[0] = wp.float32(most * most)
