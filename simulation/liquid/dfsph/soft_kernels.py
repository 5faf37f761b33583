# mypy: ignore-errors
"""Warp kernels of surfaces that deform: where their samples and pairs are on them, and what their vertices get and how they give way.

The pressure force of a pair acts on the corners of the nearest triangle by its barycentric weights, and the wall's velocity at a pair
is the same mean of theirs, so that A = D M^-1 D^T stays symmetric with the vertices' masses in M.
"""

from typing import Any

import warp as wp

from .boundary_kernels import Bodies, Pairs, Surfaces
from .list_kernels import KINDS, neighbour, toward
from .pair_kernels import SHEET
from .shape_kernels import weight
from .step_slots import Slot

wp.set_module_options({"enable_backward": False})

DT = wp.constant(int(Slot.DT))

__all__ = ["attach", "cut", "kick_vertices", "lay_samples", "press", "pull", "slow", "soften", "take", "thicken_walls", "weigh"]

TINY = wp.constant(wp.float32(1.0e-20))


@wp.kernel
def lay_samples(
    first: wp.int32,
    corner: wp.array(dtype=wp.vec3i),
    weights: wp.array(dtype=wp.vec3),
    offset: wp.array(dtype=wp.vec3),
    rest: wp.array(dtype=wp.vec2),
    row: wp.array(dtype=wp.int32),
    vertex: wp.array(dtype=wp.vec3),
    x: wp.array(dtype=wp.vec3),
    volume: wp.array(dtype=wp.float32),
):
    """Carry samples with their triangles: `offset` along the first edge, across it and along the normal; `rest` volume and area.

    Volumes go with the area of the triangle, since samples keep their depth under it.
    """
    s = first + wp.tid()
    at = corner[s]
    a = vertex[at[0]]
    b = vertex[at[1]]
    c = vertex[at[2]]
    w = weights[s]
    normal = wp.cross(b - a, c - a)
    size = wp.length(normal)
    one = wp.normalize(b - a)
    n = normal / wp.max(size, TINY)
    o = offset[s]
    x[row[s]] = w[0] * a + w[1] * b + w[2] * c + o[0] * one + o[1] * wp.cross(n, one) + o[2] * n
    volume[row[s]] = rest[s][0] * size / (2.0 * rest[s][1])


@wp.kernel
def attach(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3),
    surfaces: Surfaces,
    bodies: Bodies,
    start: wp.array(dtype=wp.int32),
    reach: wp.float32,
    vertices: wp.int32,
    pairs: Pairs,
    key: wp.array(dtype=wp.int32),
    order: wp.array(dtype=wp.int32),
):
    """Nearest place of the surface of each pair's body, if that deforms; keys that sort its corners' shares by vertex."""
    k = first + wp.tid()
    b = pairs.body[k]
    at = wp.vec3i(0, 0, 0)
    share = wp.vec3(0.0, 0.0, 0.0)
    found = wp.vec3i(vertices, vertices, vertices)
    if bodies.deforms[b] != 0:
        near = wp.mesh_query_point_no_sign(surfaces.mesh[b], x[pairs.particle[k]], reach)
        if near.result:
            mesh = surfaces.mesh[b]
            for c in range(3):
                at[c] = start[b] + wp.mesh_get_index(mesh, 3 * near.face + c)
            share = wp.vec3(near.u, near.v, 1.0 - near.u - near.v)
            found = at
    pairs.corner[k] = at
    pairs.share[k] = share
    pairs.give[k] = 1.0
    for c in range(3):
        key[3 * k + c] = found[c]
        order[3 * k + c] = 3 * k + c


@wp.func
def sheets_of(pairs: Pairs, surfaces: Surfaces, i: wp.int32):
    """Number of a particle's pairs with sheets that deform."""
    found = wp.int32(0)
    for k in range(pairs.start[i], pairs.start[i] + pairs.touched[i]):
        if surfaces.kind[pairs.body[k]] == SHEET:
            found += 1
    return found


@wp.kernel
def cut(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3),
    volume: wp.array(dtype=wp.float32),
    lightness: wp.array(dtype=wp.float32),
    pairs: Pairs,
    surfaces: Surfaces,
    h: wp.float32,
    count: wp.array(dtype=wp.int32),
    near: wp.array(dtype=Any),
    row: wp.int32,
    stride: wp.int32,
    unit: wp.float32,
    fill: wp.array(dtype=wp.float32),
    lean: wp.array(dtype=wp.vec3),
    stiffness: wp.array(dtype=wp.float32),
):
    """Take neighbours off the lists that a sheet stands between, and out of the sums over them: liquid on both sides meets the sheet alone.

    The way is followed from the particle of the lower number, so that both of a pair find the same.
    """
    i = first + wp.tid()
    if sheets_of(pairs, surfaces, i) > 0:
        kept = wp.int32(0)
        at = i * row
        to = at
        for _k in range(count[i]):
            w = near[at]
            j = neighbour(w)
            apart = wp.int32(0)
            if sheets_of(pairs, surfaces, j) > 0:
                a = x[wp.min(i, j)]
                way = x[wp.max(i, j)] - a
                length = wp.max(wp.length(way), TINY)
                for k in range(pairs.start[i], pairs.start[i] + pairs.touched[i]):
                    if surfaces.kind[pairs.body[k]] == SHEET:
                        hit = wp.mesh_query_ray(surfaces.mesh[pairs.body[k]], a, way / length, length)
                        if hit.result:
                            apart = 1
            g = unit * toward(w)
            if apart == 1:
                fill[i] = fill[i] - volume[j] * weight(wp.length(x[i] - x[j]) / h, h)
                lean[i] = lean[i] - g
                stiffness[i] = stiffness[i] - volume[i] * lightness[j] / volume[j] * wp.dot(g, g)
            else:
                near[to] = w
                to += stride
                kept += 1
            at += stride
        count[i] = kept


@wp.kernel
def weigh(
    first: wp.int32,
    volume: wp.array(dtype=wp.float32),
    lightness: wp.array(dtype=wp.float32),
    pairs: Pairs,
    order: wp.array(dtype=wp.int32),
    spans: wp.array(dtype=wp.vec2i),
    ease: wp.array(dtype=wp.float32),
    bound: wp.array(dtype=wp.float32),
    load: wp.array(dtype=wp.float32),
):
    """Write for each vertex a bound of how much all its particles together move it, and the mass of liquid on it in units of its own."""
    v = first + wp.tid()
    span = spans[v]
    one = wp.float32(0.0)
    two = wp.float32(0.0)
    if ease[v] > 0.0:
        for at in range(span[0], span[1]):
            e = order[at]
            k = e / 3
            i = pairs.particle[k]
            slope = wp.length(pairs.slope[k])
            share = pairs.share[k][e % 3]
            one += share * volume[i] * slope
            if slope > 0.0 and lightness[i] > 0.0:
                two += share * volume[i] / lightness[i]
    bound[v] = ease[v] * one
    load[v] = ease[v] * two


@wp.kernel
def soften(
    first: wp.int32,
    load: wp.array(dtype=wp.float32),
    pairs: Pairs,
):
    """Share of a particle's velocity against the surface that it loses where all of them hit it at once and nobody bounces."""
    k = first + wp.tid()
    at = pairs.corner[k]
    share = pairs.share[k]
    pairs.give[k] = 1.0 / (1.0 + share[0] * load[at[0]] + share[1] * load[at[1]] + share[2] * load[at[2]])


@wp.kernel
def slow(
    first: wp.int32,
    volume: wp.array(dtype=wp.float32),
    viscosity: wp.array(dtype=wp.float32),
    settings: wp.array(dtype=wp.float32),
    pairs: Pairs,
    order: wp.array(dtype=wp.int32),
    spans: wp.array(dtype=wp.vec2i),
    ease: wp.array(dtype=wp.float32),
    load: wp.array(dtype=wp.float32),
):
    """Write for each vertex the rate of its friction with liquid that stands still, times the step."""
    v = first + wp.tid()
    span = spans[v]
    s = wp.float32(0.0)
    if ease[v] > 0.0:
        for at in range(span[0], span[1]):
            e = order[at]
            k = e / 3
            i = pairs.particle[k]
            s += pairs.share[k][e % 3] * volume[i] * viscosity[i] * pairs.drag[k]
    load[v] = settings[DT] * ease[v] * s


@wp.kernel
def thicken_walls(
    first: wp.int32,
    load: wp.array(dtype=wp.float32),
    pairs: Pairs,
):
    """Friction of a step as vertices feel it that come to rest in the liquid meanwhile."""
    k = first + wp.tid()
    at = pairs.corner[k]
    share = pairs.share[k]
    pairs.drag[k] = pairs.drag[k] / (1.0 + share[0] * load[at[0]] + share[1] * load[at[1]] + share[2] * load[at[2]])


@wp.kernel
def pull(
    first: wp.int32,
    volume: wp.array(dtype=wp.float32),
    p: wp.array(dtype=wp.float32),
    pairs: Pairs,
    order: wp.array(dtype=wp.int32),
    spans: wp.array(dtype=wp.vec2i),
    ease: wp.array(dtype=wp.float32),
    acceleration: wp.array(dtype=wp.vec3),
):
    """Acceleration of each vertex by pressure."""
    v = first + wp.tid()
    span = spans[v]
    f = wp.vec3(0.0, 0.0, 0.0)
    if ease[v] > 0.0:
        for at in range(span[0], span[1]):
            e = order[at]
            k = e / 3
            i = pairs.particle[k]
            f += (pairs.share[k][e % 3] * volume[i] * p[i]) * pairs.slope[k]
    acceleration[v] = ease[v] * f


@wp.kernel
def press(
    first: wp.int32,
    volume: wp.array(dtype=wp.float32),
    p: wp.array(dtype=wp.float32),
    pairs: Pairs,
    force: wp.array(dtype=wp.vec3),
):
    """Pressure force of each pair on the body [N]."""
    k = first + wp.tid()
    i = pairs.particle[k]
    force[k] = (volume[i] * p[i]) * pairs.slope[k]


@wp.kernel
def take(
    first: wp.int32,
    force: wp.array(dtype=wp.vec3),
    settings: wp.array(dtype=wp.float32),
    pairs: Pairs,
    order: wp.array(dtype=wp.int32),
    spans: wp.array(dtype=wp.vec2i),
    ease: wp.array(dtype=wp.float32),
    velocity: wp.array(dtype=wp.vec3),
    impulse: wp.array(dtype=wp.vec3d),
):
    """Give vertices the impulses of forces of the pairs over the step."""
    v = first + wp.tid()
    span = spans[v]
    f = wp.vec3d()
    for at in range(span[0], span[1]):
        e = order[at]
        k = e / 3
        one = pairs.share[k][e % 3] * force[k]
        f += wp.vec3d(wp.float64(one[0]), wp.float64(one[1]), wp.float64(one[2]))
    impulse[v] = impulse[v] + wp.float64(settings[DT]) * f
    velocity[v] = velocity[v] + settings[DT] * ease[v] * wp.vec3(wp.float32(f[0]), wp.float32(f[1]), wp.float32(f[2]))


@wp.kernel
def kick_vertices(
    first: wp.int32,
    change: wp.array(dtype=wp.vec3),
    velocity: wp.array(dtype=wp.vec3),
):
    """Velocity of vertices by everything but the liquid."""
    v = first + wp.tid()
    velocity[v] = velocity[v] + change[v]


for _kind in KINDS:
    wp.overload(cut, {"near": wp.array(dtype=_kind)})
