# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Gaps thinner than a cell (`gap_kernels.py`), filled with the liquid beside them; where particles do not get into them."""

import warp as wp

from ...grids.columns import Columns, place_of, vec6i
from .distance_kernels import Walls, wall_speed
from .gap_kernels import NARROW
from .solid_kernels import face_center

wp.set_module_options({"enable_backward": False, "max_unroll": 3})

__all__ = ["close_gaps", "flood", "quiet", "seal", "settle"]

PASSED = wp.constant(0.25)
"""Least width of a gap that particles pass."""
UNKNOWN = wp.constant(9.0)
"""As `grid_kernels.BURIED`."""


@wp.func
def within(mark: int, width: float):
    """2 for a cell in a gap too narrow for particles, 1 at the edge of one, 0 elsewhere."""
    n = int(0)
    if mark > 0 and mark != NARROW and width < PASSED:
        n = 1
        if mark >= 256:
            n = 2
    return n


@wp.kernel
def flood(
    first: wp.int32, turn: int, listed: wp.array(dtype=wp.int32), near: wp.array(dtype=vec6i), gap: wp.array(dtype=wp.int32),
    opening: wp.array(dtype=wp.vec3), solid: wp.array(dtype=float), phi: wp.array(dtype=float), wet: wp.array(dtype=wp.int32),
    level: wp.array(dtype=float), since: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Distance to the surface in cells of gaps, from neighbours that had it before this turn; turn 0 begins.

    Cells of gaps that hold enough liquid of their own, and open cells beside gaps, have it from the start.
    """
    c = listed[first + wp.tid()]
    if turn == 0:
        level[c] = UNKNOWN
        since[c] = 1 << 20
        if gap[c] == NARROW and wet[c] == 1:
            level[c] = phi[c]
            since[c] = 0
        return
    if since[c] < turn:
        return
    total = float(0.0)
    count = float(0.0)
    for side in range(6):
        m = near[c][side]
        if m >= 0:
            face = c
            if side % 2 == 1:
                face = m
            if opening[face][side // 2] > 0.0:
                if gap[m] == 0:
                    if solid[m] >= 0.0:
                        total += phi[m]
                        count += 1.0
                elif since[m] < turn:
                    total += level[m]
                    count += 1.0
    if count > 0.0:
        level[c] = total / count
        since[c] = turn


@wp.kernel
def settle(
    first: wp.int32, hidden: int, listed: wp.array(dtype=wp.int32), grid: Columns, gap: wp.array(dtype=wp.int32),
    held: wp.array(dtype=wp.int32), level: wp.array(dtype=float), since: wp.array(dtype=wp.int32), phi: wp.array(dtype=float),
    wet: wp.array(dtype=wp.int32), red: wp.array(dtype=wp.int32), inside: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Give cells of gaps what `flood` found: those with their centre in the gap, or (`hidden`) in a solid."""
    c = listed[first + wp.tid()]
    w = int(-1)
    if hidden == 1:
        if gap[c] != NARROW:
            w = int(level[c] < 0.0)
            inside[c] = held[c]
    elif gap[c] == NARROW and since[c] > 0 and level[c] < 0.0:
        w = 1
    if w >= 0:
        at = place_of(grid, c)
        phi[c] = level[c]
        wet[c] = w
        red[c] = w * (1 - ((at[0] + at[1] + at[2]) & 1))


@wp.kernel
def close_gaps(
    first: wp.int32, near: wp.array(dtype=vec6i), gap: wp.array(dtype=wp.int32), since: wp.array(dtype=wp.int32),
    wet: wp.array(dtype=wp.int32), opening: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Faces between a gap's cell that is only filled by its neighbours and a cell without liquid are closed: no gap leaks into air."""
    c = first + wp.tid()
    share = opening[c]
    for axis in range(3):
        o = near[c][2 * axis]
        if o >= 0:
            g = int(0)
            if gap[c] > 0:
                g = int(since[c] > 0)
            h = int(0)
            if gap[o] > 0:
                h = int(since[o] > 0)
            if (g == 1 or h == 1) and wet[c] * wet[o] == 0:
                share[axis] = 0.0
    opening[c] = share


@wp.kernel
def seal(
    first: wp.int32, grid: Columns, near: wp.array(dtype=vec6i), gap: wp.array(dtype=wp.int32), width: wp.array(dtype=float),
    face_owner: wp.array(dtype=wp.vec3i), part: wp.array(dtype=wp.vec3), one: wp.array(dtype=wp.vec3i),
    other: wp.array(dtype=wp.vec3i), walls: Walls, was: wp.array(dtype=wp.vec3), ratio: float, now: wp.array(dtype=wp.vec3),
    drift: wp.array(dtype=wp.vec3), given: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Particles find gaps closed that are too narrow for them: their faces move as the solids do.

    Outputs are those of `solid_kernels.constrain`. A cell whose side is nearer than its gap, at a body's edge, stays open outwards.
    """
    c = first + wp.tid()
    u = now[c]
    d = drift[c]
    g = given[c]
    for axis in range(3):
        o = near[c][2 * axis]
        if o >= 0:
            mine = within(gap[c], width[c])
            its = within(gap[o], width[o])
            if mine + its >= 2:
                x = face_center(place_of(grid, c), axis)
                w = part[c][axis]
                v = wall_speed(walls, face_owner[c][axis], x)[axis]
                if w >= 0.0:
                    v = w * wall_speed(walls, one[c][axis], x)[axis] + (1.0 - w) * wall_speed(walls, other[c][axis], x)[axis]
                u[axis] = v
                d[axis] = v
                g[axis] = v - ratio * was[c][axis]
    now[c] = u
    drift[c] = d
    given[c] = g


@wp.kernel
def quiet(
    first: wp.int32, listed: wp.array(dtype=wp.int32), held: wp.array(dtype=wp.int32), row: wp.array(dtype=wp.int32),
    right: wp.array(dtype=float), excess: wp.array(dtype=float),
):  # fmt: skip
    """Cells with their centre in a solid have too little room to tell their compression."""
    c = listed[first + wp.tid()]
    if held[c] >= -1:
        r = row[c]
        if r >= 0:
            right[r] = 0.0
            excess[r] = 0.0
