# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Cells and faces cut by solids: open shares by volume, from distances at half cells."""

import warp as wp

from ...grids.columns import vec6i
from .distance_kernels import FAR, REACH, vec8

wp.set_module_options({"enable_backward": False, "max_unroll": 3})

__all__ = ["close_thin", "cut_faces", "find_halves", "halves_of", "lattice", "tent_overlap", "value_at", "vec6"]

vec6 = wp.types.vector(length=6, dtype=wp.float32)
vec27 = wp.types.vector(length=27, dtype=wp.float32)
ALIKE = wp.constant(0.2)
"""Product of two cells' gradients below which a face between them crosses a wall."""


@wp.func
def corner_part(a: float, b: float, c: float, d: float):
    """Share of a tetrahedron on a's side of a linear cut that parts a from the others."""
    return (a / (a - b)) * (a / (a - c)) * (a / (a - d))


@wp.func
def wedge_part(a: float, b: float, c: float, d: float):
    """Share of a tetrahedron on the side of a and b of a linear cut that parts them from c and d."""
    ac = a / (a - c)
    ad = a / (a - d)
    bc = b / (b - c)
    bd = b / (b - d)
    return bc * bd + ac * ad * (1.0 - bd) + ac * bd * (1.0 - bc)


@wp.func
def open_part(a: float, b: float, c: float, d: float):
    """Share of a tetrahedron where the linear function with these corner values is positive."""
    mask = int(0)
    if a > 0.0:
        mask += 1
    if b > 0.0:
        mask += 2
    if c > 0.0:
        mask += 4
    if d > 0.0:
        mask += 8
    result = float(0.0)
    if mask == 15:
        result = 1.0
    elif mask == 1:
        result = corner_part(a, b, c, d)
    elif mask == 2:
        result = corner_part(b, a, c, d)
    elif mask == 4:
        result = corner_part(c, a, b, d)
    elif mask == 8:
        result = corner_part(d, a, b, c)
    elif mask == 14:
        result = 1.0 - corner_part(a, b, c, d)
    elif mask == 13:
        result = 1.0 - corner_part(b, a, c, d)
    elif mask == 11:
        result = 1.0 - corner_part(c, a, b, d)
    elif mask == 7:
        result = 1.0 - corner_part(d, a, b, c)
    elif mask == 3:
        result = wedge_part(a, b, c, d)
    elif mask == 5:
        result = wedge_part(a, c, b, d)
    elif mask == 9:
        result = wedge_part(a, d, b, c)
    elif mask == 6:
        result = wedge_part(b, c, a, d)
    elif mask == 10:
        result = wedge_part(b, d, a, c)
    elif mask == 12:
        result = wedge_part(c, d, a, b)
    return result


@wp.func
def box_part(a: float, b: float, c: float, d: float, e: float, f: float, g: float, h: float):
    """Open share of a box with distances a b / c d at the corners of its lower side and e f / g h above; six tetrahedra."""
    low = wp.min(wp.min(wp.min(a, b), wp.min(c, d)), wp.min(wp.min(e, f), wp.min(g, h)))
    high = wp.max(wp.max(wp.max(a, b), wp.max(c, d)), wp.max(wp.max(e, f), wp.max(g, h)))
    result = float(1.0)
    if high <= 0.0:
        result = 0.0
    elif low <= 0.0:
        result = (
            open_part(a, b, d, h) + open_part(a, b, f, h) + open_part(a, c, d, h)
            + open_part(a, c, g, h) + open_part(a, e, f, h) + open_part(a, e, g, h)
        ) / 6.0  # fmt: skip
    return result


@wp.func
def value_at(field: wp.array(dtype=float), c: int):
    """A corner's distance; far where the cell does not exist."""
    if c < 0:
        return float(FAR)
    return field[c]


@wp.func
def step_to(near: wp.array(dtype=vec6i), c: int, side: int):
    """The neighbour of a cell, -1 without."""
    if c < 0:
        return -1
    return near[c][side]


@wp.func
def tent_overlap(t: float):
    """Share of a tent of half width 1 at 0 that lies below t."""
    if t >= 1.0:
        return 1.0
    if t <= -1.0:
        return 0.0
    if t >= 0.0:
        return 1.0 - 0.5 * (1.0 - t) * (1.0 - t)
    return 0.5 * (1.0 + t) * (1.0 + t)


@wp.func
def tent_room(v: vec27):
    """Open share of a tent around a cell's centre, from the distances at its corners and half way between them.

    The tent is the sum of 27 tents of half its width around those points; of each, what a plane cuts off hardly depends on how it is
    turned.
    """
    total = float(0.0)
    for i in range(3):
        for j in range(3):
            for k in range(3):
                w = float(2 - wp.abs(i - 1)) * float(2 - wp.abs(j - 1)) * float(2 - wp.abs(k - 1))
                total += w * tent_overlap(2.0 * v[9 * i + 3 * j + k])
    return total / 64.0


@wp.func
def lattice(near: wp.array(dtype=vec6i), points: wp.array(dtype=vec8), c: int):
    """Distances at a cell's corners and half way between them."""
    own = points[c]
    v = vec27()
    x = near[c][1]
    y = near[c][3]
    xy = step_to(near, x, 3)
    for a in range(2):
        for b in range(2):
            base = c
            if a == 1 and b == 0:
                base = x
            if a == 0 and b == 1:
                base = y
            if a == 1 and b == 1:
                base = xy
            for d in range(2):
                n = base
                if d == 1:
                    n = step_to(near, base, 5)
                p = own
                if n >= 0:
                    p = points[n]
                for s in range(8):
                    i = 2 * a + s // 4
                    j = 2 * b + (s // 2) % 2
                    k = 2 * d + s % 2
                    if i < 3 and j < 3 and k < 3:
                        v[9 * i + 3 * j + k] = p[s]
    return v


@wp.func
def halves_of(v: vec27):
    """Open share of the lower and upper half of a cell along each axis."""
    h = vec6()
    for s in range(8):
        i = s // 4
        j = (s // 2) % 2
        k = s % 2
        n = 9 * i + 3 * j + k
        part = 0.25 * box_part(v[n], v[n + 9], v[n + 3], v[n + 12], v[n + 1], v[n + 10], v[n + 4], v[n + 13])
        h[i] = h[i] + part
        h[2 + j] = h[2 + j] + part
        h[4 + k] = h[4 + k] + part
    return h


@wp.kernel
def find_halves(
    first: wp.int32, near: wp.array(dtype=vec6i), points: wp.array(dtype=vec8), halves: wp.array(dtype=vec6),
    room: wp.array(dtype=float), spread: wp.array(dtype=float), solid: wp.array(dtype=float),
):  # fmt: skip
    """Open share of the lower and upper half of a cell along each axis, from its eight octants; distance at its centre.

    `room` and `spread` (weighted as density is) are reduced.
    """
    c = first + wp.tid()
    own = points[c]
    solid[c] = own[7]
    h = vec6()
    for s in range(6):
        h[s] = 1.0
        if own[7] < 0.0:
            h[s] = 0.0
    around = h[0]
    if wp.abs(own[7]) < REACH:
        v = lattice(near, points, c)
        around = tent_room(v)
        h = halves_of(v)
    halves[c] = h
    room[c] = room[c] * 0.5 * (h[0] + h[1])
    spread[c] = spread[c] * around


@wp.kernel
def cut_faces(
    first: wp.int32, near: wp.array(dtype=vec6i), owner: wp.array(dtype=wp.vec4i), halves: wp.array(dtype=vec6),
    opening: wp.array(dtype=wp.vec3), face_owner: wp.array(dtype=wp.vec3i),
):  # fmt: skip
    """Reduce open shares by solids; owner of each face's solid part.

    The share of a face is that of the box of one cell around its centre (Batty et al. 2007), so that pressure pushes a body as
    far out as its surface lies, not as the cells do.
    """
    c = first + wp.tid()
    h = halves[c]
    share = wp.vec3()
    who = wp.vec3i(-1, -1, -1)
    for axis in range(3):
        o = near[c][2 * axis]
        part = h[2 * axis]
        if o >= 0:
            part = 0.5 * (part + halves[o][2 * axis + 1])
        share[axis] = part
        if part < 1.0:
            who[axis] = owner[c][1 + axis]
    opening[c] = wp.cw_mul(opening[c], share)
    face_owner[c] = who


@wp.func
def rise(near: wp.array(dtype=vec6i), solid: wp.array(dtype=float), c: int):
    """Gradient of the distance to solids at a cell's centre, by central differences."""
    g = wp.vec3()
    for axis in range(3):
        low = near[c][2 * axis]
        high = near[c][2 * axis + 1]
        if low >= 0 and high >= 0:
            g[axis] = 0.5 * (solid[high] - solid[low])
    return g


@wp.kernel
def close_thin(
    first: wp.int32, near: wp.array(dtype=vec6i), solid: wp.array(dtype=float), opening: wp.array(dtype=wp.vec3),
    thin: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Faces across a thin wall are closed: the nearest surfaces of their two cells do not look the same way.

    `thin` holds their share that was open, half a cell of liquid before a wall that lies on the face.
    """
    c = first + wp.tid()
    share = opening[c]
    mark = wp.vec3()
    for axis in range(3):
        o = near[c][2 * axis]
        if o >= 0 and share[axis] < 1.0:
            if solid[c] < 0.0 or solid[o] < 0.0:
                if wp.dot(rise(near, solid, c), rise(near, solid, o)) < ALIKE:
                    mark[axis] = share[axis]
                    share[axis] = 0.0
    opening[c] = share
    thin[c] = mark
