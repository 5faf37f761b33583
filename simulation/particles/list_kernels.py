# mypy: ignore-errors
"""Warp kernels that sort grains by cells and list their neighbours; what contacts store goes over from the old lists."""

import warp as wp

from .grain_kernels import MET, State, radius_of

wp.set_module_options({"enable_backward": False})

__all__ = ["GONE", "clear_spans", "keys", "reorder", "search", "spans"]

GONE = 2147483647
"""Key of a grain that has left its domain: sorts last."""
LAST = wp.constant(wp.int32(GONE))
MET_BIT = wp.constant(wp.int32(MET))
INDEX = wp.constant(wp.int32(MET - 1))


@wp.func
def wrapped(k: wp.int32, size: wp.int32):
    """A cell number within the table."""
    m = k % size
    if m < 0:
        m += size
    return m


@wp.func
def cell_at(place: wp.vec4i, low: wp.vec3i, shift: wp.float32):
    """Cell that a place lies in."""
    return wp.vec3i(
        wp.int32(wp.floor(wp.float32(place[0] - low[0]) * shift)),
        wp.int32(wp.floor(wp.float32(place[1] - low[1]) * shift)),
        wp.int32(wp.floor(wp.float32(place[2] - low[2]) * shift)),
    )


@wp.kernel
def keys(
    first: wp.int32,
    state: State,
    low: wp.vec3i,
    high: wp.vec3i,
    shift: wp.float32,
    size: wp.vec3i,
    key: wp.array(dtype=wp.int32),
    index: wp.array(dtype=wp.int32),
):
    """Cell of each grain, and its place before sorting. `low` and `high` are the domain's corners, `shift` cells per unit."""
    i = first + wp.tid()
    p = state.place[i]
    c = cell_at(p, low, shift)
    k = (wrapped(c[2], size[2]) * size[1] + wrapped(c[1], size[1])) * size[0] + wrapped(c[0], size[0])
    if p[0] < low[0] or p[1] < low[1] or p[2] < low[2] or p[0] > high[0] or p[1] > high[1] or p[2] > high[2]:
        k = LAST
    key[i] = k
    index[i] = i


@wp.kernel
def clear_spans(first: wp.int32, key: wp.array(dtype=wp.int32), span: wp.array(dtype=wp.vec2i)):
    """Empty the cells that the last sort filled."""
    i = first + wp.tid()
    k = key[i]
    if k != LAST and (i == 0 or key[i - 1] != k):
        span[k] = wp.vec2i(0, 0)


@wp.kernel
def spans(first: wp.int32, count: wp.int32, key: wp.array(dtype=wp.int32), span: wp.array(dtype=wp.vec2i)):
    """First and past-the-last grain of each cell that holds any; the first grain of a cell writes both."""
    i = first + wp.tid()
    k = key[i]
    if k != LAST and (i == 0 or key[i - 1] != k):
        end = i + 1
        while end < count and key[end] == k:
            end += 1
        span[k] = wp.vec2i(i, end)


@wp.kernel
def reorder(first: wp.int32, index: wp.array(dtype=wp.int32), before: State, after: State):
    """Carry all values of grain index[i] to place i."""
    i = first + wp.tid()
    j = index[i]
    after.place[i] = before.place[j]
    after.left[i] = before.left[j]
    after.motion[i] = before.motion[j]
    after.spin[i] = before.spin[j]
    after.rest[i] = before.rest[j]
    after.rest_spin[i] = before.rest_spin[j]
    after.identity[i] = before.identity[j]
    after.start[i] = before.place[j]
    after.air[i] = before.air[j]
    after.pull[i] = before.pull[j]
    after.blown[i] = before.blown[j]


@wp.kernel
def search(
    first: wp.int32,
    state: State,
    span: wp.array(dtype=wp.vec2i),
    low: wp.vec3i,
    shift: wp.float32,
    size: wp.vec3i,
    unit: wp.float32,
    skin: wp.float32,
    index: wp.array(dtype=wp.int32),
    old_count: wp.array(dtype=wp.int32),
    old_near: wp.array(dtype=wp.int32),
    old_spring: wp.array(dtype=wp.vec3),
    old_roll: wp.array(dtype=wp.vec3),
    old_row: wp.int32,
    old_stride: wp.int32,
    rolls: wp.int32,
    room: wp.int32,
    row: wp.int32,
    stride: wp.int32,
    count: wp.array(dtype=wp.int32),
    near: wp.array(dtype=wp.int32),
    spring: wp.array(dtype=wp.vec3),
    roll: wp.array(dtype=wp.vec3),
):
    """List the grains within `skin` of grain i, with what their contacts stored. `count` goes beyond `room` where the list was too short."""
    i = first + wp.tid()
    p = state.place[i]
    r = radius_of(p)
    c = cell_at(p, low, shift)
    before = index[i]
    old = wp.int32(0)
    if old_row > 0:
        old = old_count[before]
    found = wp.int32(0)
    at = i * row
    for k in range(27):
        cell = (wrapped(c[2] + k / 9 - 1, size[2]) * size[1] + wrapped(c[1] + (k / 3) % 3 - 1, size[1])) * size[0] + wrapped(
            c[0] + k % 3 - 1, size[0]
        )
        run = span[cell]
        for j in range(run[0], run[1]):
            q = state.place[j]
            way = wp.vec3(wp.float32(p[0] - q[0]), wp.float32(p[1] - q[1]), wp.float32(p[2] - q[2])) * unit
            reach = r + radius_of(q) + skin
            if j != i and wp.length_sq(way) < reach * reach:
                if found < room:
                    entry = j
                    other = index[j]
                    then = before * old_row
                    for _m in range(old):
                        e = old_near[then]
                        if e >= MET_BIT and (e & INDEX) == other:
                            entry = j | MET_BIT
                            spring[at] = old_spring[then]
                            if rolls != 0:
                                roll[at] = old_roll[then]
                        then += old_stride
                    near[at] = entry
                    at += stride
                found += 1
    count[i] = found
