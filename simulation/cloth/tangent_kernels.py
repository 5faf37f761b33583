# mypy: ignore-errors
"""Warp kernels of an implicit step: where forces are looked at, how they change with the vertices, what is left unbalanced."""

import warp as wp

from .force_kernels import across_face, strained, sum_at_vertex, wind_past

wp.set_module_options({"enable_backward": False})

__all__ = ["ahead", "block", "catch_damping", "damp_air", "frame", "guess", "regain", "tangent", "unbalanced"]


@wp.kernel
def guess(
    first: wp.int32,
    v: wp.array(dtype=wp.vec3d),
    x: wp.array(dtype=wp.vec3d),
    target: wp.array(dtype=wp.vec3d),
    inverse: wp.array(dtype=wp.float64),
    clock: wp.array(dtype=wp.float64),
    u: wp.array(dtype=wp.vec3d),
):
    """Mean velocity of the step to begin with: as before, or that which takes held vertices where they are led."""
    i = first + wp.tid()
    if inverse[i] > wp.float64(0.0):
        u[i] = v[i]
    else:
        u[i] = (target[i] - x[i]) / clock[0]


@wp.kernel
def ahead(
    first: wp.int32,
    theta: wp.float64,
    clock: wp.array(dtype=wp.float64),
    x: wp.array(dtype=wp.vec3d),
    u: wp.array(dtype=wp.vec3d),
    middle: wp.array(dtype=wp.vec3d),
):
    """Where the forces of the step are looked at."""
    i = first + wp.tid()
    middle[i] = x[i] + theta * clock[0] * u[i]


@wp.kernel
def tangent(
    first: wp.int32,
    theta: wp.float64,
    clock: wp.array(dtype=wp.float64),
    x: wp.array(dtype=wp.vec3d),
    faces: wp.array(dtype=wp.vec3i),
    inverse_rest: wp.array(dtype=wp.vec4d),
    law: wp.array(dtype=wp.vec4d),
    along: wp.array(dtype=wp.mat33d),
    across: wp.array(dtype=wp.mat33d),
    mixed: wp.array(dtype=wp.mat33d),
    warps: wp.array(dtype=wp.vec3d),
    wefts: wp.array(dtype=wp.vec3d),
):
    """Change of a triangle's stresses with its deformation, times the squared share of the step, without what would make it negative; and
    where warp and weft lie."""
    t = first + wp.tid()
    f = faces[t]
    r = inverse_rest[t]
    m = law[t]
    xa = x[f[0]]
    s = strained(r, x[f[1]] - xa, x[f[2]] - xa)
    one = wp.float64(1.0)
    zero = wp.float64(0.0)
    step = theta * clock[0]
    still = step * step
    both = still + step * m[3]
    unit = wp.identity(n=3, dtype=wp.float64)
    tight_u = still * wp.max(one - s.inverse_warp, zero)
    tight_v = still * wp.max(one - s.inverse_weft, zero)
    sheared = both * m[2]
    along[t] = m[0] * ((both - tight_u) * wp.outer(s.along, s.along) + tight_u * unit) + sheared * wp.outer(
        s.turn_warp, s.turn_warp
    )
    across[t] = m[1] * ((both - tight_v) * wp.outer(s.across, s.across) + tight_v * unit) + sheared * wp.outer(
        s.turn_weft, s.turn_weft
    )
    mixed[t] = sheared * wp.outer(s.turn_warp, s.turn_weft)
    warps[t] = s.warp
    wefts[t] = s.weft


@wp.kernel
def block(
    first: wp.int32,
    start: wp.array(dtype=wp.int32),
    items: wp.array(dtype=wp.int32),
    inverse_rest: wp.array(dtype=wp.vec4d),
    along: wp.array(dtype=wp.mat33d),
    across: wp.array(dtype=wp.mat33d),
    mixed: wp.array(dtype=wp.mat33d),
    blocks: wp.array(dtype=wp.mat33d),
):
    """One block of the matrix: what the triangles of two vertices (items: 9 * triangle + 3 * corner + corner) add up to."""
    k = first + wp.tid()
    total = wp.mat33d()
    for s in range(start[k], start[k + 1]):
        item = items[s]
        t = item / 9
        a = (item - 9 * t) / 3
        b = item - 9 * t - 3 * a
        r = inverse_rest[t]
        au = -r[0] - r[1]
        av = -r[2] - r[3]
        if a > 0:
            au = r[a - 1]
            av = r[a + 1]
        bu = -r[0] - r[1]
        bv = -r[2] - r[3]
        if b > 0:
            bu = r[b - 1]
            bv = r[b + 1]
        m = mixed[t]
        total += (au * bu) * along[t] + (av * bv) * across[t] + (au * bv) * m + (av * bu) * wp.transpose(m)
    blocks[k] = total


@wp.kernel
def frame(
    first: wp.int32,
    corner_start: wp.array(dtype=wp.int32),
    corners: wp.array(dtype=wp.int32),
    area: wp.array(dtype=wp.float64),
    warps: wp.array(dtype=wp.vec3d),
    wefts: wp.array(dtype=wp.vec3d),
    frames: wp.array(dtype=wp.mat33d),
):
    """Rows: warp, weft and normal of the sheet at a vertex, upright to each other."""
    i = first + wp.tid()
    u = wp.vec3d()
    v = wp.vec3d()
    for k in range(corner_start[i], corner_start[i + 1]):
        t = corners[k] / 3
        u += area[t] * warps[t]
        v += area[t] * wefts[t]
    tiny = wp.float64(1.0e-9)
    small = wp.float64(1.0e-30)
    lu = wp.length(u)
    lv = wp.length(v)
    u = u / wp.max(lu, small)
    v = v / wp.max(lv, small)
    p = u + v
    q = u - v
    lp = wp.length(p)
    lq = wp.length(q)
    if lp < tiny or lq < tiny:
        frames[i] = wp.identity(n=3, dtype=wp.float64)
        return
    p = p / lp
    q = q - wp.dot(q, p) * p
    q = q / wp.max(wp.length(q), small)
    half = wp.float64(0.7071067811865476)
    u = half * (p + q)
    v = half * (p - q)
    n = wp.cross(u, v)
    frames[i] = wp.mat33d(u[0], u[1], u[2], v[0], v[1], v[2], n[0], n[1], n[2])


@wp.kernel
def unbalanced(
    first: wp.int32,
    theta: wp.float64,
    v: wp.array(dtype=wp.vec3d),
    u: wp.array(dtype=wp.vec3d),
    mass: wp.array(dtype=wp.float64),
    corner_start: wp.array(dtype=wp.int32),
    corners: wp.array(dtype=wp.int32),
    force: wp.array(dtype=wp.vec3d),
    hinge_start: wp.array(dtype=wp.int32),
    hinge_items: wp.array(dtype=wp.int32),
    hinge_weight: wp.array(dtype=wp.float64),
    pull: wp.array(dtype=wp.vec3d),
    acceleration: wp.array(dtype=wp.vec3d),
    drag: wp.array(dtype=wp.mat33d),
    inverse: wp.array(dtype=wp.float64),
    clock: wp.array(dtype=wp.float64),
    rest: wp.array(dtype=wp.vec3d),
):
    """Impulse on each vertex that its change of velocity does not answer yet, times theta; of held ones, all of it."""
    i = first + wp.tid()
    f = sum_at_vertex(i, corner_start, corners, force, hinge_start, hinge_items, hinge_weight, pull)
    change = u[i] - v[i]
    m = mass[i]
    left = theta * clock[0] * (f + m * acceleration[i] - drag[i] * change)
    if inverse[i] > wp.float64(0.0):
        left -= m * change
    rest[i] = left


@wp.kernel
def damp_air(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3d),
    v: wp.array(dtype=wp.vec3d),
    faces: wp.array(dtype=wp.vec3i),
    air: wp.array(dtype=wp.vec4d),
    drag: wp.array(dtype=wp.vec2d),
    felt: wp.array(dtype=wp.mat33d),
):
    """Fall of a third of the air's force on each triangle with its velocity [N s/m]; symmetric, without what it turns."""
    t = first + wp.tid()
    f = faces[t]
    d = drag[t]
    third = wp.float64(1.0 / 3.0)
    a = air[t]
    w = wind_past(a, v, f)
    face = across_face(x, f)
    n = wp.vec3d(face[0], face[1], face[2])
    speed = wp.length(w)
    across = wp.dot(w, n)
    scale = wp.float64(0.25) * a[3] * face[3] * third
    high = scale * d[0] * (speed + across * across / wp.max(speed, wp.float64(1.0e-30)))
    low = scale * d[1] * speed
    felt[t] = (high - low) * wp.outer(n, n) + low * wp.identity(n=3, dtype=wp.float64)


@wp.kernel
def catch_damping(
    first: wp.int32,
    corner_start: wp.array(dtype=wp.int32),
    corners: wp.array(dtype=wp.int32),
    felt: wp.array(dtype=wp.mat33d),
    drag: wp.array(dtype=wp.mat33d),
):
    """The same at vertices."""
    i = first + wp.tid()
    total = wp.mat33d()
    for k in range(corner_start[i], corner_start[i + 1]):
        total += felt[corners[k] / 3]
    drag[i] = total


@wp.kernel
def regain(
    first: wp.int32,
    theta: wp.float64,
    inverse: wp.array(dtype=wp.float64),
    before: wp.array(dtype=wp.vec3d),
    mean: wp.array(dtype=wp.vec3d),
    v: wp.array(dtype=wp.vec3d),
):
    """Velocity at the end of the step, from that at its start and the mean one."""
    i = first + wp.tid()
    if inverse[i] > wp.float64(0.0):
        v[i] = before[i] + (mean[i] - before[i]) / theta
    else:
        v[i] = mean[i]
