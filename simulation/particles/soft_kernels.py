# mypy: ignore-errors
"""Warp kernels of surfaces that deform: their vertices move, and give way to what grains give them."""

import warp as wp

from .grain_kernels import Clock
from .wall_kernels import SLOT_COUNT, Bodies, Pairs

wp.set_module_options({"enable_backward": False})

__all__ = ["drift_soft", "give_way"]


@wp.kernel
def give_way(
    first: wp.int32,
    own: wp.array(dtype=wp.int32),
    start: wp.array(dtype=wp.int32),
    near: wp.array(dtype=wp.int32),
    pairs: Pairs,
    corner: wp.array(dtype=wp.int32),
    bodies: Bodies,
    vertex: wp.array(dtype=wp.vec3d),
    impulse: wp.array(dtype=wp.vec3d),
    dt: wp.array(dtype=wp.float32),
    clock: wp.array(dtype=Clock),
):
    """One step of a deforming surface's vertex: what contacts on its triangles give it, by their barycentric weights, and its way.

    `near` are the pairs that may meet one of its triangles, from `start[k]` on for vertex `own[k]`.
    """
    k = first + wp.tid()
    if clock[0].stop != 0:
        return
    i = own[k]
    f = wp.vec3d()
    for e in range(start[k], start[k + 1]):
        q = near[e]
        for s in range(SLOT_COUNT):
            face = pairs.face[q, s]
            if face >= 0:
                for c in range(3):
                    if corner[face + c] == i:
                        f -= pairs.share[q, s][c] * pairs.load[q, s]
    h = wp.float64(dt[0])
    impulse[k] = impulse[k] + h * f
    v = bodies.speed[i] + (h * bodies.yields[i]) * f
    bodies.speed[i] = v
    vertex[i] = vertex[i] + h * v


@wp.kernel
def drift_soft(
    first: wp.int32,
    row: wp.array(dtype=wp.int32),
    start: wp.array(dtype=wp.int32),
    own: wp.array(dtype=wp.int32),
    bodies: Bodies,
    dt: wp.array(dtype=wp.float32),
    clock: wp.array(dtype=Clock),
):
    """Way of a deforming surface in a step, at most."""
    k = first + wp.tid()
    if clock[0].stop != 0:
        return
    most = wp.float64(0.0)
    for e in range(start[k], start[k + 1]):
        most = wp.max(most, wp.length_sq(bodies.speed[own[e]]))
    b = row[k]
    bodies.drift[b] = bodies.drift[b] + wp.sqrt(most) * wp.float64(dt[0])
