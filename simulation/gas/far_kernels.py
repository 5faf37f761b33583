# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Ties between an active box and the coarse cells of the whole box that it lies in.

A coarse cell is `many` cells wide; the active box begins at cell `low` of the whole one. Its inner sides are those that do not lie in sides of
the whole box.
"""

import warp as wp

from ..grids.columns import vec6i
from .border_kernels import side_of
from .box_kernels import Box, count_of, face_place, index_of, is_cell, place_of, sample, speed

wp.set_module_options({"enable_backward": False})

__all__ = ["collect_cells", "collect_faces", "fill", "press", "tell"]


@wp.func
def fine_at(coarse: wp.int32, many: int, low: int, n: int, last: int):
    """First cell of a coarse one, counted from the active box on; that behind all cells where the coarse box ends beyond the whole one."""
    x = many * coarse - low
    if coarse == last and x > n and x - many < n:
        x = n
    return x


@wp.kernel
def collect_faces(
    first: wp.int32, far: Box, box: Box, many: int, low: wp.vec3i, opening: wp.array(dtype=wp.vec3), velocity: wp.array(dtype=wp.vec3),
    out: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Speeds of coarse faces by what flows through the faces of the active box that they are made of."""
    c = first + wp.tid()
    at = place_of(far, c)
    v = out[c]
    for axis in range(3):
        second = (axis + 1) % 3
        third = (axis + 2) % 3
        x = fine_at(at[axis], many, low[axis], count_of(box, axis), count_of(far, axis))
        y = many * at[second] - low[second]
        z = many * at[third] - low[third]
        inside = x >= 0 and x <= count_of(box, axis) and y >= 0 and z >= 0
        if inside and y < count_of(box, second) and z < count_of(box, third):
            flux = float(0.0)
            total = float(0.0)
            face = wp.vec3i(0, 0, 0)
            face[axis] = x
            for j in range(y, wp.min(y + many, count_of(box, second))):
                for k in range(z, wp.min(z + many, count_of(box, third))):
                    face[second] = j
                    face[third] = k
                    f = index_of(box, face[0], face[1], face[2])
                    flux += opening[f][axis] * velocity[f][axis]
                    total += opening[f][axis]
            if total > 0.0:
                v[axis] = flux / total
    out[c] = v


@wp.kernel
def collect_cells(
    first: wp.int32, far: Box, box: Box, many: int, low: wp.vec3i, room: wp.array(dtype=float), state: wp.array(dtype=wp.vec4),
    expansion: wp.array(dtype=float), to_state: wp.array(dtype=wp.vec4), to_expansion: wp.array(dtype=float),
):  # fmt: skip
    """Means of what the cells of the active box hold and make, in coarse cells; nothing in those beyond it."""
    c = first + wp.tid()
    at = place_of(far, c)
    total = float(0.0)
    made = float(0.0)
    q = wp.vec4(0.0, 0.0, 0.0, 0.0)
    if is_cell(far, at):
        x = many * at[0] - low[0]
        y = many * at[1] - low[1]
        z = many * at[2] - low[2]
        if x >= 0 and y >= 0 and z >= 0:
            for i in range(x, wp.min(x + many, box.nx)):
                for j in range(y, wp.min(y + many, box.ny)):
                    for k in range(z, wp.min(z + many, box.nz)):
                        f = index_of(box, i, j, k)
                        total += room[f]
                        made += room[f] * expansion[f]
                        q = q + room[f] * state[f]
    if total > 0.0:
        q = q / total
        made = made / total
    to_state[c] = q
    to_expansion[c] = made


@wp.func
def between_cells(far: Box, room: wp.array(dtype=float), x: wp.array(dtype=float), at: wp.vec3):
    """Pressure at a place [coarse cells], between the middles of cells that have room: 0 at open sides, the same behind closed ones."""
    y = at - wp.vec3(0.5, 0.5, 0.5)
    base = wp.vec3i(int(wp.floor(y[0])), int(wp.floor(y[1])), int(wp.floor(y[2])))
    total = float(0.0)
    found = float(0.0)
    for s in range(8):
        cell = wp.vec3i(base[0] + s // 4, base[1] + (s // 2) % 2, base[2] + s % 2)
        weight = float(1.0)
        for a in range(3):
            share = y[a] - float(base[a])
            if cell[a] == base[a]:
                share = 1.0 - share
            weight *= share
        sign = float(1.0)
        for a in range(3):
            n = count_of(far, a)
            if cell[a] < 0:
                cell[a] = 0
                if far.opens[2 * a] == 1:
                    sign = -sign
            if cell[a] >= n:
                cell[a] = n - 1
                if far.opens[2 * a + 1] == 1:
                    sign = -sign
        c = index_of(far, cell[0], cell[1], cell[2])
        if room[c] > 0.0:
            total += weight
            found += sign * weight * x[c]
    if total > 0.0:
        found = found / total
    return found


@wp.func
def place_in_far(at: wp.vec4i, axis: int, many: int, low: wp.vec3i):
    """Middle of such a face [coarse cells]."""
    y = wp.vec3(0.0, 0.0, 0.0)
    for a in range(3):
        shift = float(0.5)
        if a == axis:
            shift = 0.0
        y[a] = (float(at[a] + low[a]) + shift) / float(many)
    return y


@wp.kernel
def press(
    first: wp.int32, axis: int, far: Box, box: Box, many: int, low: wp.vec3i, inner: vec6i, room: wp.array(dtype=float),
    x: wp.array(dtype=float), lift: wp.array(dtype=float), velocity: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Let the pressure of the coarse cells push at the inner sides along an axis, one thread per face; that of cells inside is still to come."""
    at = side_of(box, axis, first + wp.tid())
    if inner[2 * axis + at[3]] == 1:
        f = index_of(box, at[0], at[1], at[2])
        pressure = float(many) * between_cells(far, room, x, place_in_far(at, axis, many, low))
        v = velocity[f]
        v[axis] = v[axis] + lift[f] * wp.where(at[3] == 0, pressure, -pressure)
        velocity[f] = v


@wp.kernel
def tell(
    first: wp.int32, axis: int, far: Box, box: Box, many: int, low: wp.vec3i, inner: vec6i, velocity: wp.array(dtype=wp.vec3),
    out: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Velocity of the air beyond the inner sides along an axis, one thread per face, in the order of `Box.beyond`."""
    n = first + wp.tid()
    at = side_of(box, axis, n)
    if inner[2 * axis + at[3]] == 1:
        out[box.starts[axis] + n] = speed(far, velocity, place_in_far(at, axis, many, low))


@wp.kernel
def fill(
    first: wp.int32, far: Box, box: Box, many: int, low: wp.vec3i, start: wp.vec3i, end: wp.vec3i, velocity: wp.array(dtype=wp.vec3),
    out: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Speeds of the faces of an active box that did not lie in the one before it, whose cells were those from `start` up to `end`, both
    counted from the new one on."""
    c = first + wp.tid()
    at = place_of(box, c)
    v = out[c]
    for axis in range(3):
        known = int(1)
        exists = int(1)
        for a in range(3):
            last = end[a]
            if a == axis:
                last = last + 1
            if at[a] < start[a] or at[a] >= last:
                known = 0
            if at[a] >= count_of(box, a) and a != axis:
                exists = 0
        if known == 0 and exists == 1:
            x = face_place(at, axis)
            for a in range(3):
                x[a] = (x[a] + float(low[a])) / float(many)
            v[axis] = sample(far, velocity, axis, x)
    out[c] = v
