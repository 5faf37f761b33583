# mypy: ignore-errors
"""Warp kernels of sums in a fixed order, and of the greatest of many counts (`passes.py` says how they share the work)."""

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = ["close", "close_greatest", "fold", "greatest"]


@wp.kernel
def fold(
    first: wp.int32,
    span: wp.int32,
    width: wp.int32,
    total: wp.int32,
    values: wp.array2d(dtype=wp.float32),
    partial: wp.array2d(dtype=wp.float64),
):
    """Sum of each column over the elements of a block."""
    t = first + wp.tid()
    start = (t / width) * span * width + t % width
    for c in range(values.shape[1]):
        s = wp.float64(0.0)
        for i in range(start, wp.min(start + span * width, total), width):
            s += wp.float64(values[i, c])
        wp.tile_store(partial[c], wp.tile_sum(wp.tile(s)), offset=t / width)


@wp.kernel
def close(
    first: wp.int32,
    width: wp.int32,
    parts: wp.int32,
    partial: wp.array2d(dtype=wp.float64),
    result: wp.array(dtype=wp.float64),
):
    """Sum of each column over all blocks."""
    t = first + wp.tid()
    for c in range(partial.shape[0]):
        s = wp.float64(0.0)
        for k in range(t, parts, width):
            s += partial[c, k]
        wp.tile_store(result, wp.tile_sum(wp.tile(s)), offset=c)


@wp.kernel
def greatest(
    first: wp.int32,
    span: wp.int32,
    width: wp.int32,
    total: wp.int32,
    count: wp.array(dtype=wp.int32),
    partial: wp.array(dtype=wp.int32),
):
    """Greatest of many counts."""
    t = first + wp.tid()
    start = (t / width) * span * width + t % width
    s = wp.int32(0)
    for i in range(start, wp.min(start + span * width, total), width):
        s = wp.max(s, count[i])
    wp.tile_store(partial, wp.tile_max(wp.tile(s)), offset=t / width)


@wp.kernel
def close_greatest(
    first: wp.int32, width: wp.int32, parts: wp.int32, partial: wp.array(dtype=wp.int32), out: wp.array(dtype=wp.int32)
):
    """The same of all blocks."""
    t = first + wp.tid()
    s = wp.int32(0)
    for k in range(t, parts, width):
        s = wp.max(s, partial[k])
    wp.tile_store(out, wp.tile_max(wp.tile(s)))
