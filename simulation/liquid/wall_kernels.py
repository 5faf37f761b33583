# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Nearest place on walls for many points, as a Warp kernel."""

import warp as wp

__all__ = ["nearest_wall"]

wp.set_module_options({"enable_backward": False})


@wp.kernel
def nearest_wall(
    first: wp.int32,
    mesh: wp.uint64,
    reach: wp.float32,
    points: wp.array(dtype=wp.vec3f),
    place: wp.array(dtype=wp.vec3f),
    sign: wp.array(dtype=wp.float32),
    outward: wp.array(dtype=wp.vec3f),
):
    """Nearest point of the mesh within `reach`, the side (1 outside, -1 inside, 0 none near) and the face's normal."""
    i = first + wp.tid()
    query = wp.mesh_query_point_sign_normal(mesh, points[i], reach)
    sign[i] = 0.0
    if query.result:
        sign[i] = query.sign
        place[i] = wp.mesh_eval_position(mesh, query.face, query.u, query.v)
        outward[i] = wp.mesh_eval_face_normal(mesh, query.face)
