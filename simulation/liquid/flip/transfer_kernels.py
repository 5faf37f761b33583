# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Between particles and faces: each column adds its particles up in a place of its own, then faces gather from nine columns.

Positions are in cells, velocities in m/s. Face d of a cell is its lower one along axis d; velocities of faces stand in one
vector per cell. Weights are trilinear (tents of half width one cell).
"""

import warp as wp

from .column_kernels import Columns, cell_at, place_of, vec6i

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
def put(
    sums: wp.array(dtype=float), at: int, w0: float, w1: float, momentum: float, slope: float,
):  # fmt: skip
    """Add weight and momentum to a node and to the one above, where the momentum grows by `slope`."""
    sums[at] = sums[at] + w0
    sums[at + 1] = sums[at + 1] + w0 * momentum
    sums[at + WIDTH] = sums[at + WIDTH] + w1
    sums[at + WIDTH + 1] = sums[at + WIDTH + 1] + w1 * (momentum + slope)


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
        row = (s + k - grid.low[c]) * WIDTH
        center = row + bz * WIDTH
        z1 = m * cz1
        z0 = m - z1
        n = center + 2 * (by + 1)
        put(sums, n, (1.0 - tx) * cy0 * z0, (1.0 - tx) * cy0 * z1, pu, g[0, 2])
        put(sums, n + 2, (1.0 - tx) * cy1 * z0, (1.0 - tx) * cy1 * z1, pu + g[0, 1], g[0, 2])
        put(sums, n + 6, tx * cy0 * z0, tx * cy0 * z1, pu + g[0, 0], g[0, 2])
        put(sums, n + 8, tx * cy1 * z0, tx * cy1 * z1, pu + g[0, 0] + g[0, 1], g[0, 2])
        n = center + 12 + 4 * (bx + 1)
        put(sums, n, cx0 * (1.0 - ty) * z0, cx0 * (1.0 - ty) * z1, pv, g[1, 2])
        put(sums, n + 2, cx0 * ty * z0, cx0 * ty * z1, pv + g[1, 1], g[1, 2])
        put(sums, n + 4, cx1 * (1.0 - ty) * z0, cx1 * (1.0 - ty) * z1, pv + g[1, 0], g[1, 2])
        put(sums, n + 6, cx1 * ty * z0, cx1 * ty * z1, pv + g[1, 0] + g[1, 1], g[1, 2])
        f1 = m * tz
        f0 = m - f1
        n = row + 24 + 2 * (3 * (bx + 1) + by + 1)
        put(sums, n, cx0 * cy0 * f0, cx0 * cy0 * f1, pw, g[2, 2])
        put(sums, n + 2, cx0 * cy1 * f0, cx0 * cy1 * f1, pw + g[2, 1], g[2, 2])
        put(sums, n + 6, cx1 * cy0 * f0, cx1 * cy0 * f1, pw + g[2, 0], g[2, 2])
        put(sums, n + 8, cx1 * cy1 * f0, cx1 * cy1 * f1, pw + g[2, 0] + g[2, 1], g[2, 2])
        n = center + 42 + 3 * (bx + 1) + by + 1
        sums[n] = sums[n] + cx0 * cy0 * z0
        sums[n + 1] = sums[n + 1] + cx0 * cy1 * z0
        sums[n + 3] = sums[n + 3] + cx1 * cy0 * z0
        sums[n + 4] = sums[n + 4] + cx1 * cy1 * z0
        n = n + WIDTH
        sums[n] = sums[n] + cx0 * cy0 * z1
        sums[n + 1] = sums[n + 1] + cx0 * cy1 * z1
        sums[n + 3] = sums[n + 3] + cx1 * cy0 * z1
        sums[n + 4] = sums[n + 4] + cx1 * cy1 * z1


@wp.kernel
def gather(
    first: wp.int32, grid: Columns, sums: wp.array(dtype=float), kick: wp.vec3,
    was: wp.array(dtype=wp.vec3), weight: wp.array(dtype=wp.vec3), density: wp.array(dtype=float), now: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Velocity and weight of the faces of a cell, its density relative to rest, and the velocity after gravity's `kick` [m/s]."""
    c = first + wp.tid()
    at = place_of(grid, c)
    wu = float(0.0)
    wv = float(0.0)
    ww = float(0.0)
    mu = float(0.0)
    mv = float(0.0)
    mw = float(0.0)
    rho = float(0.0)
    for a in range(-1, 2):
        for b in range(-1, 2):
            n = cell_at(grid, at[0] - a, at[1] - b, at[2])
            if n >= 0:
                q = n * WIDTH
                if a >= 0:
                    s = q + 2 * (3 * a + b + 1)
                    wu += sums[s]
                    mu += sums[s + 1]
                if b >= 0:
                    s = q + 12 + 2 * (2 * (a + 1) + b)
                    wv += sums[s]
                    mv += sums[s + 1]
                s = q + 24 + 2 * (3 * (a + 1) + b + 1)
                ww += sums[s]
                mw += sums[s + 1]
                rho += sums[q + 42 + 3 * (a + 1) + b + 1]
    u = wp.vec3()
    if wu > 1.0e-6:
        u[0] = mu / wu
    if wv > 1.0e-6:
        u[1] = mv / wv
    if ww > 1.0e-6:
        u[2] = mw / ww
    was[c] = u
    weight[c] = wp.vec3(wu, wv, ww)
    density[c] = rho
    now[c] = u + kick


@wp.struct
class Stencil:
    """Cells and weights of the two centres (or faces) around a point along each axis."""

    base: wp.vec3i
    part: wp.vec3


@wp.func
def around(x: float, y: float, z: float, axis: int):
    """Lower corner and fractions of the cube of faces `axis` around a point."""
    sx = x - 0.5
    sy = y - 0.5
    sz = z - 0.5
    if axis == 0:
        sx = x
    if axis == 1:
        sy = y
    if axis == 2:
        sz = z
    s = Stencil()
    fx = wp.floor(sx)
    fy = wp.floor(sy)
    fz = wp.floor(sz)
    s.base = wp.vec3i(int(fx), int(fy), int(fz))
    s.part = wp.vec3(sx - fx, sy - fy, sz - fz)
    return s


@wp.func
def sample(grid: Columns, field: wp.array(dtype=wp.vec3), x: float, y: float, z: float):
    """Velocity at a point [m/s]."""
    result = wp.vec3()
    for axis in range(3):
        s = around(x, y, z, axis)
        total = float(0.0)
        for a in range(2):
            wa = 1.0 - s.part[0]
            if a == 1:
                wa = s.part[0]
            for b in range(2):
                wb = 1.0 - s.part[1]
                if b == 1:
                    wb = s.part[1]
                n = cell_at(grid, s.base[0] + a, s.base[1] + b, s.base[2])
                if n >= 0:
                    lower = field[n]
                    upper = field[n + 1]
                    total += wa * wb * (lower[axis] + s.part[2] * (upper[axis] - lower[axis]))
        result[axis] = total
    return result


@wp.kernel
def advance(
    first: wp.int32, grid: Columns, was: wp.array(dtype=wp.vec3), now: wp.array(dtype=wp.vec3), drift: wp.array(dtype=wp.vec3),
    pressure: wp.array(dtype=float), ratio: float, apic: int, cells_per_speed: float, reach: float, lower: wp.vec3, upper: wp.vec3,
    sides: vec6i, position: wp.array(dtype=wp.vec4), velocity: wp.array(dtype=wp.vec4), affine: wp.array(dtype=wp.mat33),
    left: wp.array(dtype=wp.int32),
):  # fmt: skip
    """New velocity of a particle, then its way by the midpoint rule along `drift`; `left` marks who crossed an open side.

    cells_per_speed: time step over cell size [cells / (m/s)]. The fourth component of velocity is the pressure of the cell.
    """
    p = first + wp.tid()
    x = position[p]
    v = velocity[p]
    full = wp.vec3()
    change = wp.vec3()
    g = wp.mat33()
    for axis in range(3):
        s = around(x[0], x[1], x[2], axis)
        f = float(0.0)
        d = float(0.0)
        for a in range(2):
            wa = 1.0 - s.part[0]
            if a == 1:
                wa = s.part[0]
            for b in range(2):
                wb = 1.0 - s.part[1]
                if b == 1:
                    wb = s.part[1]
                n = cell_at(grid, s.base[0] + a, s.base[1] + b, s.base[2])
                if n >= 0:
                    n0 = now[n]
                    n1 = now[n + 1]
                    rise = n1[axis] - n0[axis]
                    mean = n0[axis] + s.part[2] * rise
                    f += wa * wb * mean
                    if apic == 1:
                        g[axis, 0] = g[axis, 0] + (2.0 * float(a) - 1.0) * wb * mean
                        g[axis, 1] = g[axis, 1] + (2.0 * float(b) - 1.0) * wa * mean
                        g[axis, 2] = g[axis, 2] + wa * wb * rise
                    else:
                        o0 = was[n]
                        o1 = was[n + 1]
                        d += wa * wb * (o0[axis] + s.part[2] * (o1[axis] - o0[axis]))
        full[axis] = f
        change[axis] = f - d
    here = cell_at(grid, int(wp.floor(x[0])), int(wp.floor(x[1])), int(wp.floor(x[2])))
    press = float(0.0)
    if here >= 0:
        press = pressure[here]
    if apic == 1:
        affine[p] = g
        velocity[p] = wp.vec4(full[0], full[1], full[2], press)
    else:
        velocity[p] = wp.vec4(
            full[0] + ratio * (v[0] + change[0] - full[0]),
            full[1] + ratio * (v[1] + change[1] - full[1]),
            full[2] + ratio * (v[2] + change[2] - full[2]),
            press,
        )
    half = 0.5 * cells_per_speed
    d1 = sample(grid, drift, x[0], x[1], x[2])
    d2 = sample(grid, drift, x[0] + half * d1[0], x[1] + half * d1[1], x[2] + half * d1[2])
    gone = int(0)
    for axis in range(3):
        t = x[axis] + wp.clamp(cells_per_speed * d2[axis], -reach, reach)
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
