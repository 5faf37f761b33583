# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Warp functions in float64: distance of two triangles, crossing of a ray, solid angle. Import only where warp is used."""

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = ["corner", "ray_crossing", "solid_angle", "triangle_gap"]

ZERO = wp.constant(wp.float64(0.0))
ONE = wp.constant(wp.float64(1.0))
TINY = wp.constant(wp.float64(2.3e-308))
PARALLEL = wp.constant(wp.float64(1e-30))
"""Squared sine of the angle below which two segments count as parallel."""
FAR = wp.constant(wp.float64(1e300))
SURE = wp.constant(wp.float64(1e-12))
"""Squared gap relative to the squared triangle sizes from which on a separating direction is known to 1e-10."""


@wp.func
def corner(t: wp.mat33d, k: wp.int32) -> wp.vec3d:
    """Corner k of a triangle whose corners are the rows of t."""
    return wp.vec3d(t[k, 0], t[k, 1], t[k, 2])


@wp.func
def segment_places(p: wp.vec3d, u: wp.vec3d, q: wp.vec3d, v: wp.vec3d) -> wp.vec2d:
    """Nearest parameters of segments p + s u and q + t v, as `triangles.segment_points`."""
    uu = wp.dot(u, u)
    vv = wp.dot(v, v)
    uv = wp.dot(u, v)
    r = q - p
    normal = wp.cross(u, v)
    square = wp.dot(normal, normal)
    s = ZERO
    if square > PARALLEL * uu * vv:
        s = wp.clamp(wp.dot(wp.cross(r, v), normal) / square, ZERO, ONE)
    ru = wp.dot(r, u)
    rv = wp.dot(r, v)
    t = wp.clamp((s * uv - rv) / wp.max(vv, TINY), ZERO, ONE)
    s = wp.clamp((t * uv + ru) / wp.max(uu, TINY), ZERO, ONE)
    t = wp.clamp((s * uv - rv) / wp.max(vv, TINY), ZERO, ONE)
    return wp.vec2d(s, t)


@wp.func
def over(b: wp.mat33d, normal: wp.vec3d, point: wp.vec3d) -> wp.bool:
    """True if a point lies over triangle b along its normal."""
    b0 = corner(b, 0)
    b1 = corner(b, 1)
    b2 = corner(b, 2)
    return (
        wp.dot(wp.cross(normal, b1 - b0), point - b0) >= ZERO
        and wp.dot(wp.cross(normal, b2 - b1), point - b1) >= ZERO
        and wp.dot(wp.cross(normal, b0 - b2), point - b2) >= ZERO
    )


@wp.func
def heights(a: wp.mat33d, origin: wp.vec3d, normal: wp.vec3d) -> wp.vec3d:
    """Heights of the corners of a over a plane, times the length of its normal."""
    return wp.vec3d(
        wp.dot(corner(a, 0) - origin, normal), wp.dot(corner(a, 1) - origin, normal), wp.dot(corner(a, 2) - origin, normal)
    )


@wp.func
def from_plane(h: wp.vec3d, square: wp.float64) -> wp.float64:
    """Squared distance of a triangle to a plane from its `heights`; 0 where it reaches both sides."""
    least = wp.min(h)
    most = wp.max(h)
    if least > ZERO:
        return least * least / square
    if most < ZERO:
        return most * most / square
    return ZERO


@wp.func
def nearest_corner(h: wp.vec3d) -> wp.int32:
    """Which corner is nearest to the plane of `heights`."""
    k = wp.int32(0)
    if wp.abs(h[1]) < wp.abs(h[k]):
        k = 1
    if wp.abs(h[2]) < wp.abs(h[k]):
        k = 2
    return k


@wp.func
def pierces(a: wp.mat33d, h: wp.vec3d, b: wp.mat33d, normal: wp.vec3d) -> wp.bool:
    """True if an edge of a goes through b, given the heights of a over the plane of b."""
    for k in range(3):
        n = (k + 1) % 3
        if (h[k] <= ZERO) != (h[n] <= ZERO):
            share = h[k] / (h[k] - h[n])
            p = corner(a, k)
            if over(b, normal, p + share * (corner(a, n) - p)):
                return True
    return False


@wp.func
def triangle_gap(a: wp.mat33d, b: wp.mat33d, bound: wp.float64) -> wp.float64:
    """Squared distance of two triangles, 0 where they cross; some number above `bound` where it is above it.

    A corner over the other's face is the nearest pair if the face's plane separates. Otherwise the nearest pair lies on
    edges; a pair of edge points with both third corners beyond the slab between them ends the search. Order and early
    ends follow Larsen, Gottschalk, Lin and Manocha (1999), "Fast proximity queries with swept sphere volumes".
    """
    a0 = corner(a, 0)
    b0 = corner(b, 0)
    normal_b = wp.cross(corner(b, 1) - b0, corner(b, 2) - b0)
    square_b = wp.max(wp.dot(normal_b, normal_b), TINY)
    h_a = heights(a, b0, normal_b)
    plane_b = from_plane(h_a, square_b)
    if plane_b > bound:
        return FAR
    if plane_b > ZERO and over(b, normal_b, corner(a, nearest_corner(h_a))):
        return plane_b
    normal_a = wp.cross(corner(a, 1) - a0, corner(a, 2) - a0)
    square_a = wp.max(wp.dot(normal_a, normal_a), TINY)
    h_b = heights(b, a0, normal_a)
    plane_a = from_plane(h_b, square_a)
    if plane_a > bound:
        return FAR
    if plane_a > ZERO and over(a, normal_a, corner(b, nearest_corner(h_b))):
        return plane_a
    if plane_a == ZERO and plane_b == ZERO and (pierces(a, h_a, b, normal_b) or pierces(b, h_b, a, normal_a)):
        return ZERO
    best = FAR
    # Lengths of triangles, squared, times the sine: good enough to tell noise from a gap.
    sure = SURE * (wp.length_sq(corner(a, 1) - a0) + wp.length_sq(corner(b, 1) - b0) + wp.length_sq(b0 - a0))
    for i in range(9):
        k = i // 3
        m = i % 3
        p = corner(a, k)
        q = corner(b, m)
        u = corner(a, (k + 1) % 3) - p
        v = corner(b, (m + 1) % 3) - q
        place = segment_places(p, u, q, v)
        on_a = p + place[0] * u
        on_b = q + place[1] * v
        way = on_b - on_a
        square = wp.dot(way, way)
        if square < best:
            best = square
            if (
                square > sure
                and wp.dot(corner(a, (k + 2) % 3) - on_a, way) <= ZERO
                and wp.dot(corner(b, (m + 2) % 3) - on_b, way) >= ZERO
            ):
                return best
    return best


@wp.func
def ray_crossing(t: wp.mat33d, point: wp.vec3d, ray: wp.vec3d, margin: wp.float64) -> wp.int32:
    """+1 or -1 where the ray leaves or enters through the triangle, 0 where it misses, 2 where it grazes an edge.

    Args:
        t: corners of the triangle.
        point: start of the ray.
        ray: unit direction.
        margin: rays that pass an edge closer than this [m] graze it.
    """
    x = corner(t, 0) - point
    y = corner(t, 1) - point
    z = corner(t, 2) - point
    # Moments of the edges about the ray: positive where it passes on the inner side, seen against an outward normal.
    e0 = wp.dot(ray, wp.cross(x, y))
    e1 = wp.dot(ray, wp.cross(y, z))
    e2 = wp.dot(ray, wp.cross(z, x))
    m0 = margin * wp.length(y - x)
    m1 = margin * wp.length(z - y)
    m2 = margin * wp.length(x - z)
    if (e0 >= -m0 and e1 >= -m1 and e2 >= -m2) or (e0 <= m0 and e1 <= m1 and e2 <= m2):
        if wp.abs(e0) <= m0 or wp.abs(e1) <= m1 or wp.abs(e2) <= m2:
            return 2
        # Weighted by the edge opposite to each corner: the place where the ray meets the plane, times the total.
        total = e0 + e1 + e2
        along = (e1 * wp.dot(x, ray) + e2 * wp.dot(y, ray) + e0 * wp.dot(z, ray)) / total
        if along <= ZERO:
            return 0
        if total > ZERO:
            return 1
        return -1
    return 0


@wp.func
def solid_angle(t: wp.mat33d, point: wp.vec3d) -> wp.float64:
    """Signed solid angle of a triangle over 2, by Van Oosterom and Strackee (1983), doi:10.1109/TBME.1983.325207."""
    a = corner(t, 0) - point
    b = corner(t, 1) - point
    c = corner(t, 2) - point
    la = wp.length(a)
    lb = wp.length(b)
    lc = wp.length(c)
    below = la * lb * lc + wp.dot(a, b) * lc + wp.dot(b, c) * la + wp.dot(c, a) * lb
    return wp.atan2(wp.dot(a, wp.cross(b, c)), below)
