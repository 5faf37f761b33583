# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Warp kernels of the judge of liquids: depth of points in a closed mesh, ways that meet one, and sums over neighbouring particles.

All only gather: thread i reads what it likes and writes its own answer. Import only where warp is used.
"""

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = ["crowding", "depth", "met"]


@wp.kernel
def depth(
    first: wp.int32,
    mesh: wp.uint64,
    points: wp.array(dtype=wp.vec3),
    sides: wp.array(dtype=wp.vec2),
    reach: float,
    least: float,
    found: wp.array(dtype=float),
):
    """Distance to the surface [m], positive inside, negative outside; -reach where farther than reach; 0 below `least`.

    `sides`: such a distance of another point, and how far that is away. Where both distances reach over the way between them, no
    surface lies there, and the sign is the same; elsewhere it is that of the winding number, which costs several times as much.
    """
    i = first + wp.tid()
    found[i] = -reach
    query = wp.mesh_query_point_no_sign(mesh, points[i], reach)
    if query.result:
        distance = wp.length(points[i] - wp.mesh_eval_position(mesh, query.face, query.u, query.v))
        if distance <= least:
            found[i] = 0.0
        elif wp.abs(sides[i][0]) + distance > sides[i][1]:
            found[i] = wp.sign(sides[i][0]) * distance
        else:
            signed = wp.mesh_query_point_sign_winding_number(mesh, points[i], reach)
            found[i] = -signed.sign * distance


@wp.kernel
def met(
    first: wp.int32,
    mesh: wp.uint64,
    start: wp.array(dtype=wp.vec3),
    end: wp.array(dtype=wp.vec3),
    found: wp.array(dtype=wp.uint8),
):
    """Which straight ways meet the surface, from either side."""
    i = first + wp.tid()
    way = end[i] - start[i]
    length = wp.length(way)
    found[i] = wp.uint8(0)
    if length > 0.0:
        query = wp.mesh_query_ray(mesh, start[i], way / length, length)
        if query.result:
            found[i] = wp.uint8(1)


@wp.kernel
def crowding(
    first: wp.int32,
    starts: wp.array(dtype=wp.int32),
    cells: wp.vec3i,
    size: float,
    points: wp.array(dtype=wp.vec3),
    velocity: wp.array(dtype=wp.vec3),
    volume: wp.array(dtype=float),
    support: float,
    asked: wp.array(dtype=wp.int32),
    filled: wp.array(dtype=float),
    divergence: wp.array(dtype=float),
    neighbours: wp.array(dtype=wp.int32),
):
    """Share of space that particles fill around those `asked` (1 at rest), divergence of velocity [1/s], neighbours within support.

    Cubic spline by Monaghan (1992), doi:10.1146/annurev.aa.30.090192.002551; support in metres. Particles lie sorted by cells of
    half the support (z fastest, two empty ones at its ends; x and y begin anew where there are too many), whose first rows are
    `starts`.
    """
    k = first + wp.tid()
    i = asked[k]
    here = points[i]
    own = velocity[i]
    inverse = 1.0 / support
    scale = 8.0 / 3.14159265 * inverse * inverse * inverse
    share = float(0.0)
    spread = float(0.0)
    count = int(0)
    x = int(here[0] / size) + cells[0]
    y = int(here[1] / size) + cells[1]
    z = int(here[2] / size) + 2
    for a in range(x - 2, x + 3):
        for b in range(y - 2, y + 3):
            row = ((a % cells[0]) * cells[1] + b % cells[1]) * cells[2] + z
            for j in range(starts[row - 2], starts[row + 3]):
                way = here - points[j]
                squared = wp.dot(way, way)
                if squared < support * support:
                    distance = wp.sqrt(squared)
                    q = inverse * distance
                    count += 1
                    value = float(0.0)
                    slope = float(0.0)
                    if q > 0.5:
                        rest = 1.0 - q
                        value = 2.0 * rest * rest * rest
                        slope = -6.0 * rest * rest
                    else:
                        value = 6.0 * q * q * (q - 1.0) + 1.0
                        slope = 6.0 * q * (3.0 * q - 2.0)
                    share += volume[j] * value
                    if distance > 0.0:
                        spread += volume[j] * slope * wp.dot(velocity[j] - own, way) / distance
    filled[k] = scale * share
    divergence[k] = scale * inverse * spread
    neighbours[k] = count - 1
