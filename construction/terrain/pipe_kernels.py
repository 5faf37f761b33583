# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Warp kernels of running water by virtual pipes: flow over faces, depth and load of cells, wear and deposit. They only gather.

Cells are flat, row-major. A face lies west and one south of each cell; face (r, c) has index r (cols + 1) + c, and the last
column and row of faces are the east and north edge. Flow [m^2/s] counts positive towards east and north. Import only where warp
is used.
"""

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = ["BLOCK", "carry", "limit", "push", "quickest", "scour"]

GRAVITY = wp.constant(wp.float64(9.81))
DRY = wp.constant(wp.float64(1e-6))
"""Films thinner than this stay where they are [m]."""
BLOCK = 32
"""Cells that one thread of `quickest` looks at."""
ZERO = wp.constant(wp.float64(0.0))
ONE = wp.constant(wp.float64(1.0))
HALF = wp.constant(wp.float64(0.5))


@wp.struct
class Land:
    """Constants of a step."""

    rows: wp.int32
    cols: wp.int32
    cell: wp.float64
    step: wp.float64
    """[s]"""
    friction: wp.float64
    """Manning's n [s/m^(1/3)]."""
    sink: wp.array(dtype=wp.uint8)
    """1 where water and load leave: the sea, cells without land."""


@wp.func
def face_flow(
    land: Land,
    low: wp.float64,
    low_depth: wp.float64,
    high: wp.float64,
    high_depth: wp.float64,
    flow: wp.float64,
    across: wp.float64,
) -> wp.float64:
    """Flow of a pipe after a step, from the cell before it (`low`, ground and depth) to the cell behind it (`high`).

    Pressure drives, Manning's friction brakes and is implicit: thin films run at their normal depth at any step.
    """
    level = wp.max(low + low_depth, high + high_depth)
    depth = level - wp.max(low, high)
    if depth <= DRY:
        return ZERO
    drop = (low + low_depth - high - high_depth) / land.cell
    pushed = flow + GRAVITY * depth * drop * land.step
    size = wp.abs(pushed)
    if size == ZERO:
        return ZERO
    brake = GRAVITY * land.step * land.friction * land.friction / (depth * depth * wp.cbrt(depth))
    found = wp.float64(2.0) * size / (ONE + wp.sqrt(ONE + wp.float64(4.0) * brake * size))
    for _ in range(2):
        found = size / (ONE + brake * wp.sqrt(found * found + across * across))
    # The scheme carries no momentum with the water: what is left of a flow that ran shallow may not shoot ahead.
    fastest = wp.max(GRAVITY * depth, GRAVITY * land.step * wp.abs(drop) / (brake * depth))
    return wp.sign(pushed) * wp.min(found, depth * wp.sqrt(fastest))


@wp.func
def between(
    land: Land,
    ground: wp.array(dtype=wp.float64),
    depth: wp.array(dtype=wp.float64),
    before: wp.int32,
    behind: wp.int32,
    flow: wp.float64,
    across: wp.float64,
) -> wp.float64:
    """Flow between two cells; -1 is outside: there water falls off the edge. Nothing comes back from sinks and outside."""
    if before < 0:
        if land.sink[behind] == wp.uint8(1):
            return ZERO
        return wp.min(face_flow(land, ground[behind], ZERO, ground[behind], depth[behind], flow, across), ZERO)
    if behind < 0:
        if land.sink[before] == wp.uint8(1):
            return ZERO
        return wp.max(face_flow(land, ground[before], depth[before], ground[before], ZERO, flow, across), ZERO)
    if land.sink[before] == wp.uint8(1) and land.sink[behind] == wp.uint8(1):
        return ZERO
    found = face_flow(land, ground[before], depth[before], ground[behind], depth[behind], flow, across)
    if land.sink[before] == wp.uint8(1):
        return wp.min(found, ZERO)
    if land.sink[behind] == wp.uint8(1):
        return wp.max(found, ZERO)
    return found


@wp.kernel
def push(
    first: wp.int32,
    land: Land,
    ground: wp.array(dtype=wp.float64),
    depth: wp.array(dtype=wp.float64),
    east: wp.array(dtype=wp.float64),
    north: wp.array(dtype=wp.float64),
    new_east: wp.array(dtype=wp.float64),
    new_north: wp.array(dtype=wp.float64),
):
    """Flow over the west and the south face of each cell (and of those one beyond)."""
    i = first + wp.tid()
    wide = land.cols + 1
    r = i // wide
    c = i - r * wide
    here = r * land.cols + c
    if r < land.rows:
        before = wp.where(c > 0, here - 1, -1)
        behind = wp.where(c < land.cols, here, -1)
        a = wp.where(c > 0, i - 1, i)
        b = wp.where(c < land.cols, i, i - 1)
        across = wp.float64(0.25) * (north[a] + north[a + wide] + north[b] + north[b + wide])
        new_east[i] = between(land, ground, depth, before, behind, east[i], across)
    if c < land.cols:
        before = wp.where(r > 0, here - land.cols, -1)
        behind = wp.where(r < land.rows, here, -1)
        a = wp.where(r > 0, i - wide, i)
        b = wp.where(r < land.rows, i, i - wide)
        across = wp.float64(0.25) * (east[a] + east[a + 1] + east[b] + east[b + 1])
        new_north[i] = between(land, ground, depth, before, behind, north[i], across)


@wp.kernel
def limit(
    first: wp.int32,
    land: Land,
    depth: wp.array(dtype=wp.float64),
    east: wp.array(dtype=wp.float64),
    north: wp.array(dtype=wp.float64),
    share: wp.array(dtype=wp.float64),
):
    """Part of the flow out of each cell that its water suffices for (Mei, Decaudin & Hu 2007, eq. 4)."""
    i = first + wp.tid()
    f = i + i // land.cols
    out = wp.max(-east[f], ZERO) + wp.max(east[f + 1], ZERO)
    out += wp.max(-north[f], ZERO) + wp.max(north[f + land.cols + 1], ZERO)
    out *= land.step
    share[i] = wp.where(out > depth[i] * land.cell, depth[i] * land.cell / wp.max(out, wp.float64(1e-300)), ONE)


@wp.func
def passed(land: Land, flow: wp.float64, before: wp.int32, behind: wp.int32, share: wp.array(dtype=wp.float64)) -> wp.float64:
    """Water that goes over a face in the step, as depth of a cell [m]."""
    donor = wp.where(flow > ZERO, before, behind)
    if donor < 0:
        return ZERO
    return flow * share[donor] * land.step / land.cell


@wp.func
def laden(
    water: wp.float64,
    before: wp.int32,
    behind: wp.int32,
    depth: wp.array(dtype=wp.float64),
    load: wp.array(dtype=wp.float64),
) -> wp.float64:
    """Load that goes with it [m]."""
    donor = wp.where(water > ZERO, before, behind)
    if donor < 0:
        return ZERO
    return wp.where(depth[donor] > ZERO, water * load[donor] / wp.max(depth[donor], wp.float64(1e-300)), ZERO)


@wp.func
def pace(water: wp.float64, before: wp.int32, behind: wp.int32, depth: wp.array(dtype=wp.float64)) -> wp.float64:
    """Speed over a face, in cells per step: what goes over it, of what stands before it."""
    donor = wp.where(water > ZERO, before, behind)
    if donor < 0:
        return ZERO
    return wp.where(depth[donor] > DRY, water / wp.max(depth[donor], DRY), ZERO)


@wp.kernel
def carry(
    first: wp.int32,
    land: Land,
    rain: wp.float64,
    dried: wp.float64,
    depth: wp.array(dtype=wp.float64),
    load: wp.array(dtype=wp.float64),
    east: wp.array(dtype=wp.float64),
    north: wp.array(dtype=wp.float64),
    share: wp.array(dtype=wp.float64),
    new_depth: wp.array(dtype=wp.float64),
    new_load: wp.array(dtype=wp.float64),
    speed: wp.array(dtype=wp.float64),
    water_out: wp.array(dtype=wp.float64),
    load_out: wp.array(dtype=wp.float64),
    evaporated: wp.array(dtype=wp.float64),
):
    """Depth and load after a step, speed of the flow, and what left over the edge or into sinks. `rain` and `dried` in m."""
    i = first + wp.tid()
    if land.sink[i] == wp.uint8(1):
        new_depth[i] = depth[i]
        new_load[i] = ZERO
        speed[i] = ZERO
        return
    r = i // land.cols
    c = i - r * land.cols
    f = i + r
    west_cell = wp.where(c > 0, i - 1, -1)
    east_cell = wp.where(c < land.cols - 1, i + 1, -1)
    south_cell = wp.where(r > 0, i - land.cols, -1)
    north_cell = wp.where(r < land.rows - 1, i + land.cols, -1)
    w = passed(land, east[f], west_cell, i, share)
    e = passed(land, east[f + 1], i, east_cell, share)
    s = passed(land, north[f], south_cell, i, share)
    n = passed(land, north[f + land.cols + 1], i, north_cell, share)
    after = wp.max(depth[i] + ((w - e) + (s - n)), ZERO)
    lw = laden(w, west_cell, i, depth, load)
    le = laden(e, i, east_cell, depth, load)
    ls = laden(s, south_cell, i, depth, load)
    ln = laden(n, i, north_cell, depth, load)
    new_load[i] = wp.max(load[i] + ((lw - le) + (ls - ln)), ZERO)
    gone = ZERO
    taken = ZERO
    if west_cell < 0 or land.sink[wp.max(west_cell, 0)] == wp.uint8(1):
        gone -= w
        taken -= lw
    if east_cell < 0 or land.sink[wp.max(east_cell, 0)] == wp.uint8(1):
        gone += e
        taken += le
    if south_cell < 0 or land.sink[wp.max(south_cell, 0)] == wp.uint8(1):
        gone -= s
        taken -= ls
    if north_cell < 0 or land.sink[wp.max(north_cell, 0)] == wp.uint8(1):
        gone += n
        taken += ln
    water_out[i] = water_out[i] + gone
    load_out[i] = load_out[i] + taken
    vx = pace(w, west_cell, i, depth) + pace(e, i, east_cell, depth)
    vy = pace(s, south_cell, i, depth) + pace(n, i, north_cell, depth)
    speed[i] = HALF * land.cell / land.step * wp.sqrt(vx * vx + vy * vy)
    dry = wp.min(after + rain, dried)
    evaporated[i] = evaporated[i] + dry
    new_depth[i] = after + rain - dry


@wp.kernel
def scour(
    first: wp.int32,
    land: Land,
    capacity: wp.float64,
    dissolving: wp.float64,
    rock_dissolving: wp.float64,
    settling: wp.float64,
    ground: wp.array(dtype=wp.float64),
    depth: wp.array(dtype=wp.float64),
    speed: wp.array(dtype=wp.float64),
    load: wp.array(dtype=wp.float64),
    rock: wp.array(dtype=wp.float64),
    soil: wp.array(dtype=wp.float64),
    wear: wp.array(dtype=wp.float64),
    laid: wp.array(dtype=wp.float64),
    new_ground: wp.array(dtype=wp.float64),
):
    """Take up or lay down towards the load that the flow can carry. The last three numbers are parts of the gap per step."""
    i = first + wp.tid()
    if land.sink[i] == wp.uint8(1):
        new_ground[i] = ground[i]
        return
    r = i // land.cols
    c = i - r * land.cols
    west = wp.where(c > 0, i - 1, i)
    east = wp.where(c < land.cols - 1, i + 1, i)
    south = wp.where(r > 0, i - land.cols, i)
    north = wp.where(r < land.rows - 1, i + land.cols, i)
    run_x = land.cell * wp.float64(wp.max(wp.where(c > 0, 1, 0) + wp.where(c < land.cols - 1, 1, 0), 1))
    run_y = land.cell * wp.float64(wp.max(wp.where(r > 0, 1, 0) + wp.where(r < land.rows - 1, 1, 0), 1))
    slope_x = (ground[east] + depth[east] - ground[west] - depth[west]) / run_x
    slope_y = (ground[north] + depth[north] - ground[south] - depth[south]) / run_y
    square = slope_x * slope_x + slope_y * slope_y
    bears = capacity * speed[i] * depth[i] * wp.sqrt(square / (ONE + square))
    if bears > load[i]:
        # Never below the lowest neighbour: water digs no pits.
        lowest = wp.min(wp.min(ground[west], ground[east]), wp.min(ground[south], ground[north]))
        room = HALF * wp.max(ground[i] - lowest, ZERO)
        gap = bears - load[i]
        loose = wp.min(wp.min(dissolving * gap, soil[i]), room)
        hard = ZERO
        if loose == soil[i]:
            hard = wp.min(rock_dissolving * gap, room - loose)
        soil[i] = soil[i] - loose
        rock[i] = rock[i] - hard
        load[i] = load[i] + loose + hard
        wear[i] = wear[i] + loose + hard
    else:
        sinks = wp.min(settling * (load[i] - bears), HALF * depth[i])
        soil[i] = soil[i] + sinks
        load[i] = load[i] - sinks
        laid[i] = laid[i] + sinks
    new_ground[i] = rock[i] + soil[i]


@wp.kernel
def quickest(
    first: wp.int32,
    land: Land,
    depth: wp.array(dtype=wp.float64),
    speed: wp.array(dtype=wp.float64),
    found: wp.array(dtype=wp.float64),
):
    """Speed of the fastest wave in each block of cells [m/s]."""
    i = first + wp.tid()
    best = wp.float64(0.0)
    for k in range(i * BLOCK, wp.min((i + 1) * BLOCK, land.rows * land.cols)):
        if land.sink[k] != wp.uint8(1):
            best = wp.max(best, speed[k] + wp.sqrt(GRAVITY * depth[k]))
    found[i] = best
