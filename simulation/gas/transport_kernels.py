# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Amounts that the gas carries, per cell, moved by fluxes through faces, so that their sums stay.

Lightness is 1 - density / density of the ambient air. The others are amounts per volume. Sweeps (`sweep_kernels.py`) go along one axis after
the other, with the volume that the same fluxes leave in each cell: a uniform concentration stays uniform (as Weymouth and Yue 2010,
doi:10.1016/j.jcp.2009.12.018). What comes in from outside is ambient air.
"""

import warp as wp

from ..grids.row_kernels import LOOP
from .box_kernels import Box, beside, has_face, index_of, is_cell, place_of, run_of, upper

wp.set_module_options({"enable_backward": False})

NO_AIR = wp.constant(1.0e-6)
"""Share of a cell's room that its air took at the end of the sweeps, up to which none has come in."""

__all__ = [
    "amounts",
    "conduct",
    "demand",
    "expansion_of",
    "finish",
    "finish_standing",
    "inject",
    "largest",
    "lightest",
    "limit",
    "spend",
]


@wp.func
def allowed(
    box: Box, axis: wp.int32, face: wp.int32, below: wp.int32, above: wp.int32, left: wp.array(dtype=float),
    volume: wp.array(dtype=float),
):  # fmt: skip
    """Volume that may pass through a face now: no cell gives more than it has."""
    through = left[face]
    donor = above
    if through > 0.0:
        donor = below
    if donor >= 0:
        up = upper(box, place_of(box, donor), axis)
        out = wp.max(-left[donor], 0.0) + wp.max(left[up], 0.0)
        held = wp.max(volume[donor], 0.0)
        if out > held:
            through = through * held / out
    return through


@wp.kernel
def limit(
    first: wp.int32, box: Box, axis: int, left: wp.array(dtype=float), volume: wp.array(dtype=float),
    through: wp.array(dtype=float),
):  # fmt: skip
    """Volumes that pass along one axis as far as cells have what is asked of them: cells that solids are about to fill give all they have."""
    c = first + wp.tid()
    at = place_of(box, c)
    now = float(0.0)
    if has_face(box, at, axis):
        here = int(-1)
        if is_cell(box, at):
            here = c
        now = allowed(box, axis, c, beside(box, at, axis, -1), here, left, volume)
    through[c] = now


@wp.kernel
def spend(first: wp.int32, through: wp.array(dtype=float), left: wp.array(dtype=float)):
    """Volume that is left to pass."""
    c = first + wp.tid()
    left[c] = left[c] - through[c]


@wp.func
def more(a: float, b: float):
    """The greater one."""
    return wp.where(a > b, a, b)


_DEMAND = (
    """
#define GAS_MOST(a, b) ((a) > (b) ? (a) : (b))
    const float* R = room.data;
    const float* X = x.data;
    const float* Y = y.data;
    const float* Z = z.data;
    int top = 0;
"""
    + LOOP
    + """
    for (int k = lo; k < hi; ++k) {
        const float a = X[own + k], b = X[high_x + k], d = Y[own + k], e = Y[high_y + k], f = Z[own + k], g = Z[high_z + k];
        const float out_x = GAS_MOST(-a, 0.0f) + GAS_MOST(b, 0.0f);
        const float out_y = GAS_MOST(-d, 0.0f) + GAS_MOST(e, 0.0f);
        const float out_z = GAS_MOST(-f, 0.0f) + GAS_MOST(g, 0.0f);
        // What a sweep may take is a share of what those before it left: volumes go down by what leaves less what comes.
        const float first_y = out_y + most * (b - a), first_z = out_z + most * (b - a + e - d);
        const float last_y = out_y + most * (g - f), last_x = out_x + most * (g - f + e - d);
        const float first_two = GAS_MOST(first_y, first_z), last_two = GAS_MOST(last_y, last_x);
        const float both = GAS_MOST(first_two, last_two), alone = GAS_MOST(out_x, out_z);
        const float whole = R[own + k];
        union { float number; int bits; } found;
        found.number = whole > 0.0f ? GAS_MOST(alone, both) / whole : 0.0f;
        top = found.bits > top ? found.bits : top;  // Numbers above 0 are in the order of their bits.
    }
    union { int bits; float number; } most_of_all;
    most_of_all.bits = top;
    return most_of_all.number;
"""
)


@wp.func_native(_DEMAND)
def demand_row(
    own: int, high_x: int, high_y: int, high_z: int, lo: int, hi: int, most: float, room: wp.array(dtype=float),
    x: wp.array(dtype=float), y: wp.array(dtype=float), z: wp.array(dtype=float),
) -> float:  # fmt: skip
    """Largest share of a cell's room that sweeps ask for, in a row of cells, times `most`."""


@wp.kernel
def demand(
    first: wp.int32, box: Box, most: float, room: wp.array(dtype=float), x: wp.array(dtype=float), y: wp.array(dtype=float),
    z: wp.array(dtype=float), out: wp.array(dtype=float),
):  # fmt: skip
    """Least number of parts of a step, per row of cells along z, in which no sweep takes more than the share `most` out of what a cell holds
    at its begin, in either order of the axes."""
    row = first + wp.tid()
    own = row * (box.nz + 1)
    at = place_of(box, own)
    found = float(0.0)
    if at[0] < box.nx and at[1] < box.ny:
        along_x = upper(box, at, 0)
        along_y = upper(box, at, 1)
        lo = int(0)
        while lo < box.nz:
            # The upper face of the last cell may be the first one again.
            hi = wp.where(box.wraps[2] == 1 and lo < box.nz - 1, box.nz - 1, box.nz)
            above = wp.where(box.wraps[2] == 1 and lo == box.nz - 1, own - lo, own + 1)
            found = wp.max(found, demand_row(own, along_x, along_y, above, lo, hi, most, room, x, y, z))
            lo = hi
    out[row] = found / most


@wp.kernel
def finish(
    first: wp.int32, box: Box, expands: int, elements: int, room: wp.array(dtype=float), amount: wp.array(dtype=float),
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
            for k in range(4):
                q[k] = amount[k * elements + c]
            if expands == 1:
                q[0] = q[0] + v - volume[c]
            q = q / v
        state[c] = q


_FINISH = """
    const float* X = expansion.data;
    const int* G = region.data;
    const float* P = taken.data;
    const float* R = room.data;
    const float rest = expands == 1 ? seconds : 0.0f;
    for (int q = 0; q < planes; ++q) {
        const float* A = amount.data + q * elements;
        float* Q = (float*)state.data + q;
        const float made = q == 0 ? rest : 0.0f;
#if defined(__clang__)
#pragma clang loop vectorize(assume_safety)
#endif
        for (int c = lo; c < hi; ++c) {
            const float kept = A[c] / (R[c] > 0.0f ? R[c] : 1.0f) + made * (X[c] - P[G[c]] / size);
            Q[4 * c] = R[c] > 0.0f ? kept : 0.0f;
        }
    }
"""


@wp.func_native(_FINISH)
def finish_run(
    lo: int, hi: int, expands: int, elements: int, planes: int, room: wp.array(dtype=float), amount: wp.array(dtype=float),
    seconds: float, size: float, expansion: wp.array(dtype=float), region: wp.array(dtype=wp.int32), taken: wp.array(dtype=float),
    state: wp.array(dtype=wp.vec4),
):  # fmt: skip
    """Concentrations of elements after the sweeps."""


@wp.kernel
def finish_standing(
    first: wp.int32, box: Box, span: int, expands: int, elements: int, planes: int, room: wp.array(dtype=float), amount: wp.array(dtype=float),
    seconds: float, size: float, expansion: wp.array(dtype=float), region: wp.array(dtype=wp.int32), taken: wp.array(dtype=float),
    state: wp.array(dtype=wp.vec4),
):  # fmt: skip
    """Concentrations after sweeps between solids that stand. Where the gas expands, what it was asked to make of a cell's room left it, so
    that it became lighter by that; the volume that the sweeps left says the same but for its rounding, which adds up."""
    at = run_of(box, span, first + wp.tid())
    own = index_of(box, at[0], at[1], 0)
    finish_run(own + at[2], own + at[3], expands, elements, planes, room, amount, seconds, size, expansion, region, taken, state)


_INJECT = """
    const float* R = rate.data;
    const float* H = heating.data;
    const float* C = (const float*)content.data;
    float* Q = (float*)state.data;
    const float less = expands == 1 ? 1.0f : 0.0f, heat = expands == 1 ? 0.0f : seconds;
    int any = 0;
#if defined(__clang__)
#pragma clang loop vectorize(assume_safety)
#endif
    for (int c = lo; c < hi; ++c)
        any |= (R[c] > 0.0f ? 1 : 0) | (H[c] != 0.0f ? 1 : 0);
    if (any == 0)
        return;
#if defined(__clang__)
#pragma clang loop vectorize(assume_safety)
#endif
    for (int c = lo; c < hi; ++c) {
        const float part = R[c] > 0.0f ? seconds * R[c] : 0.0f;
        Q[4 * c] = Q[4 * c] + part * (C[4 * c] - less) + heat * H[c];
        Q[4 * c + 1] = Q[4 * c + 1] + part * C[4 * c + 1];
        Q[4 * c + 2] = Q[4 * c + 2] + part * C[4 * c + 2];
        Q[4 * c + 3] = Q[4 * c + 3] + part * C[4 * c + 3];
    }
"""


@wp.func_native(_INJECT)
def inject_run(
    lo: int, hi: int, seconds: float, expands: int, rate: wp.array(dtype=float), content: wp.array(dtype=wp.vec4),
    heating: wp.array(dtype=float), state: wp.array(dtype=wp.vec4),
):  # fmt: skip
    """Gas that sources add to elements."""


@wp.kernel
def inject(
    first: wp.int32, box: Box, span: int, seconds: float, expands: int, rate: wp.array(dtype=float),
    content: wp.array(dtype=wp.vec4), heating: wp.array(dtype=float), state: wp.array(dtype=wp.vec4),
):  # fmt: skip
    """Gas of a composition that a source adds: volume per volume and second. What it displaces has left by the fluxes; gas that does not
    expand takes up heat as it is."""
    at = run_of(box, span, first + wp.tid())
    own = index_of(box, at[0], at[1], 0)
    inject_run(own + at[2], own + at[3], seconds, expands, rate, content, heating, state)


_EXPANSION = (
    """
    const float* R = rate.data;
    const float* H = heating.data;
    const int* G = region.data;
    const float* P = ratio.data;
    float* E = out.data;
"""
    + LOOP
    + """
    for (int c = lo; c < hi; ++c)
        E[c] = (expands == 1 ? R[c] + H[c] : R[c]) / P[G[c]];
"""
)


@wp.func_native(_EXPANSION)
def expansion_run(
    lo: int, hi: int, expands: int, rate: wp.array(dtype=float), heating: wp.array(dtype=float), region: wp.array(dtype=wp.int32),
    ratio: wp.array(dtype=float), out: wp.array(dtype=float),
):  # fmt: skip
    """As `expansion_of`, over elements that follow each other."""


@wp.kernel
def expansion_of(
    first: wp.int32, span: int, elements: int, rate: wp.array(dtype=float), heating: wp.array(dtype=float), expands: int,
    region: wp.array(dtype=wp.int32), ratio: wp.array(dtype=float), out: wp.array(dtype=float),
):  # fmt: skip
    """Volume per volume and second that sources and heat ask for; heat only where the gas expands. Their numbers are those at the ambient
    pressure: under more, they make less."""
    lo = (first + wp.tid()) * span
    expansion_run(lo, wp.min(lo + span, elements), expands, rate, heating, region, ratio, out)


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
    """Sums of the four quantities times the room of their cells, of blocks of elements."""
    b = first + wp.tid()
    sums = wp.vec4d(wp.float64(0.0), wp.float64(0.0), wp.float64(0.0), wp.float64(0.0))
    for c in range(b * block, wp.min((b + 1) * block, total)):
        if is_cell(box, place_of(box, c)):
            q = state[c] * room[c]
            sums = sums + wp.vec4d(wp.float64(q[0]), wp.float64(q[1]), wp.float64(q[2]), wp.float64(q[3]))
    for n in range(4):
        out[n, b] = sums[n]


_LIGHTEST = (
    """
    const float* Q = (const float*)state.data;
    int top = 0;
"""
    + LOOP
    + """
    for (int c = lo; c < hi; ++c) {
        union { float number; int bits; } one;
        one.number = Q[4 * c];
        const int size = one.bits & 0x7fffffff;  // Sizes of numbers are in the order of their bits.
        top = size > top ? size : top;
    }
    union { int bits; float number; } found;
    found.bits = top;
    return found.number;
"""
)


@wp.func_native(_LIGHTEST)
def lightest_run(lo: int, hi: int, state: wp.array(dtype=wp.vec4)) -> float:
    """Largest size of the lightness of elements."""


@wp.kernel
def lightest(first: wp.int32, total: int, block: int, state: wp.array(dtype=wp.vec4), out: wp.array(dtype=float)):
    """Largest size of the lightness of blocks of elements; those that are no cells have none."""
    b = first + wp.tid()
    out[b] = lightest_run(b * block, wp.min((b + 1) * block, total), state)


@wp.kernel
def largest(
    first: wp.int32, total: int, block: int, x: wp.array(dtype=float), y: wp.array(dtype=float), z: wp.array(dtype=float),
    out: wp.array(dtype=float),
):  # fmt: skip
    """Largest size of three quantities of blocks of elements."""
    b = first + wp.tid()
    top = float(0.0)
    for c in range(b * block, wp.min((b + 1) * block, total)):
        top = more(top, more(wp.abs(x[c]), more(wp.abs(y[c]), wp.abs(z[c]))))
    out[b] = top
