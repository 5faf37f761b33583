# mypy: ignore-errors
"""Warp kernels that ask a closed surface about points and columns of points. Import only where warp is used."""

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = ["columns", "nearest_places"]


@wp.kernel
def nearest_places(
    first: wp.int32,
    mesh: wp.uint64,
    points: wp.array(dtype=wp.vec3),
    reach: wp.float32,
    nearest: wp.array(dtype=wp.vec3),
    face: wp.array(dtype=wp.int32),
    sign: wp.array(dtype=wp.float32),
    outward: wp.array(dtype=wp.vec3),
):
    """Nearest point within `reach`, its face (-1 where there is none), the side (1 outside, -1 inside, 0 none) and the face's normal."""
    i = first + wp.tid()
    face[i] = -1
    sign[i] = 0.0
    found = wp.mesh_query_point_sign_normal(mesh, points[i], reach)
    if found.result:
        face[i] = found.face
        sign[i] = found.sign
        nearest[i] = wp.mesh_eval_position(mesh, found.face, found.u, found.v)
        outward[i] = wp.mesh_eval_face_normal(mesh, found.face)


@wp.kernel
def columns(
    first: wp.int32,
    mesh: wp.uint64,
    origin: wp.array(dtype=wp.vec3),
    direction: wp.vec3,
    step: wp.float32,
    count: wp.int32,
    skip: wp.float32,
    change: wp.array(dtype=wp.int8),
):
    """Surfaces entered less surfaces left between one point and the next of `count` points along each ray.

    A ray starts outside, half a step before its first point.
    """
    i = first + wp.tid()
    start = origin[i]
    last = step * float(count)
    at = float(0.0)  # noqa: UP018 - a bare number is a constant to Warp
    hits = int(0)  # noqa: UP018, RUF046
    while hits < 4096 and at < last:
        hit = wp.mesh_query_ray(mesh, start + at * direction, direction, last - at)
        if not hit.result:
            break
        until = at + hit.t
        k = int(wp.ceil(until / step - 0.5))
        if k < count:
            turn = wp.int8(1)
            if hit.sign < 0.0:
                turn = wp.int8(-1)
            change[i * count + k] = change[i * count + k] + turn
        at = until + skip
        hits = hits + 1
