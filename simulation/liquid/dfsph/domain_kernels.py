# mypy: ignore-errors
"""Warp kernel of the domain's closed sides: what a plane wall and an edge of two add to fill and gradients."""

import warp as wp

from .shape_kernels import plane_weight, weight

wp.set_module_options({"enable_backward": False})

__all__ = ["MIRROR", "behind", "side", "walls"]

MIRROR = wp.constant(wp.float32(2.0))
"""A wall answers a particle with its mirror image: equal pressure, opposite velocity. Both count the gradient twice."""


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
def behind(d: wp.float32, spacing: wp.float32, h: wp.float32):
    """Share that layers behind a plane at distance d give to the gradient of a field that is linear across it, and along it; 1 all around."""
    across = wp.float32(0.0)
    along = wp.float32(0.0)
    for k in range(4):
        z = wp.max(2.0 * d, 0.0) + wp.float32(k) * spacing
        q = z / h
        if q < 1.0:
            across += spacing * 6.2831853 * z * z * weight(q, h)
            along += spacing * plane_weight(q, h)
    return wp.vec2(across, along)


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
    lift: wp.array(dtype=wp.vec3),
    borne: wp.array(dtype=wp.vec3),
):
    """Add the closed sides of the domain to fill and gradients; `borne` is their part of the lift."""
    i = first + wp.tid()
    xi = x[i]
    w = wp.float32(0.0)
    g = wp.vec3(0.0, 0.0, 0.0)
    mine = wp.vec3(0.0, 0.0, 0.0)
    for a in range(3):
        for end in range(2):
            d = xi[a] - low[a]
            closed = low_closed[a]
            way = wp.float32(1.0)
            if end == 1:
                d = high[a] - xi[a]
                closed = high_closed[a]
                way = -1.0
            if closed > 0.0 and d < spacing:
                one = side(d, spacing, h)
                w += one[0]
                g[a] = g[a] + way * one[1]
                part = behind(d, spacing, h)
                mine += part[1] * lift[i]
                mine[a] = mine[a] + (part[0] - part[1]) * lift[i][a]
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
    borne[i] = mine
