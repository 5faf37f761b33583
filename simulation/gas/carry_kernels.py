# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Velocities of faces, carried by a flow (MacCormack, Selle et al. 2008, doi:10.1007/s10915-007-9166-4).

Faces of a row are followed by loops in C, which compilers turn into vector instructions (as in `sweep_kernels.py`). They leave no number
where a path leaves the box, and those faces, and those in its sides, are worked out one by one. Components are held in planes meanwhile,
shape (3, elements): what follows each other along z then lies side by side, and eight are loaded at once.
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
from .plane_kernels import join_row

wp.set_module_options({"enable_backward": False})

__all__ = ["bends", "carry", "correct"]

_BETWEEN = """
#define GAS_MIX(a, b, f) ((a) + (f) * ((b) - (a)))
#define GAS_BETWEEN(P, c, fx, fy, fz) \\
    GAS_MIX( \\
        GAS_MIX(GAS_MIX(P[c], P[(c) + 1], fz), GAS_MIX(P[(c) + row], P[(c) + row + 1], fz), fy), \\
        GAS_MIX( \\
            GAS_MIX(P[(c) + layer], P[(c) + layer + 1], fz), \\
            GAS_MIX(P[(c) + layer + row], P[(c) + layer + row + 1], fz), fy), \\
        fx)
#define GAS_AT_MOST(x, low, high) ((x) < (low) ? (low) : (x) > (high) ? (high) : (x))
    const bool turns_x = box.wraps[0] == 1, turns_y = box.wraps[1] == 1, turns_z = box.wraps[2] == 1;
    const float nx = (float)box.nx, ny = (float)box.ny, nz = (float)box.nz, inside = 0.999999f;
    // Along periodic axes only paths that stay inside are followed here; elsewhere a field goes on beyond its last samples.
    const float low_x = turns_x ? 0.5f : 0.0f, low_y = turns_y ? 0.5f : 0.0f, low_z = turns_z ? 0.5f : 0.0f;
    const float high_x = turns_x ? nx - 1.0f : nx, high_y = turns_y ? ny - 1.0f : ny, high_z = turns_z ? nz - 1.0f : nz;
    const float end_x = nx * inside, end_y = ny * inside, end_z = nz * inside;
    const float mid_x = (nx - 1.0f) * inside, mid_y = (ny - 1.0f) * inside, mid_z = (nz - 1.0f) * inside;
    const int plane = (box.nx + 1) * layer;
    const float* U = carrier.data;
    const float* V = U + plane;
    const float* W = V + plane;
    int missed = 0;
"""
_BEND = (
    _BETWEEN
    + """
    float* A = bend.data;
    float* B = A + plane;
    float* D = B + plane;
"""
    + LOOP
    + """
    for (int k = lo; k < hi; ++k) {
        const int c = own + k;
        const float u = 0.5f * (U[c] + U[c + layer]), v = 0.5f * (V[c] + V[c + row]), w = 0.5f * (W[c] + W[c + 1]);
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
        A[c] = good ? GAS_BETWEEN(U, cu, fx, gy, gz) - u : NAN;
        B[c] = GAS_BETWEEN(V, cv, gx, fy, gz) - v;
        D[c] = GAS_BETWEEN(W, cw, gx, gy, fz) - w;
        missed += good ? 0 : 1;
    }
    return missed;
"""
)
_FOLLOW = (
    _BETWEEN
    + """
    // With the first cell of a row, whose lower face is worked out once more, eight at a time come out even.
#define GAS_START(P, beside, back) 0.25f * (P[c] + P[c + beside] + P[c - back] + P[c + beside - back])
#define GAS_TURN(P) bent * 0.5f * (P[c] + P[c - step])
#define GAS_FOLLOW \\
        const int c = own + k; \\
        const float px = from_x, py = from_y, pz = (float)k + shift_z; \\
        float x = px + cells * (GAS_START(U, beside0, back0) + GAS_TURN(A)); \\
        float y = py + cells * (GAS_START(V, beside1, back1) + GAS_TURN(B)); \\
        float z = pz + cells * (GAS_START(W, beside2, back2) + GAS_TURN(D)); \\
        const bool good = x >= low_x && y >= low_y && z >= low_z && x < high_x && y < high_y && z < high_z; \\
        x = GAS_AT_MOST((good ? x : px) - shift_x, 0.0f, top_x); \\
        y = GAS_AT_MOST((good ? y : py) - shift_y, 0.0f, top_y); \\
        z = GAS_AT_MOST((good ? z : pz) - shift_z, 0.0f, top_z); \\
        const int kx = (int)x, ky = (int)y, kz = (int)z; \\
        const float hx = x - (float)kx, hy = y - (float)ky, hz = z - (float)kz; \\
        const int at = kx * layer + ky * row + kz;
    const float* A = bend.data;
    const float* B = A + plane;
    const float* D = B + plane;
    const float shift_x = axis == 0 ? 0.0f : 0.5f, shift_y = axis == 1 ? 0.0f : 0.5f, shift_z = axis == 2 ? 0.0f : 0.5f;
    const float from_x = (float)i + shift_x, from_y = (float)j + shift_y;
    const int step = axis == 0 ? layer : axis == 1 ? row : 1, from = hi - lo > 8 && lo == 1 ? 0 : lo;
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
    const float* S = source.data + axis * plane;
    float* O = out.data + axis * plane;
    float* L = low.data + axis * plane;
    float* H = high.data + axis * plane;
"""
    + LOOP
    + """
    for (int k = from; k < hi; ++k) {
        GAS_FOLLOW
        const float a = S[at], b = S[at + 1], d = S[at + row], e = S[at + row + 1];
        const float f = S[at + layer], g = S[at + layer + 1], h = S[at + layer + row], m = S[at + layer + row + 1];
        const float found = GAS_MIX(GAS_MIX(GAS_MIX(a, b, hz), GAS_MIX(d, e, hz), hy), GAS_MIX(GAS_MIX(f, g, hz), GAS_MIX(h, m, hz), hy), hx);
        const float ab = GAS_LESS(a, b), de = GAS_LESS(d, e), fg = GAS_LESS(f, g), hm = GAS_LESS(h, m);
        const float ba = GAS_MORE(a, b), ed = GAS_MORE(d, e), gf = GAS_MORE(f, g), mh = GAS_MORE(h, m);
        const float abde = GAS_LESS(ab, de), fghm = GAS_LESS(fg, hm), edba = GAS_MORE(ba, ed), mhgf = GAS_MORE(gf, mh);
        O[c] = good ? found : NAN;
        L[c] = GAS_LESS(abde, fghm);
        H[c] = GAS_MORE(edba, mhgf);
        missed += good || k < lo ? 0 : 1;
    }
    return missed;
"""
)

_CORRECT = (
    _FOLLOW
    + """
    const float* S = source.data + axis * plane;
    const float* F = once.data + axis * plane;
    const float* L = low.data + axis * plane;
    const float* H = high.data + axis * plane;
    float* O = better.data + axis * plane;
"""
    + LOOP
    + """
    for (int k = from; k < hi; ++k) {
        GAS_FOLLOW
        const float again = GAS_BETWEEN(F, at, hx, hy, hz);
        const float next = F[c] + 0.5f * (S[c] - again);
        const float least = L[c], most = H[c];
        const float kept = next < least ? least : next > most ? most : next;
        O[c] = good ? kept : NAN;
        missed += good || k < lo ? 0 : 1;
    }
    return missed;
"""
)


@wp.func_native(_BEND)
def bend_row(
    box: Box, i: int, j: int, own: int, row: int, layer: int, lo: int, hi: int, cells: float, carrier: wp.array2d(dtype=float),
    bend: wp.array2d(dtype=float),
) -> int:  # fmt: skip
    """As `bends`, over a row of cells; the number of cells left out."""


@wp.func_native(_CARRY)
def carry_row(
    box: Box, axis: int, i: int, j: int, own: int, row: int, layer: int, lo: int, hi: int, cells: float,
    bent: float, carrier: wp.array2d(dtype=float), bend: wp.array2d(dtype=float), source: wp.array2d(dtype=float), out: wp.array2d(dtype=float),
    low: wp.array2d(dtype=float), high: wp.array2d(dtype=float),
) -> int:  # fmt: skip
    """Values that faces of a row take from where the flow comes, with the least and greatest around there; the number of faces left out."""


@wp.func_native(_CORRECT)
def correct_row(
    box: Box, axis: int, i: int, j: int, own: int, row: int, layer: int, lo: int, hi: int, cells: float,
    bent: float, carrier: wp.array2d(dtype=float), bend: wp.array2d(dtype=float), source: wp.array2d(dtype=float), once: wp.array2d(dtype=float),
    low: wp.array2d(dtype=float), high: wp.array2d(dtype=float), better: wp.array2d(dtype=float),
) -> int:  # fmt: skip
    """Corrected values of faces of a row; the number of faces left out."""


@wp.func
def from_afar(
    box: Box, axis: int, at: wp.vec3i, c: int, cells: float, carrier: wp.array2d(dtype=float), source: wp.array2d(dtype=float)
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
def bends(first: wp.int32, box: Box, span: int, cells: float, carrier: wp.array2d(dtype=float), bend: wp.array2d(dtype=float)):
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
                if beside or wp.isnan(bend[0, own + k]):
                    x = wp.vec3(float(at[0]) + 0.5, float(at[1]) + 0.5, float(k) + 0.5)
                    here = speed(box, carrier, x)
                    found = speed(box, carrier, held(box, x - 0.5 * cells * here)) - here
                    for axis in range(3):
                        bend[axis, own + k] = found[axis]


@wp.kernel
def carry(
    first: wp.int32, box: Box, span: int, axes: int, cells: float, carrier: wp.array2d(dtype=float), bend: wp.array2d(dtype=float),
    source: wp.array2d(dtype=float), out: wp.array2d(dtype=float), low: wp.array2d(dtype=float), high: wp.array2d(dtype=float),
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
                if k < ends[0] or k >= ends[1] or wp.isnan(out[axis, c]):
                    found = from_afar(box, axis, wp.vec3i(at[0], at[1], k), c, cells, carrier, source)
                    out[axis, c] = found[0]
                    low[axis, c] = found[1]
                    high[axis, c] = found[2]
            k += 1


@wp.func
def correct_one(
    box: Box, axis: int, at: wp.vec3i, c: int, cells: float, carrier: wp.array2d(dtype=float), source: wp.array2d(dtype=float),
    once: wp.array2d(dtype=float), low: wp.array2d(dtype=float), high: wp.array2d(dtype=float),
):  # fmt: skip
    """One face of `correct`."""
    ahead = traced(box, carrier, face_place(at, axis), start_speed(box, carrier, c, at, axis), cells)
    value = once[axis, c]
    if not comes_in(box, ahead):
        back = sample(box, once, axis, held(box, ahead))
        value = wp.clamp(value + 0.5 * (source[axis, c] - back), low[axis, c], high[axis, c])
    return value


@wp.kernel
def correct(
    first: wp.int32, box: Box, span: int, axes: int, cells: float, carrier: wp.array2d(dtype=float), bend: wp.array2d(dtype=float),
    source: wp.array2d(dtype=float), once: wp.array2d(dtype=float), low: wp.array2d(dtype=float), high: wp.array2d(dtype=float),
    better: wp.array2d(dtype=float), out: wp.array(dtype=wp.vec3),
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
                high, better,
            )  # fmt: skip
        else:
            ends = wp.vec2i(end, end)
        k = at[2]
        while k < end:
            if k == ends[0] and missed == 0:
                k = ends[1]
            if k < end:
                c = own + k
                if k < ends[0] or k >= ends[1] or wp.isnan(better[axis, c]):
                    better[axis, c] = correct_one(
                        box, axis, wp.vec3i(at[0], at[1], k), c, cells, carrier, source, once, low, high
                    )
            k += 1
        for k in range(wp.max(at[2], end), at[3]):
            better[axis, own + k] = 0.0
    join_row(own + at[2], own + at[3], (box.nx + 1) * (box.ny + 1) * row, better, out)
