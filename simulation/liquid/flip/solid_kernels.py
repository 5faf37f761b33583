# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Solids and liquid on faces: velocities that walls prescribe, friction, wrenches, momentum, mouths and drains.

Lengths are in cells. Owners are rows of boundaries, then of inflows; -1 is the domain.
"""

import warp as wp

from .column_kernels import Columns, place_of, vec6i
from .cut_kernels import value_at
from .distance_kernels import FAR, Walls, wall_speed

wp.set_module_options({"enable_backward": False, "max_unroll": 3})

__all__ = [
    "Shut",
    "constrain",
    "face_center",
    "list_rows",
    "momentum",
    "open_mouths",
    "push_rows",
    "rub",
    "take_out",
    "touching",
    "vec6d",
    "wrench",
]

vec6d = wp.types.vector(length=6, dtype=wp.float64)
LEAST = wp.constant(0.02)
"""As `grid_kernels.LEAST_OPEN`."""


@wp.func
def face_center(at: wp.vec3i, axis: int):
    """Centre of a cell's lower face."""
    x = wp.vec3(float(at[0]) + 0.5, float(at[1]) + 0.5, float(at[2]) + 0.5)
    x[axis] = x[axis] - 0.5
    return x


@wp.kernel
def open_mouths(
    first: wp.int32, grid: Columns, count: int, base: int, center: wp.array(dtype=wp.vec3), rotation: wp.array(dtype=wp.mat33),
    half: wp.array(dtype=wp.vec3), near: wp.array(dtype=vec6i), lower: wp.vec3, upper: wp.vec3, solids: int,
    solid: wp.array(dtype=float), opening: wp.array(dtype=wp.vec3), face_owner: wp.array(dtype=wp.vec3i),
):  # fmt: skip
    """Faces in the mouth of an inflow have its speed, those of the domain's closed sides too where no solid is behind them.

    The third component of `half` is 1 for a disc, -1 for one that is shut.
    """
    c = first + wp.tid()
    at = place_of(grid, c)
    share = opening[c]
    who = face_owner[c]
    for axis in range(3):
        x = face_center(at, axis)
        free = share[axis] > LEAST
        k = float(at[axis])
        inner = int(-1)
        if k <= lower[axis] and k + 1.0 > lower[axis]:
            inner = c
        elif k >= upper[axis] and k - 1.0 < upper[axis]:
            inner = near[c][2 * axis]
        if inner >= 0:
            free = solids == 0
            if solids == 1:
                free = solid[inner] >= 0.0
        for m in range(count):
            h = half[m]
            if h[2] >= 0.0:
                y = wp.transpose(rotation[m]) * (x - center[m])
                inside = wp.abs(y[0]) <= h[0] and wp.abs(y[1]) <= h[1]
                if h[2] > 0.5:
                    inside = (y[0] / h[0]) * (y[0] / h[0]) + (y[1] / h[1]) * (y[1] / h[1]) <= 1.0
                if inside and y[2] >= -1.0 and y[2] <= 0.51 and free:
                    share[axis] = 0.0
                    who[axis] = base + m
    opening[c] = share
    face_owner[c] = who


@wp.struct
class Shut:
    """Which faces are closed and by whom; `inside` and `thin` hold where there are solids."""

    near: wp.array(dtype=vec6i)
    cell: wp.array(dtype=wp.int32)
    row: wp.array(dtype=wp.int32)
    opening: wp.array(dtype=wp.vec3)
    owner: wp.array(dtype=wp.vec3i)
    solids: wp.int32
    inside: wp.array(dtype=wp.int32)
    """Owner of the solid around a hidden cell (`grid_kernels.find_hidden`): all its closed faces are that one's; -2 elsewhere."""
    thin: wp.array(dtype=wp.vec3)
    """Share, once open, of faces that a thin wall closes: no cell in it carries the pressure at the wall."""


@wp.func
def face_of(at: Shut, c: int, side: int):
    """Cell whose lower face a cell's side is."""
    face = int(c)
    if side % 2 == 1:
        face = at.near[c][side]
    return face


@wp.func
def is_thin(at: Shut, c: int, side: int):
    """Whether a thin wall closes a side of a cell of liquid."""
    t = int(0)
    if at.solids == 1:
        f = face_of(at, c, side)
        if f >= 0 and at.inside[c] == -2:
            if at.thin[f][side // 2] > 0.0:
                t = 1
    return t


@wp.func
def beyond(at: Shut, c: int, side: int):
    """Row of the open neighbour across from a side; -1 where there is none."""
    other = side + 1
    if side % 2 == 1:
        other = side - 1
    r = int(-1)
    m = at.near[c][other]
    if m >= 0:
        f = face_of(at, c, other)
        if at.opening[f][side // 2] >= LEAST:
            r = at.row[m]
    return r


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
def behind(at: Shut, c: int, side: int):
    """Neighbour at a side that has a thin wall on its far side, so that this cell shares in the pressure there; -1 otherwise."""
    n = int(-1)
    if at.solids == 1:
        m = at.near[c][side]
        if m >= 0:
            if at.row[m] >= 0 and at.opening[face_of(at, c, side)][side // 2] >= LEAST:
                if is_thin(at, m, side) == 1:
                    n = m
    return n


@wp.kernel
def touching(first: wp.int32, at: Shut, flag: wp.array(dtype=wp.int32)):
    """Rows with a face that is not fully open, and those behind a row at a thin wall."""
    r = first + wp.tid()
    c = at.cell[r]
    hit = int(0)
    for side in range(6):
        face = face_of(at, c, side)
        if face >= 0:
            if at.opening[face][side // 2] < 1.0:
                hit = 1
            elif behind(at, c, side) >= 0:
                hit = 1
    flag[r] = hit


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
    """Sum of q over the solid shares of faces: along axes, and about the owner's centre [cells], for one owner and block of rows.

    At a thin wall q is continued from the two nearest cells, elsewhere cells inside the solid carry it.
    """
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
                s = shut(at.opening[face][axis])
                if s > 0.0 and owner_of(at, c, side) == who:
                    value = q[r]
                    if is_thin(at, c, side) == 1:
                        o = beyond(at, c, side)
                        if o >= 0:
                            value = 1.5 * q[r] - 0.5 * q[o]
                    f = wp.vec3()
                    f[axis] = float(2 * (side % 2) - 1) * s * value
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
            who = owner_of(at, c, side)
            if s > 0.0 and who >= 0:
                part = float(1.0)
                if is_thin(at, c, side) == 1:
                    if beyond(at, c, side) >= 0:
                        part = 1.5
                total += part * sign * s * wall_speed(walls, who, side_center(grid, c, side))[axis]
            m = behind(at, c, side)
            if m >= 0:
                who = owner_of(at, m, side)
                s = shut(at.opening[face_of(at, m, side)][axis])
                if who >= 0:
                    total -= 0.5 * sign * s * wall_speed(walls, who, side_center(grid, m, side))[axis]
    y[r] = y[r] + scale * total


@wp.kernel
def constrain(
    first: wp.int32, grid: Columns, near: wp.array(dtype=vec6i), lower: wp.vec3, upper: wp.vec3, sides: vec6i, solids: int,
    solid: wp.array(dtype=float), opening: wp.array(dtype=wp.vec3), face_owner: wp.array(dtype=wp.vec3i), walls: Walls,
    was: wp.array(dtype=wp.vec3), ratio: float, thick: int, friction: wp.array(dtype=float),
    now: wp.array(dtype=wp.vec3), drift: wp.array(dtype=wp.vec3),
    now_out: wp.array(dtype=wp.vec3), drift_out: wp.array(dtype=wp.vec3), given: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Closed faces: what moves into the solid is taken away, what slips along it stays; `thick` liquid sticks by the wall's friction.

    `given` is what a face gives to particles beside their own velocity: now - ratio was.
    """
    c = first + wp.tid()
    at = place_of(grid, c)
    u = now[c]
    d = drift[c]
    for axis in range(3):
        k = float(at[axis])
        if (k <= lower[axis] and sides[2 * axis] == 0) or (k >= upper[axis] and sides[2 * axis + 1] == 0):
            u[axis] = 0.0
            d[axis] = 0.0
            if face_owner[c][axis] >= 0:
                u[axis] = wall_speed(walls, face_owner[c][axis], face_center(at, axis))[axis]
                d[axis] = u[axis]
        elif solids == 1 and opening[c][axis] < LEAST and near[c][2 * axis] >= 0:
            o = near[c][2 * axis]
            normal = wp.vec3()
            v = wp.vec3()
            e = wp.vec3()
            for b in range(3):
                if b == axis:
                    normal[b] = solid[c] - solid[o]
                    v[b] = now[c][b]
                    e[b] = drift[c][b]
                else:
                    low = near[c][2 * b]
                    high = near[c][2 * b + 1]
                    olow = near[o][2 * b]
                    ohigh = near[o][2 * b + 1]
                    normal[b] = 0.25 * (
                        value_at(solid, high) + value_at(solid, ohigh) - value_at(solid, low) - value_at(solid, olow)
                    )
                    count = float(2.0)
                    sv = now[c][b] + now[o][b]
                    se = drift[c][b] + drift[o][b]
                    if high >= 0:
                        sv += now[high][b]
                        se += drift[high][b]
                        count += 1.0
                    if ohigh >= 0:
                        sv += now[ohigh][b]
                        se += drift[ohigh][b]
                        count += 1.0
                    v[b] = sv / count
                    e[b] = se / count
            normal = wp.normalize(normal)
            w = wall_speed(walls, face_owner[c][axis], face_center(at, axis))
            u[axis] = v[axis] - wp.min(wp.dot(v - w, normal), 0.0) * normal[axis]
            d[axis] = e[axis] - wp.min(wp.dot(e - w, normal), 0.0) * normal[axis]
            if thick == 1 and face_owner[c][axis] >= 0:
                depth = wp.clamp(-0.5 * (solid[c] + solid[o]), 0.0, 0.5)
                stick = friction[face_owner[c][axis]] / (1.0 - depth)
                u[axis] = u[axis] + stick * (w[axis] - u[axis])
                d[axis] = d[axis] + stick * (w[axis] - d[axis])
    now_out[c] = u
    drift_out[c] = d
    given[c] = u - ratio * was[c]


@wp.kernel
def rub(
    first: wp.int32, grid: Columns, near: wp.array(dtype=vec6i), lower: wp.vec3, upper: wp.vec3, sides: vec6i, solids: int,
    solid: wp.array(dtype=float), rate: float, now: wp.array(dtype=wp.vec3), now_out: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Friction of walls on the cells beside them, implicit: u / (1 + rate |u|)."""
    c = first + wp.tid()
    at = place_of(grid, c)
    u = now[c]
    v = u
    for axis in range(3):
        o = near[c][2 * axis]
        x = face_center(at, axis)
        d = float(FAR)
        if solids == 1:
            d = solid[c]
            if o >= 0:
                d = 0.5 * (d + solid[o])
        for side in range(3):
            if side != axis:
                if sides[2 * side] == 0:
                    d = wp.min(d, x[side] - lower[side])
                if sides[2 * side + 1] == 0:
                    d = wp.min(d, upper[side] - x[side])
        if d > 0.0 and d < 1.0:
            speed = wp.length(u)
            if o >= 0:
                speed = 0.5 * (speed + wp.length(now[o]))
            v[axis] = u[axis] / (1.0 + rate * speed)
    now_out[c] = v


@wp.kernel
def momentum(
    first: wp.int32, cells: int, block: int, grid: Columns, near: wp.array(dtype=vec6i), row: wp.array(dtype=wp.int32),
    phi: wp.array(dtype=float), opening: wp.array(dtype=wp.vec3), thin: wp.array(dtype=wp.vec3), before: wp.array(dtype=wp.vec3),
    after: wp.array(dtype=wp.vec3), sums: wp.array(dtype=vec6d),
):  # fmt: skip
    """Change of the liquid's momentum on its faces between two velocities, and about the grid's origin, in cells of liquid."""
    n = first + wp.tid()
    total = vec6d()
    for c in range(n * block, wp.min((n + 1) * block, cells)):
        at = place_of(grid, c)
        for axis in range(3):
            o = near[c][2 * axis]
            s = int(-1)
            if o >= 0:
                s = row[o]
            r = row[c]
            share = wp.max(opening[c][axis], thin[c][axis])
            if share >= LEAST and (r >= 0 or s >= 0):
                mass = share
                if thin[c][axis] > 0.0:
                    mass = share
                elif r < 0:
                    mass = share * wp.clamp(phi[o] / (phi[o] - wp.max(phi[c], 1.0e-3)), 0.05, 1.0)
                elif s < 0:
                    theta = float(0.5)
                    if o >= 0:
                        theta = wp.clamp(phi[c] / (phi[c] - wp.max(phi[o], 1.0e-3)), 0.05, 1.0)
                    mass = share * theta
                f = wp.vec3()
                f[axis] = mass * (after[c][axis] - before[c][axis])
                m = wp.cross(face_center(at, axis), f)
                total += vec6d(
                    wp.float64(f[0]), wp.float64(f[1]), wp.float64(f[2]), wp.float64(m[0]), wp.float64(m[1]), wp.float64(m[2])
                )
    sums[n] = total


@wp.kernel
def take_out(
    first: wp.int32, count: int, center: wp.array(dtype=wp.vec3), rotation: wp.array(dtype=wp.mat33), half: wp.array(dtype=wp.vec3),
    position: wp.array(dtype=wp.vec4), left: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Particles inside an outflow are marked with 2 + its number; they and those that left have no volume any more."""
    p = first + wp.tid()
    x = position[p]
    gone = left[p]
    for m in range(count):
        y = wp.transpose(rotation[m]) * (wp.vec3(x[0], x[1], x[2]) - center[m])
        if gone == 0 and wp.abs(y[0]) <= half[m][0] and wp.abs(y[1]) <= half[m][1] and wp.abs(y[2]) <= half[m][2]:
            gone = 2 + m
    left[p] = gone
    if gone > 0:
        position[p] = wp.vec4(x[0], x[1], x[2], 0.0)
