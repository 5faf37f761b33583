# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Velocities of faces, carried by a flow (MacCormack, Selle et al. 2008, doi:10.1007/s10915-007-9166-4).

Faces of a row are followed by loops in C, which compilers turn into vector instructions (as in `sweep_kernels.py`). They leave no number
where a path leaves the box, and those faces, and those in its sides, are worked out one by one.
"""

import warp as wp

from ..grids.row_kernels import LOOP
from .box_kernels import (
    Box,
    around,
    blown_in,
    comes_in,
    count_of,
    face_place,
    held,
    incoming,
    index_of,
    run_of,
    sample,
    speed,
    start_speed,
    traced,
)  # fmt: skip

wp.set_module_options({"enable_backward": False})

__all__ = ["bends", "carry", "correct"]

_BETWEEN = """
#define GAS_MIX(a, b, f) ((a) + (f) * ((b) - (a)))
#define GAS_BETWEEN(P, c, fx, fy, fz) \\
    GAS_MIX( \\
        GAS_MIX(GAS_MIX(P[3 * (c)], P[3 * (c) + 3], fz), GAS_MIX(P[3 * ((c) + row)], P[3 * ((c) + row) + 3], fz), fy), \\
        GAS_MIX( \\
            GAS_MIX(P[3 * ((c) + layer)], P[3 * ((c) + layer) + 3], fz), \\
            GAS_MIX(P[3 * ((c) + layer + row)], P[3 * ((c) + layer + row) + 3], fz), fy), \\
        fx)
#define GAS_AT_MOST(x, low, high) ((x) < (low) ? (low) : (x) > (high) ? (high) : (x))
    const bool turns_x = box.wraps[0] == 1, turns_y = box.wraps[1] == 1, turns_z = box.wraps[2] == 1;
    const float nx = (float)box.nx, ny = (float)box.ny, nz = (float)box.nz, inside = 0.999999f;
    // Along periodic axes only paths that stay inside are followed here; elsewhere a field goes on beyond its last samples.
    const float low_x = turns_x ? 0.5f : 0.0f, low_y = turns_y ? 0.5f : 0.0f, low_z = turns_z ? 0.5f : 0.0f;
    const float high_x = turns_x ? nx - 1.0f : nx, high_y = turns_y ? ny - 1.0f : ny, high_z = turns_z ? nz - 1.0f : nz;
    const float end_x = nx * inside, end_y = ny * inside, end_z = nz * inside;
    const float mid_x = (nx - 1.0f) * inside, mid_y = (ny - 1.0f) * inside, mid_z = (nz - 1.0f) * inside;
    const float* U = (const float*)carrier.data;
    int missed = 0;
"""
_BEND = (
    _BETWEEN
    + """
    const float* V = U + 1;
    const float* W = U + 2;
    float* B = (float*)bend.data;
"""
    + LOOP
    + """
    for (int k = lo; k < hi; ++k) {
        const int c = own + k;
        const float u = 0.5f * (U[3 * c] + U[3 * (c + layer)]), v = 0.5f * (V[3 * c] + V[3 * (c + row)]), w = 0.5f * (W[3 * c] + W[3 * c + 3]);
        const float px = (float)i + 0.5f, py = (float)j + 0.5f, pz = (float)k + 0.5f;
        float x = px + cells * u, y = py + cells * v, z = pz + cells * w;
        const bool good = x >= low_x && y >= low_y && z >= low_z && x < high_x && y < high_y && z < high_z;
        x = good ? x : px;
        y = good ? y : py;
        z = good ? z : pz;
        const float rx = GAS_AT_MOST(x - 0.5f, 0.0f, mid_x), ry = GAS_AT_MOST(y - 0.5f, 0.0f, mid_y), rz = GAS_AT_MOST(z - 0.5f, 0.0f, mid_z);
        x = GAS_AT_MOST(x, 0.0f, end_x);
        y = GAS_AT_MOST(y, 0.0f, end_y);
        z = GAS_AT_MOST(z, 0.0f, end_z);
        const int ix = (int)x, iy = (int)y, iz = (int)z, jx = (int)rx, jy = (int)ry, jz = (int)rz;
        const float fx = x - (float)ix, fy = y - (float)iy, fz = z - (float)iz;
        const float gx = rx - (float)jx, gy = ry - (float)jy, gz = rz - (float)jz;
        const int cu = ix * layer + jy * row + jz, cv = jx * layer + iy * row + jz, cw = jx * layer + jy * row + iz;
        B[3 * c] = good ? GAS_BETWEEN(U, cu, fx, gy, gz) - u : NAN;
        B[3 * c + 1] = GAS_BETWEEN(V, cv, gx, fy, gz) - v;
        B[3 * c + 2] = GAS_BETWEEN(W, cw, gx, gy, fz) - w;
        missed += good ? 0 : 1;
    }
    return missed;
"""
)
_FOLLOW = (
    _BETWEEN
    + """
#define GAS_START(b, beside) \\
    0.25f * (U[3 * c + b] + U[3 * (c + beside) + b] + U[3 * (c - back##b) + b] + U[3 * (c + beside - back##b) + b])
#define GAS_TURN(b) bent * 0.5f * (B[3 * c + b] + B[3 * (c - step) + b])
#define GAS_FOLLOW \\
        const int c = own + k; \\
        const float px = from_x, py = from_y, pz = (float)k + shift_z; \\
        float x = px + cells * (GAS_START(0, beside0) + GAS_TURN(0)); \\
        float y = py + cells * (GAS_START(1, beside1) + GAS_TURN(1)); \\
        float z = pz + cells * (GAS_START(2, beside2) + GAS_TURN(2)); \\
        const bool good = x >= low_x && y >= low_y && z >= low_z && x < high_x && y < high_y && z < high_z; \\
        x = GAS_AT_MOST((good ? x : px) - shift_x, 0.0f, top_x); \\
        y = GAS_AT_MOST((good ? y : py) - shift_y, 0.0f, top_y); \\
        z = GAS_AT_MOST((good ? z : pz) - shift_z, 0.0f, top_z); \\
        const int kx = (int)x, ky = (int)y, kz = (int)z; \\
        const float hx = x - (float)kx, hy = y - (float)ky, hz = z - (float)kz; \\
        const int at = kx * layer + ky * row + kz;
    const float* B = (const float*)bend.data;
    const float shift_x = axis == 0 ? 0.0f : 0.5f, shift_y = axis == 1 ? 0.0f : 0.5f, shift_z = axis == 2 ? 0.0f : 0.5f;
    const float from_x = (float)i + shift_x, from_y = (float)j + shift_y;
    const int step = axis == 0 ? layer : axis == 1 ? row : 1;
    const int beside0 = axis == 0 ? 0 : layer, beside1 = axis == 1 ? 0 : row, beside2 = axis == 2 ? 0 : 1;
    const int back0 = axis == 0 ? 0 : step, back1 = axis == 1 ? 0 : step, back2 = axis == 2 ? 0 : step;
    const float top_x = axis == 0 ? end_x : mid_x, top_y = axis == 1 ? end_y : mid_y, top_z = axis == 2 ? end_z : mid_z;
"""
)

_CARRY = (
    _FOLLOW
    + """
#define GAS_LESS(a, b) ((a) < (b) ? (a) : (b))
#define GAS_MORE(a, b) ((a) > (b) ? (a) : (b))
    const float* S = (const float*)source.data + axis;
    float* O = (float*)out.data + axis;
    float* L = (float*)low.data + axis;
    float* H = (float*)high.data + axis;
"""
    + LOOP
    + """
    for (int k = lo; k < hi; ++k) {
        GAS_FOLLOW
        const float a = S[3 * at], b = S[3 * at + 3], d = S[3 * (at + row)], e = S[3 * (at + row) + 3];
        const float f = S[3 * (at + layer)], g = S[3 * (at + layer) + 3];
        const float h = S[3 * (at + layer + row)], m = S[3 * (at + layer + row) + 3];
        const float found = GAS_MIX(GAS_MIX(GAS_MIX(a, b, hz), GAS_MIX(d, e, hz), hy), GAS_MIX(GAS_MIX(f, g, hz), GAS_MIX(h, m, hz), hy), hx);
        const float ab = GAS_LESS(a, b), de = GAS_LESS(d, e), fg = GAS_LESS(f, g), hm = GAS_LESS(h, m);
        const float ba = GAS_MORE(a, b), ed = GAS_MORE(d, e), gf = GAS_MORE(f, g), mh = GAS_MORE(h, m);
        const float abde = GAS_LESS(ab, de), fghm = GAS_LESS(fg, hm), edba = GAS_MORE(ba, ed), mhgf = GAS_MORE(gf, mh);
        O[3 * c] = good ? found : NAN;
        L[3 * c] = GAS_LESS(abde, fghm);
        H[3 * c] = GAS_MORE(edba, mhgf);
        missed += good ? 0 : 1;
    }
    return missed;
"""
)

_CORRECT = (
    _FOLLOW
    + """
    const float* S = (const float*)source.data + axis;
    const float* F = (const float*)once.data + axis;
    const float* L = (const float*)low.data + axis;
    const float* H = (const float*)high.data + axis;
    float* O = (float*)out.data + axis;
"""
    + LOOP
    + """
    for (int k = lo; k < hi; ++k) {
        GAS_FOLLOW
        const float again = GAS_BETWEEN(F, at, hx, hy, hz);
        const float better = F[3 * c] + 0.5f * (S[3 * c] - again);
        const float least = L[3 * c], most = H[3 * c];
        const float kept = better < least ? least : better > most ? most : better;
        O[3 * c] = good ? kept : NAN;
        missed += good ? 0 : 1;
    }
    return missed;
"""
)


@wp.func_native(_BEND)
def bend_row(
    box: Box, i: int, j: int, own: int, row: int, layer: int, lo: int, hi: int, cells: float, carrier: wp.array(dtype=wp.vec3),
    bend: wp.array(dtype=wp.vec3),
) -> int:  # fmt: skip
    """As `bends`, over a row of cells; the number of cells left out."""


@wp.func_native(_CARRY)
def carry_row(
    box: Box, axis: int, i: int, j: int, own: int, row: int, layer: int, lo: int, hi: int, cells: float,
    bent: float, carrier: wp.array(dtype=wp.vec3), bend: wp.array(dtype=wp.vec3), source: wp.array(dtype=wp.vec3), out: wp.array(dtype=wp.vec3),
    low: wp.array(dtype=wp.vec3), high: wp.array(dtype=wp.vec3),
) -> int:  # fmt: skip
    """Values that faces of a row take from where the flow comes, with the least and greatest around there; the number of faces left out."""


@wp.func_native(_CORRECT)
def correct_row(
    box: Box, axis: int, i: int, j: int, own: int, row: int, layer: int, lo: int, hi: int, cells: float,
    bent: float, carrier: wp.array(dtype=wp.vec3), bend: wp.array(dtype=wp.vec3), source: wp.array(dtype=wp.vec3), once: wp.array(dtype=wp.vec3),
    low: wp.array(dtype=wp.vec3), high: wp.array(dtype=wp.vec3), out: wp.array(dtype=wp.vec3),
) -> int:  # fmt: skip
    """Corrected values of faces of a row; the number of faces left out."""


@wp.func
def from_afar(
    box: Box, axis: int, at: wp.vec3i, c: int, cells: float, carrier: wp.array(dtype=wp.vec3), source: wp.array(dtype=wp.vec3)
):  # fmt: skip
    """Value that a face takes, the least and the greatest around there, also beside the sides of the box."""
    foot = traced(box, carrier, face_place(at, axis), start_speed(box, carrier, c, at, axis), -cells)
    wind = blown_in(box, at, axis)
    found = wp.vec3(wind, wind, wind)
    if wind == 0.0:
        if comes_in(box, foot):
            outer = incoming(box, foot)[axis]
            found = wp.vec3(outer, outer, outer)
        else:
            found = around(box, source, axis, held(box, foot))
    return found


@wp.func
def put(field: wp.array(dtype=wp.vec3), c: int, axis: int, value: float):
    """Write one component."""
    v = field[c]
    v[axis] = value
    field[c] = v


@wp.func
def faces_end(box: Box, axis: int, at: wp.vec4i):
    """End of the cells of a run that have a lower face along an axis."""
    found = wp.min(at[3], box.nz)
    if axis == 2 and box.wraps[2] == 0:
        found = at[3]
    if at[0] >= box.nx and (axis != 0 or box.wraps[0] == 1):
        found = 0
    if at[1] >= box.ny and (axis != 1 or box.wraps[1] == 1):
        found = 0
    return found


@wp.func
def followed(box: Box, axis: int, at: wp.vec4i):
    """The cells of a run whose lower faces along an axis `carry_row` and `correct_row` may follow, from the first to the end: those with
    others all around where the box is periodic, and those that do not lie in a side."""
    found = wp.vec2i(at[2], wp.min(at[3], box.nz))
    for a in range(3):
        n = count_of(box, a)
        least = wp.where(box.wraps[a] == 1 or a == axis, 1, 0)
        most = wp.where(box.wraps[a] == 1, n - 2, n - 1)
        if a < 2:
            if at[a] < least or at[a] > most:
                found[1] = 0
        else:
            found[0] = wp.max(found[0], least)
            found[1] = wp.min(found[1], most + 1)
    return found


@wp.kernel
def bends(first: wp.int32, box: Box, span: int, cells: float, carrier: wp.array(dtype=wp.vec3), bend: wp.array(dtype=wp.vec3)):
    """Excess of the speed half a step back on the path to a cell's middle over that there: paths back and ahead bend by as much, which
    makes them second order in time."""
    at = run_of(box, span, first + wp.tid())
    own = index_of(box, at[0], at[1], 0)
    row = box.nz + 1
    ends = followed(box, -1, at)
    missed = int(0)
    if ends[0] < ends[1]:
        missed = bend_row(box, at[0], at[1], own, row, (box.ny + 1) * row, ends[0], ends[1], -0.5 * cells, carrier, bend)
    if at[0] < box.nx and at[1] < box.ny:
        for k in range(at[2], wp.min(at[3], box.nz)):
            beside = k < ends[0] or k >= ends[1]
            if beside or missed > 0:
                if beside or wp.isnan(bend[own + k][0]):
                    x = wp.vec3(float(at[0]) + 0.5, float(at[1]) + 0.5, float(k) + 0.5)
                    here = speed(box, carrier, x)
                    bend[own + k] = speed(box, carrier, held(box, x - 0.5 * cells * here)) - here


@wp.kernel
def carry(
    first: wp.int32, box: Box, span: int, axes: int, cells: float, carrier: wp.array(dtype=wp.vec3), bend: wp.array(dtype=wp.vec3),
    source: wp.array(dtype=wp.vec3), out: wp.array(dtype=wp.vec3), low: wp.array(dtype=wp.vec3), high: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Every face takes the value from where the flow comes, and the least and greatest around there; `cells` is time over cell size.
    `axes` is 3: the compiler is not to make three of all this."""
    at = run_of(box, span, first + wp.tid())
    own = index_of(box, at[0], at[1], 0)
    row = box.nz + 1
    for axis in range(axes):
        end = faces_end(box, axis, at)
        ends = followed(box, axis, at)
        missed = int(0)
        if ends[0] < ends[1]:
            missed = carry_row(
                box, axis, at[0], at[1], own, row, (box.ny + 1) * row, ends[0], ends[1], -cells, 1.0, carrier, bend, source, out, low, high
            )  # fmt: skip
        else:
            ends = wp.vec2i(end, end)
        k = at[2]
        while k < end:
            if k == ends[0] and missed == 0:
                k = ends[1]
            if k < end:
                c = own + k
                if k < ends[0] or k >= ends[1] or wp.isnan(out[c][axis]):
                    found = from_afar(box, axis, wp.vec3i(at[0], at[1], k), c, cells, carrier, source)
                    put(out, c, axis, found[0])
                    put(low, c, axis, found[1])
                    put(high, c, axis, found[2])
            k += 1


@wp.func
def correct_one(
    box: Box, axis: int, at: wp.vec3i, c: int, cells: float, carrier: wp.array(dtype=wp.vec3), source: wp.array(dtype=wp.vec3),
    once: wp.array(dtype=wp.vec3), low: wp.array(dtype=wp.vec3), high: wp.array(dtype=wp.vec3), out: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """One face of `correct`."""
    ahead = traced(box, carrier, face_place(at, axis), start_speed(box, carrier, c, at, axis), cells)
    value = once[c][axis]
    if not comes_in(box, ahead):
        back = sample(box, once, axis, held(box, ahead))
        value = wp.clamp(value + 0.5 * (source[c][axis] - back), low[c][axis], high[c][axis])
    put(out, c, axis, value)


@wp.kernel
def correct(
    first: wp.int32, box: Box, span: int, axes: int, cells: float, carrier: wp.array(dtype=wp.vec3), bend: wp.array(dtype=wp.vec3),
    source: wp.array(dtype=wp.vec3), once: wp.array(dtype=wp.vec3), low: wp.array(dtype=wp.vec3), high: wp.array(dtype=wp.vec3),
    out: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """The second half of MacCormack: what the way there and back changes is taken out by half, within the values that were carried."""
    at = run_of(box, span, first + wp.tid())
    own = index_of(box, at[0], at[1], 0)
    row = box.nz + 1
    for axis in range(axes):
        end = faces_end(box, axis, at)
        ends = followed(box, axis, at)
        missed = int(0)
        if ends[0] < ends[1]:
            missed = correct_row(
                box, axis, at[0], at[1], own, row, (box.ny + 1) * row, ends[0], ends[1], cells, -1.0, carrier, bend, source, once, low,
                high, out,
            )  # fmt: skip
        else:
            ends = wp.vec2i(end, end)
        k = at[2]
        while k < end:
            if k == ends[0] and missed == 0:
                k = ends[1]
            if k < end:
                c = own + k
                if k < ends[0] or k >= ends[1] or wp.isnan(out[c][axis]):
                    correct_one(box, axis, wp.vec3i(at[0], at[1], k), c, cells, carrier, source, once, low, high, out)
            k += 1
        for k in range(wp.max(at[2], end), at[3]):
            put(out, own + k, axis, 0.0)
