# mypy: ignore-errors
"""Warp kernels that bring found pairs into lists: all of them, and those of each vertex."""

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = ["by_vertex", "starts", "together"]


@wp.kernel
def together(
    first: wp.int32,
    room: wp.int32,
    behind: wp.int32,
    found: wp.array(dtype=wp.int32),
    before: wp.array(dtype=wp.int32),
    pairs: wp.array(dtype=wp.vec4i),
    kinds: wp.array(dtype=wp.vec2i),
    all_pairs: wp.array(dtype=wp.vec4i),
    all_kinds: wp.array(dtype=wp.vec2i),
):
    """Write what a triangle found, of `room` for each, behind what those before it found and `behind` others."""
    t = first + wp.tid()
    for k in range(found[t]):
        all_pairs[behind + before[t] + k] = pairs[t * room + k]
        all_kinds[behind + before[t] + k] = kinds[t * room + k]


@wp.kernel
def by_vertex(
    first: wp.int32,
    vertices: wp.int32,
    pairs: wp.array(dtype=wp.vec4i),
    key: wp.array(dtype=wp.int32),
    item: wp.array(dtype=wp.int32),
):
    """Keys that sort the corners of all pairs by vertex, those that are not among the first `vertices` last."""
    i = first + wp.tid()
    key[i] = wp.min(pairs[i / 4][i % 4], vertices)
    item[i] = i


@wp.kernel
def starts(first: wp.int32, count: wp.int32, key: wp.array(dtype=wp.int32), start: wp.array(dtype=wp.int32)):
    """Where each vertex' corners begin among the sorted."""
    i = first + wp.tid()
    start[i] = wp.lower_bound(key, 0, count, i)
