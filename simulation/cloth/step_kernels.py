# mypy: ignore-errors
"""Warp kernels that gather forces at vertices and move them."""

import warp as wp

from .force_kernels import across_face, sum_at_vertex, wind_past

wp.set_module_options({"enable_backward": False})

__all__ = ["blow", "carry", "catch_air", "fall", "lead", "tick"]


@wp.kernel
def fall(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3d),
    v: wp.array(dtype=wp.vec3d),
    mass: wp.array(dtype=wp.float64),
    corner_start: wp.array(dtype=wp.int32),
    corners: wp.array(dtype=wp.int32),
    force: wp.array(dtype=wp.vec3d),
    hinge_start: wp.array(dtype=wp.int32),
    hinge_items: wp.array(dtype=wp.int32),
    hinge_weight: wp.array(dtype=wp.float64),
    pull: wp.array(dtype=wp.vec3d),
    acceleration: wp.array(dtype=wp.vec3d),
    inverse: wp.array(dtype=wp.float64),
    target: wp.array(dtype=wp.vec3d),
    clock: wp.array(dtype=wp.float64),
    reaction: wp.array(dtype=wp.vec3d),
    u: wp.array(dtype=wp.vec3d),
):
    """Velocity after all forces but those of contacts; held vertices take theirs from what holds them, which feels the rest."""
    i = first + wp.tid()
    f = sum_at_vertex(i, corner_start, corners, force, hinge_start, hinge_items, hinge_weight, pull)
    dt = clock[0]
    m = mass[i]
    push = dt * (f + m * acceleration[i])
    if inverse[i] == wp.float64(0.0):
        speed = (target[i] - x[i]) / dt
        reaction[i] = reaction[i] + push - m * (speed - v[i])
        u[i] = speed
    else:
        u[i] = v[i] + push / m


@wp.kernel
def blow(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3d),
    v: wp.array(dtype=wp.vec3d),
    faces: wp.array(dtype=wp.vec3i),
    air: wp.array(dtype=wp.vec4d),
    drag: wp.array(dtype=wp.vec2d),
    force: wp.array(dtype=wp.vec3d),
):
    """A third of the air's force on each triangle, by its velocity past the triangle: across it and along it."""
    t = first + wp.tid()
    f = faces[t]
    d = drag[t]
    third = wp.float64(1.0 / 3.0)
    a = air[t]
    w = wind_past(a, v, f)
    face = across_face(x, f)
    n = wp.vec3d(face[0], face[1], face[2])
    across = wp.dot(w, n)
    force[t] = wp.float64(0.25) * a[3] * face[3] * wp.length(w) * third * (d[0] * across * n + d[1] * (w - across * n))


@wp.kernel
def catch_air(
    first: wp.int32,
    mass: wp.array(dtype=wp.float64),
    corner_start: wp.array(dtype=wp.int32),
    corners: wp.array(dtype=wp.int32),
    force: wp.array(dtype=wp.vec3d),
    body_force: wp.array(dtype=wp.vec3d),
    acceleration: wp.array(dtype=wp.vec3d),
):
    """Acceleration of each vertex by gravity and fields (`body_force`, per mass) and by the air on its triangles."""
    i = first + wp.tid()
    f = wp.vec3d()
    for k in range(corner_start[i], corner_start[i + 1]):
        f += force[corners[k] / 3]
    acceleration[i] = body_force[i] + f / mass[i]


@wp.kernel
def lead(
    first: wp.int32,
    vertex: wp.array(dtype=wp.int32),
    row: wp.array(dtype=wp.int32),
    place: wp.array(dtype=wp.vec3d),
    rotation: wp.array(dtype=wp.mat33d),
    origin: wp.array(dtype=wp.vec3d),
    center: wp.array(dtype=wp.vec3d),
    velocity: wp.array(dtype=wp.vec3d),
    spin: wp.array(dtype=wp.vec3d),
    clock: wp.array(dtype=wp.float64),
    x: wp.array(dtype=wp.vec3d),
    target: wp.array(dtype=wp.vec3d),
    u: wp.array(dtype=wp.vec3d),
):
    """Where bodies take their vertices by the end of this step, and how fast they go there."""
    k = first + wp.tid()
    b = row[k]
    i = vertex[k]
    time = clock[1] + clock[0]
    arm = rotation[b] * place[k] + origin[b] - center[b]
    rate = wp.length(spin[b])
    if rate > wp.float64(0.0):
        axis = spin[b] / rate
        s = wp.sin(rate * time)
        c = wp.cos(rate * time)
        arm = c * arm + s * wp.cross(axis, arm) + (wp.float64(1.0) - c) * wp.dot(axis, arm) * axis
    target[i] = center[b] + time * velocity[b] + arm
    u[i] = (target[i] - x[i]) / clock[0]


@wp.kernel
def tick(first: wp.int32, clock: wp.array(dtype=wp.float64)):
    """Time goes on by a step: since the bodies' states were given, and since pairs were looked for."""
    if first + wp.tid() == 0:
        clock[1] = clock[1] + clock[0]
        clock[2] = clock[2] + clock[0]


@wp.kernel
def carry(
    first: wp.int32, sheets: wp.int32, clock: wp.array(dtype=wp.float64), u: wp.array(dtype=wp.vec3d), x: wp.array(dtype=wp.vec3d)
):
    """Move the solids' vertices, which come after those of the sheets."""
    i = sheets + first + wp.tid()
    x[i] = x[i] + clock[0] * u[i]
