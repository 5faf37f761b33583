# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Rows of the pressure system of a box, and the velocities after it.

Unknowns are p time / (ambient density x cell) [m/s]: a face's velocity changes by their difference over its relative density. Faces count by
the share of them that is open; at open sides the pressure beyond is the ambient one, half a cell away.
"""

import warp as wp

from ..grids.columns import Columns, vec6, vec6i
from ..grids.columns import place_of as place_in
from .box_kernels import Box, beside, has_face, index_of, place_of, upper
from .force_kernels import face_density

wp.set_module_options({"enable_backward": False})

__all__ = ["LEAST_OPEN", "divergence", "gather", "link", "mark", "project", "shift", "weigh"]

LEAST_OPEN = wp.constant(0.05)
"""Faces open by less are closed."""


@wp.kernel
def mark(
    first: wp.int32, grid: Columns, box: Box, room: wp.array(dtype=float), red: wp.array(dtype=wp.int32),
    wet: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Cells with room for gas, and the red ones of them."""
    c = first + wp.tid()
    at = place_in(grid, c)
    w = int(room[index_of(box, at[0], at[1], at[2])] > 0.0)
    wet[c] = w
    red[c] = w * (1 - ((at[0] + at[1] + at[2]) & 1))


@wp.kernel
def link(
    first: wp.int32, grid: Columns, box: Box, cell: wp.array(dtype=wp.int32), row: wp.array(dtype=wp.int32),
    links: wp.array(dtype=vec6i), element: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Neighbouring rows of each row, its own number where there is none, and its element in the fields."""
    r = first + wp.tid()
    at = place_in(grid, cell[r])
    found = vec6i()
    for side in range(6):
        axis = side // 2
        step = 2 * (side - 2 * axis) - 1
        found[side] = r
        other = beside(box, at, axis, step)
        if other >= 0:
            to = place_of(box, other)
            q = row[(to[0] * box.ny + to[1]) * box.nz + to[2]]
            if q >= 0:
                found[side] = q
    links[r] = found
    element[r] = index_of(box, at[0], at[1], at[2])


@wp.kernel
def weigh(
    first: wp.int32, box: Box, sides: vec6i, load: float, expands: int, element: wp.array(dtype=wp.int32),
    links: wp.array(dtype=vec6i), opening: wp.array(dtype=wp.vec3), state: wp.array(dtype=wp.vec4),
    coefficient: wp.array(dtype=vec6), diagonal: wp.array(dtype=float),
):  # fmt: skip
    """Couplings of rows: open share over relative density; `sides` is 1 where a side of the box is open."""
    r = first + wp.tid()
    c = element[r]
    at = place_of(box, c)
    k = vec6()
    total = float(0.0)
    for side in range(6):
        axis = side // 2
        step = 2 * (side - 2 * axis) - 1
        face = c
        where = at
        if step == 1:
            face = upper(box, at, axis)
            where = place_of(box, face)
        share = opening[face][axis]
        if expands == 1:
            share = share / face_density(box, where, axis, load, state)
        if beside(box, at, axis, step) < 0:
            if sides[side] == 1:
                total += 2.0 * share
        elif links[r][side] != r and share > 0.0:
            k[side] = share
            total += share
    coefficient[r] = k
    diagonal[r] = wp.max(total, 1.0e-6)


@wp.func
def outflow(
    box: Box, c: wp.int32, size: float, velocity: wp.array(dtype=wp.vec3), opening: wp.array(dtype=wp.vec3),
    growth: wp.array(dtype=float), room: wp.array(dtype=float), expansion: wp.array(dtype=float),
):  # fmt: skip
    """Flux out of a cell, less what it should be [m/s]: what its gas makes, and what its room loses to solids that move."""
    at = place_of(box, c)
    total = float(0.0)
    for axis in range(3):
        up = upper(box, at, axis)
        total += opening[up][axis] * velocity[up][axis] - opening[c][axis] * velocity[c][axis]
    return total - size * (expansion[c] * room[c] - growth[c])


@wp.kernel
def gather(
    first: wp.int32, box: Box, size: float, element: wp.array(dtype=wp.int32), velocity: wp.array(dtype=wp.vec3),
    opening: wp.array(dtype=wp.vec3), growth: wp.array(dtype=float), room: wp.array(dtype=float),
    expansion: wp.array(dtype=float), right: wp.array(dtype=float),
):  # fmt: skip
    """Right sides."""
    r = first + wp.tid()
    right[r] = -outflow(box, element[r], size, velocity, opening, growth, room, expansion)


@wp.kernel
def shift(
    first: wp.int32, element: wp.array(dtype=wp.int32), region: wp.array(dtype=wp.int32), room: wp.array(dtype=float),
    by: wp.array(dtype=float), right: wp.array(dtype=float),
):  # fmt: skip
    """Take the mean of each region out of its right sides, by volume: a sealed one has no room for it."""
    r = first + wp.tid()
    c = element[r]
    right[r] = right[r] - by[region[c]] * room[c]


@wp.kernel
def project(
    first: wp.int32, grid: Columns, box: Box, sides: vec6i, load: float, expands: int, row: wp.array(dtype=wp.int32),
    x: wp.array(dtype=float), opening: wp.array(dtype=wp.vec3), solid: wp.array(dtype=wp.vec3), state: wp.array(dtype=wp.vec4),
    velocity: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Subtract the pressure's gradient; closed faces move as what closes them."""
    c = first + wp.tid()
    at = place_of(box, c)
    v = velocity[c]
    for axis in range(3):
        if has_face(box, at, axis):
            below = int(-1)
            above = int(-1)
            low = beside(box, at, axis, -1)
            if low >= 0:
                p = place_of(box, low)
                below = row[(p[0] * box.ny + p[1]) * box.nz + p[2]]
            if at[0] < box.nx and at[1] < box.ny and at[2] < box.nz:
                above = row[(at[0] * box.ny + at[1]) * box.nz + at[2]]
            share = opening[c][axis]
            if share <= 0.0:
                v[axis] = solid[c][axis]
            else:
                d = float(0.0)
                if below >= 0 and above >= 0:
                    d = x[above] - x[below]
                elif above >= 0 and low < 0 and sides[2 * axis] == 1:
                    d = 2.0 * x[above]
                elif below >= 0 and sides[2 * axis + 1] == 1:
                    d = -2.0 * x[below]
                if expands == 1:
                    d = d / face_density(box, at, axis, load, state)
                v[axis] = v[axis] - d
    velocity[c] = v


@wp.kernel
def divergence(
    first: wp.int32, total: int, block: int, box: Box, size: float, element: wp.array(dtype=wp.int32),
    velocity: wp.array(dtype=wp.vec3), opening: wp.array(dtype=wp.vec3), growth: wp.array(dtype=float),
    room: wp.array(dtype=float), expansion: wp.array(dtype=float),
    region: wp.array(dtype=wp.int32), by: wp.array(dtype=float), out: wp.array(dtype=wp.float64),
):  # fmt: skip
    """Largest |flux out of a cell - what it should be| of blocks of rows [m/s]."""
    b = first + wp.tid()
    top = float(0.0)
    for r in range(b * block, wp.min((b + 1) * block, total)):
        c = element[r]
        left = outflow(box, c, size, velocity, opening, growth, room, expansion)
        top = wp.max(top, wp.abs(left + by[region[c]] * room[c]))
    out[b] = wp.float64(top)
