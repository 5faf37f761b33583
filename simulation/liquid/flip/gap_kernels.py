# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Gaps thinner than a cell between a body that moves freely and what it lies on: found, opened, and shared out.

Two cells share a face along the gap, each with its centre in another solid (or beyond a closed side of the domain): no cell's centre is
in the gap, and no particle need be. Both carry pressure, and what is closed of the face between them belongs to both solids.
Lengths are in cells. Owners are rows of boundaries; -1 is the domain.
"""

import warp as wp

from ...grids.columns import Columns, place_of, vec6i
from .cut_kernels import halves_of, lattice, vec6
from .distance_kernels import REACH, vec8
from .solid_kernels import LEAST

wp.set_module_options({"enable_backward": False, "max_unroll": 3})

__all__ = ["NARROW", "Near", "cut_fixed", "find_gaps", "list_gaps", "open_gaps", "split_faces"]

LEAST_GAP = wp.constant(0.1)
"""Least open share of faces of gaps: what touches counts as wetted."""
OVERLAP = wp.constant(0.25)
"""Depth to which two solids may lie in each other and still count as touching."""
DEEPER = wp.constant(0.1)
"""By how much a solid is deeper half a cell away from its gap: a wall's edge, which the gap does not face, is not."""
NARROW = wp.constant(64)
"""Mark of a cell whose centre is in a gap; of others, bits 0 to 5 tell sides at a gap, 8 to 13 those that lead deeper into a solid."""
THIN = wp.constant(1 << 14)
"""Mark of a cell in a solid whose other side is nearer than its gap: what lies there is cut off."""


@wp.func
def beyond(x: wp.vec3, lower: wp.vec3, upper: wp.vec3):
    """Distance of a place to the domain's closed sides, negative outside."""
    d = float(1.0e6)
    for a in range(3):
        d = wp.min(d, wp.min(x[a] - lower[a], upper[a] - x[a]))
    return d


@wp.func
def middle(at: wp.vec3i):
    """Centre of a cell."""
    return wp.vec3(float(at[0]) + 0.5, float(at[1]) + 0.5, float(at[2]) + 0.5)


@wp.func
def face_point(axis: int):
    """Number of the centre of a cell's lower face among its eight points."""
    s = int(3)
    if axis == 1:
        s = 5
    if axis == 2:
        s = 6
    return s


@wp.struct
class Near:
    """Distances to solids and whose they are, at the points of each cell (`distance_kernels.corner_distances`)."""

    grid: Columns
    near: wp.array(dtype=vec6i)
    points: wp.array(dtype=vec8)
    fixed: wp.array(dtype=vec8)
    fixed_owner: wp.array(dtype=wp.vec4i)
    mover: wp.array(dtype=wp.vec4i)
    lower: wp.vec3
    upper: wp.vec3


@wp.func
def depth_at(at: Near, c: int):
    """Distance of a cell's centre to solids and closed sides, negative inside."""
    return wp.min(at.points[c][7], beyond(middle(place_of(at.grid, c)), at.lower, at.upper))


@wp.func
def who_inside(at: Near, c: int, side: int):
    """Owner of the solid that a cell's centre lies in, -2 if in none; half a cell away from `side`, 1 if that is deeper, -1 if less deep."""
    axis = side // 2
    x = middle(place_of(at.grid, c))
    out = beyond(x, at.lower, at.upper)
    p = at.points[c][7]
    d = wp.min(p, out)
    f = int(c)
    y = x
    if side % 2 == 0:
        f = at.near[c][2 * axis + 1]
        y[axis] = y[axis] + 0.5
    else:
        y[axis] = y[axis] - 0.5
    who = int(-2)
    deep = int(0)
    if d < 0.0 and f >= 0:
        if out < p:
            who = -1
        elif p < at.fixed[c][7]:
            who = at.mover[f][1 + axis]
        else:
            who = at.fixed_owner[f][1 + axis]
        far = wp.min(at.points[f][face_point(axis)], beyond(y, at.lower, at.upper))
        if far < d - DEEPER:
            deep = 1
        if far > d + DEEPER:
            deep = -1
    return wp.vec2i(who, deep)


@wp.func
def is_free(free: wp.array(dtype=wp.int32), who: int):
    """1 for a body that moves freely."""
    f = int(0)
    if who >= 0:
        f = free[who]
    return f


@wp.kernel
def find_gaps(
    first: wp.int32, at: Near, free: wp.array(dtype=wp.int32), opening: wp.array(dtype=wp.vec3), thin: wp.array(dtype=wp.vec3),
    gap: wp.array(dtype=wp.int32), held: wp.array(dtype=wp.int32), width: wp.array(dtype=float), flag: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Marks of cells at gaps: sides at which one is, or NARROW; who holds a cell's centre, -2 for nobody; width of the gap."""
    c = first + wp.tid()
    mark = int(0)
    wide = float(0.0)
    mine = int(-2)
    d = depth_at(at, c)
    if d < 0.0:
        if d > -1.0 - OVERLAP:
            for side in range(6):
                o = at.near[c][side]
                if o >= 0:
                    other = depth_at(at, o)
                    if other < 0.0 and 1.0 + d + other > -OVERLAP:
                        opposite = side + 1 - 2 * (side % 2)
                        a = who_inside(at, c, side)
                        b = who_inside(at, o, opposite)
                        if a[0] >= -1 and b[0] >= -1 and a[0] != b[0]:
                            if is_free(free, a[0]) + is_free(free, b[0]) > 0:
                                mark = mark | (1 << side)
                                mine = a[0]
                                face = int(c)
                                if side % 2 == 1:
                                    face = o
                                share = wp.max(opening[face][side // 2], thin[face][side // 2])
                                if a[0] == -1 or b[0] == -1:
                                    share = 1.0 + d + other
                                wide = wp.max(wide, share)
                                if a[1] == 1:
                                    mark = mark | (1 << (8 + opposite))
                                if a[1] == -1:
                                    mark = mark | THIN
    elif d < 0.5:
        for axis in range(3):
            m = at.near[c][2 * axis]
            n = at.near[c][2 * axis + 1]
            if m >= 0 and n >= 0:
                e = depth_at(at, m)
                f = depth_at(at, n)
                if e < 0.0 and f < 0.0 and 2.0 + e + f < 1.0:
                    a = who_inside(at, m, 2 * axis + 1)
                    b = who_inside(at, n, 2 * axis)
                    if a[0] >= -1 and b[0] >= -1 and a[0] != b[0]:
                        if is_free(free, a[0]) + is_free(free, b[0]) > 0:
                            mark = NARROW
    if at.near[c][5] < 0:
        # The last cell of its column has no upper face: what its liquid pressed on there would reach nobody.
        mark = 0
    gap[c] = mark
    held[c] = mine
    width[c] = wide
    flag[c] = int(mark > 0)


@wp.kernel
def list_gaps(
    first: wp.int32, flag: wp.array(dtype=wp.int32), before: wp.array(dtype=wp.int32), listed: wp.array(dtype=wp.int32)
):
    """Marked cells, one after the other."""
    c = first + wp.tid()
    if flag[c] == 1:
        listed[before[c]] = c


@wp.func
def faces_gap(mark: int, side: int):
    """True where a cell's side is at a gap."""
    return mark != NARROW and ((mark >> side) & 1) == 1


@wp.func
def turns_away(mark: int, side: int):
    """True where a cell's side leads into the solid that holds its centre, away from the gap."""
    return mark != NARROW and ((mark >> (8 + side)) & 1) == 1 and ((mark >> side) & 1) == 0


@wp.func
def lies_along(mark: int, axis: int):
    """True where a cell's gap is across an axis, or its centre is in a gap."""
    return mark == NARROW or ((mark >> (2 * axis)) & 3) == 0


@wp.func
def only_beside(at: Near, free: wp.array(dtype=wp.int32), c: int, o: int, axis: int):
    """1 where a face was taken for a thin wall's because a free body is beside it: one cell is open, the other in thick fixed ground."""
    hidden = int(o)
    open_cell = int(c)
    side = 2 * axis + 1
    if depth_at(at, c) < 0.0:
        hidden = c
        open_cell = o
        side = 2 * axis
    found = int(0)
    if depth_at(at, hidden) < 0.0 and depth_at(at, open_cell) >= 0.0 and at.fixed[hidden][7] <= at.points[hidden][7]:
        if at.points[open_cell][7] < at.fixed[open_cell][7] and is_free(free, at.mover[open_cell][0]) == 1:
            w = who_inside(at, hidden, side)
            if w[1] == 1:
                found = 1
    return found


@wp.kernel
def open_gaps(
    first: wp.int32, at: Near, free: wp.array(dtype=wp.int32), gap: wp.array(dtype=wp.int32), held: wp.array(dtype=wp.int32), opening: wp.array(dtype=wp.vec3),
    thin: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Open the faces of gaps, close those that lead away from them into the solids."""
    c = first + wp.tid()
    share = opening[c]
    mark = thin[c]
    for axis in range(3):
        o = at.near[c][2 * axis]
        if o >= 0:
            g = gap[c]
            h = gap[o]
            if g > 0 or h > 0:
                shut = turns_away(g, 2 * axis) or turns_away(h, 2 * axis + 1)
                if ((g & THIN) > 0 and h == 0) or ((h & THIN) > 0 and g == 0):
                    shut = True
                if shut:
                    share[axis] = 0.0
                    mark[axis] = 0.0
                elif faces_gap(g, 2 * axis) and faces_gap(h, 2 * axis + 1):
                    s = wp.max(share[axis], mark[axis])
                    if held[c] == -1 or held[o] == -1:
                        s = wp.max(s, 1.0 + depth_at(at, c) + depth_at(at, o))
                    share[axis] = wp.max(s, LEAST_GAP)
                    mark[axis] = 0.0
                elif held[c] != -1 and held[o] != -1 and lies_along(g, axis) and lies_along(h, axis):
                    if g > 0 and h > 0:
                        share[axis] = wp.max(wp.max(share[axis], mark[axis]), LEAST_GAP)
                    else:
                        share[axis] = wp.max(share[axis], mark[axis])
                    mark[axis] = 0.0
            elif mark[axis] > 0.0 and only_beside(at, free, c, o, axis) == 1:
                share[axis] = mark[axis]
                mark[axis] = 0.0
    opening[c] = share
    thin[c] = mark


@wp.kernel
def cut_fixed(first: wp.int32, at: Near, halves: wp.array(dtype=vec6)):
    """Open share of the halves of cells beside fixed solids alone, near moving ones (`cut_kernels.find_halves`)."""
    c = first + wp.tid()
    h = vec6()
    d = at.fixed[c][7]
    if at.mover[c][0] >= 0 and wp.abs(d) < REACH and wp.abs(at.points[c][7]) < REACH:
        h = halves_of(lattice(at.near, at.fixed, c))
    else:
        for s in range(6):
            h[s] = 1.0
            if d < 0.0:
                h[s] = 0.0
    halves[c] = h


@wp.kernel
def split_faces(
    first: wp.int32, at: Near, free: wp.array(dtype=wp.int32), halves: wp.array(dtype=vec6), fixed_halves: wp.array(dtype=vec6),
    gap: wp.array(dtype=wp.int32), held: wp.array(dtype=wp.int32), opening: wp.array(dtype=wp.vec3),
    part: wp.array(dtype=wp.vec3), one: wp.array(dtype=wp.vec3i), other: wp.array(dtype=wp.vec3i),
):  # fmt: skip
    """Part of what is closed of a face that belongs to its first owner; the rest is the second's, which moves freely.

    -1: the face has one owner only.
    """
    c = first + wp.tid()
    parts = wp.vec3(-1.0, -1.0, -1.0)
    a = wp.vec3i()
    b = wp.vec3i()
    for axis in range(3):
        o = at.near[c][2 * axis]
        who = at.mover[c][1 + axis]
        shut = 1.0 - opening[c][axis]
        if o >= 0 and who >= 0 and shut > 0.0:
            if free[who] == 1:
                moves = 0.5 * (fixed_halves[c][2 * axis] + fixed_halves[o][2 * axis + 1])
                stays = 1.0 - moves
                moves = wp.max(moves - 0.5 * (halves[c][2 * axis] + halves[o][2 * axis + 1]), 0.0)
                x = beyond(middle(place_of(at.grid, c)), at.lower, at.upper)
                out = wp.min(x, beyond(middle(place_of(at.grid, o)), at.lower, at.upper))
                if gap[c] > 0 and gap[o] > 0 and held[c] >= 0 and held[o] >= 0 and held[c] != held[o] and stays < 1.0e-3:
                    parts[axis] = wp.clamp(at.points[o][7] / (at.points[c][7] + at.points[o][7]), 0.0, 1.0)
                    a[axis] = held[o]
                    b[axis] = held[c]
                elif stays > 1.0e-3 or out < 0.0:
                    a[axis] = at.fixed_owner[c][1 + axis]
                    if out < 0.0 and stays < 1.0e-3:
                        a[axis] = -1
                    if out < 0.0:
                        stays = wp.max(shut - moves, stays)
                    if (gap[c] == 0 or gap[o] == 0) and opening[c][axis] < LEAST:
                        if wp.min(out, wp.min(at.fixed[c][7], at.fixed[o][7])) < 0.0:
                            moves = 0.0
                    parts[axis] = stays / wp.max(stays + moves, 1.0e-3)
                    b[axis] = who
    part[c] = parts
    one[c] = a
    other[c] = b
