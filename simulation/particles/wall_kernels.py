# mypy: ignore-errors
"""Contacts of grains with surfaces of bodies as a Warp kernel, in double precision.

A pair is a grain and a body that it is near; `pair_kernels.py` lists them. Each keeps up to `SLOTS` contacts with what they store,
known again by their direction. Of a surface's triangles, those act whose inside is nearest; edges and corners act where no
such face lies over them.
"""

import warp as wp

from .grain_kernels import Clock, State, double, kind_of, mass_of, radius_of, single
from .law_kernels import Law, touch

wp.set_module_options({"enable_backward": False})

__all__ = ["SLOTS", "Bodies", "Pairs", "point_of", "walls"]

SLOTS = 4
SLOT_COUNT = wp.constant(SLOTS)
Rows = wp.types.matrix(shape=(SLOTS, 3), dtype=wp.float64)
Stored = wp.types.matrix(shape=(SLOTS, 3), dtype=wp.float32)
Depths = wp.types.vector(length=SLOTS, dtype=wp.float64)
Faces = wp.types.vector(length=SLOTS, dtype=wp.int32)
SAME = wp.constant(wp.float64(0.94))
"""Cosine between the directions of two contacts that count as one."""
AGAIN = wp.constant(wp.float64(0.7))
"""Cosine between the directions of a contact before and now."""


@wp.struct
class Bodies:
    """Bodies that grains meet, one row each."""

    position: wp.array(dtype=wp.vec3d)
    """Position of the frame's origin, relative to that of the places [m]."""
    rotation: wp.array(dtype=wp.quatd)
    center: wp.array(dtype=wp.vec3d)
    velocity: wp.array(dtype=wp.vec3d)
    spin: wp.array(dtype=wp.vec3d)
    lightness: wp.array(dtype=wp.float64)
    """1 / mass; 0 where the body does not react."""
    mobility: wp.array(dtype=wp.mat33d)
    """Velocity per impulse at the centre, what else holds the body included, world axes."""
    turning: wp.array(dtype=wp.mat33d)
    """Angular velocity per angular impulse likewise."""
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
    soft: wp.array(dtype=wp.int32)
    """True where its vertices move by themselves; its pose is then that of the world."""
    speed: wp.array(dtype=wp.vec3d)
    """Velocities of such vertices, among those of all bodies [m/s]."""
    yields: wp.array(dtype=wp.float64)
    """Speed that each of those alone gains per impulse on it [1/kg]."""


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
    depth: wp.array2d(dtype=wp.float32)
    """Depth of the contacts at the last step [m]; 0 where there is none."""
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
    worked: wp.array(dtype=wp.float64)
    """Work of the body's motion on the grain since then [J]."""
    face: wp.array2d(dtype=wp.int32)
    """First corner of the triangle that each contact is on; -1 where there is none, or its vertices do not move by themselves."""
    share: wp.array2d(dtype=wp.vec3d)
    """Barycentric weights of the contact on it."""
    load: wp.array2d(dtype=wp.vec3d)
    """Force of the contact on the grain."""


@wp.func
def point_of(p: wp.vec4i, unit: wp.float64):
    """A place [m] relative to the origin of the places."""
    return wp.vec3d(wp.float64(p[0]) * unit, wp.float64(p[1]) * unit, wp.float64(p[2]) * unit)


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
    face: Faces
    """First corner of the triangle."""
    number: wp.int32
    faces: wp.int32
    """Number of them that are on faces."""


@wp.func
def lies_under(found: Contacts, c: wp.vec3d, big: wp.float64):
    """True if a point of an edge belongs to a face that acts already."""
    under = wp.int32(0)
    for s in range(found.faces):
        if wp.abs(wp.dot(row_of(found.normal, s), c - row_of(found.point, s))) < wp.float64(1.0e-3) * big:
            under = 1
    return under


@wp.func
def joined(found: Contacts, n: wp.vec3d, c: wp.vec3d, deep: wp.float64, face: wp.int32):
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
        found.face[at] = face
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
                    found = joined(found, n, c, big - gap, f)
        if stage == 0:
            found.faces = found.number
    return found


@wp.func
def shares(p: wp.vec3d, a: wp.vec3d, b: wp.vec3d, c: wp.vec3d):
    """Barycentric weights of a point of a triangle."""
    normal = wp.cross(b - a, c - a)
    double = wp.max(wp.length_sq(normal), wp.float64(1.0e-300))
    v = wp.dot(wp.cross(p - a, c - a), normal) / double
    w = wp.dot(wp.cross(b - a, p - a), normal) / double
    return wp.vec3d(wp.float64(1.0) - v - w, v, w)


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
    power = wp.float64(0.0)
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
        pairs.face[q, k] = -1
        pairs.depth[q, k] = 0.0
        if k < found.number:
            n = single(wp.quat_rotate(turned, row_of(found.normal, k)))
            arm = bodies.position[b] + wp.quat_rotate(turned, row_of(found.point, k)) - center
            there = bodies.velocity[b] + wp.cross(bodies.spin[b], arm)
            face = wp.int32(-1)
            heavy = mass
            if bodies.soft[b] != 0:
                face = found.face[k]
                one_at = corner[face]
                two_at = corner[face + 1]
                three_at = corner[face + 2]
                part = shares(row_of(found.point, k), vertex[one_at], vertex[two_at], vertex[three_at])
                there = part[0] * bodies.speed[one_at] + part[1] * bodies.speed[two_at] + part[2] * bodies.speed[three_at]
                pairs.share[q, k] = part
                # Two things that give way are damped as their reduced mass.
                ease = (
                    part[0] * part[0] * bodies.yields[one_at]
                    + part[1] * part[1] * bodies.yields[two_at]
                    + part[2] * part[2] * bodies.yields[three_at]
                )
                heavy = wp.float32(wp.float64(mass) / (wp.float64(1.0) + wp.float64(mass) * ease))
            slip = speed - single(there) - wp.cross(r * w, n)
            one = touch(
                law, n, wp.float32(found.depth[k]), r, heavy, slip, w - single(bodies.spin[b]), kept_of(spring, k),
                kept_of(roll, k), dt[0],
            )  # fmt: skip
            given = double(one.force)
            force += given
            torque += double(wp.cross(n, one.force) * (-r) + one.couple)
            turn -= wp.cross(arm, given) + double(one.couple)
            power += wp.dot(given, there) + wp.dot(double(one.couple), bodies.spin[b])
            pairs.face[q, k] = face
            pairs.depth[q, k] = wp.float32(found.depth[k])
            pairs.load[q, k] = given
            pairs.spring[q, k] = one.spring
            pairs.roll[q, k] = one.roll
        pairs.way[q, k] = n
    pairs.force[q] = force
    pairs.torque[q] = torque
    pairs.turn[q] = turn
    pairs.given[q] = pairs.given[q] + force * wp.float64(dt[0])
    pairs.twisted[q] = pairs.twisted[q] - turn * wp.float64(dt[0])
    pairs.worked[q] = pairs.worked[q] + power * wp.float64(dt[0])
