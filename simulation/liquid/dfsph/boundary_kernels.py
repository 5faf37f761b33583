# mypy: ignore-errors
"""Warp kernels of boundaries: samples of bodies in their cells, and the pairs (particle, body).

All samples of one body near one particle act through one vector B = sum_s V_s grad W_is: the pressure force on the liquid is
-V_i p_i B, central between particle and sample, so the same force at the particle gives the body's torque. A pair (particle, body)
therefore stands for all its samples in both solves.
"""

import warp as wp

from .domain_kernels import MIRROR
from .shape_kernels import cell_of, slope, weight, wrapped

wp.set_module_options({"enable_backward": False, "max_unroll": 2})  # 27 cells

__all__ = ["BODIES_NEAR", "Bodies", "Pairs", "Samples", "arrange", "count_pairs", "fill_pairs", "list_pairs", "place"]

BODIES_NEAR = 8
"""Bodies that one particle can touch at once."""
DRAG = wp.constant(wp.float32(4.7))
"""Of friction 1: 2 for the pairs, twice for the mirrored velocity, and what viscosity has; liquid then stands still at the surface,
within a tenth of a spacing (measured, Couette and Poiseuille)."""
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
                                c -= DRAG * part * d2 / (d2 + 0.01 * h * h)
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
