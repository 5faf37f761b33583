# mypy: ignore-errors
"""Warp kernels that place samples inside surfaces. Import only where warp is used."""

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = ["inset", "inside_cells"]


@wp.kernel
def inset(
    first: wp.int32,
    mesh: wp.uint64,
    points: wp.array(dtype=wp.vec3),
    normals: wp.array(dtype=wp.vec3),
    depth: wp.float32,
    reach: wp.float32,
    moved: wp.array(dtype=wp.vec3),
    inside: wp.array(dtype=wp.float32),
    kept: wp.array(dtype=wp.int32),
):
    """Move a point against its normal by `depth`, in thin parts to the middle; keep it where no other face is nearer."""
    i = first + wp.tid()
    p = points[i]
    n = normals[i]
    d = depth
    hit = wp.mesh_query_ray(mesh, p - 1.0e-3 * depth * n, -n, 2.0 * depth)
    if hit.result:
        d = wp.min(d, 0.5 * (hit.t + 1.0e-3 * depth))
    x = p - d * n
    near = wp.mesh_query_point_no_sign(mesh, x, reach)
    gap = reach
    if near.result:
        gap = wp.length(wp.mesh_eval_position(mesh, near.face, near.u, near.v) - x)
    moved[i] = x
    inside[i] = d
    kept[i] = wp.where(gap > 0.93 * d, 1, 0)


@wp.kernel
def inside_cells(
    first: wp.int32,
    mesh: wp.uint64,
    center: wp.array(dtype=wp.vec3),
    size: wp.float32,
    depth: wp.float32,
    moved: wp.array(dtype=wp.vec3),
    share: wp.array(dtype=wp.float32),
):
    """Share of each cubic cell that lies inside a closed surface, at most `depth` below it, and the middle of that part."""
    i = first + wp.tid()
    x = center[i]
    moved[i] = x
    share[i] = 0.0
    near = wp.mesh_query_point_sign_winding_number(mesh, x, depth + size)
    if near.result:
        way = wp.mesh_eval_position(mesh, near.face, near.u, near.v) - x
        gap = wp.length(way)
        inside = -near.sign * gap
        if inside < depth:
            part = wp.clamp(0.5 + inside / size, 0.0, 1.0)
            share[i] = part
            if part < 1.0 and gap > 1.0e-6 * size:
                # The way leads out of the solid where x is inside, into it where it is outside.
                moved[i] = x + (near.sign * 0.5 * (1.0 - part) * size / gap) * way
