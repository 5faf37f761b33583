# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Warp kernels of the judge of liquids: depth of points in a closed mesh, and sums over neighbouring particles.

All only gather: thread i reads what it likes and writes its own answer. Import only where warp is used.
"""

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = ["crowding", "depth"]


@wp.kernel
def depth(first: wp.int32, mesh: wp.uint64, points: wp.array(dtype=wp.vec3), reach: float, found: wp.array(dtype=float)):
    """Distance to the surface [m], positive inside (winding number), negative outside; -reach where farther than reach."""
    i = first + wp.tid()
    query = wp.mesh_query_point_sign_winding_number(mesh, points[i], reach)
    found[i] = -reach
    if query.result:
        nearest = wp.mesh_eval_position(mesh, query.face, query.u, query.v)
        found[i] = -query.sign * wp.length(points[i] - nearest)


@wp.func
def spline(q: float) -> float:
    """Cubic spline of support 1, times pi / 8."""
    if q >= 1.0:
        return 0.0
    if q > 0.5:
        return 2.0 * (1.0 - q) * (1.0 - q) * (1.0 - q)
    return 6.0 * q * q * (q - 1.0) + 1.0


@wp.func
def slope(q: float) -> float:
    """Its derivative."""
    if q >= 1.0:
        return 0.0
    if q > 0.5:
        return -6.0 * (1.0 - q) * (1.0 - q)
    return 6.0 * q * (3.0 * q - 2.0)


@wp.kernel
def crowding(
    first: wp.int32,
    grid: wp.uint64,
    points: wp.array(dtype=wp.vec3),
    velocity: wp.array(dtype=wp.vec3),
    volume: wp.array(dtype=float),
    support: float,
    filled: wp.array(dtype=float),
    divergence: wp.array(dtype=float),
    neighbours: wp.array(dtype=wp.int32),
):
    """Share of space that particles fill around each (1 at rest), divergence of velocity [1/s], neighbours within support.

    Cubic spline by Monaghan (1992), doi:10.1146/annurev.aa.30.090192.002551; support in metres.
    """
    i = first + wp.tid()
    here = points[i]
    scale = 8.0 / (3.14159265 * support * support * support)
    share = wp.float32(0.0)
    spread = wp.float32(0.0)
    count = wp.int32(0)
    query = wp.hash_grid_query(grid, here, support)
    j = wp.int32(0)
    while wp.hash_grid_query_next(query, j):
        way = here - points[j]
        distance = wp.length(way)
        if distance < support:
            q = distance / support
            share += volume[j] * scale * spline(q)
            count += 1
            if distance > 0.0:
                spread += volume[j] * scale / support * slope(q) * wp.dot(velocity[j] - velocity[i], way) / distance
    filled[i] = share
    divergence[i] = spread
    neighbours[i] = count - 1
