# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Ways that run into a closed surface and soon out of it again."""

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = ["meet"]


@wp.kernel
def meet(
    first: wp.int32, mesh: wp.uint64, origin: wp.array(dtype=wp.vec3), direction: wp.vec3, length: float,
    hit: wp.array(dtype=wp.int32),
):  # fmt: skip
    """1 where a way of some length enters the surface and would be out of it again within as much more: each wall closes one face."""
    i = first + wp.tid()
    hit[i] = 0
    enter = wp.mesh_query_ray(mesh, origin[i], direction, length)
    if enter.result:
        if enter.sign > 0.0:
            skip = 1.0e-4 * length
            leave = wp.mesh_query_ray(mesh, origin[i] + (enter.t + skip) * direction, direction, length - skip)
            if leave.result:
                if leave.sign < 0.0:
                    hit[i] = 1
