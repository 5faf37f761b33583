# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""A box of cells, the velocities of their faces, and where these take a position.

All fields have (nx + 1)(ny + 1)(nz + 1) elements. Element (i, j, k) of a velocity holds the three lower faces of that cell, so that
the last layers hold the upper faces of the box; elements beyond the cells of a scalar are not used. Positions are in cells.
"""

from typing import Any

import warp as wp

from ..grids.columns import vec6i

wp.set_module_options({"enable_backward": False})

__all__ = ["Box", "beside", "index_of", "is_cell", "near", "place_of", "row_at", "run_of", "sample"]

vec8 = wp.types.vector(length=8, dtype=wp.float32)


@wp.struct
class Box:
    """Cells along each axis, whether it is periodic, which sides are open, and the velocity of the air beyond the faces of all sides: those
    of an axis begin at `starts`, first the lower side's, the third axis after this one running fastest."""

    nx: wp.int32
    ny: wp.int32
    nz: wp.int32
    wraps: wp.vec3i
    opens: vec6i
    starts: wp.vec3i
    beyond: wp.array(dtype=wp.vec3)
    density: float
    """Density of the ambient air [kg/m^3] where its gas may burn, so that no cell's air falls below nothing; 0 elsewhere."""


@wp.func
def index_of(box: Box, i: wp.int32, j: wp.int32, k: wp.int32):
    """Index of an element."""
    return (i * (box.ny + 1) + j) * (box.nz + 1) + k


@wp.func
def place_of(box: Box, c: wp.int32):
    """Indices (i, j, k) of an element."""
    layer = (box.ny + 1) * (box.nz + 1)
    i = c // layer
    rest = c - i * layer
    j = rest // (box.nz + 1)
    return wp.vec3i(i, j, rest - j * (box.nz + 1))


@wp.func
def count_of(box: Box, axis: wp.int32):
    """Cells along an axis."""
    n = box.nx
    if axis == 1:
        n = box.ny
    if axis == 2:
        n = box.nz
    return n


@wp.func
def is_cell(box: Box, at: wp.vec3i):
    """True for a cell of the box, false for an element that only holds upper faces."""
    return at[0] < box.nx and at[1] < box.ny and at[2] < box.nz


@wp.func
def has_face(box: Box, at: wp.vec3i, axis: wp.int32):
    """True where an element's lower face along the axis exists and is not the periodic copy of another."""
    found = int(1)
    for a in range(3):
        n = count_of(box, a)
        last = n - 1
        if a == axis and box.wraps[a] == 0:
            last = n
        if at[a] > last:
            found = 0
    return found == 1


@wp.func
def beside(box: Box, at: wp.vec3i, axis: wp.int32, step: wp.int32):
    """Element some steps beside a cell along an axis; -1 beyond the box."""
    n = count_of(box, axis)
    x = at[axis] + step
    if box.wraps[axis] == 1:
        x = (x + n) % n
    found = int(-1)
    if x >= 0 and x < n:
        to = at
        to[axis] = x
        found = index_of(box, to[0], to[1], to[2])
    return found


@wp.func
def upper(box: Box, at: wp.vec3i, axis: wp.int32):
    """Element that holds the upper face of a cell."""
    to = at
    to[axis] = at[axis] + 1
    if box.wraps[axis] == 1 and to[axis] == count_of(box, axis):
        to[axis] = 0
    return index_of(box, to[0], to[1], to[2])


@wp.func
def run_of(box: Box, span: int, t: int):
    """The run of cells of a thread: row along x, row along y, first cell, end."""
    many = box.nz + 1
    row = t
    lo = int(0)
    if span < many:
        pieces = (many + span - 1) // span
        row = t // pieces
        lo = (t - row * pieces) * span
    i = row // (box.ny + 1)
    return wp.vec4i(i, row - i * (box.ny + 1), lo, wp.where(lo + span < many, lo + span, many))


@wp.func
def near(n: int, wraps: int, x: int):
    """Index of a cell along an axis of n: repeated, or that of the elements that are no cells."""
    y = x
    if wraps == 1:
        y = (x + 2 * n) % n
    elif x < 0 or x > n:
        y = n
    return y


@wp.func
def row_at(box: Box, axis: int, i: int, j: int, step: int):
    """First element of the row some steps beside another along x or y."""
    a = i
    b = j
    if axis == 0:
        a = near(box.nx, box.wraps[0], i + step)
    else:
        b = near(box.ny, box.wraps[1], j + step)
    return index_of(box, a, b, 0)


@wp.func
def along(box: Box, axis: wp.int32, own: wp.int32, x: wp.int32):
    """Index along an axis of a component's samples: clamped to the box, or repeated."""
    n = count_of(box, axis)
    last = n - 1
    if own == 1:
        last = n
    y = wp.clamp(x, 0, last)
    if box.wraps[axis] == 1:
        y = (x + n) % n
    return y


@wp.func
def corners(box: Box, axis: wp.int32, x: wp.vec3):
    """Lowest of the eight samples of a component around a position, and where the position is between them."""
    y = x - wp.vec3(0.5, 0.5, 0.5)
    y[axis] = x[axis]
    return y


@wp.func
def part_of(field: wp.array(dtype=wp.vec3), c: wp.int32, axis: wp.int32):
    """One component of a sample."""
    return field[c][axis]


@wp.func
def part_of(field: wp.array2d(dtype=float), c: wp.int32, axis: wp.int32):  # noqa: F811
    """One component of a sample, of a field that is held in planes."""
    return field[axis, c]


@wp.func
def lies_within(box: Box, i: wp.int32, j: wp.int32, k: wp.int32):
    """True where the eight samples from (i, j, k) on are all in the box, for every component."""
    return i >= 0 and j >= 0 and k >= 0 and i + 1 < box.nx and j + 1 < box.ny and k + 1 < box.nz


@wp.func
def mixed(lower: float, higher: float, share: float):
    """Value between two."""
    return lower + share * (higher - lower)


@wp.func
def eight(box: Box, field: Any, axis: wp.int32, i: wp.int32, j: wp.int32, k: wp.int32):
    """One component of the eight samples from (i, j, k) on, which are held in the box or repeated."""
    a = along(box, 0, int(axis == 0), i)
    b = along(box, 0, int(axis == 0), i + 1)
    d = along(box, 1, int(axis == 1), j)
    e = along(box, 1, int(axis == 1), j + 1)
    m = along(box, 2, int(axis == 2), k)
    n = along(box, 2, int(axis == 2), k + 1)
    ad = index_of(box, a, d, 0)
    ae = index_of(box, a, e, 0)
    bd = index_of(box, b, d, 0)
    be = index_of(box, b, e, 0)
    return vec8(
        part_of(field, ad + m, axis), part_of(field, ad + n, axis), part_of(field, ae + m, axis), part_of(field, ae + n, axis),
        part_of(field, bd + m, axis), part_of(field, bd + n, axis), part_of(field, be + m, axis), part_of(field, be + n, axis),
    )  # fmt: skip


@wp.func
def blended(v: vec8, f: wp.vec3):
    """Value between eight samples."""
    first = mixed(mixed(v[0], v[1], f[2]), mixed(v[2], v[3], f[2]), f[1])
    second = mixed(mixed(v[4], v[5], f[2]), mixed(v[6], v[7], f[2]), f[1])
    return mixed(first, second, f[0])


@wp.func
def around(box: Box, field: Any, axis: wp.int32, x: wp.vec3):
    """One component at a position [cells], trilinear, and the least and the greatest of its eight samples."""
    y = corners(box, axis, x)
    i = int(wp.floor(y[0]))
    j = int(wp.floor(y[1]))
    k = int(wp.floor(y[2]))
    v = eight(box, field, axis, i, j, k)
    low = wp.min(wp.min(wp.min(v[0], v[1]), wp.min(v[2], v[3])), wp.min(wp.min(v[4], v[5]), wp.min(v[6], v[7])))
    high = wp.max(wp.max(wp.max(v[0], v[1]), wp.max(v[2], v[3])), wp.max(wp.max(v[4], v[5]), wp.max(v[6], v[7])))
    return wp.vec3(blended(v, wp.vec3(y[0] - float(i), y[1] - float(j), y[2] - float(k))), low, high)


@wp.func
def between(field: Any, axis: wp.int32, c: wp.int32, row: wp.int32, layer: wp.int32, f: wp.vec3):
    """One component between the eight samples from an element on, all within the box."""
    a = mixed(part_of(field, c, axis), part_of(field, c + 1, axis), f[2])
    b = mixed(part_of(field, c + row, axis), part_of(field, c + row + 1, axis), f[2])
    d = c + layer
    e = mixed(part_of(field, d, axis), part_of(field, d + 1, axis), f[2])
    g = mixed(part_of(field, d + row, axis), part_of(field, d + row + 1, axis), f[2])
    return mixed(mixed(a, b, f[1]), mixed(e, g, f[1]), f[0])


@wp.func
def sample(box: Box, field: Any, axis: wp.int32, x: wp.vec3):
    """One component at a position [cells], trilinear."""
    y = corners(box, axis, x)
    i = int(wp.floor(y[0]))
    j = int(wp.floor(y[1]))
    k = int(wp.floor(y[2]))
    return blended(eight(box, field, axis, i, j, k), wp.vec3(y[0] - float(i), y[1] - float(j), y[2] - float(k)))


@wp.func
def speed(box: Box, carrier: Any, x: wp.vec3):
    """Velocity at a position."""
    i = int(wp.floor(x[0]))
    j = int(wp.floor(x[1]))
    k = int(wp.floor(x[2]))
    h = x - wp.vec3(0.5, 0.5, 0.5)
    a = int(wp.floor(h[0]))
    b = int(wp.floor(h[1]))
    c = int(wp.floor(h[2]))
    v = wp.vec3(0.0, 0.0, 0.0)
    if a >= 0 and b >= 0 and c >= 0 and lies_within(box, i, j, k):
        row = box.nz + 1
        layer = (box.ny + 1) * row
        fi = x[0] - float(i)
        fj = x[1] - float(j)
        fk = x[2] - float(k)
        fa = h[0] - float(a)
        fb = h[1] - float(b)
        fc = h[2] - float(c)
        v = wp.vec3(
            between(carrier, 0, index_of(box, i, b, c), row, layer, wp.vec3(fi, fb, fc)),
            between(carrier, 1, index_of(box, a, j, c), row, layer, wp.vec3(fa, fj, fc)),
            between(carrier, 2, index_of(box, a, b, k), row, layer, wp.vec3(fa, fb, fk)),
        )
    else:
        v = wp.vec3(sample(box, carrier, 0, x), sample(box, carrier, 1, x), sample(box, carrier, 2, x))
    return v


@wp.func
def held(box: Box, x: wp.vec3):
    """A position, moved back into the box along axes that are not periodic, and by whole boxes along those that are."""
    y = x
    for a in range(3):
        n = float(count_of(box, a))
        if box.wraps[a] == 1:
            y[a] = x[a] - n * wp.floor(x[a] / n)
        else:
            y[a] = wp.clamp(x[a], 0.0, n)
    return y


@wp.func
def face_speed(box: Box, carrier: Any, c: wp.int32, at: wp.vec3i, axis: wp.int32):
    """Velocity at the centre of an element's lower face: its own, and the means of the four faces around it along other axes."""
    v = wp.vec3(0.0, 0.0, 0.0)
    v[axis] = part_of(carrier, c, axis)
    for a in range(3):
        if a != axis:
            to = at
            to[a] = at[a] + 1
            back = at
            back[axis] = at[axis] - 1
            both = to
            both[axis] = at[axis] - 1
            v[a] = 0.25 * (
                part_of(carrier, c, a)
                + part_of(carrier, index_of(box, to[0], to[1], to[2]), a)
                + part_of(carrier, index_of(box, back[0], back[1], back[2]), a)
                + part_of(carrier, index_of(box, both[0], both[1], both[2]), a)
            )
    return v


@wp.func
def traced(box: Box, carrier: Any, x: wp.vec3, start: wp.vec3, cells: float):
    """Where the flow takes a position within a time that is given as cells per speed, in the box or not; midpoint rule.
    `start` is the velocity there."""
    middle = held(box, x + 0.5 * cells * start)
    return x + cells * speed(box, carrier, middle)


@wp.func
def comes_in(box: Box, x: wp.vec3):
    """True for a position beyond an open side: what comes from there is air that moves with the wind, whatever flows at the side.

    Without that, inflow would bring ever more energy in, since the pressure is held at open sides.
    """
    found = int(0)
    for a in range(3):
        if box.wraps[a] == 0:
            if x[a] < 0.0 and box.opens[2 * a] == 1:
                found = 1
            if x[a] > float(count_of(box, a)) and box.opens[2 * a + 1] == 1:
                found = 1
    return found == 1


@wp.func
def face_place(at: wp.vec3i, axis: wp.int32):
    """Centre of the lower face of a cell along an axis [cells]."""
    x = wp.vec3(float(at[0]) + 0.5, float(at[1]) + 0.5, float(at[2]) + 0.5)
    x[axis] = float(at[axis])
    return x


@wp.func
def air_beyond(box: Box, axis: wp.int32, side: wp.int32, x: wp.vec3):
    """Velocity of the air beyond a side (0 the lower, 1 the upper one of an axis), at the face nearest to a position."""
    second = (axis + 1) % 3
    third = (axis + 2) % 3
    across = count_of(box, third)
    i = wp.clamp(int(wp.floor(x[second])), 0, count_of(box, second) - 1)
    j = wp.clamp(int(wp.floor(x[third])), 0, across - 1)
    return box.beyond[box.starts[axis] + (side * count_of(box, second) + i) * across + j]


@wp.func
def incoming(box: Box, x: wp.vec3):
    """Velocity of the air beyond the open side that a position lies behind."""
    v = wp.vec3(0.0, 0.0, 0.0)
    for a in range(3):
        if box.wraps[a] == 0:
            if x[a] < 0.0 and box.opens[2 * a] == 1:
                v = air_beyond(box, a, 0, x)
            if x[a] > float(count_of(box, a)) and box.opens[2 * a + 1] == 1:
                v = air_beyond(box, a, 1, x)
    return v


@wp.func
def blown_in(box: Box, at: wp.vec3i, axis: wp.int32):
    """Speed of wind into the box through a face of an open side; 0 where none blows in."""
    speed = float(0.0)
    if box.wraps[axis] == 0:
        if at[axis] == 0 and box.opens[2 * axis] == 1:
            speed = wp.max(air_beyond(box, axis, 0, face_place(at, axis))[axis], 0.0)
        if at[axis] == count_of(box, axis) and box.opens[2 * axis + 1] == 1:
            speed = wp.min(air_beyond(box, axis, 1, face_place(at, axis))[axis], 0.0)
    return speed


@wp.func
def start_speed(box: Box, carrier: Any, c: wp.int32, at: wp.vec3i, axis: wp.int32):
    """Velocity at the centre of an element's lower face, also beside the sides of the box."""
    v = wp.vec3(0.0, 0.0, 0.0)
    if lies_within(box, at[0] - 1, at[1] - 1, at[2] - 1) and lies_within(box, at[0], at[1], at[2]):
        v = face_speed(box, carrier, c, at, axis)
    else:
        v = speed(box, carrier, face_place(at, axis))
    return v
