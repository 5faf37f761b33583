# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Viscosity on faces: strain at centres and edges, the force it makes, and the vector work of conjugate gradients around it.

The system minimises 1/2 m (u - u0)^2 + dt (dissipation) over faces (Batty and Bridson 2008, doi:10.2312/SCA/SCA08/219-228), so that
stress at free surfaces vanishes and turning as a whole costs nothing. The edge along axis d of a cell runs through its lowest corner;
a = d + 1 and b = d + 2 are the other axes. Masses are in cells of liquid, viscosities times dt / (density cell^2).
"""

import warp as wp

from ...grids.columns import Columns, place_of, vec6, vec6i
from .distance_kernels import Walls, wall_speed
from .exchange_kernels import vec6d
from .grid_kernels import LEAST_OPEN
from .solid_kernels import face_center

wp.set_module_options({"enable_backward": False, "max_unroll": 3})

__all__ = [
    "add", "advance_all", "begin", "divide", "drag", "fill_walls", "find_mass", "find_weights", "force", "put_back", "strain", "sum_pairs",
    "thicken", "turn",
]  # fmt: skip

OPEN = wp.constant(-2)
"""Owner of faces that are no wall."""
FLOOR = wp.constant(0.01)
"""Least mass of a face that liquid rubs against: those just above the surface follow it."""
LEAST_LEG = wp.constant(0.2)
"""Nearest distance of a wall to a face, in cells."""


@wp.kernel
def thicken(
    first: wp.int32, grid: Columns, head: wp.array(dtype=wp.int32), position: wp.array(dtype=wp.vec4), slot: wp.array(dtype=wp.int32),
    known: wp.array(dtype=float), scale: float, thickness: wp.array(dtype=float), count: wp.array(dtype=float),
):  # fmt: skip
    """Mean viscosity of the particles in each cell of a column; 0 where there are none."""
    c = first + wp.tid()
    for n in range(grid.start[c], grid.start[c + 1]):
        thickness[n] = 0.0
        count[n] = 0.0
    for p in range(head[c], head[c + 1]):
        n = grid.base[c] + int(position[p][2])
        thickness[n] = thickness[n] + scale * known[slot[p]]
        count[n] = count[n] + 1.0
    for n in range(grid.start[c], grid.start[c + 1]):
        thickness[n] = thickness[n] / wp.max(count[n], 1.0)


@wp.func
def beside(near: wp.array(dtype=vec6i), c: int, side: int):
    """Neighbour of a cell that may not exist."""
    n = int(-1)
    if c >= 0:
        n = near[c][side]
    return n


@wp.kernel
def find_mass(
    first: wp.int32, near: wp.array(dtype=vec6i), phi: wp.array(dtype=float), solids: int, solid: wp.array(dtype=float),
    opening: wp.array(dtype=wp.vec3), face_owner: wp.array(dtype=wp.vec3i), friction: wp.array(dtype=float),
    mass: wp.array(dtype=wp.vec3), wall: wp.array(dtype=wp.vec3i),
):  # fmt: skip
    """Mass of each face in cells, and the owner of those that are walls: closed ones, and rough ones whose centre lies in a solid."""
    c = first + wp.tid()
    m = wp.vec3()
    who = wp.vec3i(OPEN, OPEN, OPEN)
    for axis in range(3):
        o = near[c][2 * axis]
        share = opening[c][axis]
        owner = face_owner[c][axis]
        if share < LEAST_OPEN or o < 0:
            who[axis] = owner
        else:
            m[axis] = wp.max(share * wp.clamp(0.5 - 0.5 * (phi[c] + phi[o]), 0.0, 1.0), FLOOR)
            if solids == 1 and owner >= 0:
                if friction[owner] > 0.0 and solid[c] + solid[o] < 0.0:
                    who[axis] = owner
    mass[c] = m
    wall[c] = who


@wp.func
def leg(solids: int, friction: wp.array(dtype=float), high: int, low: int, d_high: float, d_low: float):
    """Reach of a difference between two faces, and its weight: 1 in the open, the wall's friction where one of them is a wall."""
    r = wp.vec2(1.0, 1.0)
    if (high == OPEN) != (low == OPEN):
        who = high
        inner = d_low
        outer = d_high
        if high == OPEN:
            who = low
            inner = d_high
            outer = d_low
        r = wp.vec2(1.0, 0.0)
        if who >= 0 and solids == 1:
            r = wp.vec2(wp.clamp(inner / wp.max(inner - outer, 1.0e-3), LEAST_LEG, 1.0), friction[who])
    return r


@wp.kernel
def find_weights(
    first: wp.int32, near: wp.array(dtype=vec6i), phi: wp.array(dtype=float), room: wp.array(dtype=float), solids: int,
    solid: wp.array(dtype=float), friction: wp.array(dtype=float), thickness: wp.array(dtype=float), wall: wp.array(dtype=wp.vec3i),
    middle: wp.array(dtype=float), edge: wp.array(dtype=wp.vec3), legs: wp.array(dtype=vec6),
):  # fmt: skip
    """Viscosity times liquid volume at centres (twice) and edges, and one over the reach of each edge's two differences."""
    c = first + wp.tid()
    middle[c] = 2.0 * thickness[c] * room[c] * wp.clamp(0.5 - phi[c], 0.0, 1.0)
    weight = wp.vec3()
    reach = vec6()
    for d in range(3):
        a = (d + 1) % 3
        b = (d + 2) % 3
        ca = near[c][2 * a]
        cb = near[c][2 * b]
        cab = beside(near, ca, 2 * b)
        if ca >= 0 and cb >= 0 and cab >= 0:
            total = float(0.0)
            height = float(0.0)
            mu = float(0.0)
            thick = float(0.0)
            for s in range(4):
                n = c
                if s == 1:
                    n = ca
                if s == 2:
                    n = cb
                if s == 3:
                    n = cab
                if room[n] > 0.01 and phi[n] < 5.0:
                    total += 1.0
                    height += phi[n]
                    if thickness[n] > 0.0:
                        thick += 1.0
                        mu += thickness[n]
            if thick > 0.0:
                s0 = float(0.0)
                s1 = float(0.0)
                s2 = float(0.0)
                s3 = float(0.0)
                if solids == 1:
                    s0 = solid[c]
                    s1 = solid[ca]
                    s2 = solid[cb]
                    s3 = solid[cab]
                along_b = leg(solids, friction, wall[c][a], wall[cb][a], s0 + s1, s2 + s3)
                along_a = leg(solids, friction, wall[c][b], wall[ca][b], s0 + s2, s1 + s3)
                liquid = wp.clamp(0.5 - height / total, 0.0, 1.0)
                weight[d] = mu / thick * liquid * along_a[0] * along_b[0] * wp.min(along_a[1], along_b[1])
                reach[2 * d] = 1.0 / along_b[0]
                reach[2 * d + 1] = 1.0 / along_a[0]
    edge[c] = weight
    legs[c] = reach


@wp.kernel
def fill_walls(first: wp.int32, grid: Columns, wall: wp.array(dtype=wp.vec3i), walls: Walls, u: wp.array(dtype=wp.vec3)):
    """Velocity of walls on their faces."""
    c = first + wp.tid()
    who = wall[c]
    if who[0] != OPEN or who[1] != OPEN or who[2] != OPEN:
        at = place_of(grid, c)
        v = u[c]
        for axis in range(3):
            if who[axis] != OPEN:
                v[axis] = wall_speed(walls, who[axis], face_center(at, axis))[axis]
        u[c] = v


@wp.kernel
def strain(
    first: wp.int32, near: wp.array(dtype=vec6i), middle: wp.array(dtype=float), edge: wp.array(dtype=wp.vec3),
    legs: wp.array(dtype=vec6), u: wp.array(dtype=wp.vec3), normal: wp.array(dtype=wp.vec3), shear: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Stress at a cell's centre and at its three edges."""
    c = first + wp.tid()
    n = near[c]
    own = u[c]
    s = wp.vec3()
    if middle[c] > 0.0:
        for axis in range(3):
            if n[2 * axis + 1] >= 0:
                s[axis] = middle[c] * (u[n[2 * axis + 1]][axis] - own[axis])
    normal[c] = s
    w = edge[c]
    t = wp.vec3()
    for d in range(3):
        if w[d] > 0.0:
            a = (d + 1) % 3
            b = (d + 2) % 3
            t[d] = w[d] * (legs[c][2 * d] * (own[a] - u[n[2 * b]][a]) + legs[c][2 * d + 1] * (own[b] - u[n[2 * a]][b]))
    shear[c] = t


@wp.kernel
def force(
    first: wp.int32, near: wp.array(dtype=vec6i), legs: wp.array(dtype=vec6), mass: wp.array(dtype=wp.vec3),
    wall: wp.array(dtype=wp.vec3i), u: wp.array(dtype=wp.vec3), normal: wp.array(dtype=wp.vec3), shear: wp.array(dtype=wp.vec3),
    out: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Mass times velocity less the stress on each face; on walls, the impulse that the liquid takes from them."""
    c = first + wp.tid()
    n = near[c]
    f = wp.vec3()
    for axis in range(3):
        total = -normal[c][axis]
        if n[2 * axis] >= 0:
            total += normal[n[2 * axis]][axis]
        for k in range(2):
            d = (axis + 1 + k) % 3
            other = 3 - axis - d
            place = 2 * d
            if k == 0:
                place = 2 * d + 1
            total += legs[c][place] * shear[c][d]
            m = n[2 * other + 1]
            if m >= 0:
                total -= legs[m][place] * shear[m][d]
        if wall[c][axis] == OPEN:
            total += mass[c][axis] * u[c][axis]
        f[axis] = total
    out[c] = f


@wp.kernel
def divide(
    first: wp.int32, near: wp.array(dtype=vec6i), middle: wp.array(dtype=float), edge: wp.array(dtype=wp.vec3),
    legs: wp.array(dtype=vec6), mass: wp.array(dtype=wp.vec3), wall: wp.array(dtype=wp.vec3i), inverse: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """One over the diagonal; 0 on walls and where no liquid rubs."""
    c = first + wp.tid()
    n = near[c]
    out = wp.vec3()
    for axis in range(3):
        total = middle[c]
        if n[2 * axis] >= 0:
            total += middle[n[2 * axis]]
        for k in range(2):
            d = (axis + 1 + k) % 3
            other = 3 - axis - d
            place = 2 * d
            if k == 0:
                place = 2 * d + 1
            total += legs[c][place] * legs[c][place] * edge[c][d]
            m = n[2 * other + 1]
            if m >= 0:
                total += legs[m][place] * legs[m][place] * edge[m][d]
        if wall[c][axis] == OPEN and total > 0.0:
            out[axis] = 1.0 / (total + mass[c][axis])
    inverse[c] = out


@wp.kernel
def sum_pairs(
    first: wp.int32, cells: int, block: int, inverse: wp.array(dtype=wp.vec3), a: wp.array(dtype=wp.vec3), b: wp.array(dtype=wp.vec3),
    scaled: int, sums: wp.array(dtype=wp.float64),
):  # fmt: skip
    """a b over the faces that are sought, in blocks of cells; each divided by the diagonal where `scaled`."""
    n = first + wp.tid()
    total = wp.float64(0.0)
    for c in range(n * block, wp.min((n + 1) * block, cells)):
        i = inverse[c]
        for axis in range(3):
            if i[axis] > 0.0:
                v = a[c][axis] * b[c][axis]
                if scaled == 1:
                    v = v * i[axis]
                total += wp.float64(v)
    sums[n] = total


@wp.kernel
def begin(first: wp.int32, mass: wp.array(dtype=wp.vec3), u: wp.array(dtype=wp.vec3), r: wp.array(dtype=wp.vec3)):
    """Residual at the velocities before: their momentum less what the matrix makes of them, which comes in `r`."""
    c = first + wp.tid()
    r[c] = wp.cw_mul(mass[c], u[c]) - r[c]


@wp.kernel
def turn(first: wp.int32, beta: float, inverse: wp.array(dtype=wp.vec3), r: wp.array(dtype=wp.vec3), p: wp.array(dtype=wp.vec3)):
    """The next direction: the residual over the diagonal, plus beta times the last one."""
    c = first + wp.tid()
    p[c] = wp.cw_mul(inverse[c], r[c]) + beta * p[c]


@wp.kernel
def advance_all(
    first: wp.int32, alpha: float, inverse: wp.array(dtype=wp.vec3), p: wp.array(dtype=wp.vec3), ap: wp.array(dtype=wp.vec3),
    u: wp.array(dtype=wp.vec3), r: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """u += alpha p, r -= alpha A p on the faces that are sought."""
    c = first + wp.tid()
    i = inverse[c]
    v = u[c]
    w = r[c]
    for axis in range(3):
        if i[axis] > 0.0:
            v[axis] = v[axis] + alpha * p[c][axis]
            w[axis] = w[axis] - alpha * ap[c][axis]
    u[c] = v
    r[c] = w


@wp.kernel
def drag(
    first: wp.int32, cells: int, block: int, blocks: int, grid: Columns, owners: wp.array(dtype=wp.int32),
    wall: wp.array(dtype=wp.vec3i), walls: Walls, f: wp.array(dtype=wp.vec3), sums: wp.array(dtype=vec6d),
):  # fmt: skip
    """Sum of `force` over the wall faces of one owner in a block of cells: along axes, and about its centre [cells]."""
    n = first + wp.tid()
    who = owners[n // blocks]
    b = n % blocks
    about = wp.vec3()
    if who >= 0:
        about = walls.center[who]
    total = vec6d()
    for c in range(b * block, wp.min((b + 1) * block, cells)):
        w = wall[c]
        if w[0] == who or w[1] == who or w[2] == who:
            at = place_of(grid, c)
            for axis in range(3):
                if w[axis] == who and f[c][axis] != 0.0:
                    g = wp.vec3()
                    g[axis] = f[c][axis]
                    m = wp.cross(face_center(at, axis) - about, g)
                    total += vec6d(
                        wp.float64(g[0]), wp.float64(g[1]), wp.float64(g[2]), wp.float64(m[0]), wp.float64(m[1]), wp.float64(m[2])
                    )
    sums[n] = total


@wp.kernel
def put_back(
    first: wp.int32, near: wp.array(dtype=vec6i), row: wp.array(dtype=wp.int32), opening: wp.array(dtype=wp.vec3),
    solved: wp.array(dtype=wp.vec3), now: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Velocities of the open faces of liquid cells."""
    c = first + wp.tid()
    u = now[c]
    for axis in range(3):
        o = near[c][2 * axis]
        if o >= 0 and opening[c][axis] >= LEAST_OPEN:
            if row[c] >= 0 or row[o] >= 0:
                u[axis] = solved[c][axis]
    now[c] = u


@wp.kernel
def add(first: wp.int32, more: wp.array(dtype=float), values: wp.array(dtype=float)):
    """values += more."""
    c = first + wp.tid()
    values[c] = values[c] + more[c]
