# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Warp kernels of batched clearance: descent of two trees, and containment of one vertex per component.

Both only gather: thread i reads its own query and writes its own answer. Import only where warp is used.
"""

import warp as wp

from .triangle_kernels import ray_crossing, solid_angle, triangle_gap

wp.set_module_options({"enable_backward": False})

__all__ = ["STACK", "contained", "nearest"]

STACK = 96
"""Entries of the stack of a descent: enough for two trees of 2**47 leaves; one entry is pushed per level of either."""
GRAZE = wp.constant(wp.float64(1e-11))
"""Relative to the size: rays this close to an edge are left to the solid angle."""
HALF_TURN = wp.constant(wp.float64(3.141592653589793))
RAY = wp.constant(wp.vec3d(0.0178902, 0.0123463, 0.9997637))
"""Unit direction, slanted so that meshes made on grids are not hit along their edges."""


@wp.struct
class Wood:
    """A `forest.Forest` on a device."""

    lower: wp.array(dtype=wp.vec3d)
    upper: wp.array(dtype=wp.vec3d)
    link: wp.array(dtype=wp.int32)
    span: wp.array(dtype=wp.int32)
    corners: wp.array(dtype=wp.mat33d)
    face: wp.array(dtype=wp.int32)
    first_face: wp.array(dtype=wp.int32)
    heads: wp.array(dtype=wp.vec3d)
    first_head: wp.array(dtype=wp.int32)
    volume: wp.array(dtype=wp.int32)


@wp.func
def absolute(m: wp.mat33d) -> wp.mat33d:
    """Entries without their sign."""
    return wp.mat33d(
        wp.abs(m[0, 0]), wp.abs(m[0, 1]), wp.abs(m[0, 2]),
        wp.abs(m[1, 0]), wp.abs(m[1, 1]), wp.abs(m[1, 2]),
        wp.abs(m[2, 0]), wp.abs(m[2, 1]), wp.abs(m[2, 2]),
    )  # fmt: skip


@wp.func
def outside(way: wp.vec3d, reach: wp.vec3d) -> wp.float64:
    """Squared distance of two boxes along their axes, from the way between centres and the sum of half extents."""
    x = wp.max(wp.abs(way[0]) - reach[0], wp.float64(0.0))
    y = wp.max(wp.abs(way[1]) - reach[1], wp.float64(0.0))
    z = wp.max(wp.abs(way[2]) - reach[2], wp.float64(0.0))
    return x * x + y * y + z * z


@wp.func
def box_gap(wood: Wood, a: wp.int32, b: wp.int32, turn: wp.mat33d, bare: wp.mat33d, shift: wp.vec3d) -> wp.float64:
    """Lower bound of the squared distance of node a to node b: that of their boxes in the frame of either."""
    half_a = wp.float64(0.5) * (wood.upper[a] - wood.lower[a])
    half_b = wp.float64(0.5) * (wood.upper[b] - wood.lower[b])
    way = turn * (wood.lower[a] + half_a) + shift - wood.lower[b] - half_b
    in_b = outside(way, bare * half_a + half_b)
    in_a = outside(way * turn, half_b * bare + half_a)
    return wp.max(in_b, in_a)


@wp.func
def moved(t: wp.mat33d, turn: wp.mat33d, shift: wp.vec3d) -> wp.mat33d:
    """Triangle t, rows its corners, carried by a motion."""
    a = turn * wp.vec3d(t[0, 0], t[0, 1], t[0, 2]) + shift
    b = turn * wp.vec3d(t[1, 0], t[1, 1], t[1, 2]) + shift
    c = turn * wp.vec3d(t[2, 0], t[2, 1], t[2, 2]) + shift
    return wp.mat33d(a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2])


@wp.kernel
def nearest(
    first: wp.int32,
    wood: Wood,
    solid_a: wp.array(dtype=wp.int32),
    solid_b: wp.array(dtype=wp.int32),
    rotation: wp.array(dtype=wp.mat33d),
    translation: wp.array(dtype=wp.vec3d),
    touch: wp.array(dtype=wp.float64),
    skip_above: wp.array(dtype=wp.float64),
    distance: wp.array(dtype=wp.float64),
    face_a: wp.array(dtype=wp.int32),
    face_b: wp.array(dtype=wp.int32),
):
    """Distance of two triangle soups where it is at most its `skip_above`, a lower bound above it elsewhere (faces -1).

    The descent ends at a distance of `touch` or less: the surfaces touch or cross.
    """
    i = first + wp.tid()
    turn = rotation[i]
    shift = translation[i]
    bare = absolute(turn)
    best = skip_above[i] * skip_above[i]
    enough = touch[i] * touch[i]
    least = wp.float64(1e300)
    found_a = wp.int32(-1)
    found_b = wp.int32(-1)
    stack_a = wp.zeros(shape=STACK, dtype=wp.int32)
    stack_b = wp.zeros(shape=STACK, dtype=wp.int32)
    stack_gap = wp.zeros(shape=STACK, dtype=wp.float64)
    stack_a[0] = solid_a[i]
    stack_b[0] = solid_b[i]
    stack_gap[0] = box_gap(wood, solid_a[i], solid_b[i], turn, bare, shift)
    top = wp.int32(1)
    while top > 0:
        top = top - 1
        if stack_gap[top] > best:
            least = wp.min(least, stack_gap[top])
            continue
        a = stack_a[top]
        b = stack_b[top]
        span_a = wood.span[a]
        span_b = wood.span[b]
        if span_a > 0 and span_b > 0:
            for m in range(span_a):
                place_a = m - 1 - wood.link[a]
                one = moved(wood.corners[place_a], turn, shift)
                for n in range(span_b):
                    place_b = n - 1 - wood.link[b]
                    gap = triangle_gap(one, wood.corners[place_b], best)
                    if gap < best or (gap == best and found_a < 0):
                        best = gap
                        found_a = place_a
                        found_b = place_b
            if best <= enough:
                top = 0
        else:
            size_a = wp.length_sq(wood.upper[a] - wood.lower[a])
            size_b = wp.length_sq(wood.upper[b] - wood.lower[b])
            a1 = a
            a2 = a
            b1 = b
            b2 = b
            if span_b > 0 or (span_a == 0 and size_a >= size_b):
                a1 = wood.link[a]
                a2 = a1 + 1
            else:
                b1 = wood.link[b]
                b2 = b1 + 1
            gap1 = box_gap(wood, a1, b1, turn, bare, shift)
            gap2 = box_gap(wood, a2, b2, turn, bare, shift)
            # The nearer pair comes last, so that it is taken first.
            if gap2 <= gap1:
                stack_a[top] = a1
                stack_b[top] = b1
                stack_gap[top] = gap1
                stack_a[top + 1] = a2
                stack_b[top + 1] = b2
                stack_gap[top + 1] = gap2
            else:
                stack_a[top] = a2
                stack_b[top] = b2
                stack_gap[top] = gap2
                stack_a[top + 1] = a1
                stack_b[top + 1] = b1
                stack_gap[top + 1] = gap1
            top = top + 2
    if found_a >= 0:
        distance[i] = wp.sqrt(best)
        face_a[i] = wood.face[found_a]
        face_b[i] = wood.face[found_b]
    else:
        distance[i] = wp.sqrt(least)
        face_a[i] = -1
        face_b[i] = -1


@wp.func
def under_ray(wood: Wood, node: wp.int32, point: wp.vec3d, slack: wp.float64) -> wp.bool:
    """True if the ray from `point` may meet the box of a node."""
    low = wood.lower[node] - point
    high = wood.upper[node] - point
    if high[2] < wp.float64(0.0):
        return False
    # The ray rises by RAY[2] per unit: between the heights of the box it covers these stretches sideways.
    s0 = wp.max(low[2], wp.float64(0.0)) / RAY[2]
    s1 = high[2] / RAY[2]
    return (
        s1 * RAY[0] + slack >= low[0]
        and s0 * RAY[0] - slack <= high[0]
        and s1 * RAY[1] + slack >= low[1]
        and s0 * RAY[1] - slack <= high[1]
    )


@wp.func
def inside(wood: Wood, solid: wp.int32, point: wp.vec3d) -> wp.bool:
    """True if a point, away from the surface, lies inside a closed solid (in its frame)."""
    low = wood.lower[solid]
    high = wood.upper[solid]
    for k in range(3):
        if point[k] < low[k] or point[k] > high[k]:
            return False
    margin = GRAZE * wp.length(high - low)
    winding = wp.int32(0)
    doubtful = wood.volume[solid] < 2
    stack = wp.zeros(shape=STACK, dtype=wp.int32)
    stack[0] = solid
    top = wp.int32(1)
    while top > 0 and not doubtful:
        top = top - 1
        node = stack[top]
        if under_ray(wood, node, point, margin):
            span = wood.span[node]
            if span > 0:
                for m in range(span):
                    turn = ray_crossing(wood.corners[m - 1 - wood.link[node]], point, RAY, margin)
                    if turn == 2:
                        doubtful = True
                    else:
                        winding = winding + turn
            else:
                stack[top] = wood.link[node]
                stack[top + 1] = wood.link[node] + 1
                top = top + 2
    if not doubtful:
        return winding != 0
    total = wp.float64(0.0)
    for k in range(wood.first_face[solid], wood.first_face[solid + 1]):
        total = total + solid_angle(wood.corners[k], point)
    return wp.abs(total) > HALF_TURN


@wp.kernel
def contained(
    first: wp.int32,
    wood: Wood,
    solid_a: wp.array(dtype=wp.int32),
    solid_b: wp.array(dtype=wp.int32),
    rotation: wp.array(dtype=wp.mat33d),
    translation: wp.array(dtype=wp.vec3d),
    query: wp.array(dtype=wp.int32),
    held: wp.array(dtype=wp.int32),
):
    """For surfaces that do not meet: 1 where a component of one lies inside the other, else 0."""
    i = query[first + wp.tid()]
    a = solid_a[i]
    b = solid_b[i]
    answer = wp.int32(0)
    if wood.volume[b] > 0:
        for k in range(wood.first_head[a], wood.first_head[a + 1]):
            if answer == 0 and inside(wood, b, rotation[i] * wood.heads[k] + translation[i]):
                answer = 1
    if wood.volume[a] > 0:
        for k in range(wood.first_head[b], wood.first_head[b + 1]):
            if answer == 0 and inside(wood, a, (wood.heads[k] - translation[i]) * rotation[i]):
                answer = 1
    held[first + wp.tid()] = answer
