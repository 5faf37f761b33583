# mypy: ignore-errors
"""Warp kernels of the forces within a sheet and of the air on it."""

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = ["bending", "membrane"]


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
    p = x[f[1]] - xa
    q = x[f[2]] - xa
    fu = r[0] * p + r[1] * q
    fv = r[2] * p + r[3] * q
    one = wp.float64(1.0)
    lu = wp.length(fu)
    lv = wp.length(fv)
    iu = one / wp.max(lu, wp.float64(1.0e-9))
    iv = one / wp.max(lv, wp.float64(1.0e-9))
    eu = iu * fu
    ev = iv * fv
    shear = wp.dot(eu, ev)
    tu = iu * (ev - shear * eu)
    tv = iv * (eu - shear * ev)
    su = lu - one
    sv = lv - one
    ss = shear
    if m[3] > wp.float64(0.0):
        va = v[f[0]]
        p = v[f[1]] - va
        q = v[f[2]] - va
        fu = r[0] * p + r[1] * q
        fv = r[2] * p + r[3] * q
        su += m[3] * wp.dot(eu, fu)
        sv += m[3] * wp.dot(ev, fv)
        ss += m[3] * (wp.dot(tu, fu) + wp.dot(tv, fv))
    fu = -m[0] * su * eu - m[2] * ss * tu
    fv = -m[1] * sv * ev - m[2] * ss * tv
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
