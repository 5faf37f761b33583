# mypy: ignore-errors
"""Warp kernel that places samples inside surfaces. Import only where warp is used."""

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = ["inside_cells"]


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
