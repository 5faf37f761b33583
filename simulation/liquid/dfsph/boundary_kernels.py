# mypy: ignore-errors
"""Warp kernels of boundaries: planes of the domain, samples of bodies, and what bodies and liquid exchange.

All samples of one body near one particle act through one vector B = sum_s V_s grad W_is: the pressure force on the liquid is
-V_i p_i B, central between particle and sample, so the same force at the particle gives the body's torque. A pair (particle, body)
therefore stands for all its samples in both solves.
"""

import warp as wp

from .shape_kernels import cell_of, plane_weight, slope, weight, wrapped

wp.set_module_options({"enable_backward": False})

__all__ = [
    "BODIES_NEAR",
    "Bodies",
    "Pairs",
    "Samples",
    "account",
    "arrange",
    "at_place",
    "carry",
    "count_pairs",
    "fill_pairs",
    "finish_factors",
    "force_lanes",
    "kick",
    "ledger_lanes",
    "list_pairs",
    "place",
    "reach",
    "react",
    "walls",
    "wrench_lanes",
]

MIRROR = wp.constant(wp.float32(2.0))
"""A wall answers a particle with its mirror image: equal pressure, opposite velocity. Both count the gradient twice."""
BODIES_NEAR = 8
"""Bodies that one particle can touch at once."""
Eight = wp.types.vector(length=8, dtype=wp.int32)


@wp.struct
class Samples:
    """Boundary samples in the order of their cells."""

    count: wp.int32
    x: wp.array(dtype=wp.vec3)
    v: wp.array(dtype=wp.vec3)
    volume: wp.array(dtype=wp.float32)
    body: wp.array(dtype=wp.int32)
    span: wp.array(dtype=wp.vec2i)
    low: wp.vec3
    inverse: wp.float32
    size: wp.vec3i


@wp.struct
class Bodies:
    """Bodies of the boundaries at the start of the step."""

    center: wp.array(dtype=wp.vec3)
    velocity: wp.array(dtype=wp.vec3)
    spin: wp.array(dtype=wp.vec3)
    lightness: wp.array(dtype=wp.float32)
    mobility: wp.array(dtype=wp.mat33)
    friction: wp.array(dtype=wp.float32)
    deforms: wp.array(dtype=wp.int32)


@wp.func
def side(d: wp.float32, spacing: wp.float32, h: wp.float32):
    """Fill that a plane wall gives at distance d, and its slope: the particle's mirror image and layers behind it."""
    w = wp.float32(0.0)
    g = wp.float32(0.0)
    for k in range(4):
        z = wp.max(2.0 * d, 0.0) + wp.float32(k) * spacing
        q = wp.abs(z) / h
        if q < 1.0:
            w += spacing * plane_weight(q, h)
            g -= MIRROR * spacing * 6.2831853 * wp.max(z, 0.1 * spacing) * weight(q, h)
    return wp.vec2(w, g)


@wp.func
def edge(d: wp.float32, e: wp.float32, spacing: wp.float32, h: wp.float32):
    """Fill that two planes at distances d and e count twice behind their edge, and its slopes: lines of the lattice."""
    w = wp.float32(0.0)
    g = wp.float32(0.0)
    k = wp.float32(0.0)
    for a in range(2):
        for b in range(2):
            x = wp.max(2.0 * d, 0.25 * spacing) + wp.float32(a) * spacing
            y = wp.max(2.0 * e, 0.25 * spacing) + wp.float32(b) * spacing
            u = 1.0 - (x * x + y * y) / (h * h)
            if u > 0.0:
                scale = 2.5464791 * spacing * spacing / (h * h) * u * u
                w += scale * u * (0.03524 + u * (0.59718 + u * (-0.83797 + u * 0.95511)))
                slant = -2.0 * MIRROR / (h * h) * scale * (0.10572 + u * (2.38872 + u * (-4.18985 + u * 5.73066)))
                g += slant * x
                k += slant * y
    return wp.vec3(w, g, k)


@wp.kernel
def walls(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3),
    low: wp.vec3,
    high: wp.vec3,
    low_closed: wp.vec3,
    high_closed: wp.vec3,
    spacing: wp.float32,
    h: wp.float32,
    fill: wp.array(dtype=wp.float32),
    lean: wp.array(dtype=wp.vec3),
    wall: wp.array(dtype=wp.vec3),
):
    """Add the closed sides of the domain to fill and gradients; `wall` is their share."""
    i = first + wp.tid()
    xi = x[i]
    w = wp.float32(0.0)
    g = wp.vec3(0.0, 0.0, 0.0)
    for a in range(3):
        d = xi[a] - low[a]
        if low_closed[a] > 0.0 and d < 1.5 * spacing:
            one = side(d, spacing, h)
            w += one[0]
            g[a] = g[a] + one[1]
        d = high[a] - xi[a]
        if high_closed[a] > 0.0 and d < 1.5 * spacing:
            one = side(d, spacing, h)
            w += one[0]
            g[a] = g[a] - one[1]
    far = wp.float32(1.0e3) * spacing
    away = wp.vec3(far, far, far)
    sign = wp.vec3(1.0, 1.0, 1.0)
    for a in range(3):
        if low_closed[a] > 0.0:
            away[a] = xi[a] - low[a]
        if high_closed[a] > 0.0 and high[a] - xi[a] < away[a]:
            away[a] = high[a] - xi[a]
            sign[a] = -1.0
    for a in range(3):
        b = (a + 1) % 3
        if away[a] < 1.5 * spacing and away[b] < 1.5 * spacing:
            both = edge(away[a], away[b], spacing, h)
            w -= both[0]
            g[a] = g[a] - sign[a] * both[1]
            g[b] = g[b] - sign[b] * both[2]
    fill[i] = fill[i] + w
    lean[i] = lean[i] + g
    wall[i] = g


@wp.func
def seen(s: Samples, xi: wp.vec3, h: wp.float32, known: Eight):
    """The bodies near a place, added to those known; -1 where the list ends."""
    if s.count > 0:
        c = cell_of(xi, s.low, s.inverse)
        for dz in range(-1, 2):
            for dy in range(-1, 2):
                line = (wrapped(c[2] + dz, s.size[2]) * s.size[1] + wrapped(c[1] + dy, s.size[1])) * s.size[0]
                for dx in range(-1, 2):
                    at = s.span[line + wrapped(c[0] + dx, s.size[0])]
                    for j in range(at[0], at[1]):
                        way = xi - s.x[j]
                        if wp.dot(way, way) < h * h:
                            k = wp.int32(0)
                            while k < 8 and known[k] >= 0 and known[k] != s.body[j]:
                                k += 1
                            if k < 8:
                                known[k] = s.body[j]
    return known


@wp.kernel
def count_pairs(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3),
    fixed: Samples,
    moving: Samples,
    h: wp.float32,
    touched: wp.array(dtype=wp.int32),
):
    """Number of bodies near each particle."""
    i = first + wp.tid()
    known = Eight(-1, -1, -1, -1, -1, -1, -1, -1)
    known = seen(fixed, x[i], h, known)
    known = seen(moving, x[i], h, known)
    k = wp.int32(0)
    while k < 8 and known[k] >= 0:
        k += 1
    touched[i] = k


@wp.struct
class Pairs:
    """(particle, body) pairs, those of a particle side by side."""

    start: wp.array(dtype=wp.int32)
    touched: wp.array(dtype=wp.int32)
    particle: wp.array(dtype=wp.int32)
    body: wp.array(dtype=wp.int32)
    slope: wp.array(dtype=wp.vec3)
    drag: wp.array(dtype=wp.float32)


@wp.func
def gathered(s: Samples, xi: wp.vec3, h: wp.float32, body: wp.int32):
    """Of one body near a place: sums of V W, V grad W, drag, and V v_s . grad W of its samples' own velocities."""
    w = wp.float32(0.0)
    g = wp.vec3(0.0, 0.0, 0.0)
    c = wp.float32(0.0)
    own = wp.float32(0.0)
    if s.count > 0:
        at_cell = cell_of(xi, s.low, s.inverse)
        for dz in range(-1, 2):
            for dy in range(-1, 2):
                line = (wrapped(at_cell[2] + dz, s.size[2]) * s.size[1] + wrapped(at_cell[1] + dy, s.size[1])) * s.size[0]
                for dx in range(-1, 2):
                    at = s.span[line + wrapped(at_cell[0] + dx, s.size[0])]
                    for j in range(at[0], at[1]):
                        if s.body[j] == body:
                            way = xi - s.x[j]
                            d2 = wp.dot(way, way)
                            if d2 < h * h:
                                q = wp.sqrt(d2) / h
                                part = s.volume[j] * slope(q, h)
                                w += s.volume[j] * weight(q, h)
                                g += part * way
                                c -= 2.0 * part * d2 / (d2 + 0.01 * h * h)
                                own += part * wp.dot(way, s.v[j])
    return wp.vec4(w, c, own, 0.0), g


@wp.kernel
def fill_pairs(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3),
    fixed: Samples,
    moving: Samples,
    bodies: Bodies,
    h: wp.float32,
    pairs: Pairs,
    fill: wp.array(dtype=wp.float32),
    lean: wp.array(dtype=wp.vec3),
    own: wp.array(dtype=wp.float32),
):
    """Fill in the pairs of a particle; add bodies to its fill and gradients; `own` is D of samples that move by themselves."""
    i = first + wp.tid()
    own[i] = 0.0
    n = pairs.touched[i]
    if n == 0:
        return
    xi = x[i]
    known = Eight(-1, -1, -1, -1, -1, -1, -1, -1)
    known = seen(fixed, xi, h, known)
    known = seen(moving, xi, h, known)
    total = wp.float32(0.0)
    way = wp.vec3(0.0, 0.0, 0.0)
    mine = wp.float32(0.0)
    for k in range(n):
        body = known[k]
        one, g = gathered(fixed, xi, h, body)
        two, g2 = gathered(moving, xi, h, body)
        sums = one + two
        slant = g + g2
        at = pairs.start[i] + k
        pairs.particle[at] = i
        pairs.body[at] = body
        pairs.slope[at] = MIRROR * slant
        pairs.drag[at] = sums[1] * bodies.friction[body]
        total += sums[0]
        way += slant
        mine += sums[2]
    fill[i] = fill[i] + total
    lean[i] = lean[i] + MIRROR * way
    own[i] = MIRROR * mine


@wp.func
def at_place(velocity: wp.vec3, spin: wp.vec3, arm: wp.vec3):
    """Velocity of a rigid body at an arm from its centre."""
    return velocity + wp.cross(spin, arm)


@wp.kernel
def carry(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3),
    pairs: Pairs,
    center: wp.array(dtype=wp.vec3),
    velocity: wp.array(dtype=wp.vec3),
    spin: wp.array(dtype=wp.vec3),
    own: wp.array(dtype=wp.float32),
    moving: wp.array(dtype=wp.float32),
):
    """What bodies that move (or accelerate) with `velocity` and `spin` take away from D."""
    i = first + wp.tid()
    s = own[i]
    for k in range(pairs.start[i], pairs.start[i] + pairs.touched[i]):
        b = pairs.body[k]
        s += wp.dot(at_place(velocity[b], spin[b], x[i] - center[b]), pairs.slope[k])
    moving[i] = s


@wp.kernel
def reach(
    first: wp.int32,
    lanes: wp.int32,
    x: wp.array(dtype=wp.vec3),
    volume: wp.array(dtype=wp.float32),
    pairs: Pairs,
    order: wp.array(dtype=wp.int32),
    spans: wp.array(dtype=wp.vec2i),
    bodies: Bodies,
    partial: wp.array(dtype=wp.vec2d),
):
    """Sums over the pairs of a body that bound how much all its particles together can move it."""
    t = first + wp.tid()
    b = t / lanes
    span = spans[b]
    one = wp.float64(0.0)
    two = wp.float64(0.0)
    if bodies.lightness[b] > 0.0:
        for at in range(span[0] + t % lanes, span[1], lanes):
            k = order[at]
            i = pairs.particle[k]
            turn = wp.cross(x[i] - bodies.center[b], pairs.slope[k])
            one += wp.float64(volume[i] * wp.length(pairs.slope[k]))
            two += wp.float64(volume[i] * wp.sqrt(wp.max(wp.dot(turn, bodies.mobility[b] * turn), 0.0)))
    partial[t] = wp.vec2d(one, two)


@wp.kernel
def finish_factors(
    first: wp.int32,
    lanes: wp.int32,
    x: wp.array(dtype=wp.vec3),
    lean: wp.array(dtype=wp.vec3),
    lightness: wp.array(dtype=wp.float32),
    pairs: Pairs,
    bodies: Bodies,
    partial: wp.array(dtype=wp.vec2d),
    least: wp.float32,
    stiffness: wp.array(dtype=wp.float32),
):
    """Diagonal of A: own acceleration, neighbours' (summed by the search), and bounds of the bodies' rows."""
    i = first + wp.tid()
    s = stiffness[i] + lightness[i] * wp.dot(lean[i], lean[i])
    for k in range(pairs.start[i], pairs.start[i] + pairs.touched[i]):
        b = pairs.body[k]
        if bodies.lightness[b] > 0.0:
            one = wp.float64(0.0)
            two = wp.float64(0.0)
            for t in range(lanes):
                one += partial[b * lanes + t][0]
                two += partial[b * lanes + t][1]
            turn = wp.cross(x[i] - bodies.center[b], pairs.slope[k])
            s += 0.25 * bodies.lightness[b] * wp.length(pairs.slope[k]) * wp.float32(one)
            s += 0.25 * wp.sqrt(wp.max(wp.dot(turn, bodies.mobility[b] * turn), 0.0)) * wp.float32(two)
    if s < least:
        s = 0.0
    stiffness[i] = s


@wp.kernel
def wrench_lanes(
    first: wp.int32,
    lanes: wp.int32,
    x: wp.array(dtype=wp.vec3),
    volume: wp.array(dtype=wp.float32),
    p: wp.array(dtype=wp.float32),
    pairs: Pairs,
    order: wp.array(dtype=wp.int32),
    spans: wp.array(dtype=wp.vec2i),
    center: wp.array(dtype=wp.vec3),
    force: wp.array(dtype=wp.vec3d),
    torque: wp.array(dtype=wp.vec3d),
):
    """Pressure force and torque on a body, one lane of its pairs."""
    t = first + wp.tid()
    b = t / lanes
    span = spans[b]
    f = wp.vec3d()
    m = wp.vec3d()
    for at in range(span[0] + t % lanes, span[1], lanes):
        k = order[at]
        i = pairs.particle[k]
        one = volume[i] * p[i] * pairs.slope[k]
        turn = wp.cross(x[i] - center[b], one)
        f += wp.vec3d(wp.float64(one[0]), wp.float64(one[1]), wp.float64(one[2]))
        m += wp.vec3d(wp.float64(turn[0]), wp.float64(turn[1]), wp.float64(turn[2]))
    force[t] = f
    torque[t] = m


@wp.kernel
def react(
    first: wp.int32,
    lanes: wp.int32,
    bodies: Bodies,
    force: wp.array(dtype=wp.vec3d),
    torque: wp.array(dtype=wp.vec3d),
    velocity: wp.array(dtype=wp.vec3),
    spin: wp.array(dtype=wp.vec3),
):
    """Sum the lanes of a body; its linear and angular acceleration by them."""
    b = first + wp.tid()
    f = wp.vec3d()
    m = wp.vec3d()
    for t in range(lanes):
        f += force[b * lanes + t]
        m += torque[b * lanes + t]
    velocity[b] = bodies.lightness[b] * wp.vec3(wp.float32(f[0]), wp.float32(f[1]), wp.float32(f[2]))
    spin[b] = bodies.mobility[b] * wp.vec3(wp.float32(m[0]), wp.float32(m[1]), wp.float32(m[2]))


@wp.kernel
def place(
    first: wp.int32,
    local: wp.array(dtype=wp.vec3),
    body: wp.array(dtype=wp.int32),
    rotation: wp.array(dtype=wp.mat33),
    position: wp.array(dtype=wp.vec3),
    x: wp.array(dtype=wp.vec3),
):
    """Carry samples with their bodies."""
    i = first + wp.tid()
    x[i] = rotation[body[i]] * local[i] + position[body[i]]


@wp.kernel
def arrange(
    first: wp.int32,
    index: wp.array(dtype=wp.int32),
    x: wp.array(dtype=wp.vec3),
    v: wp.array(dtype=wp.vec3),
    volume: wp.array(dtype=wp.float32),
    body: wp.array(dtype=wp.int32),
    out: Samples,
):
    """Samples in the order of their cells."""
    i = first + wp.tid()
    j = index[i]
    out.x[i] = x[j]
    out.v[i] = v[j]
    out.volume[i] = volume[j]
    out.body[i] = body[j]


@wp.kernel
def list_pairs(
    first: wp.int32,
    pairs: Pairs,
    key: wp.array(dtype=wp.int32),
    order: wp.array(dtype=wp.int32),
):
    """Keys that sort the pairs by body, those of a body by particle."""
    k = first + wp.tid()
    key[k] = pairs.body[k]
    order[k] = k


@wp.kernel
def kick(
    first: wp.int32,
    acceleration: wp.array(dtype=wp.vec3),
    settings: wp.array(dtype=wp.float32),
    velocity: wp.array(dtype=wp.vec3),
):
    """Velocity by the acceleration of everything but the liquid."""
    b = first + wp.tid()
    velocity[b] = velocity[b] + settings[0] * acceleration[b]


@wp.kernel
def ledger_lanes(
    first: wp.int32,
    lanes: wp.int32,
    x: wp.array(dtype=wp.vec3),
    volume: wp.array(dtype=wp.float32),
    lightness: wp.array(dtype=wp.float32),
    p: wp.array(dtype=wp.float32),
    pairs: Pairs,
    order: wp.array(dtype=wp.int32),
    spans: wp.array(dtype=wp.vec2i),
    center: wp.array(dtype=wp.vec3),
    force: wp.array(dtype=wp.vec3d),
    torque: wp.array(dtype=wp.vec3d),
):
    """What a body's pressure changes of the liquid's own momentum: masses times accelerations of the particles, one lane."""
    t = first + wp.tid()
    b = t / lanes
    span = spans[b]
    f = wp.vec3d()
    m = wp.vec3d()
    for at in range(span[0] + t % lanes, span[1], lanes):
        k = order[at]
        i = pairs.particle[k]
        if lightness[i] > 0.0:
            a = -lightness[i] * (p[i] * pairs.slope[k])
            one = (volume[i] / lightness[i]) * a
            turn = wp.cross(x[i] - center[b], one)
            f += wp.vec3d(wp.float64(one[0]), wp.float64(one[1]), wp.float64(one[2]))
            m += wp.vec3d(wp.float64(turn[0]), wp.float64(turn[1]), wp.float64(turn[2]))
    force[t] = f
    torque[t] = m


@wp.kernel
def force_lanes(
    first: wp.int32,
    lanes: wp.int32,
    x: wp.array(dtype=wp.vec3),
    value: wp.array(dtype=wp.vec3),
    pairs: Pairs,
    order: wp.array(dtype=wp.int32),
    spans: wp.array(dtype=wp.vec2i),
    center: wp.array(dtype=wp.vec3),
    force: wp.array(dtype=wp.vec3d),
    torque: wp.array(dtype=wp.vec3d),
):
    """Forces of the pairs summed, one lane of each body."""
    t = first + wp.tid()
    b = t / lanes
    span = spans[b]
    f = wp.vec3d()
    m = wp.vec3d()
    for at in range(span[0] + t % lanes, span[1], lanes):
        k = order[at]
        one = value[k]
        turn = wp.cross(x[pairs.particle[k]] - center[b], one)
        f += wp.vec3d(wp.float64(one[0]), wp.float64(one[1]), wp.float64(one[2]))
        m += wp.vec3d(wp.float64(turn[0]), wp.float64(turn[1]), wp.float64(turn[2]))
    force[t] = f
    torque[t] = m


@wp.kernel
def account(
    first: wp.int32,
    lanes: wp.int32,
    bodies: Bodies,
    force: wp.array(dtype=wp.vec3d),
    torque: wp.array(dtype=wp.vec3d),
    settings: wp.array(dtype=wp.float32),
    moves: wp.int32,
    linear: wp.array(dtype=wp.vec3d),
    angular: wp.array(dtype=wp.vec3d),
):
    """Add the impulse of one solve to a body's sums; where `moves`, to its velocity too."""
    b = first + wp.tid()
    f = wp.vec3d()
    m = wp.vec3d()
    for t in range(lanes):
        f += force[b * lanes + t]
        m += torque[b * lanes + t]
    dt = wp.float64(settings[0])
    linear[b] = linear[b] + dt * f
    angular[b] = angular[b] + dt * m
    if moves != 0:
        bodies.velocity[b] = bodies.velocity[b] + settings[0] * bodies.lightness[b] * wp.vec3(
            wp.float32(f[0]), wp.float32(f[1]), wp.float32(f[2])
        )
        bodies.spin[b] = bodies.spin[b] + settings[0] * (
            bodies.mobility[b] * wp.vec3(wp.float32(m[0]), wp.float32(m[1]), wp.float32(m[2]))
        )
