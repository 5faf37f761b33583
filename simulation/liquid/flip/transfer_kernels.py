# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Between particles and faces: each column adds its particles up in a place of its own, then faces gather from nine columns.

Positions are in cells, velocities in m/s. Face d of a cell is its lower one along axis d; velocities of faces stand in one
vector per cell. Weights are trilinear (tents of half width one cell).
"""

import warp as wp

from ...grids.columns import Columns, vec6i

wp.set_module_options({"enable_backward": False})

__all__ = ["CENTRES", "FACES", "add_up", "advance", "fastest", "gather", "permute", "permute_affine"]

FACES = wp.constant(21)
"""Sums of faces per cell of a column: 6 along x, 6 along y, 9 along z; weight and momentum, each of a node and the one above."""
CENTRES = wp.constant(9)
"""Sums of centres per cell of a column: weight of a node and the one above."""


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
def growth(w0: float, w1: float, more: float):
    """Momentum that a node and the one above get for a velocity that is greater by `more`."""
    return wp.vec4(0.0, w0 * more, 0.0, w1 * more)


@wp.func
def with_slope(q: wp.vec4, change: float, slope: float):
    """Weights and momenta of a velocity that differs by `change` at the lower node and grows by `slope` to the one above."""
    return wp.vec4(q[0], q[1] + q[0] * change, q[2], q[3] + q[2] * (change + slope))


@wp.kernel
def add_up(
    first: wp.int32, ny: int, head: wp.array(dtype=wp.int32), low: wp.array(dtype=wp.int32), start: wp.array(dtype=wp.int32),
    position: wp.array(dtype=wp.vec4), velocity: wp.array(dtype=wp.vec4), affine: wp.array(dtype=wp.mat33), apic: int,
    sums: wp.array(dtype=wp.vec4), weights: wp.array(dtype=wp.vec2),
):  # fmt: skip
    """Sums from the particles of one column to the faces and centres of the nine columns around it."""
    c = first + wp.tid()
    s = start[c]
    many = start[c + 1] - s
    if many == 0:
        return
    for n in range(FACES * s, FACES * (s + many)):
        sums[n] = wp.vec4()
    for n in range(CENTRES * s, CENTRES * (s + many)):
        weights[n] = wp.vec2()
    i = c // ny
    ti = float(i)
    tj = float(c - i * ny)
    bottom = low[c]
    for p in range(head[c], head[c + 1]):
        x = position[p]
        v = velocity[p]
        k = int(x[2])
        tx = x[0] - ti
        ty = x[1] - tj
        tz = x[2] - float(k)
        bx = int(tx + 0.5)
        by = int(ty + 0.5)
        bz = int(tz + 0.5)
        cx1 = tx + 0.5 - float(bx)
        cy1 = ty + 0.5 - float(by)
        cz1 = tz + 0.5 - float(bz)
        cx0 = 1.0 - cx1
        cy0 = 1.0 - cy1
        z1 = x[3] * cz1
        z0 = x[3] - z1
        f1 = x[3] * tz
        f0 = x[3] - f1
        # Weight and momentum of the lower node of each kind and of the one above it, and how momentum grows along x and y.
        qu = wp.vec4(z0, z0 * v[0], z1, z1 * v[0])
        qv = wp.vec4(z0, z0 * v[1], z1, z1 * v[1])
        qw = wp.vec4(f0, f0 * v[2], f1, f1 * v[2])
        level = s * FACES + k - bottom + bz
        u = level + many * by
        vv = level + many * (6 + 2 * bx)
        w = s * FACES + k - bottom + 1 + many * (12 + 3 * bx + by)
        a = cx0 * cy0
        b = cx0 * cy1
        d = cx1 * cy0
        e = cx1 * cy1
        if apic == 1:
            g = affine[p]
            qu = with_slope(qu, -g[0, 0] * tx - g[0, 1] * cy1 - g[0, 2] * cz1, g[0, 2])
            qv = with_slope(qv, -g[1, 0] * cx1 - g[1, 1] * ty - g[1, 2] * cz1, g[1, 2])
            qw = with_slope(qw, -g[2, 0] * cx1 - g[2, 1] * cy1 - g[2, 2] * tz, g[2, 2])
            sums[u + many] = sums[u + many] + (1.0 - tx) * cy1 * growth(z0, z1, g[0, 1])
            sums[u + 3 * many] = sums[u + 3 * many] + tx * cy0 * growth(z0, z1, g[0, 0])
            sums[u + 4 * many] = sums[u + 4 * many] + tx * cy1 * growth(z0, z1, g[0, 0] + g[0, 1])
            sums[vv + many] = sums[vv + many] + cx0 * ty * growth(z0, z1, g[1, 1])
            sums[vv + 2 * many] = sums[vv + 2 * many] + cx1 * (1.0 - ty) * growth(z0, z1, g[1, 0])
            sums[vv + 3 * many] = sums[vv + 3 * many] + cx1 * ty * growth(z0, z1, g[1, 0] + g[1, 1])
            sums[w + many] = sums[w + many] + b * growth(f0, f1, g[2, 1])
            sums[w + 3 * many] = sums[w + 3 * many] + d * growth(f0, f1, g[2, 0])
            sums[w + 4 * many] = sums[w + 4 * many] + e * growth(f0, f1, g[2, 0] + g[2, 1])
        sums[u] = sums[u] + (1.0 - tx) * cy0 * qu
        sums[u + many] = sums[u + many] + (1.0 - tx) * cy1 * qu
        sums[u + 3 * many] = sums[u + 3 * many] + tx * cy0 * qu
        sums[u + 4 * many] = sums[u + 4 * many] + tx * cy1 * qu
        sums[vv] = sums[vv] + cx0 * (1.0 - ty) * qv
        sums[vv + many] = sums[vv + many] + cx0 * ty * qv
        sums[vv + 2 * many] = sums[vv + 2 * many] + cx1 * (1.0 - ty) * qv
        sums[vv + 3 * many] = sums[vv + 3 * many] + cx1 * ty * qv
        sums[w] = sums[w] + a * qw
        sums[w + many] = sums[w + many] + b * qw
        sums[w + 3 * many] = sums[w + 3 * many] + d * qw
        sums[w + 4 * many] = sums[w + 4 * many] + e * qw
        n = s * CENTRES + k - bottom + bz + many * (3 * bx + by)
        q = wp.vec2(z0, z1)
        weights[n] = weights[n] + a * q
        weights[n + many] = weights[n + many] + b * q
        weights[n + 3 * many] = weights[n + 3 * many] + d * q
        weights[n + 4 * many] = weights[n + 4 * many] + e * q


@wp.kernel
def gather(
    first: wp.int32, grid: Columns, low: wp.array(dtype=wp.int32), start: wp.array(dtype=wp.int32), sums: wp.array(dtype=wp.vec4),
    weights: wp.array(dtype=wp.vec2), kick: wp.vec3, was: wp.array(dtype=wp.vec3), weight: wp.array(dtype=wp.vec3),
    density: wp.array(dtype=float), now: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Velocity and weight of the faces of a column's cells, their density relative to rest, and the velocity after gravity's
    `kick` [m/s].
    """
    c = first + wp.tid()
    begin = grid.start[c]
    end = grid.start[c + 1]
    if end == begin:
        return
    for cell in range(begin, end):
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
            other = start[col]
            n = start[col + 1] - other
            if n > 0:
                # Each node of a column of sums stands for z = low - 1 + its number and, with its upper half, for the one above.
                z = begin + low[col] - 1 - grid.low[c]
                u = other * FACES + n * (3 * a + b + 1)
                v = other * FACES + n * (6 + 2 * (a + 1) + b)
                w = other * FACES + n * (12 + 3 * (a + 1) + b + 1)
                d = other * CENTRES + n * (3 * (a + 1) + b + 1)
                below = wp.vec3()
                pull = wp.vec3()
                lower = float(0.0)
                for node in range(n + 1):
                    m = below
                    p = pull
                    r = lower
                    if node < n:
                        qu = wp.vec4()
                        qv = wp.vec4()
                        if a >= 0:
                            qu = sums[u + node]
                        if b >= 0:
                            qv = sums[v + node]
                        qw = sums[w + node]
                        q = weights[d + node]
                        m = m + wp.vec3(qu[0], qv[0], qw[0])
                        p = p + wp.vec3(qu[1], qv[1], qw[1])
                        r = r + q[0]
                        below = wp.vec3(qu[2], qv[2], qw[2])
                        pull = wp.vec3(qu[3], qv[3], qw[3])
                        lower = q[1]
                    cell = z + node
                    if cell >= begin and cell < end:
                        weight[cell] = weight[cell] + m
                        was[cell] = was[cell] + p
                        density[cell] = density[cell] + r
    for cell in range(begin, end):
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
    y0 = wp.clamp(x[0] + wp.clamp(half * d[0], 0.5 - reach, reach - 0.5), lower[0] - 0.5, upper[0] + 0.5)
    y1 = wp.clamp(x[1] + wp.clamp(half * d[1], 0.5 - reach, reach - 0.5), lower[1] - 0.5, upper[1] + 0.5)
    y2 = wp.clamp(x[2] + wp.clamp(half * d[2], 0.5 - reach, reach - 0.5), lower[2] - 0.5, upper[2] + 0.5)
    s = stencil(grid, y0, y1, y2)
    d = sample(s, drift)
    gone = int(0)
    tx = x[0] + wp.clamp(cells_per_speed * d[0], -reach, reach)
    ty = x[1] + wp.clamp(cells_per_speed * d[1], -reach, reach)
    tz = x[2] + wp.clamp(cells_per_speed * d[2], -reach, reach)
    inner = tx >= lower[0] + 0.001 and ty >= lower[1] + 0.001 and tz >= lower[2] + 0.001
    if inner and tx <= upper[0] - 0.001 and ty <= upper[1] - 0.001 and tz <= upper[2] - 0.001:
        x = wp.vec4(tx, ty, tz, x[3])
    else:
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
