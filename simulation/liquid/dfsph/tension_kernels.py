# mypy: ignore-errors
"""Warp kernels of surface tension: forces between particles that reach farther than their pressure, and adhesion to walls."""

import warp as wp

from .boundary_kernels import Pairs
from .domain_kernels import MIRROR
from .shape_kernels import SIGMA, cell_of, plane_weight, wrapped
from .step_slots import Slot

wp.set_module_options({"enable_backward": False})

__all__ = ["adhere", "attract", "cling"]

DT = wp.constant(int(Slot.DT))
SIDES = wp.constant(wp.float32(2.75))
"""Measured: closed sides attract so much more than bodies, so that drops stand on them at about 90 degrees; none within a gap of theirs."""


@wp.func
def drawn(q: wp.float32, h: wp.float32):
    """Slope of the fill of a half-space at distance q h, doubled as that of bodies is; none within an eighth of h."""
    f = wp.float32(0.0)
    if q > 0.125 and q < 1.0:
        f = SIDES * MIRROR * wp.min(4.0 * (q - 0.125), 1.0) * plane_weight(q, h)
    return f


@wp.func
def steep(q: wp.float32):
    """W'(r) / r of the cubic spline at distance q in supports, without its scale."""
    u = wp.max(1.0 - q, 0.0)
    f = -6.0 * u * u / q
    if q < 0.5:
        f = 6.0 * (3.0 * q - 2.0)
    return f


@wp.kernel
def attract(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3),
    volume: wp.array(dtype=wp.float32),
    lightness: wp.array(dtype=wp.float32),
    fluid: wp.array(dtype=wp.int32),
    strength: wp.array(dtype=wp.float32),
    span: wp.array(dtype=wp.vec2i),
    low: wp.vec3,
    inverse: wp.float32,
    size: wp.vec3i,
    reach: wp.float32,
    ratio: wp.float32,
    core: wp.float32,
    lower: wp.vec3,
    upper: wp.vec3,
    lower_closed: wp.vec3,
    upper_closed: wp.vec3,
    h: wp.float32,
    adhesion: wp.float32,
    settings: wp.array(dtype=wp.float32),
    v: wp.array(dtype=wp.vec3),
):
    """Velocity after a step of central forces V_i V_j k_i k_j (W'(r) - c w'(r)) with cubic splines: W of support `reach` (two cells)
    attracts, w of support `reach` / `ratio` parts; `core` is c ratio^5.

    `strength` is k of each fluid [sqrt(Pa)]. Closed sides of the domain attract with `adhesion` k^2 times the slope of the fill that
    a half-space has in the kernel of support h, doubled as that of bodies is.
    """
    i = first + wp.tid()
    own = strength[fluid[i]]
    if lightness[i] == 0.0 or own == 0.0:
        return
    xi = x[i]
    c = cell_of(xi, low, inverse)
    s = wp.vec3(0.0, 0.0, 0.0)
    per = 1.0 / reach
    for dz in range(-2, wp.min(3, size[2] - 2)):
        layer = wrapped(c[2] + dz, size[2]) * size[1]
        for dy in range(-2, wp.min(3, size[1] - 2)):
            line = (layer + wrapped(c[1] + dy, size[1])) * size[0]
            for dx in range(-2, wp.min(3, size[0] - 2)):
                near = span[line + wrapped(c[0] + dx, size[0])]
                for j in range(near[0], near[1]):
                    way = xi - x[j]
                    q = wp.length(way) * per
                    if q < 1.0 and q > 0.0:
                        s += (strength[fluid[j]] * volume[j] * (steep(q) - core * steep(q * ratio))) * way
    s = SIGMA * per * per * per * per * per * s
    for a in range(3):
        if lower_closed[a] > 0.0:
            s[a] = s[a] - adhesion * own * drawn((xi[a] - lower[a]) / h, h)
        if upper_closed[a] > 0.0:
            s[a] = s[a] + adhesion * own * drawn((upper[a] - xi[a]) / h, h)
    v[i] = v[i] + settings[DT] * lightness[i] * own * s


@wp.kernel
def adhere(
    first: wp.int32,
    volume: wp.array(dtype=wp.float32),
    lightness: wp.array(dtype=wp.float32),
    fluid: wp.array(dtype=wp.int32),
    strength: wp.array(dtype=wp.float32),
    pairs: Pairs,
    adhesion: wp.float32,
    sign: wp.float32,
    force: wp.array(dtype=wp.vec3),
):
    """Force of each pair on the body [N], times `sign`: particles draw it along the gradient of the fill that it gives them."""
    i = first + wp.tid()
    own = strength[fluid[i]]
    if lightness[i] == 0.0:
        own = 0.0
    for k in range(pairs.start[i], pairs.start[i] + pairs.touched[i]):
        force[k] = -sign * adhesion * own * own * volume[i] * pairs.slope[k]


@wp.kernel
def cling(
    first: wp.int32,
    volume: wp.array(dtype=wp.float32),
    lightness: wp.array(dtype=wp.float32),
    pairs: Pairs,
    force: wp.array(dtype=wp.vec3),
    settings: wp.array(dtype=wp.float32),
    v: wp.array(dtype=wp.vec3),
):
    """Velocity of the particles after a step of the forces that they give to bodies."""
    i = first + wp.tid()
    s = wp.vec3(0.0, 0.0, 0.0)
    for k in range(pairs.start[i], pairs.start[i] + pairs.touched[i]):
        s += force[k]
    v[i] = v[i] - settings[DT] * lightness[i] / volume[i] * s
