# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Between particles and faces: each column adds its particles up in a place of its own, then faces gather from nine columns.

Positions are in cells, velocities in m/s. Face d of a cell is its lower one along axis d; velocities of faces stand in one
vector per cell. Weights are trilinear (tents of half width one cell).
"""

import warp as wp

from .column_kernels import Columns, vec6i

wp.set_module_options({"enable_backward": False})

__all__ = ["SUMS", "add_up", "advance", "fastest", "gather", "permute", "permute_affine"]

SUMS = 51
"""Sums per cell of a column: weight and momentum of 6 + 6 + 9 faces, weight of 9 centres."""
WIDTH = wp.constant(51)


@wp.kernel
def permute(
    first: wp.int32, order: wp.array(dtype=wp.int32), position: wp.array(dtype=wp.vec4), velocity: wp.array(dtype=wp.vec4),
    slot: wp.array(dtype=wp.int32), position_out: wp.array(dtype=wp.vec4), velocity_out: wp.array(dtype=wp.vec4),
    slot_out: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Particles in the order of their cells."""
    p = first + wp.tid()
    q = order[p]
    position_out[p] = position[q]
    velocity_out[p] = velocity[q]
    slot_out[p] = slot[q]


@wp.kernel
def permute_affine(
    first: wp.int32, order: wp.array(dtype=wp.int32), affine: wp.array(dtype=wp.mat33), affine_out: wp.array(dtype=wp.mat33)
):
    """Affine parts (APIC) in the order of the particles' cells."""
    p = first + wp.tid()
    affine_out[p] = affine[order[p]]


@wp.func
def put(sums: wp.array(dtype=float), at: int, w0: float, w1: float, momentum: float, slope: float):
    """Add weight and momentum to a node and to the one above, where the momentum grows by `slope`."""
    sums[at] = sums[at] + w0
    sums[at + 1] = sums[at + 1] + w0 * momentum
    sums[at + 2] = sums[at + 2] + w1
    sums[at + 3] = sums[at + 3] + w1 * (momentum + slope)


@wp.kernel
def add_up(
    first: wp.int32, grid: Columns, head: wp.array(dtype=wp.int32), position: wp.array(dtype=wp.vec4),
    velocity: wp.array(dtype=wp.vec4), affine: wp.array(dtype=wp.mat33), apic: int, sums: wp.array(dtype=float),
):  # fmt: skip
    """What the particles of one column give to the faces and centres of the nine columns around it."""
    c = first + wp.tid()
    s = grid.start[c]
    e = grid.start[c + 1]
    if e == s:
        return
    for n in range(s * WIDTH, e * WIDTH):
        sums[n] = 0.0
    i = c // grid.ny
    j = c - i * grid.ny
    many = 2 * (e - s)
    for p in range(head[c], head[c + 1]):
        x = position[p]
        v = velocity[p]
        kf = wp.floor(x[2])
        k = int(kf)
        tx = x[0] - float(i)
        ty = x[1] - float(j)
        tz = x[2] - kf
        bx = int(0)
        by = int(0)
        bz = int(0)
        if tx < 0.5:
            bx = -1
        if ty < 0.5:
            by = -1
        if tz < 0.5:
            bz = -1
        cx1 = tx - 0.5 - float(bx)
        cy1 = ty - 0.5 - float(by)
        cz1 = tz - 0.5 - float(bz)
        cx0 = 1.0 - cx1
        cy0 = 1.0 - cy1
        m = x[3]
        # Momentum at the lowest node of each kind, and how it grows from node to node.
        pu = v[0]
        pv = v[1]
        pw = v[2]
        g = wp.mat33()
        if apic == 1:
            g = affine[p]
            pu = pu - g[0, 0] * tx - g[0, 1] * cy1 - g[0, 2] * cz1
            pv = pv - g[1, 0] * cx1 - g[1, 1] * ty - g[1, 2] * cz1
            pw = pw - g[2, 0] * cx1 - g[2, 1] * cy1 - g[2, 2] * tz
        z1 = m * cz1
        z0 = m - z1
        level = k - grid.low[c]
        low = s * WIDTH + 2 * (level + bz)
        n = low + many * (by + 1)
        put(sums, n, (1.0 - tx) * cy0 * z0, (1.0 - tx) * cy0 * z1, pu, g[0, 2])
        put(sums, n + many, (1.0 - tx) * cy1 * z0, (1.0 - tx) * cy1 * z1, pu + g[0, 1], g[0, 2])
        put(sums, n + 3 * many, tx * cy0 * z0, tx * cy0 * z1, pu + g[0, 0], g[0, 2])
        put(sums, n + 4 * many, tx * cy1 * z0, tx * cy1 * z1, pu + g[0, 0] + g[0, 1], g[0, 2])
        n = low + many * (6 + 2 * (bx + 1))
        put(sums, n, cx0 * (1.0 - ty) * z0, cx0 * (1.0 - ty) * z1, pv, g[1, 2])
        put(sums, n + many, cx0 * ty * z0, cx0 * ty * z1, pv + g[1, 1], g[1, 2])
        put(sums, n + 2 * many, cx1 * (1.0 - ty) * z0, cx1 * (1.0 - ty) * z1, pv + g[1, 0], g[1, 2])
        put(sums, n + 3 * many, cx1 * ty * z0, cx1 * ty * z1, pv + g[1, 0] + g[1, 1], g[1, 2])
        f1 = m * tz
        f0 = m - f1
        n = s * WIDTH + 2 * level + many * (12 + 3 * (bx + 1) + by + 1)
        put(sums, n, cx0 * cy0 * f0, cx0 * cy0 * f1, pw, g[2, 2])
        put(sums, n + many, cx0 * cy1 * f0, cx0 * cy1 * f1, pw + g[2, 1], g[2, 2])
        put(sums, n + 3 * many, cx1 * cy0 * f0, cx1 * cy0 * f1, pw + g[2, 0], g[2, 2])
        put(sums, n + 4 * many, cx1 * cy1 * f0, cx1 * cy1 * f1, pw + g[2, 0] + g[2, 1], g[2, 2])
        n = s * WIDTH + 21 * many + level + bz + (e - s) * (3 * (bx + 1) + by + 1)
        sums[n] = sums[n] + cx0 * cy0 * z0
        sums[n + 1] = sums[n + 1] + cx0 * cy0 * z1
        n = n + e - s
        sums[n] = sums[n] + cx0 * cy1 * z0
        sums[n + 1] = sums[n + 1] + cx0 * cy1 * z1
        n = n + 2 * (e - s)
        sums[n] = sums[n] + cx1 * cy0 * z0
        sums[n + 1] = sums[n + 1] + cx1 * cy0 * z1
        n = n + e - s
        sums[n] = sums[n] + cx1 * cy1 * z0
        sums[n + 1] = sums[n + 1] + cx1 * cy1 * z1


@wp.kernel
def gather(
    first: wp.int32, grid: Columns, sums: wp.array(dtype=float), kick: wp.vec3,
    was: wp.array(dtype=wp.vec3), weight: wp.array(dtype=wp.vec3), density: wp.array(dtype=float), now: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Velocity and weight of the faces of a column's cells, their density relative to rest, and the velocity after gravity's
    `kick` [m/s].
    """
    c = first + wp.tid()
    start = grid.start[c]
    end = grid.start[c + 1]
    if end == start:
        return
    for cell in range(start, end):
        was[cell] = wp.vec3()
        weight[cell] = wp.vec3()
        density[cell] = 0.0
    i = c // grid.ny
    j = c - i * grid.ny
    for s in range(9):
        a = s // 3 - 1
        b = s - 3 * (s // 3) - 1
        if i - a >= 0 and j - b >= 0 and i - a < grid.nx and j - b < grid.ny:
            col = (i - a) * grid.ny + j - b
            other = grid.start[col]
            n = grid.start[col + 1] - other
            shift = grid.low[col] - grid.low[c]
            low = wp.max(0, shift)
            high = wp.min(end - start, shift + n)
            u = other * WIDTH + 2 * n * (3 * a + b + 1) - 2 * shift
            v = other * WIDTH + 2 * n * (6 + 2 * (a + 1) + b) - 2 * shift
            w = other * WIDTH + 2 * n * (12 + 3 * (a + 1) + b + 1) - 2 * shift
            d = other * WIDTH + 42 * n + n * (3 * (a + 1) + b + 1) - shift
            for k in range(low, high):
                m = wp.vec3(0.0, 0.0, sums[w + 2 * k])
                p = wp.vec3(0.0, 0.0, sums[w + 2 * k + 1])
                if a >= 0:
                    m[0] = sums[u + 2 * k]
                    p[0] = sums[u + 2 * k + 1]
                if b >= 0:
                    m[1] = sums[v + 2 * k]
                    p[1] = sums[v + 2 * k + 1]
                weight[start + k] = weight[start + k] + m
                was[start + k] = was[start + k] + p
                density[start + k] = density[start + k] + sums[d + k]
    for cell in range(start, end):
        m = weight[cell]
        p = was[cell]
        for axis in range(3):
            if m[axis] > 1.0e-6:
                p[axis] = p[axis] / m[axis]
            else:
                p[axis] = 0.0
        was[cell] = p
        now[cell] = p + kick


@wp.func
def blend(
    field: wp.array(dtype=wp.vec3), n00: int, n01: int, n10: int, n11: int, axis: int, wx: float, wy: float, wz: float,
):  # fmt: skip
    """Value between eight faces of an axis: four columns and the cells above them."""
    a = field[n00][axis]
    b = field[n01][axis]
    c = field[n10][axis]
    d = field[n11][axis]
    a = a + wz * (field[n00 + 1][axis] - a)
    b = b + wz * (field[n01 + 1][axis] - b)
    c = c + wz * (field[n10 + 1][axis] - c)
    d = d + wz * (field[n11 + 1][axis] - d)
    a = a + wy * (b - a)
    c = c + wy * (d - c)
    return a + wx * (c - a)


@wp.struct
class Stencil:
    """The cells at the bottom of the four columns around a point for each axis, and the point's place between faces (f) and
    between centres (c)."""

    u00: wp.int32
    u01: wp.int32
    u10: wp.int32
    u11: wp.int32
    v00: wp.int32
    v01: wp.int32
    v10: wp.int32
    v11: wp.int32
    w00: wp.int32
    w01: wp.int32
    w10: wp.int32
    w11: wp.int32
    f: wp.vec3
    c: wp.vec3


@wp.func
def stencil(grid: Columns, x: float, y: float, z: float):
    """Where a point lies; all cells around it exist."""
    i = int(x)
    j = int(y)
    k = int(z)
    ci = int(x - 0.5)
    cj = int(y - 0.5)
    ck = int(z - 0.5)
    s = Stencil()
    s.f = wp.vec3(x - float(i), y - float(j), z - float(k))
    s.c = wp.vec3(x - 0.5 - float(ci), y - 0.5 - float(cj), z - 0.5 - float(ck))
    n = i * grid.ny + cj
    s.u00 = grid.base[n] + ck
    s.u01 = grid.base[n + 1] + ck
    s.u10 = grid.base[n + grid.ny] + ck
    s.u11 = grid.base[n + grid.ny + 1] + ck
    n = ci * grid.ny + j
    s.v00 = grid.base[n] + ck
    s.v01 = grid.base[n + 1] + ck
    s.v10 = grid.base[n + grid.ny] + ck
    s.v11 = grid.base[n + grid.ny + 1] + ck
    n = ci * grid.ny + cj
    s.w00 = grid.base[n] + k
    s.w01 = grid.base[n + 1] + k
    s.w10 = grid.base[n + grid.ny] + k
    s.w11 = grid.base[n + grid.ny + 1] + k
    return s


@wp.func
def sample(s: Stencil, field: wp.array(dtype=wp.vec3)):
    """Velocity at a point [m/s]."""
    return wp.vec3(
        blend(field, s.u00, s.u01, s.u10, s.u11, 0, s.f[0], s.c[1], s.c[2]),
        blend(field, s.v00, s.v01, s.v10, s.v11, 1, s.c[0], s.f[1], s.c[2]),
        blend(field, s.w00, s.w01, s.w10, s.w11, 2, s.c[0], s.c[1], s.f[2]),
    )


@wp.func
def slope(
    field: wp.array(dtype=wp.vec3), n00: int, n01: int, n10: int, n11: int, axis: int, wx: float, wy: float, wz: float,
):  # fmt: skip
    """Gradient of one component between eight faces [m/s per cell]."""
    a0 = field[n00][axis]
    b0 = field[n01][axis]
    c0 = field[n10][axis]
    d0 = field[n11][axis]
    a1 = field[n00 + 1][axis]
    b1 = field[n01 + 1][axis]
    c1 = field[n10 + 1][axis]
    d1 = field[n11 + 1][axis]
    a = a0 + wz * (a1 - a0)
    b = b0 + wz * (b1 - b0)
    c = c0 + wz * (c1 - c0)
    d = d0 + wz * (d1 - d0)
    gx = (1.0 - wy) * (c - a) + wy * (d - b)
    gy = (1.0 - wx) * (b - a) + wx * (d - c)
    gz = (1.0 - wx) * ((1.0 - wy) * (a1 - a0) + wy * (b1 - b0)) + wx * ((1.0 - wy) * (c1 - c0) + wy * (d1 - d0))
    return wp.vec3(gx, gy, gz)


@wp.kernel
def advance(
    first: wp.int32, grid: Columns, given: wp.array(dtype=wp.vec3), drift: wp.array(dtype=wp.vec3), pressure: wp.array(dtype=float),
    ratio: float, apic: int, cells_per_speed: float, reach: float, lower: wp.vec3, upper: wp.vec3, sides: vec6i,
    position: wp.array(dtype=wp.vec4), velocity: wp.array(dtype=wp.vec4), affine: wp.array(dtype=wp.mat33),
    left: wp.array(dtype=wp.int32),
):  # fmt: skip
    """New velocity of a particle, then its way by the midpoint rule along `drift`; `left` marks who crossed an open side.

    Its velocity is ratio times its own plus what the faces give: FLIP and PIC in one (ratio 0 for APIC). The midpoint is guessed with
    that velocity. cells_per_speed: time step over cell size [cells / (m/s)]. The fourth component of velocity is the cell's pressure.
    """
    p = first + wp.tid()
    x = position[p]
    v = velocity[p]
    s = stencil(grid, x[0], x[1], x[2])
    d = sample(s, given)
    if apic == 1:
        gu = slope(given, s.u00, s.u01, s.u10, s.u11, 0, s.f[0], s.c[1], s.c[2])
        gv = slope(given, s.v00, s.v01, s.v10, s.v11, 1, s.c[0], s.f[1], s.c[2])
        gw = slope(given, s.w00, s.w01, s.w10, s.w11, 2, s.c[0], s.c[1], s.f[2])
        affine[p] = wp.matrix_from_rows(gu, gv, gw)
    else:
        d = d + ratio * wp.vec3(v[0], v[1], v[2])
    press = pressure[grid.base[int(x[0]) * grid.ny + int(x[1])] + int(x[2])]
    velocity[p] = wp.vec4(d[0], d[1], d[2], press)
    half = 0.5 * cells_per_speed
    d = sample(s, drift)
    y = wp.vec3()
    for axis in range(3):
        t = x[axis] + wp.clamp(half * d[axis], 0.5 - reach, reach - 0.5)
        y[axis] = wp.clamp(t, lower[axis] - 0.5, upper[axis] + 0.5)
    s = stencil(grid, y[0], y[1], y[2])
    d = sample(s, drift)
    gone = int(0)
    for axis in range(3):
        t = x[axis] + wp.clamp(cells_per_speed * d[axis], -reach, reach)
        if t < lower[axis] + 0.001:
            if sides[2 * axis] == 1:
                if t < lower[axis]:
                    gone = 1
            else:
                t = lower[axis] + 0.001
        if t > upper[axis] - 0.001:
            if sides[2 * axis + 1] == 1:
                if t > upper[axis]:
                    gone = 1
            else:
                t = upper[axis] - 0.001
        x[axis] = t
    position[p] = x
    left[p] = gone


@wp.kernel
def fastest(first: wp.int32, count: int, block: int, velocity: wp.array(dtype=wp.vec4), top: wp.array(dtype=wp.float64)):
    """Largest squared speed of each block of particles; infinite where one is not finite."""
    n = first + wp.tid()
    most = float(0.0)
    for p in range(n * block, wp.min((n + 1) * block, count)):
        v = velocity[p]
        s = v[0] * v[0] + v[1] * v[1] + v[2] * v[2]
        if wp.isfinite(s):
            most = wp.max(most, s)
        else:
            most = float(wp.inf)
    top[n] = wp.float64(most)
