# mypy: ignore-errors
"""Warp kernels that bring found pairs into lists: all of them, and those of each vertex."""

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = ["by_vertex", "enlist", "enlist_cut", "none_yet", "order", "starts", "together", "widest"]


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


@wp.kernel
def none_yet(first: wp.int32, start: wp.array(dtype=wp.int32), end: wp.array(dtype=wp.int32)):
    """Empty the lists of all vertices."""
    i = first + wp.tid()
    end[i] = start[i]


@wp.kernel
def enlist(
    first: wp.int32,
    yielding: wp.int32,
    room: wp.int32,
    pairs: wp.array(dtype=wp.vec4i),
    wanted: wp.array(dtype=wp.float64),
    end: wp.array(dtype=wp.int32),
    items: wp.array(dtype=wp.int32),
):
    """Corners of the pairs that press, at the first `yielding` vertices, in any order; those beyond `room` of a vertex are counted only."""
    p = first + wp.tid()
    if wanted[p] < wp.float64(-1.0e29):
        return
    for c in range(4):
        i = pairs[p][c]
        if i < yielding:
            place = wp.atomic_add(end, i, 1)
            if place < (i + 1) * room:
                items[place] = 4 * p + c


@wp.kernel
def enlist_cut(
    first: wp.int32,
    sheets: wp.int32,
    room: wp.int32,
    pairs: wp.array(dtype=wp.vec4i),
    wanted: wp.array(dtype=wp.float64),
    limit: wp.array(dtype=wp.vec4d),
    end: wp.array(dtype=wp.int32),
    items: wp.array(dtype=wp.int32),
):
    """Corners whose displacement is cut, at the first `sheets` vertices, as `enlist`."""
    p = first + wp.tid()
    if wanted[p] < wp.float64(-1.5e30):
        return
    for c in range(4):
        i = pairs[p][c]
        if i < sheets and limit[p][c] < wp.float64(1.0):
            place = wp.atomic_add(end, i, 1)
            if place < (i + 1) * room:
                items[place] = 4 * p + c


@wp.kernel
def order(
    first: wp.int32,
    room: wp.int32,
    start: wp.array(dtype=wp.int32),
    end: wp.array(dtype=wp.int32),
    items: wp.array(dtype=wp.int32),
    ordered: wp.array(dtype=wp.int32),
    over: wp.array(dtype=wp.int32),
):
    """Each of `room` corners of a vertex goes to its place in the order of the pairs, so that sums do not depend on who came first; say
    where there was no room."""
    place = first + wp.tid()
    i = place / room
    begin = start[i]
    last = wp.min(end[i], begin + room)
    if place >= last:
        return
    if place == begin and end[i] > last:
        over[2] = 1
        end[i] = last
    item = items[place]
    rank = wp.int32(0)
    for k in range(begin, last):
        if items[k] < item:
            rank += 1
    ordered[begin + rank] = item


@wp.kernel
def widest(first: wp.int32, found: wp.array(dtype=wp.int32), most: wp.array(dtype=wp.int32)):
    """Greatest number found."""
    k = found[first + wp.tid()]
    if k > most[0]:
        wp.atomic_max(most, 0, k)
