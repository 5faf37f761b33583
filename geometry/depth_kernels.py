# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Warp kernel of batched overlap depth: the deepest surface point of one body inside the other, both ways.

The same quantity as `depth.surface_depth`, by branch and bound over pieces of triangles. Import only where warp is used.
"""

import warp as wp

from .clearance_kernels import STACK, Wood, inside, moved, outside
from .triangle_kernels import corner, over

wp.set_module_options({"enable_backward": False})

__all__ = ["deepest"]

PIECES = 64
"""Entries of the stack of pieces: three are left behind per halving."""
PATIENCE = wp.constant(30_000)
"""Own choice: pieces after which a query is handed back, about 0.1 s of work."""
DOUBT = wp.constant(10_000)
"""Own choice: pieces after which a query without any depth so far is handed back: the surfaces may only touch."""
ZERO = wp.constant(wp.float64(0.0))


@wp.struct
class Foot:
    """Nearest place of a surface."""

    square: wp.float64
    face: wp.int32


@wp.func
def to_triangle(point: wp.vec3d, t: wp.mat33d) -> wp.float64:
    """Squared distance of a point to a triangle."""
    a = corner(t, 0)
    normal = wp.cross(corner(t, 1) - a, corner(t, 2) - a)
    if over(t, normal, point):
        height = wp.dot(point - a, normal)
        return height * height / wp.dot(normal, normal)
    best = wp.float64(1e300)
    for k in range(3):
        p = corner(t, k)
        u = corner(t, (k + 1) % 3) - p
        s = wp.clamp(wp.dot(point - p, u) / wp.dot(u, u), ZERO, wp.float64(1.0))
        best = wp.min(best, wp.length_sq(point - p - s * u))
    return best


@wp.func
def to_box(wood: Wood, node: wp.int32, point: wp.vec3d) -> wp.float64:
    """Squared distance of a point to the box of a node."""
    half = wp.float64(0.5) * (wood.upper[node] - wood.lower[node])
    return outside(point - wood.lower[node] - half, half)


@wp.func
def foot(wood: Wood, solid: wp.int32, point: wp.vec3d, enough: wp.float64) -> Foot:
    """Nearest triangle of a solid; any triangle within `enough` (squared) ends the search."""
    best = Foot()
    best.square = wp.float64(1e300)
    best.face = -1
    stack = wp.zeros(shape=STACK, dtype=wp.int32)
    gaps = wp.zeros(shape=STACK, dtype=wp.float64)
    stack[0] = solid
    gaps[0] = to_box(wood, solid, point)
    top = wp.int32(1)
    while top > 0:
        top = top - 1
        if gaps[top] >= best.square:
            continue
        node = stack[top]
        span = wood.span[node]
        if span > 0:
            for m in range(span):
                place = m - 1 - wood.link[node]
                gap = to_triangle(point, wood.corners[place])
                if gap < best.square:
                    best.square = gap
                    best.face = place
            if best.square <= enough:
                top = 0
        else:
            one = wood.link[node]
            gap1 = to_box(wood, one, point)
            gap2 = to_box(wood, one + 1, point)
            if gap2 <= gap1:
                stack[top] = one
                gaps[top] = gap1
                stack[top + 1] = one + 1
                gaps[top + 1] = gap2
            else:
                stack[top] = one + 1
                gaps[top] = gap2
                stack[top + 1] = one
                gaps[top + 1] = gap1
            top = top + 2
    return best


@wp.func
def misses(wood: Wood, solid: wp.int32, t: wp.mat33d) -> wp.bool:
    """True if the box of a triangle misses that of a solid."""
    for k in range(3):
        if wp.min(wp.min(t[0, k], t[1, k]), t[2, k]) > wood.upper[solid][k]:
            return True
        if wp.max(wp.max(t[0, k], t[1, k]), t[2, k]) < wood.lower[solid][k]:
            return True
    return False


@wp.func
def square_above(value: wp.float64) -> wp.float64:
    """The square of a positive number, -1 of another."""
    if value <= ZERO:
        return wp.float64(-1.0)
    return value * value


@wp.func
def deepest_corner(
    wood: Wood, surface: wp.int32, solid: wp.int32, turn: wp.mat33d, shift: wp.vec3d, known: wp.float64
) -> wp.float64:
    """Greatest depth of a vertex of a surface inside a solid where it is more than `known`, else `known`."""
    best = known
    for k in range(wood.first_face[surface], wood.first_face[surface + 1]):
        t = moved(wood.corners[k], turn, shift)
        if not misses(wood, solid, t):
            for m in range(3):
                far = foot(wood, solid, corner(t, m), best * best)
                if far.square > best * best and inside(wood, solid, corner(t, m)):
                    best = wp.sqrt(far.square)
    return best


@wp.func
def one_way(
    wood: Wood,
    surface: wp.int32,
    solid: wp.int32,
    turn: wp.mat33d,
    shift: wp.vec3d,
    known: wp.float64,
    noise: wp.float64,
    tolerance: wp.float64,
    precision: wp.float64,
    enough: wp.float64,
) -> wp.float64:
    """Depth of a surface inside a solid where it is more than `known`, else `known`; -1 where patience ended, and any depth from `enough` on."""
    best = deepest_corner(wood, surface, solid, turn, shift, known)
    pieces = wp.int32(0)
    stack = wp.zeros(shape=PIECES, dtype=wp.mat33d)
    for k in range(wood.first_face[surface], wood.first_face[surface + 1]):
        t = moved(wood.corners[k], turn, shift)
        if misses(wood, solid, t):
            continue
        stack[0] = t
        top = wp.int32(1)
        while top > 0:
            if best >= enough:
                return best
            top = top - 1
            piece = stack[top]
            pieces = pieces + 1
            if pieces > PATIENCE or (pieces > DOUBT and best <= wp.max(noise, known)) or top + 4 > PIECES:
                return wp.float64(-1.0)
            a = corner(piece, 0)
            b = corner(piece, 1)
            c = corner(piece, 2)
            middle = (a + b + c) / wp.float64(3.0)
            reach = wp.sqrt(wp.max(wp.max(wp.length_sq(a - middle), wp.length_sq(b - middle)), wp.length_sq(c - middle)))
            goal = best * (wp.float64(1.0) + precision) + wp.max(noise, tolerance)
            # Depth changes no faster than one moves: a middle that is shallow enough settles the piece.
            shallow = square_above(goal - reach)
            far = foot(wood, solid, middle, shallow)
            if far.square > shallow:
                depth = wp.sqrt(far.square)
                settled = wp.bool(False)
                if inside(wood, solid, middle):
                    if depth > best:
                        best = depth
                        goal = best * (wp.float64(1.0) + precision) + wp.max(noise, tolerance)
                elif reach - depth <= goal:
                    settled = wp.bool(True)
                if not settled:
                    # The distance to one triangle is convex: its corners bound it over the piece.
                    near = wood.corners[far.face]
                    bound = wp.max(wp.max(to_triangle(a, near), to_triangle(b, near)), to_triangle(c, near))
                    if bound > goal * goal:
                        ab = wp.float64(0.5) * (a + b)
                        bc = wp.float64(0.5) * (b + c)
                        ca = wp.float64(0.5) * (c + a)
                        stack[top] = wp.matrix_from_rows(a, ab, ca)
                        stack[top + 1] = wp.matrix_from_rows(b, bc, ab)
                        stack[top + 2] = wp.matrix_from_rows(c, ca, bc)
                        stack[top + 3] = wp.matrix_from_rows(ab, bc, ca)
                        top = top + 4
    return best


@wp.kernel
def deepest(
    first: wp.int32,
    wood: Wood,
    solid_a: wp.array(dtype=wp.int32),
    solid_b: wp.array(dtype=wp.int32),
    rotation: wp.array(dtype=wp.mat33d),
    translation: wp.array(dtype=wp.vec3d),
    noise: wp.array(dtype=wp.float64),
    tolerance: wp.float64,
    precision: wp.float64,
    enough: wp.array(dtype=wp.float64),
    idle: wp.array(dtype=wp.float64),
    query: wp.array(dtype=wp.int32),
    depth: wp.array(dtype=wp.float64),
):
    """Depth of two bodies that touch or overlap [m]; -1 where it is not above `noise` or patience ended, -2 where it is not above `idle`.

    Depths up to `idle` are of no interest, and so no piece is halved for them.
    """
    i = query[first + wp.tid()]
    a = solid_a[i]
    b = solid_b[i]
    turn = rotation[i]
    shift = translation[i]
    best = ZERO
    if idle[i] > noise[i]:
        best = idle[i]
    if wood.volume[b] > 0:
        best = one_way(wood, a, b, turn, shift, best, noise[i], tolerance, precision, enough[i])
    if best >= ZERO and best < enough[i] and wood.volume[a] > 0:
        back = wp.transpose(turn)
        best = one_way(wood, b, a, back, -(back * shift), best, noise[i], tolerance, precision, enough[i])
    if best >= ZERO and idle[i] > noise[i] and best <= idle[i]:
        best = wp.float64(-2.0)
    elif best <= noise[i]:
        best = wp.float64(-1.0)
    depth[first + wp.tid()] = best
