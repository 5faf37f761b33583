# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""A box of cells and the velocities of their faces, and how these are carried by themselves (MacCormack, Selle et al. 2008,
doi:10.1007/s10915-007-9166-4).

All fields have (nx + 1)(ny + 1)(nz + 1) elements. Element (i, j, k) of a velocity holds the three lower faces of that cell, so that
the last layers hold the upper faces of the box; elements beyond the cells of a scalar are not used. Positions are in cells.
"""

import warp as wp

from ..grids.columns import vec6i

wp.set_module_options({"enable_backward": False})

__all__ = ["Box", "beside", "carry", "correct", "extrapolate", "fastest", "index_of", "is_cell", "place_of", "sample"]


@wp.struct
class Box:
    """Cells along each axis, whether it is periodic, which sides are open, and the velocity of the air beyond them."""

    nx: wp.int32
    ny: wp.int32
    nz: wp.int32
    wraps: wp.vec3i
    opens: vec6i
    wind: wp.vec3


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
def value_at(box: Box, field: wp.array(dtype=wp.vec3), axis: wp.int32, i: wp.int32, j: wp.int32, k: wp.int32):
    """One component of a sample, which is held in the box or repeated."""
    c = index_of(box, along(box, 0, int(axis == 0), i), along(box, 1, int(axis == 1), j), along(box, 2, int(axis == 2), k))
    return field[c][axis]


@wp.func
def sample(box: Box, field: wp.array(dtype=wp.vec3), axis: wp.int32, x: wp.vec3):
    """One component at a position [cells], trilinear."""
    y = corners(box, axis, x)
    i0 = int(wp.floor(y[0]))
    j0 = int(wp.floor(y[1]))
    k0 = int(wp.floor(y[2]))
    f = wp.vec3(y[0] - float(i0), y[1] - float(j0), y[2] - float(k0))
    total = float(0.0)
    for s in range(8):
        a = s // 4
        b = (s // 2) % 2
        c = s % 2
        wx = f[0]
        wy = f[1]
        wz = f[2]
        if a == 0:
            wx = 1.0 - wx
        if b == 0:
            wy = 1.0 - wy
        if c == 0:
            wz = 1.0 - wz
        total += wx * wy * wz * value_at(box, field, axis, i0 + a, j0 + b, k0 + c)
    return total


@wp.func
def bounds(box: Box, field: wp.array(dtype=wp.vec3), axis: wp.int32, x: wp.vec3):
    """Least and greatest of the eight samples around a position."""
    y = corners(box, axis, x)
    i0 = int(wp.floor(y[0]))
    j0 = int(wp.floor(y[1]))
    k0 = int(wp.floor(y[2]))
    low = float(1.0e30)
    high = float(-1.0e30)
    for s in range(8):
        v = value_at(box, field, axis, i0 + s // 4, j0 + (s // 2) % 2, k0 + s % 2)
        low = wp.min(low, v)
        high = wp.max(high, v)
    return wp.vec2(low, high)


@wp.func
def speed(box: Box, carrier: wp.array(dtype=wp.vec3), x: wp.vec3):
    """Velocity at a position."""
    return wp.vec3(sample(box, carrier, 0, x), sample(box, carrier, 1, x), sample(box, carrier, 2, x))


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
def traced(box: Box, carrier: wp.array(dtype=wp.vec3), x: wp.vec3, cells: float):
    """Where the flow takes a position within a time that is given as cells per speed, in the box or not; midpoint rule."""
    middle = held(box, x + 0.5 * cells * speed(box, carrier, x))
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


@wp.kernel
def extrapolate(
    first: wp.int32, ratio: float, now: wp.array(dtype=wp.vec3), before: wp.array(dtype=wp.vec3), out: wp.array(dtype=wp.vec3)
):
    """Velocity half a step ahead: now + ratio (now - before)."""
    c = first + wp.tid()
    out[c] = now[c] + ratio * (now[c] - before[c])


@wp.kernel
def carry(
    first: wp.int32, box: Box, cells: float, carrier: wp.array(dtype=wp.vec3), source: wp.array(dtype=wp.vec3),
    out: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Every face takes the value from where the flow comes; `cells` is time over cell size, negative to look ahead."""
    c = first + wp.tid()
    at = place_of(box, c)
    v = wp.vec3(0.0, 0.0, 0.0)
    for axis in range(3):
        if has_face(box, at, axis):
            foot = traced(box, carrier, face_place(at, axis), -cells)
            if comes_in(box, foot):
                v[axis] = box.wind[axis]
            else:
                v[axis] = sample(box, source, axis, held(box, foot))
    out[c] = v


@wp.kernel
def correct(
    first: wp.int32, box: Box, cells: float, carrier: wp.array(dtype=wp.vec3), source: wp.array(dtype=wp.vec3),
    once: wp.array(dtype=wp.vec3), out: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """The second half of MacCormack: what the way there and back changes is taken out by half, within the values that were carried."""
    c = first + wp.tid()
    at = place_of(box, c)
    v = wp.vec3(0.0, 0.0, 0.0)
    for axis in range(3):
        if has_face(box, at, axis):
            x = face_place(at, axis)
            foot = traced(box, carrier, x, -cells)
            ahead = traced(box, carrier, x, cells)
            v[axis] = once[c][axis]
            if not comes_in(box, foot) and not comes_in(box, ahead):
                back = sample(box, once, axis, held(box, ahead))
                range_ = bounds(box, source, axis, held(box, foot))
                v[axis] = wp.clamp(v[axis] + 0.5 * (source[c][axis] - back), range_[0], range_[1])
    out[c] = v


@wp.kernel
def fastest(first: wp.int32, total: int, block: int, field: wp.array(dtype=wp.vec3), out: wp.array(dtype=wp.float64)):
    """Largest component of blocks of elements."""
    b = first + wp.tid()
    top = float(0.0)
    for c in range(b * block, wp.min((b + 1) * block, total)):
        v = field[c]
        top = wp.max(top, wp.max(wp.abs(v[0]), wp.max(wp.abs(v[1]), wp.abs(v[2]))))
    out[b] = wp.float64(top)
