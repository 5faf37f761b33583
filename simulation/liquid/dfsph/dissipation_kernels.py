# mypy: ignore-errors
"""Warp kernels that damp motion at the scale of single particles, which the method cannot resolve.

Between two particles the velocities are continued linearly to their middle, and what then still differs is damped in proportion to
itself and to a signal velocity (Monaghan's artificial viscosity with linear reconstruction, as in Frontiere, Raskin and Owen 2017):
fields that are linear or quadratic in space are left alone. Forces act along the connection: momentum and angular momentum are kept.
"""

from typing import Any

import warp as wp

from .list_kernels import KINDS, neighbour, toward
from .step_slots import Slot

wp.set_module_options({"enable_backward": False})

__all__ = ["damp", "shear"]

DT = wp.constant(int(Slot.DT))
STRENGTH = wp.constant(wp.float32(1.0))
"""Factor of the squared difference; the classical values are 1 to 2."""
REGULAR = wp.constant(wp.float32(0.1))
"""Determinant of the shape matrix, 1 in full surroundings, below which a velocity gradient says nothing."""


@wp.kernel
def shear(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3),
    v: wp.array(dtype=wp.vec3),
    count: wp.array(dtype=wp.int32),
    near: wp.array(dtype=Any),
    row: wp.int32,
    stride: wp.int32,
    unit: wp.float32,
    tensor: wp.array(dtype=wp.mat33),
    known: wp.array(dtype=wp.float32),
):
    """Velocity gradient at each particle, exact for linear fields; `known` 0 where too few particles lie around."""
    i = first + wp.tid()
    xi = x[i]
    vi = v[i]
    shape = wp.mat33(0.0)
    change = wp.mat33(0.0)
    at = i * row
    for _k in range(count[i]):
        one = near[at]
        j = neighbour(one)
        g = unit * toward(one)
        shape += wp.outer(x[j] - xi, g)
        change += wp.outer(v[j] - vi, g)
        at += stride
    known[i] = 0.0
    if wp.determinant(shape) > REGULAR:
        known[i] = 1.0
        tensor[i] = change * wp.inverse(shape)


@wp.kernel
def damp(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3),
    v: wp.array(dtype=wp.vec3),
    lightness: wp.array(dtype=wp.float32),
    count: wp.array(dtype=wp.int32),
    near: wp.array(dtype=Any),
    row: wp.int32,
    stride: wp.int32,
    unit: wp.float32,
    tensor: wp.array(dtype=wp.mat33),
    known: wp.array(dtype=wp.float32),
    signal: wp.float32,
    most: wp.float32,
    settings: wp.array(dtype=wp.float32),
    out: wp.array(dtype=wp.vec3),
):
    """Velocity after a step of damping with the signal velocity STRENGTH |u| + signal, at most `most` [m/s]."""
    i = first + wp.tid()
    vi = v[i]
    change = wp.vec3(0.0, 0.0, 0.0)
    if known[i] > 0.0 and lightness[i] > 0.0:
        at = i * row
        for _k in range(count[i]):
            one = near[at]
            j = neighbour(one)
            if known[j] > 0.0 and lightness[j] > 0.0:
                way = x[i] - x[j]
                length = wp.length(way)
                if length > 0.0:
                    n = way / length
                    u = wp.dot(vi - v[j] - 0.5 * ((tensor[i] + tensor[j]) * way), n)
                    share = 2.0 * lightness[i] / (lightness[i] + lightness[j])
                    change -= (share * unit * wp.length(toward(one)) * wp.min(STRENGTH * wp.abs(u) + signal, most) * u) * n
            at += stride
    out[i] = vi + settings[DT] * change


for _kind in KINDS:
    for _kernel in (shear, damp):
        wp.overload(_kernel, {"near": wp.array(dtype=_kind)})
