# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Amounts that the gas carries, per cell, moved by fluxes through faces, so that their sums stay.

Lightness is 1 - density / density of the ambient air. The others are amounts per volume. Sweeps along one axis after the other, second
order (slopes limited, monotonized central, van Leer 1977, doi:10.1016/0021-9991(77)90095-X), with the volume that the same fluxes leave in each cell: a uniform
concentration stays uniform (as Weymouth and Yue 2010, doi:10.1016/j.jcp.2009.12.018). What comes in from outside is ambient air.
"""

import warp as wp

from .box_kernels import Box, beside, count_of, has_face, is_cell, place_of, upper

wp.set_module_options({"enable_backward": False})

NO_AIR = wp.constant(1.0e-6)
"""Share of a cell's room that its air took at the end of the sweeps, up to which none has come in."""

__all__ = [
    "amounts",
    "ask",
    "conduct",
    "expansion_of",
    "fastest",
    "finish",
    "finish_standing",
    "fluxes",
    "inject",
    "limit",
    "settle",
    "start",
]


@wp.func
def limited(a: float, b: float):
    """Slope between the differences to the lower and the upper neighbour."""
    s = float(0.0)
    if a * b > 0.0:
        s = wp.sign(a) * wp.min(wp.min(2.0 * wp.abs(a), 2.0 * wp.abs(b)), 0.5 * wp.abs(a + b))
    return s


@wp.func
def slope_of(a: wp.vec4, b: wp.vec4):
    """Limited slopes of four quantities."""
    return wp.vec4(limited(a[0], b[0]), limited(a[1], b[1]), limited(a[2], b[2]), limited(a[3], b[3]))


@wp.func
def flux(
    box: Box, axis: wp.int32, below: wp.int32, above: wp.int32, below_at: wp.vec3i, above_at: wp.vec3i, through: float,
    share: wp.array(dtype=wp.vec4), volume: wp.array(dtype=float), opening: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Amounts that a volume takes along from a cell to the one above it, or back where it is negative; elements are -1 outside."""
    moved = wp.vec4(0.0, 0.0, 0.0, 0.0)
    donor = above
    at = above_at
    side = float(-1.0)
    if through > 0.0:
        donor = below
        at = below_at
        side = 1.0
    if donor >= 0:
        here = share[donor]
        lower = beside(box, at, axis, -1)
        higher = beside(box, at, axis, 1)
        if lower >= 0 and higher >= 0:
            up = upper(box, at, axis)
            if opening[donor][axis] > 0.0 and opening[up][axis] > 0.0:
                s = slope_of(here - share[lower], share[higher] - here)
                edge = here + 0.5 * side * (1.0 - wp.min(wp.abs(through) / wp.max(volume[donor], 1.0e-9), 1.0)) * s
                # What is neither fuel nor product is air: slopes that are limited one by one could take more than there is.
                if box.density == 0.0 or box.density * (1.0 - edge[0]) >= edge[2] + edge[3]:
                    here = edge
        moved = through * here
    return moved


@wp.func
def held_share(amount: wp.vec4, volume: float):
    """Concentrations of amounts in a volume."""
    return amount / wp.max(volume, 1.0e-9)


@wp.kernel
def start(
    first: wp.int32, room: wp.array(dtype=float), state: wp.array(dtype=wp.vec4), amount: wp.array(dtype=wp.vec4),
    volume: wp.array(dtype=float), share: wp.array(dtype=wp.vec4),
):  # fmt: skip
    """Amounts, volume and concentrations of each cell before the sweeps."""
    c = first + wp.tid()
    volume[c] = room[c]
    amount[c] = state[c] * room[c]
    share[c] = held_share(amount[c], volume[c])


@wp.kernel
def fluxes(
    first: wp.int32, box: Box, axis: int, through: wp.array(dtype=wp.vec3), share: wp.array(dtype=wp.vec4),
    volume: wp.array(dtype=float), opening: wp.array(dtype=wp.vec3), moved: wp.array(dtype=wp.vec4),
):  # fmt: skip
    """Amounts that pass the lower faces of all elements along one axis with the volumes that do, each once for the cells on both sides."""
    c = first + wp.tid()
    at = place_of(box, c)
    if has_face(box, at, axis):
        volume_through = through[c][axis]
        found = wp.vec4(0.0, 0.0, 0.0, 0.0)
        if volume_through != 0.0:
            above = int(-1)
            if is_cell(box, at):
                above = c
            below = beside(box, at, axis, -1)
            below_at = at
            below_at[axis] = at[axis] - 1
            if below_at[axis] < 0:
                below_at[axis] = count_of(box, axis) - 1
            found = flux(box, axis, below, above, below_at, at, volume_through, share, volume, opening)
        moved[c] = found


@wp.kernel
def settle(
    first: wp.int32, box: Box, axis: int, through: wp.array(dtype=wp.vec3), moved: wp.array(dtype=wp.vec4),
    amount: wp.array(dtype=wp.vec4), volume: wp.array(dtype=float), share: wp.array(dtype=wp.vec4),
):  # fmt: skip
    """Amounts, volume and concentrations of each cell after what passed its two faces along one axis."""
    c = first + wp.tid()
    at = place_of(box, c)
    if is_cell(box, at):
        up = upper(box, at, axis)
        volume[c] = volume[c] + through[c][axis] - through[up][axis]
        amount[c] = amount[c] + (moved[c] - moved[up])
        share[c] = held_share(amount[c], volume[c])


@wp.kernel
def ask(
    first: wp.int32,
    cells: float,
    velocity: wp.array(dtype=wp.vec3),
    opening: wp.array(dtype=wp.vec3),
    left: wp.array(dtype=wp.vec3),
):
    """Volumes that are to pass through lower faces, in cells."""
    c = first + wp.tid()
    left[c] = wp.cw_mul(cells * velocity[c], opening[c])


@wp.func
def allowed(
    box: Box, axis: wp.int32, face: wp.int32, below: wp.int32, above: wp.int32, left: wp.array(dtype=wp.vec3),
    volume: wp.array(dtype=float),
):  # fmt: skip
    """Volume that may pass through a face now: no cell gives more than it has."""
    through = left[face][axis]
    donor = above
    if through > 0.0:
        donor = below
    if donor >= 0:
        up = upper(box, place_of(box, donor), axis)
        out = wp.max(-left[donor][axis], 0.0) + wp.max(left[up][axis], 0.0)
        held = wp.max(volume[donor], 0.0)
        if out > held:
            through = through * held / out
    return through


@wp.kernel
def limit(
    first: wp.int32, box: Box, axis: int, left: wp.array(dtype=wp.vec3), volume: wp.array(dtype=float),
    left_after: wp.array(dtype=wp.vec3), through: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Volumes that pass along one axis as far as cells have what is asked of them, and what is left to pass: cells that solids are about to
    fill give all they have."""
    c = first + wp.tid()
    at = place_of(box, c)
    rest = left[c]
    now = wp.vec3(0.0, 0.0, 0.0)
    if has_face(box, at, axis):
        here = int(-1)
        if is_cell(box, at):
            here = c
        now[axis] = allowed(box, axis, c, beside(box, at, axis, -1), here, left, volume)
        rest[axis] = rest[axis] - now[axis]
    left_after[c] = rest
    through[c] = now


@wp.kernel
def finish(
    first: wp.int32, box: Box, expands: int, room: wp.array(dtype=float), amount: wp.array(dtype=wp.vec4),
    volume: wp.array(dtype=float), state: wp.array(dtype=wp.vec4),
):  # fmt: skip
    """Concentrations after sweeps between solids that move. Where the gas expands, what left a cell in excess of its room made it lighter:
    its mass is kept. Room that no air has reached (solids that part within others) has that of outside: it came through gaps finer than
    cells."""
    c = first + wp.tid()
    if is_cell(box, place_of(box, c)):
        v = room[c]
        q = wp.vec4(0.0, 0.0, 0.0, 0.0)
        if v > 0.0 and volume[c] > NO_AIR * v:
            q = amount[c]
            if expands == 1:
                q[0] = q[0] + v - volume[c]
            q = q / v
        state[c] = q


@wp.kernel
def finish_standing(
    first: wp.int32, box: Box, expands: int, room: wp.array(dtype=float), amount: wp.array(dtype=wp.vec4), seconds: float,
    size: float, expansion: wp.array(dtype=float), region: wp.array(dtype=wp.int32), taken: wp.array(dtype=float),
    state: wp.array(dtype=wp.vec4),
):  # fmt: skip
    """Concentrations after sweeps between solids that stand. Where the gas expands, what it was asked to make of a cell's room left it, so
    that it became lighter by that; the volume that the sweeps left says the same but for its rounding, which adds up."""
    c = first + wp.tid()
    if is_cell(box, place_of(box, c)):
        v = room[c]
        q = wp.vec4(0.0, 0.0, 0.0, 0.0)
        if v > 0.0:
            q = amount[c] / v
            if expands == 1:
                q[0] = q[0] + seconds * (expansion[c] - taken[region[c]] / size)
        state[c] = q


@wp.kernel
def inject(
    first: wp.int32, seconds: float, expands: int, rate: wp.array(dtype=float), content: wp.array(dtype=wp.vec4),
    heating: wp.array(dtype=float), state: wp.array(dtype=wp.vec4),
):  # fmt: skip
    """Gas of a composition that a source adds: volume per volume and second. What it displaces has left by the fluxes; gas that does not
    expand takes up heat as it is."""
    c = first + wp.tid()
    q = state[c]
    if rate[c] > 0.0:
        added = content[c]
        if expands == 1:
            added[0] = added[0] - 1.0
        q = q + seconds * rate[c] * added
    if expands == 0:
        q[0] = q[0] + seconds * heating[c]
    state[c] = q


@wp.kernel
def expansion_of(
    first: wp.int32, rate: wp.array(dtype=float), heating: wp.array(dtype=float), expands: int, region: wp.array(dtype=wp.int32),
    ratio: wp.array(dtype=float), out: wp.array(dtype=float),
):  # fmt: skip
    """Volume per volume and second that sources and heat ask for; heat only where the gas expands. Their numbers are those at the ambient
    pressure: under more, they make less."""
    c = first + wp.tid()
    d = rate[c]
    if expands == 1:
        d = d + heating[c]
    out[c] = d / ratio[region[c]]


@wp.kernel
def conduct(
    first: wp.int32, box: Box, number: float, walls: wp.array(dtype=wp.vec2), opening: wp.array(dtype=wp.vec3),
    state: wp.array(dtype=wp.vec4), expands: int, seconds: float, region: wp.array(dtype=wp.int32), ratio: wp.array(dtype=float),
    out: wp.array(dtype=wp.vec4), expansion: wp.array(dtype=float),
):  # fmt: skip
    """Heat conduction over a step of `number` = diffusivity time / cell^2. `walls` holds of each side whether it has a temperature, and its excess
    over the ambient one as a share of that. Gas that expands takes the heat up as volume, else its lightness is its excess."""
    c = first + wp.tid()
    at = place_of(box, c)
    q = state[c]
    if is_cell(box, at):
        here = q[0]
        if expands == 1:
            here = ratio[region[c]] / (1.0 - q[0]) - 1.0
        total = float(0.0)
        for side in range(6):
            axis = side // 2
            step = 2 * (side - 2 * axis) - 1
            other = beside(box, at, axis, step)
            face = c
            if step == 1:
                face = upper(box, at, axis)
            if other >= 0:
                there = state[other][0]
                if expands == 1:
                    there = ratio[region[other]] / (1.0 - there) - 1.0
                total += opening[face][axis] * (there - here)
            else:
                wall = walls[side]
                if wall[0] > 0.0:
                    total += 2.0 * (wall[1] - here)
        if expands == 1:
            expansion[c] = expansion[c] + number * total / (seconds * ratio[region[c]])
        else:
            q[0] = q[0] + number * total
    out[c] = q


@wp.kernel
def amounts(
    first: wp.int32, box: Box, total: int, block: int, room: wp.array(dtype=float), state: wp.array(dtype=wp.vec4),
    out: wp.array2d(dtype=wp.float64),
):  # fmt: skip
    """Sums of the four quantities times the room of their cells, of blocks of elements, and the greatest lightness."""
    b = first + wp.tid()
    sums = wp.vec4d(wp.float64(0.0), wp.float64(0.0), wp.float64(0.0), wp.float64(0.0))
    top = float(0.0)
    for c in range(b * block, wp.min((b + 1) * block, total)):
        if is_cell(box, place_of(box, c)):
            q = state[c] * room[c]
            sums = sums + wp.vec4d(wp.float64(q[0]), wp.float64(q[1]), wp.float64(q[2]), wp.float64(q[3]))
            top = wp.max(top, wp.abs(state[c][0]))
    for n in range(4):
        out[n, b] = sums[n]
    out[4, b] = wp.float64(top)


@wp.kernel
def fastest(first: wp.int32, total: int, block: int, field: wp.array(dtype=wp.vec3), out: wp.array(dtype=wp.float64)):
    """Largest component of blocks of elements."""
    b = first + wp.tid()
    top = float(0.0)
    for c in range(b * block, wp.min((b + 1) * block, total)):
        v = field[c]
        top = wp.max(top, wp.max(wp.abs(v[0]), wp.max(wp.abs(v[1]), wp.abs(v[2]))))
    out[b] = wp.float64(top)
