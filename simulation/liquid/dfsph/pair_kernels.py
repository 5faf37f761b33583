# mypy: ignore-errors
"""Warp kernels that find the pairs (particle, body), with the fill, the gradient and the friction of each."""

import warp as wp

from .boundary_kernels import Bodies, Pairs, Samples, Surfaces
from .domain_kernels import MIRROR, behind, edge, side
from .shape_kernels import cell_of, half_space, plane_weight, slope, weight, wrapped

wp.set_module_options({"enable_backward": False, "max_unroll": 2})  # 27 cells

__all__ = ["SHEET", "count_pairs", "fill_pairs", "list_pairs", "sum_pairs"]

LAYER = wp.constant(wp.float32(0.1497))
"""Fill that a plane of samples gives at a spacing, where liquid at rest keeps to it: of sheets and bodies that deform, the fill goes
with its square, so that its gradient there is that of a mirror image."""
MOVING = wp.constant(2)
"""Kind of closed bodies that move. Along their surfaces pressure does not go on behind them: held bodies ten spacings wide then feel
1.01 to 1.02 of what they displace, else 0.96 to 0.98. Along walls at rest it does, which keeps the pressure beside them linear."""
SOFT = wp.constant(4)
"""Kind of closed bodies that deform, which act as those that move."""
SHEET = wp.constant(5)
"""Kind of sheets that deform."""
FAINT = wp.constant(wp.float32(0.01))
"""Gradient of the fill by a solid along its nearest surface, in units of 1/h, below which nothing else of it is near."""
DRAG = wp.constant(wp.float32(4.7))
"""Drag of friction 1: 2 for the pairs, twice for the mirrored velocity, and what viscosity has; liquid then stands still at the surface,
within a tenth of a spacing (measured, Couette and Poiseuille)."""
Eight = wp.types.vector(length=8, dtype=wp.int32)


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


@wp.kernel
def sum_pairs(
    first: wp.int32,
    total: wp.int32,
    start: wp.array(dtype=wp.int32),
    touched: wp.array(dtype=wp.int32),
    most: wp.array(dtype=wp.int32),
):
    """Number of all pairs, into the second place of `most`."""
    most[1 + first + wp.tid()] = start[total - 1] + touched[total - 1]


@wp.func
def gathered(s: Samples, xi: wp.vec3, h: wp.float32, body: wp.int32, lift: wp.vec3):
    """Sums over one body near a place: V W and drag; V grad W; V (r . lift) grad W, which makes the gradient of a linear field
    whole."""
    w = wp.float32(0.0)
    g = wp.vec3(0.0, 0.0, 0.0)
    c = wp.float32(0.0)
    m = wp.vec3(0.0, 0.0, 0.0)
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
                                c -= DRAG * part * d2 / (d2 + 0.01 * h * h)
                                m -= (part * wp.dot(way, lift)) * way
    return wp.vec2(w, c), g, m


@wp.func
def wall_along(mesh: wp.uint64, at: wp.vec3, way: wp.vec3, h: wp.float32):
    """Outward normal of the face that a way from outside meets, and the distance of its plane; a distance of h where it meets none."""
    found = wp.vec4(0.0, 0.0, 0.0, h)
    length = wp.length(way)
    if length * h > FAINT:
        hit = wp.mesh_query_ray(mesh, at, way / length, 2.0 * h)
        if hit.result:
            slant = -wp.dot(hit.normal, way) / length
            if slant > 0.0 and hit.t * slant < h:
                found = wp.vec4(hit.normal[0], hit.normal[1], hit.normal[2], hit.t * slant)
    return found


@wp.func
def second_wall(d: wp.float32, n: wp.vec3, e: wp.float32, m: wp.vec3, spacing: wp.float32, h: wp.float32):
    """Fill and its gradient by a wall at distance e, less what it has in common with one at distance d."""
    one = side(e, spacing, h)
    both = edge(d, e, spacing, h)
    f = (one[1] - both[2]) * m - both[1] * n
    return wp.vec4(f[0], f[1], f[2], one[0] - both[0])


@wp.func
def lifted(d: wp.float32, n: wp.vec3, lift: wp.vec3, fixed: wp.float32, spacing: wp.float32, h: wp.float32):
    """Part of the lift that a plane wall bears; along itself where it is fixed."""
    part = behind(d, spacing, h)
    along = fixed * part[1]
    return along * lift + ((part[0] - along) * wp.dot(lift, n)) * n


@wp.func
def cornered(
    g: wp.vec3,
    d: wp.float32,
    n: wp.vec3,
    lift: wp.vec3,
    fixed: wp.float32,
    mesh: wp.uint64,
    at: wp.vec3,
    turn: wp.mat33,
    spacing: wp.float32,
    h: wp.float32,
):
    """Where walls of one solid meet around the liquid: fill, gradient and lift of all of them as of sides of the domain, and by how
    much the second turns away from the nearest, 0 if there is none.

    What the solid's gradient has along the nearest wall leads to the second, and what it has along both to a third.
    """
    f = wp.vec4(0.0, 0.0, 0.0, 0.0)
    borne = wp.vec3(0.0, 0.0, 0.0)
    share = wp.float32(0.0)
    inverse = wp.transpose(turn)
    rest = g - wp.dot(g, n) * n
    two = wall_along(mesh, at, inverse * rest, h)
    e = two[3]
    if e < h:
        m = turn * wp.vec3(two[0], two[1], two[2])
        share = wp.clamp(1.0 - wp.dot(n, m), 0.0, 1.0)
        one = side(d, spacing, h)
        f = wp.vec4(one[1] * n[0], one[1] * n[1], one[1] * n[2], one[0]) + second_wall(d, n, e, m, spacing, h)
        borne = lifted(d, n, lift, fixed, spacing, h) + lifted(e, m, lift, fixed, spacing, h)
        rest = rest - wp.dot(rest, m) * m
        three = wall_along(mesh, at, inverse * (rest - wp.dot(rest, n) * n), h)
        c = three[3]
        if c < h:
            k = turn * wp.vec3(three[0], three[1], three[2])
            both = edge(e, c, spacing, h)
            f += second_wall(d, n, c, k, spacing, h)
            less = both[1] * m + both[2] * k
            f -= wp.vec4(less[0], less[1], less[2], both[0])
            borne += lifted(c, k, lift, fixed, spacing, h)
    return f, borne, share


@wp.func
def mirrored(
    w: wp.float32,
    g: wp.vec3,
    m: wp.vec3,
    lift: wp.vec3,
    surfaces: Surfaces,
    body: wp.int32,
    xi: wp.vec3,
    spacing: wp.float32,
    h: wp.float32,
):
    """Fill by a solid, its gradient, and its part of the lift: the integrals w, g, m times what a plane's mirror image has over a
    plane's integral.

    A plane then acts as a side of the domain, an edge or a corner by its share of it, and walls that meet around the liquid as the sides
    of a domain do.
    """
    turn = surfaces.rotation[body]
    at = wp.transpose(turn) * (xi - surfaces.position[body])
    near = wp.mesh_query_point_sign_normal(surfaces.mesh[body], at, h)
    if not near.result:
        return wp.vec4(0.0, 0.0, 0.0, 0.0), wp.vec3(0.0, 0.0, 0.0)
    away = turn * (at - wp.mesh_eval_position(surfaces.mesh[body], near.face, near.u, near.v))
    gap = wp.length(away)
    d = near.sign * gap
    if d >= spacing:
        return wp.vec4(0.0, 0.0, 0.0, 0.0), wp.vec3(0.0, 0.0, 0.0)
    image = side(wp.max(d, 0.0), spacing, h)
    plane = half_space(d / h)
    share = image[0] / plane
    f = share * g
    part = behind(wp.max(d, 0.0), spacing, h)
    whole = wp.max(d, 0.0) * plane_weight(wp.max(d, 0.0) / h, h) + plane
    fixed = wp.float32(1.0)
    if surfaces.kind[body] == MOVING or surfaces.kind[body] == SOFT:
        fixed = 0.0
    along = fixed * part[1] / plane
    borne = along * m
    if gap > 1.0e-6 * spacing:
        borne += ((part[0] / whole - along) * wp.dot(m, away) / (gap * gap)) * away
    if d > 1.0e-6 * spacing:
        change = (image[1] + share * plane_weight(d / h, h)) / plane
        f += (w * change / gap) * away
        walls, held, turned = cornered(g, d, away / gap, lift, fixed, surfaces.mesh[body], at, turn, spacing, h)
        single = wp.vec4(f[0], f[1], f[2], share * w)
        return (1.0 - turned) * single + turned * walls, (1.0 - turned) * borne + turned * held
    return wp.vec4(f[0], f[1], f[2], share * w), borne


@wp.func
def thin(
    w: wp.float32,
    lift: wp.vec3,
    surfaces: Surfaces,
    body: wp.int32,
    xi: wp.vec3,
    spacing: wp.float32,
    h: wp.float32,
):
    """Fill by a sheet, its gradient, and its part of the lift: of the mirror image in the nearest place of it, as a side of the domain has,
    times the share that samples within reach are of a whole plane's."""
    near = wp.mesh_query_point_no_sign(surfaces.mesh[body], xi, h)
    if not near.result:
        return wp.vec4(0.0, 0.0, 0.0, 0.0), wp.vec3(0.0, 0.0, 0.0)
    away = xi - wp.mesh_eval_position(surfaces.mesh[body], near.face, near.u, near.v)
    d = wp.length(away)
    if d >= spacing or d < 1.0e-6 * spacing:
        return wp.vec4(0.0, 0.0, 0.0, 0.0), wp.vec3(0.0, 0.0, 0.0)
    n = away / d
    share = wp.min(w / (spacing * plane_weight(d / h, h)), 1.0)
    image = side(d, spacing, h)
    f = (share * image[1]) * n
    return wp.vec4(f[0], f[1], f[2], share * image[0]), wp.vec3(0.0, 0.0, 0.0)


@wp.kernel
def fill_pairs(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3),
    fixed: Samples,
    moving: Samples,
    bodies: Bodies,
    surfaces: Surfaces,
    spacing: wp.float32,
    h: wp.float32,
    lift: wp.array(dtype=wp.vec3),
    pairs: Pairs,
    fill: wp.array(dtype=wp.float32),
    lean: wp.array(dtype=wp.vec3),
):
    """Fill in the pairs of a particle; add bodies to its fill and gradients."""
    i = first + wp.tid()
    n = pairs.touched[i]
    if n == 0:
        return
    xi = x[i]
    known = Eight(-1, -1, -1, -1, -1, -1, -1, -1)
    known = seen(fixed, xi, h, known)
    known = seen(moving, xi, h, known)
    total = wp.float32(0.0)
    way = wp.vec3(0.0, 0.0, 0.0)
    for k in range(n):
        body = known[k]
        one, g, m = gathered(fixed, xi, h, body, lift[i])
        two, g2, m2 = gathered(moving, xi, h, body, lift[i])
        sums = one + two
        w = sums[0]
        share = w / LAYER
        slant = MIRROR * share * (g + g2)
        w = share * w
        borne = wp.vec3(0.0, 0.0, 0.0)
        if surfaces.kind[body] == 1 or surfaces.kind[body] == MOVING or surfaces.kind[body] == SOFT:
            seen_as, borne = mirrored(sums[0], g + g2, m + m2, lift[i], surfaces, body, xi, spacing, h)
            slant = wp.vec3(seen_as[0], seen_as[1], seen_as[2])
            w = seen_as[3]
        if surfaces.kind[body] == SHEET:
            sheet, borne = thin(sums[0], lift[i], surfaces, body, xi, spacing, h)
            slant = wp.vec3(sheet[0], sheet[1], sheet[2])
            w = sheet[3]
        at = pairs.start[i] + k
        pairs.particle[at] = i
        pairs.body[at] = body
        pairs.slope[at] = slant
        pairs.borne[at] = borne
        pairs.drag[at] = sums[1] * bodies.friction[body]
        total += w
        way += slant
    fill[i] = fill[i] + total
    lean[i] = lean[i] + way


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
