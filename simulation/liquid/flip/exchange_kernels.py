# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Momentum between liquid and owners of faces: pressure on closed shares, half cells that stick to thin walls, the liquid's own change.

Lengths are in cells. Owners are rows of boundaries, then of inflows; -1 is the domain.
"""

import warp as wp

from ...grids.columns import Columns, place_of, vec6i
from .distance_kernels import Walls, wall_speed
from .solid_kernels import LEAST, face_center

wp.set_module_options({"enable_backward": False, "max_unroll": 3})

__all__ = ["Shut", "hold", "list_rows", "momentum", "push_rows", "touching", "vec6d", "vec27d", "wrench"]

vec6d = wp.types.vector(length=6, dtype=wp.float64)
vec27d = wp.types.vector(length=27, dtype=wp.float64)


@wp.struct
class Shut:
    """Which faces are closed and by whom; `inside` and `thin` hold where there are solids."""

    near: wp.array(dtype=vec6i)
    cell: wp.array(dtype=wp.int32)
    row: wp.array(dtype=wp.int32)
    phi: wp.array(dtype=float)
    opening: wp.array(dtype=wp.vec3)
    owner: wp.array(dtype=wp.vec3i)
    solids: wp.int32
    inside: wp.array(dtype=wp.int32)
    """Owner of the solid around a hidden cell (`grid_kernels.find_hidden`): all its closed faces are that one's; -2 elsewhere."""
    thin: wp.array(dtype=wp.vec3)
    """Share, once open, of faces that a thin wall closes: no cell in it carries the pressure at the wall."""
    gaps: wp.int32
    """1 where there are gaps thinner than a cell (`gap_kernels.py`)."""
    part: wp.array(dtype=wp.vec3)
    """Share of `one` in what is closed of a face, the rest being `other`'s; negative where a single solid closes it."""
    one: wp.array(dtype=wp.vec3i)
    other: wp.array(dtype=wp.vec3i)


@wp.func
def face_of(at: Shut, c: int, side: int):
    """Cell whose lower face a cell's side is."""
    face = int(c)
    if side % 2 == 1:
        face = at.near[c][side]
    return face


@wp.func
def half_cell(at: Shut, c: int, side: int):
    """Liquid between a cell's centre and a thin wall at its side, in cells: it moves as the wall does. 0 where there is none.

    Of the two cells at such a face one lies in the wall, so that all the open share is this one's.
    """
    m = float(0.0)
    if at.solids == 1:
        f = face_of(at, c, side)
        if f >= 0:
            if at.row[c] >= 0 and at.inside[c] == -2 and at.thin[f][side // 2] >= LEAST:
                m = at.thin[f][side // 2] * wp.clamp(0.5 - at.phi[c], 0.0, 1.0)
    return m


@wp.func
def owner_of(at: Shut, c: int, side: int):
    """Who closes a side of a cell."""
    who = int(-2)
    if at.solids == 1:
        who = at.inside[c]
    if who == -2:
        who = at.owner[face_of(at, c, side)][side // 2]
    return who


@wp.func
def part_of(at: Shut, c: int, side: int, who: int):
    """Part of what is closed of a cell's side that belongs to an owner."""
    axis = side // 2
    face = face_of(at, c, side)
    w = float(-1.0)
    if at.gaps == 1:
        w = at.part[face][axis]
    p = float(0.0)
    if w >= 0.0:
        if at.one[face][axis] == who:
            p += w
        if at.other[face][axis] == who:
            p += 1.0 - w
    elif owner_of(at, c, side) == who:
        p = 1.0
    return p


@wp.func
def closing_speed(at: Shut, walls: Walls, c: int, side: int, x: wp.vec3):
    """Velocity, along its axis, of what closes a cell's side [m/s]; each of two solids counts by its part."""
    axis = side // 2
    face = face_of(at, c, side)
    w = float(-1.0)
    if at.gaps == 1:
        w = at.part[face][axis]
    v = float(0.0)
    if w >= 0.0:
        v = w * wall_speed(walls, at.one[face][axis], x)[axis] + (1.0 - w) * wall_speed(walls, at.other[face][axis], x)[axis]
    else:
        v = wall_speed(walls, owner_of(at, c, side), x)[axis]
    return v


@wp.kernel
def touching(first: wp.int32, at: Shut, flag: wp.array(dtype=wp.int32), thin: wp.array(dtype=wp.int32)):
    """Rows with a face that is not fully open, and those with a thin wall."""
    r = first + wp.tid()
    c = at.cell[r]
    hit = int(0)
    held = int(0)
    for side in range(6):
        face = face_of(at, c, side)
        if face >= 0:
            if at.opening[face][side // 2] < 1.0:
                hit = 1
            if half_cell(at, c, side) > 0.0:
                held = 1
    flag[r] = hit
    thin[r] = held


@wp.kernel
def list_rows(
    first: wp.int32, flag: wp.array(dtype=wp.int32), before: wp.array(dtype=wp.int32), touched: wp.array(dtype=wp.int32)
):
    """Flagged rows, one after the other."""
    r = first + wp.tid()
    if flag[r] == 1:
        touched[before[r]] = r


@wp.func
def shut(share: float):
    """Solid share of a face."""
    if share < LEAST:
        return 1.0
    return 1.0 - share


@wp.func
def side_center(grid: Columns, c: int, side: int):
    """Centre of a side of a cell."""
    axis = side // 2
    x = face_center(place_of(grid, c), axis)
    if side % 2 == 1:
        x[axis] = x[axis] + 1.0
    return x


@wp.kernel
def wrench(
    first: wp.int32, grid: Columns, at: Shut, touched: wp.array(dtype=wp.int32), count: int, block: int, blocks: int,
    owners: wp.array(dtype=wp.int32), walls: Walls, q: wp.array(dtype=float), sums: wp.array(dtype=vec6d),
):  # fmt: skip
    """Sum of q over the solid shares of faces: along axes, and about the owner's centre [cells], for one owner and block of rows."""
    n = first + wp.tid()
    who = owners[n // blocks]
    b = n % blocks
    about = wp.vec3()
    if who >= 0:
        about = walls.center[who]
    total = vec6d()
    for t in range(b * block, wp.min((b + 1) * block, count)):
        r = touched[t]
        c = at.cell[r]
        for side in range(6):
            axis = side // 2
            face = face_of(at, c, side)
            if face >= 0:
                s = shut(at.opening[face][axis]) * part_of(at, c, side, who)
                if s > 0.0:
                    f = wp.vec3()
                    f[axis] = float(2 * (side % 2) - 1) * s * q[r]
                    m = wp.cross(side_center(grid, c, side) - about, f)
                    total += vec6d(
                        wp.float64(f[0]), wp.float64(f[1]), wp.float64(f[2]),
                        wp.float64(m[0]), wp.float64(m[1]), wp.float64(m[2]),
                    )  # fmt: skip
    sums[n] = total


@wp.kernel
def push_rows(
    first: wp.int32, grid: Columns, at: Shut, touched: wp.array(dtype=wp.int32), walls: Walls, y: wp.array(dtype=float),
    scale: float,
):  # fmt: skip
    """Add the flux that moving walls give to each touching cell: the transpose of `wrench`."""
    r = touched[first + wp.tid()]
    c = at.cell[r]
    total = float(0.0)
    for side in range(6):
        axis = side // 2
        face = face_of(at, c, side)
        sign = float(2 * (side % 2) - 1)
        if face >= 0:
            s = shut(at.opening[face][axis])
            if s > 0.0:
                total += sign * s * closing_speed(at, walls, c, side, side_center(grid, c, side))
    y[r] = y[r] + scale * total


@wp.kernel
def hold(
    first: wp.int32, grid: Columns, at: Shut, rows: wp.array(dtype=wp.int32), count: int, block: int, blocks: int,
    owners: wp.array(dtype=wp.int32), walls: Walls, velocity: wp.array(dtype=wp.vec3), sums: wp.array(dtype=vec27d),
):  # fmt: skip
    """Momentum and inertia of the half cells at an owner's thin walls, for one owner and block of rows, in cells of liquid.

    The first 6 numbers are the momentum, along axes and about the owner's centre; the other 21 are the upper half of the
    matrix that gives it from the owner's velocity and spin, row by row.
    """
    n = first + wp.tid()
    who = owners[n // blocks]
    b = n % blocks
    about = wp.vec3()
    if who >= 0:
        about = walls.center[who]
    total = vec27d()
    for t in range(b * block, wp.min((b + 1) * block, count)):
        c = at.cell[rows[t]]
        for side in range(6):
            m = half_cell(at, c, side)
            if m > 0.0:
                if owner_of(at, c, side) == who:
                    axis = side // 2
                    f = wp.vec3()
                    f[axis] = 1.0
                    g = wp.cross(side_center(grid, c, side) - about, f)
                    a = vec6d(
                        wp.float64(f[0]), wp.float64(f[1]), wp.float64(f[2]), wp.float64(g[0]), wp.float64(g[1]), wp.float64(g[2])
                    )
                    mass = wp.float64(m)
                    speed = wp.float64(velocity[face_of(at, c, side)][axis])
                    k = int(6)
                    for i in range(6):
                        total[i] = total[i] + mass * speed * a[i]
                        for j in range(i, 6):
                            total[k] = total[k] + mass * a[i] * a[j]
                            k += 1
    sums[n] = total


@wp.kernel
def momentum(
    first: wp.int32, cells: int, block: int, grid: Columns, at: Shut, before: wp.array(dtype=wp.vec3),
    after: wp.array(dtype=wp.vec3), sums: wp.array(dtype=vec6d),
):  # fmt: skip
    """Change of the liquid's momentum on its faces between two velocities, and about the grid's origin, in cells of liquid; half cells
    at thin walls count.
    """
    n = first + wp.tid()
    total = vec6d()
    for c in range(n * block, wp.min((n + 1) * block, cells)):
        place = place_of(grid, c)
        for axis in range(3):
            o = at.near[c][2 * axis]
            s = int(-1)
            if o >= 0:
                s = at.row[o]
            r = at.row[c]
            mass = half_cell(at, c, 2 * axis)
            if o >= 0:
                mass += half_cell(at, o, 2 * axis + 1)
            share = at.opening[c][axis]
            if share >= LEAST and (r >= 0 or s >= 0):
                mass = share
                if r < 0:
                    mass = share * wp.clamp(at.phi[o] / (at.phi[o] - wp.max(at.phi[c], 1.0e-3)), 0.05, 1.0)
                elif s < 0:
                    theta = float(0.5)
                    if o >= 0:
                        theta = wp.clamp(at.phi[c] / (at.phi[c] - wp.max(at.phi[o], 1.0e-3)), 0.05, 1.0)
                    mass = share * theta
            if mass > 0.0:
                f = wp.vec3()
                f[axis] = mass * (after[c][axis] - before[c][axis])
                m = wp.cross(face_center(place, axis), f)
                total += vec6d(
                    wp.float64(f[0]), wp.float64(f[1]), wp.float64(f[2]), wp.float64(m[0]), wp.float64(m[1]), wp.float64(m[2])
                )
    sums[n] = total
