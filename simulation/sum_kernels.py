# mypy: ignore-errors
"""Warp kernels of sums in a fixed order (`passes.py` says how they share the work)."""

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = ["close", "fold"]


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
