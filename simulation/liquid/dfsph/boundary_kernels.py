# mypy: ignore-errors
"""Warp kernels of boundaries: bodies, their samples in the order of cells, and the pairs (particle, body) as `pair_kernels.py` finds them.

All samples of one body near one particle act through one vector B = sum_s V_s grad W_is: the pressure force on the liquid is
-V_i p_i B, central between particle and sample, so the same force at the particle gives the body's torque. A pair (particle, body)
therefore stands for all its samples in both solves.
"""

import warp as wp

from .step_slots import Slot

wp.set_module_options({"enable_backward": False})

__all__ = ["Bodies", "Pairs", "Samples", "Surfaces", "arrange", "at_corners", "at_place", "bear", "place", "wall_speed"]

DT = wp.constant(int(Slot.DT))


@wp.struct
class Samples:
    """Boundary samples in the order of their cells."""

    count: wp.int32
    x: wp.array(dtype=wp.vec3)
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
    """Most that an impulse at the centre changes the speed, per impulse; 0 where the body does not react."""
    mobility: wp.array(dtype=wp.mat33)
    """Velocity per impulse at the centre, what else holds the body included."""
    turning: wp.array(dtype=wp.mat33)
    """Angular velocity per angular impulse likewise."""
    friction: wp.array(dtype=wp.float32)
    deforms: wp.array(dtype=wp.int32)
    vertex_velocity: wp.array(dtype=wp.vec3)
    vertex_start: wp.array(dtype=wp.vec3)


@wp.func
def at_place(velocity: wp.vec3, spin: wp.vec3, arm: wp.vec3):
    """Velocity of a rigid body at an arm from its centre."""
    return velocity + wp.cross(spin, arm)


@wp.func
def at_corners(values: wp.array(dtype=wp.vec3), corner: wp.vec3i, share: wp.vec3):
    """Value at a place on a triangle, from those at its corners."""
    return share[0] * values[corner[0]] + share[1] * values[corner[1]] + share[2] * values[corner[2]]


@wp.struct
class Pairs:
    """(particle, body) pairs, those of a particle side by side."""

    start: wp.array(dtype=wp.int32)
    touched: wp.array(dtype=wp.int32)
    particle: wp.array(dtype=wp.int32)
    body: wp.array(dtype=wp.int32)
    slope: wp.array(dtype=wp.vec3)
    borne: wp.array(dtype=wp.vec3)
    drag: wp.array(dtype=wp.float32)
    corner: wp.array(dtype=wp.vec3i)
    share: wp.array(dtype=wp.vec3)
    give: wp.array(dtype=wp.float32)


@wp.func
def wall_speed(pairs: Pairs, bodies: Bodies, k: wp.int32, xi: wp.vec3):
    """Velocity of the body of pair k at its particle: of one that deforms, that of the nearest place of its surface."""
    b = pairs.body[k]
    u = at_place(bodies.velocity[b], bodies.spin[b], xi - bodies.center[b])
    if bodies.deforms[b] != 0:
        u = at_corners(bodies.vertex_velocity, pairs.corner[k], pairs.share[k])
    return u


@wp.struct
class Surfaces:
    """Surfaces of the bodies in their own frames, and where those are."""

    mesh: wp.array(dtype=wp.uint64)
    kind: wp.array(dtype=wp.int32)
    rotation: wp.array(dtype=wp.mat33)
    position: wp.array(dtype=wp.vec3)


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
    volume: wp.array(dtype=wp.float32),
    body: wp.array(dtype=wp.int32),
    out: Samples,
):
    """Samples in the order of their cells."""
    i = first + wp.tid()
    j = index[i]
    out.x[i] = x[j]
    out.volume[i] = volume[j]
    out.body[i] = body[j]


@wp.kernel
def bear(
    first: wp.int32,
    volume: wp.array(dtype=wp.float32),
    lightness: wp.array(dtype=wp.float32),
    pairs: Pairs,
    settings: wp.array(dtype=wp.float32),
    borne: wp.array(dtype=wp.vec3),
    v: wp.array(dtype=wp.vec3),
    force: wp.array(dtype=wp.vec3),
    back: wp.array(dtype=wp.vec3),
):
    """Pressure goes on behind walls with the gradient that bears liquid at rest: what this gives a particle.

    Without it the pressure of a liquid at rest bends within a spacing of a wall, and bodies feel too large a volume. `borne` is the part
    of the domain's sides.
    """
    i = first + wp.tid()
    total = wp.vec3(0.0, 0.0, 0.0)
    if lightness[i] > 0.0:
        total = borne[i]
    for k in range(pairs.start[i], pairs.start[i] + pairs.touched[i]):
        f = wp.vec3(0.0, 0.0, 0.0)
        if lightness[i] > 0.0:
            f = (volume[i] / lightness[i]) * pairs.borne[k]
            total += pairs.borne[k]
        force[k] = -f
        back[k] = f
    v[i] = v[i] + settings[DT] * total
