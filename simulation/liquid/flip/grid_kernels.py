# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Cells: where the surface lies, the rows of the pressure system (Batty et al. 2007, doi:10.1145/1276377.1276502; ghost fluid by
Enright et al. 2003), velocities after it, and their extension beyond the liquid.

`opening` holds the open share of a cell's lower faces; `room` that of its volume. Pressure unknowns are p dt / (density cell)
[m/s], so that a face's velocity changes by their difference.
"""

import warp as wp

from ...grids.columns import Columns, place_of, vec6, vec6i
from .cut_kernels import tent_overlap
from .distance_kernels import Walls, wall_speed
from .exchange_kernels import Shut, closing_speed, half_cell
from .solid_kernels import face_center

wp.set_module_options({"enable_backward": False})

__all__ = [
    "build_rows",
    "close_buried",
    "extend",
    "find_hidden",
    "find_surface",
    "measure",
    "open_box",
    "project",
    "rate_density",
]

LEAST_OPEN = wp.constant(0.02)
"""Faces open by less are closed: their cells would make the system stiff."""
BURIED = wp.constant(9.0)
"""Distance to the surface that marks cells inside solids which touch no open one."""
SHALLOW = wp.constant(64)
"""Mark of cells that look to lie less than a quarter of a cell under the surface: beside air they may be air in the next step."""
LEAST_THETA = wp.constant(0.05)
"""Nearest distance of the surface to the centre of a liquid cell, in cells."""


@wp.func
def overlap(k: float, low: float, high: float):
    """Share of [k, k + 1] inside [low, high]."""
    return wp.clamp(wp.min(k + 1.0, high) - wp.max(k, low), 0.0, 1.0)


@wp.func
def tent_inside(center: float, low: float, high: float):
    """Share of a tent around `center` inside [low, high]."""
    return tent_overlap(high - center) - tent_overlap(low - center)


@wp.func
def share_of(k: float, low: float, high: float):
    """On one axis: share of a cell inside [low, high], whether its lower face is, and the share of a tent around its centre."""
    full = float(0.0)
    if k > low and k < high:
        full = 1.0
    return wp.vec3(overlap(k, low, high), full, tent_inside(k + 0.5, low, high))


@wp.kernel
def open_box(
    first: wp.int32, grid: Columns, lower: wp.vec3, upper: wp.vec3, opening: wp.array(dtype=wp.vec3), room: wp.array(dtype=float),
    spread: wp.array(dtype=float), face_owner: wp.array(dtype=wp.vec3i),
):  # fmt: skip
    """Open shares of a column's cells in a box; `spread` is the room weighted as density is."""
    column = first + wp.tid()
    begin = grid.start[column]
    end = grid.start[column + 1]
    if end == begin:
        return
    i = column // grid.ny
    x = share_of(float(i), lower[0], upper[0])
    y = share_of(float(column - i * grid.ny), lower[1], upper[1])
    for c in range(begin, end):
        z = share_of(float(c - begin + grid.low[column]), lower[2], upper[2])
        opening[c] = wp.vec3(x[1] * y[0] * z[0], x[0] * y[1] * z[0], x[0] * y[0] * z[1])
        room[c] = x[0] * y[0] * z[0]
        spread[c] = x[2] * y[2] * z[2]
        face_owner[c] = wp.vec3i(-1, -1, -1)


@wp.kernel
def find_surface(
    first: wp.int32, grid: Columns, density: wp.array(dtype=float), spread: wp.array(dtype=float), lower: wp.vec3, upper: wp.vec3,
    phi: wp.array(dtype=float), red: wp.array(dtype=wp.int32), wet: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Signed distance [cells] of a cell's centre to the surface, negative inside, and whether its pressure is sought.

    A tent around a point at depth D below flat liquid holds 1 - (1 - D)^2 / 2 of it; the distance inverts that.
    """
    c = first + wp.tid()
    at = place_of(grid, c)
    f = density[c] / wp.max(spread[c], 0.05)
    d = float(0.0)
    if f >= 0.5:
        d = wp.sqrt(wp.max(2.0 * (1.0 - f), 0.0)) - 1.0
    else:
        d = 1.0 - wp.sqrt(2.0 * wp.max(f, 0.0))
    inside = int(1)
    for axis in range(3):
        if float(at[axis]) + 0.5 < lower[axis] or float(at[axis]) + 0.5 > upper[axis]:
            inside = 0
    if spread[c] < 0.05:
        inside = 0
    phi[c] = d
    w = int(0)
    if d < 0.0 and inside == 1:
        w = 1
    wet[c] = w
    red[c] = w * (1 - ((at[0] + at[1] + at[2]) & 1))


@wp.kernel
def find_hidden(
    first: wp.int32, grid: Columns, near: wp.array(dtype=vec6i), solid: wp.array(dtype=float), opening: wp.array(dtype=wp.vec3),
    face_owner: wp.array(dtype=wp.vec3i), wet: wp.array(dtype=wp.int32), phi: wp.array(dtype=float),
    red_out: wp.array(dtype=wp.int32), wet_out: wp.array(dtype=wp.int32), phi_out: wp.array(dtype=float),
    inside: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Cells whose centre lies in a solid continue the liquid beside them: they carry the pressure of cut faces.

    `inside` is the owner of the solid that they lie in, of the face that is most open; -2 elsewhere.
    """
    c = first + wp.tid()
    d = phi[c]
    w = wet[c]
    who = int(-2)
    if solid[c] < 0.0:
        n = near[c]
        total = float(0.0)
        count = float(0.0)
        widest = float(0.0)
        for side in range(6):
            m = n[side]
            if m >= 0:
                face = c
                if side % 2 == 1:
                    face = m
                if opening[face][side // 2] >= LEAST_OPEN and solid[m] >= 0.0:
                    total += phi[m]
                    count += 1.0
                    if opening[face][side // 2] > widest:
                        widest = opening[face][side // 2]
                        who = face_owner[face][side // 2]
        w = 0
        d = float(BURIED)
        if count > 0.0:
            d = total / count
            if d < 0.0:
                w = 1
    at = place_of(grid, c)
    wet_out[c] = w
    inside[c] = who
    phi_out[c] = d
    red_out[c] = w * (1 - ((at[0] + at[1] + at[2]) & 1))


@wp.kernel
def close_buried(first: wp.int32, near: wp.array(dtype=vec6i), phi: wp.array(dtype=float), opening: wp.array(dtype=wp.vec3)):
    """Faces of cells that lie in a solid and touch no open one are closed."""
    c = first + wp.tid()
    share = opening[c]
    for axis in range(3):
        o = near[c][2 * axis]
        if phi[c] > 5.0:
            share[axis] = 0.0
        if o >= 0:
            if phi[o] > 5.0:
                share[axis] = 0.0
    opening[c] = share


@wp.kernel
def build_rows(
    first: wp.int32, near: wp.array(dtype=vec6i), cell: wp.array(dtype=wp.int32), row: wp.array(dtype=wp.int32),
    phi: wp.array(dtype=float), opening: wp.array(dtype=wp.vec3), velocity: wp.array(dtype=wp.vec3),
    link: wp.array(dtype=vec6i), coefficient: wp.array(dtype=vec6), diagonal: wp.array(dtype=float), right: wp.array(dtype=float),
    airy: wp.array(dtype=wp.int32),
):  # fmt: skip
    """One row per liquid cell; its right side is the flux into the cell. `airy` tells which sides of a cell are open to
    air (bit n for side n) and which cells are SHALLOW.
    """
    r = first + wp.tid()
    c = cell[r]
    n = near[c]
    total = float(0.0)
    flux = float(0.0)
    links = vec6i()
    k = vec6()
    free = int(0)
    for side in range(6):
        axis = side // 2
        other = n[side]
        face = c
        sign = float(-1.0)
        if side - 2 * axis == 1:
            face = other
            sign = 1.0
        share = float(1.0)
        speed = float(0.0)
        if face >= 0:
            share = opening[face][axis]
            speed = velocity[face][axis]
        if share < LEAST_OPEN:
            share = 0.0
        flux += sign * share * speed
        if share > 0.0:
            target = int(-1)
            if other >= 0:
                target = row[other]
            if target >= 0:
                links[side] = target
                k[side] = share
                total += share
            else:
                free = free | (1 << side)
                theta = float(0.5)
                if other >= 0:
                    theta = wp.clamp(phi[c] / (phi[c] - wp.max(phi[other], 1.0e-3)), LEAST_THETA, 1.0)
                total += share / theta
    if total <= 0.0:
        total = 1.0
    link[r] = links
    coefficient[r] = k
    diagonal[r] = total
    right[r] = -flux
    if phi[c] > -0.25:
        free = free | SHALLOW
    airy[r] = free


@wp.kernel
def rate_density(
    first: wp.int32, cell: wp.array(dtype=wp.int32), density: wp.array(dtype=float), spread: wp.array(dtype=float),
    link: wp.array(dtype=vec6i), coefficient: wp.array(dtype=vec6), airy: wp.array(dtype=wp.int32), solids: int,
    solid: wp.array(dtype=float), share: float, right: wp.array(dtype=float), excess: wp.array(dtype=float),
    inner: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Source that undoes a share of a cell's compression, in cells of displacement; `excess` is the compression itself.

    The tent that weighs a cell's density reaches its neighbours across faces and edges: where one of them is air, or a shallow cell
    beside air, expansion may be that of the surface and is let be. In all others, which are `inner`, it is air that was mixed in: that
    a cell is half empty tells nothing. (Air across a corner alone takes 1/720 of the density at most.) Of cells whose centre lies in
    a solid too little is open to tell.
    """
    r = first + wp.tid()
    c = cell[r]
    e = density[c] / wp.max(spread[c], 0.05) - 1.0
    free = airy[r] & (SHALLOW - 1)
    links = link[r]
    k = coefficient[r]
    for side in range(6):
        if k[side] > 0.0:
            its = airy[links[side]]
            free = free | (its & (SHALLOW - 1) & ~(3 << (side - side % 2)))
            if its > SHALLOW:
                free = 1
    inside = int(1)
    if free != 0:
        e = wp.max(e, 0.0)
        inside = 0
    inner[r] = inside
    if solids == 1:
        if solid[c] < 0.0:
            e = 0.0
    excess[r] = e
    right[r] = share * wp.min(spread[c], 1.0) * wp.clamp(e, -0.2, 0.5)


@wp.kernel
def measure(
    first: wp.int32,
    cells: int,
    block: int,
    phi: wp.array(dtype=float),
    room: wp.array(dtype=float),
    sums: wp.array(dtype=wp.float64),
):
    """Volume under the surface in each block of cells [cells]."""
    n = first + wp.tid()
    total = wp.float64(0.0)
    for c in range(n * block, wp.min((n + 1) * block, cells)):
        total += wp.float64(room[c] * wp.clamp(0.5 - phi[c], 0.0, 1.0))
    sums[n] = total


@wp.kernel
def project(
    first: wp.int32, grid: Columns, near: wp.array(dtype=vec6i), row: wp.array(dtype=wp.int32), phi: wp.array(dtype=float),
    opening: wp.array(dtype=wp.vec3), face_owner: wp.array(dtype=wp.vec3i), at: Shut, walls: Walls, q: wp.array(dtype=float),
    push: wp.array(dtype=float), solids: int, solid: wp.array(dtype=float), per_cell: float, scale: float, weight: wp.array(dtype=wp.vec3), before: wp.array(dtype=wp.vec3),
    now: wp.array(dtype=wp.vec3), drift: wp.array(dtype=wp.vec3), known: wp.array(dtype=wp.vec3i), pressure: wp.array(dtype=float),
):  # fmt: skip
    """Velocity of a cell's faces after the pressure, the drift that moves particles, and whether each face is known (2), carries
    only flying particles (1) or nothing (0), as between cells inside a solid. A half cell at a thin wall moves as all that closes its face. `per_cell`: displacement in cells to velocity [m/s]; `scale`: q to Pa.
    """
    c = first + wp.tid()
    n = near[c]
    r = row[c]
    u = before[c]
    d = u
    state = wp.vec3i()
    w = weight[c]
    for axis in range(3):
        other = n[2 * axis]
        s = int(-1)
        if other >= 0:
            s = row[other]
        if w[axis] > 1.0e-6:
            state[axis] = 1
        share = opening[c][axis]
        if share < LEAST_OPEN:
            state[axis] = 0
            inside = int(0)
            if solids == 1 and other >= 0:
                if solid[c] < 0.0 and solid[other] < 0.0:
                    inside = 1
            mine = half_cell(at, c, 2 * axis)
            its = float(0.0)
            if other >= 0:
                its = half_cell(at, other, 2 * axis + 1)
            if (inside == 0 or mine > 0.0 or its > 0.0) and (r >= 0 or s >= 0):
                who = face_owner[c][axis]
                v = float(0.0)
                middle = face_center(place_of(grid, c), axis)
                if mine > 0.0:
                    v = closing_speed(at, walls, c, 2 * axis, middle)
                elif its > 0.0:
                    v = closing_speed(at, walls, other, 2 * axis + 1, middle)
                elif who >= 0:
                    v = wall_speed(walls, who, middle)[axis]
                u[axis] = v
                d[axis] = v
                state[axis] = 2
        elif r >= 0 or s >= 0:
            dq = float(0.0)
            dx = float(0.0)
            if r >= 0 and s >= 0:
                dq = q[r] - q[s]
                dx = push[r] - push[s]
            elif r >= 0:
                theta = float(0.5)
                if other >= 0:
                    theta = wp.clamp(phi[c] / (phi[c] - wp.max(phi[other], 1.0e-3)), LEAST_THETA, 1.0)
                dq = q[r] / theta
                dx = push[r] / theta
            else:
                theta = wp.clamp(phi[other] / (phi[other] - wp.max(phi[c], 1.0e-3)), LEAST_THETA, 1.0)
                dq = -q[s] / theta
                dx = -push[s] / theta
            u[axis] = u[axis] - dq
            d[axis] = u[axis] - per_cell * wp.clamp(dx, -0.25, 0.25)
            state[axis] = 2
    now[c] = u
    drift[c] = d
    known[c] = state
    pressure[c] = 0.0
    if r >= 0:
        pressure[c] = scale * q[r]


@wp.kernel
def extend(
    first: wp.int32, near: wp.array(dtype=vec6i), level: int, mark: int, known: wp.array(dtype=wp.vec3i),
    now: wp.array(dtype=wp.vec3), drift: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Faces that are less known than `level` take the mean of their neighbours that are at least as known.

    They are marked by `mark`, which is above all others and counts as known from the next launch on.
    """
    c = first + wp.tid()
    state = known[c]
    if state[0] >= level and state[1] >= level and state[2] >= level:
        return
    n = near[c]
    u = now[c]
    d = drift[c]
    for axis in range(3):
        if state[axis] < level:
            total = float(0.0)
            su = float(0.0)
            sd = float(0.0)
            for side in range(6):
                m = n[side]
                if m >= 0:
                    s = known[m][axis]
                    if s >= level and s < mark:
                        total += 1.0
                        su += now[m][axis]
                        sd += drift[m][axis]
            if total > 0.0:
                u[axis] = su / total
                d[axis] = sd / total
                state[axis] = mark
    known[c] = state
    now[c] = u
    drift[c] = d
