# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Warp kernels of ways through cubes: which cubes a surface passes through, and which ways of particles lead through such.

In double precision, since a cube is small beside the world. All but `mark` only gather; `mark` writes the same value wherever it
writes. Import only where warp is used.
"""

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = ["beside", "blocked", "follow", "mark"]

SHUT = wp.constant(1)
"""Flag: the particle is in a closed cube."""
THROUGH = wp.constant(2)
"""Flag: its way since it was last in an open one leads through closed ones."""


@wp.func
def is_closed(point: wp.vec3d, low: wp.vec3d, cube: wp.float64, grid: wp.array3d(dtype=wp.uint8)) -> bool:
    """True if a point lies in a closed cube; outside of the space nothing is closed."""
    x = (point[0] - low[0]) / cube
    y = (point[1] - low[1]) / cube
    z = (point[2] - low[2]) / cube
    zero = wp.float64(0.0)
    if x < zero or y < zero or z < zero:
        return False
    if x >= wp.float64(grid.shape[0]) or y >= wp.float64(grid.shape[1]) or z >= wp.float64(grid.shape[2]):
        return False
    return grid[wp.int32(x), wp.int32(y), wp.int32(z)] != wp.uint8(0)


@wp.func
def leads_through(start: wp.vec3d, end: wp.vec3d, low: wp.vec3d, cube: wp.float64, grid: wp.array3d(dtype=wp.uint8)) -> bool:
    """True if points at most half a cube apart on a straight way, its ends left out, lie in closed cubes."""
    way = end - start
    steps = wp.ceil(wp.length(way) / (wp.float64(0.5) * cube)) + wp.float64(1.0)
    if not steps < wp.float64(65536.0):
        return False
    count = wp.int32(4)
    while wp.float64(count) <= steps:
        count = count * 4
    for k in range(1, count - 1):
        if is_closed(start + (wp.float64(k) / wp.float64(count - 1)) * way, low, cube, grid):
            return True
    return False


@wp.func
def nearest_open(point: wp.vec3d, low: wp.vec3d, cube: wp.float64, grid: wp.array3d(dtype=wp.uint8)) -> wp.vec3d:
    """Middle of the open cube nearest to a point; not a number where none is within two cubes."""
    nothing = wp.float64(wp.nan)
    best = wp.vec3d(nothing, nothing, nothing)
    least = wp.float64(wp.inf)
    half = wp.float64(0.5)
    x = wp.floor((point[0] - low[0]) / cube) + half
    y = wp.floor((point[1] - low[1]) / cube) + half
    z = wp.floor((point[2] - low[2]) / cube) + half
    for i in range(-2, 3):
        for j in range(-2, 3):
            for k in range(-2, 3):
                middle = low + cube * wp.vec3d(x + wp.float64(i), y + wp.float64(j), z + wp.float64(k))
                gap = wp.length(middle - point)
                if gap < least:
                    if not is_closed(middle, low, cube, grid):
                        least = gap
                        best = middle
    return best


@wp.kernel
def mark(
    first: wp.int32,
    triangles: wp.array2d(dtype=wp.vec3d),
    normals: wp.array(dtype=wp.vec3d),
    parts: wp.int32,
    away: wp.float64,
    turn: wp.mat33d,
    at: wp.vec3d,
    low: wp.vec3d,
    cube: wp.float64,
    grid: wp.array3d(dtype=wp.uint8),
):
    """Close the cubes of points all over triangles whose edges are cut into `parts`, and of points `away` [m] on both sides."""
    t = first + wp.tid()
    for i in range(parts + 1):
        for j in range(parts + 1 - i):
            share = wp.vec3d(wp.float64(i), wp.float64(j), wp.float64(parts - i - j)) / wp.float64(parts)
            point = share[0] * triangles[t, 0] + share[1] * triangles[t, 1] + share[2] * triangles[t, 2]
            for side in range(-1, 2):
                place = (turn * (point + wp.float64(side) * away * normals[t]) + at - low) / cube
                x = wp.int32(wp.floor(place[0]))
                y = wp.int32(wp.floor(place[1]))
                z = wp.int32(wp.floor(place[2]))
                if x >= 0 and y >= 0 and z >= 0 and x < grid.shape[0] and y < grid.shape[1] and z < grid.shape[2]:
                    grid[x, y, z] = wp.uint8(1)


@wp.kernel
def beside(
    first: wp.int32,
    points: wp.array(dtype=wp.vec3d),
    low: wp.vec3d,
    cube: wp.float64,
    grid: wp.array3d(dtype=wp.uint8),
    found: wp.array(dtype=wp.vec3d),
):
    """Middle of the open cube nearest to each point; not a number where none is within two cubes."""
    i = first + wp.tid()
    found[i] = nearest_open(points[i], low, cube, grid)


@wp.kernel
def blocked(
    first: wp.int32,
    start: wp.array(dtype=wp.vec3d),
    end: wp.array(dtype=wp.vec3d),
    low: wp.vec3d,
    cube: wp.float64,
    grid: wp.array3d(dtype=wp.uint8),
    found: wp.array(dtype=wp.uint8),
):
    """Which straight ways lead through closed cubes."""
    i = first + wp.tid()
    found[i] = wp.uint8(0)
    if leads_through(start[i], end[i], low, cube, grid):
        found[i] = wp.uint8(1)


@wp.kernel
def follow(
    first: wp.int32,
    now: wp.array(dtype=wp.vec3d),
    before: wp.array(dtype=wp.vec3d),
    waiting: wp.array(dtype=wp.vec3d),
    turn_now: wp.mat33d,
    at_now: wp.vec3d,
    turn_before: wp.mat33d,
    at_before: wp.vec3d,
    low: wp.vec3d,
    high: wp.vec3d,
    cube: wp.float64,
    grid: wp.array3d(dtype=wp.uint8),
    inside: wp.array3d(dtype=wp.uint8),
    here: wp.array(dtype=wp.vec3d),
    start: wp.array(dtype=wp.vec3d),
    flags: wp.array(dtype=wp.uint8),
):
    """Follow particles by one frame in the frame of a barrier.

    `before` is where they were (world), `waiting` where those in closed cubes were last in an open one (barrier's frame), both not a
    number where there is none; `inside` are cubes that are closed or lie in a solid: no particle began there. Found: where they are,
    where their way began (not a number where nobody knows), flags.
    """
    i = first + wp.tid()
    point = wp.transpose(turn_now) * (now[i] - at_now)
    here[i] = point
    flags[i] = wp.uint8(0)
    begin = waiting[i]
    if wp.isnan(begin[0]):
        begin = wp.transpose(turn_before) * (before[i] - at_before)
        if not wp.isnan(begin[0]):
            if is_closed(begin, low, cube, grid):
                nothing = wp.float64(wp.nan)
                begin = wp.vec3d(nothing, nothing, nothing)
    if is_closed(point, low, cube, grid):
        flags[i] = wp.uint8(SHUT)
        if wp.isnan(begin[0]):
            begin = nearest_open(point, low, cube, inside)
    elif not wp.isnan(begin[0]):
        meets = True
        for axis in range(3):
            if wp.min(begin[axis], point[axis]) > high[axis] or wp.max(begin[axis], point[axis]) < low[axis]:
                meets = False
        if meets:
            if leads_through(begin, point, low, cube, grid):
                flags[i] = wp.uint8(THROUGH)
    start[i] = begin
