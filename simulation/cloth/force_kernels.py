# mypy: ignore-errors
"""Warp kernels of the forces within a sheet, and what they and those of the air are made of."""

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = ["Strained", "across_face", "bending", "membrane", "strained", "sum_at_vertex", "wind_past"]


@wp.struct
class Strained:
    """Deformation of a triangle."""

    warp: wp.vec3d
    """Where a unit of length along warp goes."""
    weft: wp.vec3d
    inverse_warp: wp.float64
    """Inverse stretches along both [1]."""
    inverse_weft: wp.float64
    along: wp.vec3d
    """Directions of both."""
    across: wp.vec3d
    shear: wp.float64
    """Cosine of the angle between them."""
    turn_warp: wp.vec3d
    """Change of the shear with warp and with weft."""
    turn_weft: wp.vec3d


@wp.func
def strained(r: wp.vec4d, p: wp.vec3d, q: wp.vec3d):
    """Deformation of a triangle with edges p and q from its first corner, at rest the inverse of `r`
    (Baraff and Witkin 1998, doi:10.1145/280814.280821)."""
    s = Strained()
    one = wp.float64(1.0)
    tiny = wp.float64(1.0e-9)
    s.warp = r[0] * p + r[1] * q
    s.weft = r[2] * p + r[3] * q
    s.inverse_warp = one / wp.max(wp.length(s.warp), tiny)
    s.inverse_weft = one / wp.max(wp.length(s.weft), tiny)
    s.along = s.inverse_warp * s.warp
    s.across = s.inverse_weft * s.weft
    s.shear = wp.dot(s.along, s.across)
    s.turn_warp = s.inverse_warp * (s.across - s.shear * s.along)
    s.turn_weft = s.inverse_weft * (s.along - s.shear * s.across)
    return s


@wp.func
def sum_at_vertex(
    i: wp.int32,
    corner_start: wp.array(dtype=wp.int32),
    corners: wp.array(dtype=wp.int32),
    force: wp.array(dtype=wp.vec3d),
    hinge_start: wp.array(dtype=wp.int32),
    hinge_items: wp.array(dtype=wp.int32),
    hinge_weight: wp.array(dtype=wp.float64),
    pull: wp.array(dtype=wp.vec3d),
):
    """Force on a vertex by its triangles and hinges [N]."""
    f = wp.vec3d()
    for k in range(corner_start[i], corner_start[i + 1]):
        item = corners[k]
        t = item / 3
        corner = item - 3 * t
        if corner == 0:
            f -= force[2 * t] + force[2 * t + 1]
        else:
            f += force[2 * t + corner - 1]
    for k in range(hinge_start[i], hinge_start[i + 1]):
        item = hinge_items[k]
        f += hinge_weight[item] * pull[item / 4]
    return f


@wp.func
def wind_past(air: wp.vec4d, v: wp.array(dtype=wp.vec3d), f: wp.vec3i):
    """Velocity of the air against a triangle [m/s]."""
    return wp.vec3d(air[0], air[1], air[2]) - wp.float64(1.0 / 3.0) * (v[f[0]] + v[f[1]] + v[f[2]])


@wp.func
def across_face(x: wp.array(dtype=wp.vec3d), f: wp.vec3i):
    """Normal of a triangle, and twice its area [m^2] in a fourth place."""
    n = wp.cross(x[f[1]] - x[f[0]], x[f[2]] - x[f[0]])
    double = wp.length(n)
    n = n / wp.max(double, wp.float64(1.0e-30))
    return wp.vec4d(n[0], n[1], n[2], double)


@wp.kernel
def membrane(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3d),
    v: wp.array(dtype=wp.vec3d),
    faces: wp.array(dtype=wp.vec3i),
    inverse_rest: wp.array(dtype=wp.vec4d),
    law: wp.array(dtype=wp.vec4d),
    force: wp.array(dtype=wp.vec3d),
):
    """Forces on the second and third corner of each triangle: linear in the stretch along warp and weft and in the shear between them
    (after Baraff and Witkin 1998, doi:10.1145/280814.280821), with stresses of the same shape for their rates."""
    t = first + wp.tid()
    f = faces[t]
    r = inverse_rest[t]
    m = law[t]
    xa = x[f[0]]
    s = strained(r, x[f[1]] - xa, x[f[2]] - xa)
    one = wp.float64(1.0)
    su = wp.length(s.warp) - one
    sv = wp.length(s.weft) - one
    ss = s.shear
    if m[3] > wp.float64(0.0):
        va = v[f[0]]
        p = v[f[1]] - va
        q = v[f[2]] - va
        fu = r[0] * p + r[1] * q
        fv = r[2] * p + r[3] * q
        su += m[3] * wp.dot(s.along, fu)
        sv += m[3] * wp.dot(s.across, fv)
        ss += m[3] * (wp.dot(s.turn_warp, fu) + wp.dot(s.turn_weft, fv))
    fu = -m[0] * su * s.along - m[2] * ss * s.turn_warp
    fv = -m[1] * sv * s.across - m[2] * ss * s.turn_weft
    force[2 * t] = r[0] * fu + r[2] * fv
    force[2 * t + 1] = r[1] * fu + r[3] * fv


@wp.kernel
def bending(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3d),
    v: wp.array(dtype=wp.vec3d),
    hinges: wp.array(dtype=wp.vec4i),
    weight: wp.array(dtype=wp.vec4d),
    law: wp.array(dtype=wp.vec3d),
    pull: wp.array(dtype=wp.vec3d),
):
    """Force of each hinge on a vertex of weight 1."""
    h = first + wp.tid()
    e = hinges[h]
    w = weight[h]
    k = law[h]
    x0 = x[e[0]]
    s = w[1] * (x[e[1]] - x0) + w[2] * (x[e[2]] - x0) + w[3] * (x[e[3]] - x0)
    ds = w[0] * v[e[0]] + w[1] * v[e[1]] + w[2] * v[e[2]] + w[3] * v[e[3]]
    length = wp.length(s)
    if length < wp.float64(1.0e-12):
        pull[h] = -k[0] * k[2] * ds
        return
    along = s / length
    rest = k[1]
    if rest != wp.float64(0.0):
        n = wp.cross(x[e[1]] - x0, x[e[2]] - x0) + wp.cross(x[e[3]] - x0, x[e[1]] - x0)
        if wp.dot(s, n) < wp.float64(0.0):
            rest = -rest
    pull[h] = -k[0] * (length - rest + k[2] * wp.dot(along, ds)) * along
