# mypy: ignore-errors
"""Warp kernels of what a GPU's steps are chosen by, and of what air and fields gave in them, folded as `passes.py` says."""

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = ["add", "airs", "close_most", "drifts", "fastest", "stretches"]

NOTHING = wp.constant(wp.float64(-1.0e300))


@wp.kernel
def drifts(
    first: wp.int32,
    span: wp.int32,
    width: wp.int32,
    total: wp.int32,
    mass: wp.array(dtype=wp.float64),
    v: wp.array(dtype=wp.vec3d),
    partial: wp.array2d(dtype=wp.float64),
):
    """Momentum of vertices."""
    t = first + wp.tid()
    start = (t / width) * span * width + t % width
    s = wp.vec3d()
    for i in range(start, wp.min(start + span * width, total), width):
        s += mass[i] * v[i]
    for c in range(3):
        wp.tile_store(partial[c], wp.tile_sum(wp.tile(s[c])), offset=t / width)


@wp.kernel
def fastest(
    first: wp.int32,
    span: wp.int32,
    width: wp.int32,
    total: wp.int32,
    weight: wp.float64,
    momentum: wp.array(dtype=wp.float64),
    v: wp.array(dtype=wp.vec3d),
    acceleration: wp.array(dtype=wp.vec3d),
    gravity: wp.vec3d,
    drift: wp.array(dtype=wp.vec3d),
    partial: wp.array2d(dtype=wp.float64),
):
    """Squares of the greatest speed against the mean velocity, `momentum` over the `weight` of all, and of the greatest acceleration beside
    gravity."""
    t = first + wp.tid()
    mean = wp.vec3d(momentum[0], momentum[1], momentum[2]) / weight
    if t == 0:
        drift[0] = mean
    start = (t / width) * span * width + t % width
    s = NOTHING
    p = NOTHING
    for i in range(start, wp.min(start + span * width, total), width):
        s = wp.max(s, wp.length_sq(v[i] - mean))
        p = wp.max(p, wp.length_sq(acceleration[i] - gravity))
    wp.tile_store(partial[0], wp.tile_max(wp.tile(s)), offset=t / width)
    wp.tile_store(partial[1], wp.tile_max(wp.tile(p)), offset=t / width)


@wp.kernel
def stretches(
    first: wp.int32,
    span: wp.int32,
    width: wp.int32,
    total: wp.int32,
    x: wp.array(dtype=wp.vec3d),
    edges: wp.array(dtype=wp.vec2i),
    length: wp.array(dtype=wp.float64),
    partial: wp.array2d(dtype=wp.float64),
):
    """Greatest length of edges over that at rest, and the negative of the least."""
    t = first + wp.tid()
    start = (t / width) * span * width + t % width
    s = NOTHING
    p = NOTHING
    for i in range(start, wp.min(start + span * width, total), width):
        e = edges[i]
        ratio = wp.length(x[e[0]] - x[e[1]]) / length[i]
        s = wp.max(s, ratio)
        p = wp.max(p, -ratio)
    wp.tile_store(partial[0], wp.tile_max(wp.tile(s)), offset=t / width)
    wp.tile_store(partial[1], wp.tile_max(wp.tile(p)), offset=t / width)


@wp.kernel
def close_most(
    first: wp.int32, width: wp.int32, parts: wp.int32, partial: wp.array2d(dtype=wp.float64), out: wp.array(dtype=wp.float64)
):
    """The greatest of each of two columns."""
    t = first + wp.tid()
    for c in range(2):
        s = NOTHING
        for k in range(t, parts, width):
            s = wp.max(s, partial[c, k])
        wp.tile_store(out, wp.tile_max(wp.tile(s)), offset=c)


@wp.kernel
def airs(
    first: wp.int32,
    span: wp.int32,
    width: wp.int32,
    total: wp.int32,
    mass: wp.array(dtype=wp.float64),
    acceleration: wp.array(dtype=wp.vec3d),
    gravity: wp.vec3d,
    x: wp.array(dtype=wp.vec3d),
    start_x: wp.array(dtype=wp.vec3d),
    partial: wp.array2d(dtype=wp.float64),
):
    """Force of the air and of fields [N] and its work on what vertices went [J]."""
    t = first + wp.tid()
    start = (t / width) * span * width + t % width
    s = wp.vec3d()
    w = wp.float64(0.0)
    for i in range(start, wp.min(start + span * width, total), width):
        f = mass[i] * (acceleration[i] - gravity)
        s += f
        w += wp.dot(f, x[i] - start_x[i])
    for c in range(3):
        wp.tile_store(partial[c], wp.tile_sum(wp.tile(s[c])), offset=t / width)
    wp.tile_store(partial[3], wp.tile_sum(wp.tile(w)), offset=t / width)


@wp.kernel
def add(first: wp.int32, some: wp.array(dtype=wp.float64), total: wp.array(dtype=wp.float64)):
    """Add to totals."""
    i = first + wp.tid()
    total[i] = total[i] + some[i]
