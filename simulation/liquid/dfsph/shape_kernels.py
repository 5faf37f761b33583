# mypy: ignore-errors
"""The cubic spline of support h, its gradient, its integral over planes, and cells of a wrapped grid, as Warp functions."""

import warp as wp

__all__ = ["cell", "cell_of", "half_space", "plane_weight", "slope", "weight"]

SIGMA = wp.constant(wp.float32(2.546479089470325))
"""8/pi: normalises the cubic spline in three dimensions."""


@wp.func
def weight(q: wp.float32, h: wp.float32):
    """W at distance q h [1/m^3]; 0 from q = 1 on."""
    u = wp.max(1.0 - q, 0.0)
    w = 2.0 * u * u * u
    if q < 0.5:
        w = 6.0 * q * q * (q - 1.0) + 1.0
    return SIGMA * w / (h * h * h)


@wp.func
def slope(q: wp.float32, h: wp.float32):
    """W'(r) / r at distance q h [1/m^5]: the gradient is this times the way.

    Nearer than where it is steepest the spline keeps that steepness, or close particles would not be parted (Thomas and
    Couchman 1992).
    """
    u = wp.max(1.0 - q, 0.0)
    f = -6.0 * u * u / wp.max(q, 1.0e-6)
    if q < 0.5:
        f = 6.0 * (3.0 * q - 2.0)
    if q < 0.33333333:
        f = -2.0 / wp.max(q, 1.0e-3)
    return SIGMA * f / (h * h * h * h * h)


@wp.func
def plane_weight(q: wp.float32, h: wp.float32):
    """Integral of W over a plane at distance q h [1/m]."""
    u = wp.max(1.0 - q, 0.0)
    u4 = u * u * u * u
    part = 2.0 * u4 * (0.25 - 0.2 * u)
    if q < 0.5:
        q2 = q * q
        part = 0.0875 - (6.0 * q2 * q2 * (0.2 * q - 0.25) + 0.5 * q2)
    return 16.0 * part / h


@wp.func
def half_space(q: wp.float32):
    """Integral of W over a half space at distance q h; 1/2 from q = 0 down."""
    u = wp.clamp(1.0 - q, 0.0, 1.0)
    u5 = u * u * u * u * u
    part = u5 * (0.1 - 0.06666667 * u)
    if q < 0.5:
        p = wp.max(q, 0.0)
        p3 = p * p * p
        part = 0.03125 - 0.0875 * p + p3 * (0.16666667 + p * p * (0.2 * p - 0.3))
    return 16.0 * part


@wp.func
def cell_of(x: wp.vec3, low: wp.vec3, inverse: wp.float32):
    """Cell coordinates, not wrapped."""
    y = (x - low) * inverse
    return wp.vec3i(wp.int32(wp.floor(y[0])), wp.int32(wp.floor(y[1])), wp.int32(wp.floor(y[2])))


@wp.func
def wrapped(c: wp.int32, size: wp.int32):
    """C modulo size, never negative."""
    r = c % size
    if r < 0:
        r += size
    return r


@wp.func
def cell(c: wp.vec3i, size: wp.vec3i):
    """Number of a cell; distant ones share a number."""
    return (wrapped(c[2], size[2]) * size[1] + wrapped(c[1], size[1])) * size[0] + wrapped(c[0], size[0])
