# mypy: ignore-errors
"""Warp kernels of neighbourhoods: cells, reordering, and one search that also sums density and gradients.

All gather: thread i writes only its own rows (or, for the spans of cells, entries that no other thread writes).
"""

from typing import Any

import warp as wp

from .list_kernels import KINDS, keep, neighbour, note
from .shape_kernels import cell, cell_of, slope, weight, wrapped

wp.set_module_options({"enable_backward": False})

__all__ = ["GONE", "clear_spans", "keys", "reorder", "search", "spans"]

GONE = 2147483647
"""Key of a particle that leaves, less the code of its way out: sorts last."""
LAST = wp.constant(wp.int32(GONE))
CELLS = wp.constant(wp.int32(GONE - (1 << 16)))
"""Keys from here on are no cells."""


@wp.kernel
def keys(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3),
    leaving: wp.array(dtype=wp.int32),
    low: wp.vec3,
    inverse: wp.float32,
    size: wp.vec3i,
    key: wp.array(dtype=wp.int32),
    index: wp.array(dtype=wp.int32),
):
    """Cell of each particle, and its place before sorting."""
    i = first + wp.tid()
    k = cell(cell_of(x[i], low, inverse), size)
    if leaving[i] != 0:
        k = LAST - leaving[i]
    key[i] = k
    index[i] = i


@wp.kernel
def clear_spans(first: wp.int32, key: wp.array(dtype=wp.int32), span: wp.array(dtype=wp.vec2i)):
    """Empty the cells that the last sort filled."""
    i = first + wp.tid()
    k = key[i]
    if k < CELLS and (i == 0 or key[i - 1] != k):
        span[k] = wp.vec2i(0, 0)


@wp.kernel
def spans(first: wp.int32, count: wp.int32, key: wp.array(dtype=wp.int32), span: wp.array(dtype=wp.vec2i)):
    """First and past-the-last particle of each cell that holds any; the first particle of a cell writes both."""
    i = first + wp.tid()
    k = key[i]
    if k < CELLS and (i == 0 or key[i - 1] != k):
        end = i + 1
        while end < count and key[end] == k:
            end += 1
        span[k] = wp.vec2i(i, end)


@wp.struct
class Particles:
    """State that a particle carries from step to step."""

    x: wp.array(dtype=wp.vec3)
    v: wp.array(dtype=wp.vec3)
    identity: wp.array(dtype=wp.int32)
    fluid: wp.array(dtype=wp.int32)
    volume: wp.array(dtype=wp.float32)
    temperature: wp.array(dtype=wp.float32)
    pressure: wp.array(dtype=wp.float32)
    push: wp.array(dtype=wp.float32)
    held: wp.array(dtype=wp.float32)


@wp.kernel
def reorder(first: wp.int32, index: wp.array(dtype=wp.int32), before: Particles, after: Particles):
    """Carry all values of particle index[i] to place i."""
    i = first + wp.tid()
    j = index[i]
    after.x[i] = before.x[j]
    after.v[i] = before.v[j]
    after.identity[i] = before.identity[j]
    after.fluid[i] = before.fluid[j]
    after.volume[i] = before.volume[j]
    after.temperature[i] = before.temperature[j]
    after.pressure[i] = before.pressure[j]
    after.push[i] = before.push[j]
    after.held[i] = before.held[j]


@wp.func
def joined(one: wp.vec2i, two: wp.vec2i):
    """Two runs of particles of which the second follows the first, or one where the other is empty."""
    if one[0] == one[1]:
        return two
    if two[0] == two[1]:
        return one
    return wp.vec2i(one[0], two[1])


@wp.func
def beyond(inside: wp.float32, k: wp.int32):
    """Distance in cells to the cell before (k = 0), to the own (1) and to the one after (2) from a place in a cell."""
    d = wp.float32(0.0)
    if k == 0:
        d = inside
    if k == 2:
        d = 1.0 - inside
    return d


@wp.kernel
def search(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3),
    volume: wp.array(dtype=wp.float32),
    lightness: wp.array(dtype=wp.float32),
    span: wp.array(dtype=wp.vec2i),
    low: wp.vec3,
    inverse: wp.float32,
    size: wp.vec3i,
    h: wp.float32,
    room: wp.int32,
    count: wp.array(dtype=wp.int32),
    near: wp.array(dtype=Any),
    row: wp.int32,
    stride: wp.int32,
    unit: wp.float32,
    fill: wp.array(dtype=wp.float32),
    lean: wp.array(dtype=wp.vec3),
    stiffness: wp.array(dtype=wp.float32),
):
    """List the neighbours of i with V_j grad W_ij, and sum its fill (density / rest density), their gradients and the diagonal.

    Neighbour k of particle i stands at i row + k stride. `count` goes beyond `room` where the list was too short.
    `lightness` is 1/density, 0 for held particles.
    """
    i = first + wp.tid()
    xi = x[i]
    vi = volume[i]
    c = cell_of(xi, low, inverse)
    found = wp.int32(0)
    at = i * row
    limit = h * h
    runs = wp.int32(3)
    left = wrapped(c[0] - 1, size[0])
    if left + 2 == wrapped(c[0] + 1, size[0]):
        runs = 1
    inside = (xi - low) * inverse - wp.vec3(wp.float32(c[0]), wp.float32(c[1]), wp.float32(c[2]))
    for k in range(9):
        aside = beyond(inside[1], k % 3)
        above = beyond(inside[2], k / 3)
        layer = wrapped(c[2] + k / 3 - 1, size[2]) * size[1]
        line = (layer + wrapped(c[1] + k % 3 - 1, size[1])) * size[0]
        here = runs
        if aside * aside + above * above > 1.001:
            here = 0
        for m in range(here):
            run = span[line + wrapped(left + m, size[0])]
            if runs == 1:
                run = joined(run, joined(span[line + left + 1], span[line + left + 2]))
            for j in range(run[0], run[1]):
                way = xi - x[j]
                if wp.dot(way, way) < limit and j != i:
                    if found < room:
                        note(near, at, j)
                    at += stride
                    found += 1
    sum_w = vi * weight(0.0, h)
    sum_g = wp.vec3(0.0, 0.0, 0.0)
    sum_d = wp.float32(0.0)
    per_h = 1.0 / h
    at = i * row
    for _k in range(wp.min(found, room)):
        j = neighbour(near[at])
        way = xi - x[j]
        q = wp.length(way) * per_h
        vj = volume[j]
        g = keep(near, at, j, way * (vj * slope(q, h)), unit)
        sum_w += vj * weight(q, h)
        sum_g += g
        sum_d += vi * lightness[j] / vj * wp.dot(g, g)
        at += stride
    count[i] = found
    fill[i] = sum_w
    lean[i] = sum_g
    stiffness[i] = sum_d


for _kind in KINDS:
    wp.overload(search, {"near": wp.array(dtype=_kind)})
