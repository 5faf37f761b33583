# mypy: ignore-errors
"""Lists of neighbours with V_j grad W_ij, as Warp functions: an array of `wp.vec4` on a CPU, of `wp.vec2i` on a GPU.

The first keeps three components and the bits of the index. On a GPU every pass of the solves waits for memory, so there a neighbour
takes 8 bytes: 22 bits of its index and three components of 14 bits in steps of `unit`, 1/8191 of the largest there can be (`unit` is
1 for the wide list). All sums of a step are made of the same rounded gradients, so that divergence and pressure force stay adjoint,
and between particles of one volume the forces stay opposite bit for bit.
"""

import warp as wp

__all__ = ["KINDS", "MOST_PACKED", "STEPS", "keep", "neighbour", "note", "toward"]

KINDS = (wp.vec4, wp.vec2i)
"""Types that a neighbour is kept as: kernels over lists are made for both."""
MOST_PACKED = 1 << 22
"""Particles whose indices fit into a packed neighbour."""
STEPS = 8191
"""Units of the largest component of a packed neighbour."""
INDEX = wp.constant(wp.int32(MOST_PACKED - 1))
LARGEST = wp.constant(wp.float32(STEPS))
FOURTEEN = wp.constant(wp.int32(16383))
TEN = wp.constant(wp.int32(1023))


@wp.func
def neighbour(w: wp.vec4):
    """Index of a neighbour."""
    return wp.cast(w[3], wp.int32)


@wp.func
def neighbour(w: wp.vec2i):  # noqa: F811
    """Index of a neighbour."""
    return w[0] & INDEX


@wp.func
def toward(w: wp.vec4):
    """V_j grad W_ij in units."""
    return wp.vec3(w[0], w[1], w[2])


@wp.func
def toward(w: wp.vec2i):  # noqa: F811
    """V_j grad W_ij in units."""
    x = ((w[1] << 28) >> 18) | ((w[0] >> 22) & TEN)
    return wp.vec3(wp.float32(x), wp.float32((w[1] << 14) >> 18), wp.float32(w[1] >> 18))


@wp.func
def note(near: wp.array(dtype=wp.vec4), at: wp.int32, j: wp.int32):
    """Write a neighbour whose gradient is still to come."""
    near[at] = wp.vec4(0.0, 0.0, 0.0, wp.cast(j, wp.float32))


@wp.func
def note(near: wp.array(dtype=wp.vec2i), at: wp.int32, j: wp.int32):  # noqa: F811
    """Write a neighbour whose gradient is still to come."""
    near[at] = wp.vec2i(j, 0)


@wp.func
def keep(near: wp.array(dtype=wp.vec4), at: wp.int32, j: wp.int32, g: wp.vec3, unit: wp.float32):
    """Write a neighbour and its gradient [1/m]; returns that as it is kept."""
    near[at] = wp.vec4(g[0], g[1], g[2], wp.cast(j, wp.float32))
    return g


@wp.func
def whole(component: wp.float32):
    """A component in whole units."""
    return wp.int32(wp.clamp(wp.round(component), -LARGEST, LARGEST))


@wp.func
def keep(near: wp.array(dtype=wp.vec2i), at: wp.int32, j: wp.int32, g: wp.vec3, unit: wp.float32):  # noqa: F811
    """Write a neighbour and its gradient [1/m]; returns that as it is kept."""
    x = whole(g[0] / unit)
    y = whole(g[1] / unit)
    z = whole(g[2] / unit)
    near[at] = wp.vec2i(j | ((x & FOURTEEN) << 22), ((x & FOURTEEN) >> 10) | ((y & FOURTEEN) << 4) | (z << 18))
    return unit * wp.vec3(wp.float32(x), wp.float32(y), wp.float32(z))
