# mypy: ignore-errors
"""Warp kernels of the tests of prepared passes."""

import warp as wp

wp.set_module_options({"enable_backward": False})


@wp.kernel
def add(first: wp.int32, step: wp.float32, values: wp.array(dtype=wp.float32)):
    i = first + wp.tid()
    values[i] = values[i] + step


@wp.kernel
def count_down(first: wp.int32, left: wp.array(dtype=wp.int32)):
    left[0] = left[0] - 1
