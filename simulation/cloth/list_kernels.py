# mypy: ignore-errors
"""Warp kernels that bring found pairs into lists: in order on a CPU, in any order on a GPU."""

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = ["gather", "together"]


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
def gather(
    first: wp.int32,
    room: wp.int32,
    most: wp.int32,
    found: wp.array(dtype=wp.int32),
    pairs: wp.array(dtype=wp.vec4i),
    kinds: wp.array(dtype=wp.vec2i),
    all_pairs: wp.array(dtype=wp.vec4i),
    all_kinds: wp.array(dtype=wp.vec2i),
    slack: wp.array(dtype=wp.float64),
    book: wp.array(dtype=wp.int64),
):
    """Write what something found, of `room` for each, into the first `most` places, in any order. The book counts all that was found,
    and in its third place after that the most that one found: whether they had room is asked later."""
    t = first + wp.tid()
    count = found[t]
    if count == 0:
        return
    if count > room:
        wp.atomic_max(book, 3, wp.int64(count))
        count = room
    place = wp.int32(wp.atomic_add(book, 0, wp.int64(count)))
    for k in range(count):
        if place + k < most:
            p = place + k
            all_pairs[p] = pairs[t * room + k]
            all_kinds[p] = kinds[t * room + k]
            slack[p] = wp.float64(0.0)
