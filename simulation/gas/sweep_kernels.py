# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Sweeps of amounts along one axis, as loops in C over runs of cells that follow each other in memory, which compilers turn into vector
instructions: on a CPU a thread takes a row along z, on a GPU a cell (`span`). Warp's own loops (1.19) stay scalar.

Amounts, concentrations and fluxes are planes of floats, one after the other: quantity q of element c is at q elements + c. What a row finds
beyond the box are its elements that are no cells: they hold nothing and have no slope.

Less than 1e-30 of anything passes no face: tails that thin out forever would else end in numbers below 1.2e-38, with which processors are
some hundred times slower. Sums stay exact, since what does not pass is kept.
"""

import warp as wp

from .box_kernels import Box, count_of, index_of, near, row_at, run_of

wp.set_module_options({"enable_backward": False})

__all__ = ["crossed", "fluxes", "settle", "shares", "smooth"]

_FLUX = """
#define GAS_SLOPE(e, a0, a1, a2, a3) \\
    const float x##e = up ? a1 - a0 : a2 - a1, y##e = up ? a2 - a1 : a3 - a2; \\
    const float ax##e = x##e < 0.0f ? -x##e : x##e, ay##e = y##e < 0.0f ? -y##e : y##e; \\
    const float least##e = 2.0f * (ax##e < ay##e ? ax##e : ay##e), mean##e = 0.5f * (ax##e + ay##e); \\
    const float size##e = least##e < mean##e ? least##e : mean##e; \\
    const float slope##e = x##e > 0.0f && y##e > 0.0f ? size##e : x##e < 0.0f && y##e < 0.0f ? -size##e : 0.0f; \\
    const float here##e = up ? a1 : a2, edge##e = here##e + reach * slope##e;
#define GAS_PASS(x) ((x) > 1.0e-30f || (x) < -1.0e-30f ? (x) : 0.0f)
#define GAS_REACH \\
    const float pass = T[k]; \\
    const bool up = pass > 0.0f; \\
    const float held = up ? V1[k] : V2[k]; \\
    float spent = (up ? pass : -pass) / (held > 1.0e-9f ? held : 1.0e-9f); \\
    spent = spent < 1.0f ? spent : 1.0f; \\
    const float reach = 0.5f * (1.0f - spent) * (up ? M1[k] : -M2[k]);
    const float* T = through.data + face;
    const float* V1 = volume.data + lower;
    const float* V2 = volume.data + own;
    const float* M1 = slopes.data + lower;
    const float* M2 = slopes.data + own;
    const float* S = share.data;
    float* F = moved.data + face;
    if (planes == 2) {
#if defined(__clang__)
#pragma clang loop vectorize(assume_safety)
#endif
        for (int k = lo; k < hi; ++k) {
            GAS_REACH
            GAS_SLOPE(0, S[below + k], S[lower + k], S[own + k], S[upper + k])
            GAS_SLOPE(1, S[elements + below + k], S[elements + lower + k], S[elements + own + k], S[elements + upper + k])
            F[k] = GAS_PASS(pass * edge0);
            F[elements + k] = GAS_PASS(pass * edge1);
        }
    } else {
        const float* S2 = S + 2 * elements;
        const float* S3 = S + 3 * elements;
#if defined(__clang__)
#pragma clang loop vectorize(assume_safety)
#endif
        for (int k = lo; k < hi; ++k) {
            GAS_REACH
            GAS_SLOPE(0, S[below + k], S[lower + k], S[own + k], S[upper + k])
            GAS_SLOPE(1, S[elements + below + k], S[elements + lower + k], S[elements + own + k], S[elements + upper + k])
            GAS_SLOPE(2, S2[below + k], S2[lower + k], S2[own + k], S2[upper + k])
            GAS_SLOPE(3, S3[below + k], S3[lower + k], S3[own + k], S3[upper + k])
            const bool whole = density == 0.0f || density * (1.0f - edge0) >= edge2 + edge3;
            F[k] = GAS_PASS(pass * (whole ? edge0 : here0));
            F[elements + k] = GAS_PASS(pass * (whole ? edge1 : here1));
            F[2 * elements + k] = GAS_PASS(pass * (whole ? edge2 : here2));
            F[3 * elements + k] = GAS_PASS(pass * (whole ? edge3 : here3));
        }
    }
"""


@wp.func_native(_FLUX)
def flux_row(
    below: int, lower: int, own: int, upper: int, face: int, lo: int, hi: int, elements: int, planes: int, density: float,
    through: wp.array(dtype=float), slopes: wp.array(dtype=float), volume: wp.array(dtype=float), share: wp.array(dtype=float),
    moved: wp.array(dtype=float),
):  # fmt: skip
    """Fluxes through the lower faces of a row of cells from `lo` to `hi`; the others are first elements of the rows around these."""


_SETTLE = """
    const float* T1 = through.data + own;
    const float* T2 = through.data + upper;
    float* V = volume.data + own;
#if defined(__clang__)
#pragma clang loop vectorize(assume_safety)
#endif
    for (int k = lo; k < hi; ++k)
        V[k] += T1[k] - T2[k];
    for (int q = 0; q < planes; ++q) {
        const float* F1 = moved.data + q * elements + own;
        const float* F2 = moved.data + q * elements + upper;
        float* A = amount.data + q * elements + own;
        float* S = share.data + q * elements + own;
#if defined(__clang__)
#pragma clang loop vectorize(assume_safety)
#endif
        for (int k = lo; k < hi; ++k) {
            const float kept = A[k] + (F1[k] - F2[k]);
            A[k] = kept;
            S[k] = kept / (V[k] > 1.0e-9f ? V[k] : 1.0e-9f);
        }
    }
"""


@wp.func_native(_SETTLE)
def settle_row(
    own: int, upper: int, lo: int, hi: int, elements: int, planes: int, through: wp.array(dtype=float),
    moved: wp.array(dtype=float), amount: wp.array(dtype=float), volume: wp.array(dtype=float), share: wp.array(dtype=float),
):  # fmt: skip
    """Volumes, amounts and concentrations of a row of cells after what passed its faces."""


@wp.kernel
def fluxes(
    first: wp.int32, box: Box, span: int, axis: int, planes: int, elements: int, through: wp.array(dtype=float),
    slopes: wp.array(dtype=float), volume: wp.array(dtype=float), share: wp.array(dtype=float), moved: wp.array(dtype=float),
):  # fmt: skip
    """Amounts that pass the lower faces of all elements along one axis with the volumes that do, each once for the cells on both sides.

    Concentrations at faces are second order (slopes limited, monotonized central, van Leer 1977, doi:10.1016/0021-9991(77)90095-X), in the
    mean over what passes.
    """
    at = run_of(box, span, first + wp.tid())
    own = index_of(box, at[0], at[1], 0)
    lo = at[2]
    hi = at[3]
    if axis < 2:
        below = row_at(box, axis, at[0], at[1], -2)
        lower = row_at(box, axis, at[0], at[1], -1)
        higher = row_at(box, axis, at[0], at[1], 1)
        flux_row(
            below, lower, own, higher, own, lo, hi, elements, planes, box.density, through, slopes, volume, share, moved
        )  # fmt: skip
    else:
        # Beside a row's ends lie elements that hold nothing; only the first row has none below.
        free = int(box.wraps[2] == 0 and own > 0)
        start = wp.where(free == 1 or lo > 2, lo, 2)
        end = wp.where(free == 1 or hi < box.nz - 1, hi, box.nz - 1)
        flux_row(
            own - 2, own - 1, own, own + 1, own, start, end, elements, planes, box.density, through, slopes, volume, share, moved
        )
        if free == 0:
            for k in range(lo, hi):
                if k < 2 or k >= box.nz - 1:
                    below = own - k + near(box.nz, box.wraps[2], k - 2)
                    lower = own - k + near(box.nz, box.wraps[2], k - 1)
                    higher = own - k + near(box.nz, box.wraps[2], k + 1)
                    flux_row(
                        below, lower, own, higher, own, k, k + 1, elements, planes, box.density, through, slopes, volume, share, moved
                    )  # fmt: skip


@wp.kernel
def settle(
    first: wp.int32, box: Box, span: int, axis: int, planes: int, elements: int, through: wp.array(dtype=float),
    moved: wp.array(dtype=float), amount: wp.array(dtype=float), volume: wp.array(dtype=float), share: wp.array(dtype=float),
):  # fmt: skip
    """Amounts, volume and concentrations of each cell after what passed its two faces along one axis."""
    at = run_of(box, span, first + wp.tid())
    if at[0] < box.nx and at[1] < box.ny:
        own = index_of(box, at[0], at[1], 0)
        lo = at[2]
        hi = wp.where(at[3] < box.nz, at[3], box.nz)
        if axis < 2:
            # The upper faces of the last cells are elements of their own, or the first ones again.
            a = at[0]
            b = at[1]
            if axis == 0:
                a = wp.where(box.wraps[0] == 1 and a == box.nx - 1, 0, a + 1)
            else:
                b = wp.where(box.wraps[1] == 1 and b == box.ny - 1, 0, b + 1)
            settle_row(own, index_of(box, a, b, 0), lo, hi, elements, planes, through, moved, amount, volume, share)
        else:
            end = wp.where(box.wraps[2] == 1 and hi == box.nz, hi - 1, hi)
            settle_row(own, own + 1, lo, end, elements, planes, through, moved, amount, volume, share)
            if end < hi:
                c = own + end
                volume[c] = volume[c] + through[c] - through[own]
                for q in range(planes):
                    kept = amount[q * elements + c] + (moved[q * elements + c] - moved[q * elements + own])
                    amount[q * elements + c] = kept
                    share[q * elements + c] = kept / wp.max(volume[c], 1.0e-9)


@wp.kernel
def smooth(first: wp.int32, box: Box, axis: int, opening: wp.array(dtype=wp.vec3), slopes: wp.array(dtype=float)):
    """1 where a cell has neighbours on both sides along an axis, through open faces: its concentrations then have a slope."""
    c = first + wp.tid()
    row = c // (box.nz + 1)
    at = wp.vec3i(row // (box.ny + 1), row - (row // (box.ny + 1)) * (box.ny + 1), c - row * (box.nz + 1))
    found = float(0.0)
    if at[0] < box.nx and at[1] < box.ny and at[2] < box.nz:
        n = count_of(box, axis)
        if box.wraps[axis] == 1 or (at[axis] > 0 and at[axis] < n - 1):
            to = at
            to[axis] = at[axis] + 1
            if to[axis] == n:
                to[axis] = 0
            if opening[c][axis] > 0.0 and opening[index_of(box, to[0], to[1], to[2])][axis] > 0.0:
                found = 1.0
    slopes[c] = found


_VOLUMES = """
    const float* U = (const float*)velocity.data;
    const float* O = (const float*)opening.data;
    for (int axis = 0; axis < 3; ++axis) {
        float* T = (axis == 0 ? x.data : axis == 1 ? y.data : z.data);
#if defined(__clang__)
#pragma clang loop vectorize(assume_safety)
#endif
        for (int c = lo; c < hi; ++c)
            T[c] = cells * U[3 * c + axis] * O[3 * c + axis];
    }
"""


@wp.func_native(_VOLUMES)
def volume_run(
    lo: int, hi: int, cells: float, velocity: wp.array(dtype=wp.vec3), opening: wp.array(dtype=wp.vec3),
    x: wp.array(dtype=float), y: wp.array(dtype=float), z: wp.array(dtype=float),
):  # fmt: skip
    """Volumes through the lower faces of elements along the three axes."""


@wp.kernel
def crossed(
    first: wp.int32, box: Box, span: int, cells: float, velocity: wp.array(dtype=wp.vec3), opening: wp.array(dtype=wp.vec3),
    x: wp.array(dtype=float), y: wp.array(dtype=float), z: wp.array(dtype=float),
):  # fmt: skip
    """Volumes that are to pass through lower faces, in cells; `cells` is time over cell size."""
    at = run_of(box, span, first + wp.tid())
    own = index_of(box, at[0], at[1], 0)
    volume_run(own + at[2], own + at[3], cells, velocity, opening, x, y, z)


_SHARES = """
    const float* Q = (const float*)state.data;
    for (int q = 0; q < planes; ++q) {
        float* A = amount.data + q * elements;
        float* S = share.data + q * elements;
        float* V = volume.data;
        const float* R = room.data;
#if defined(__clang__)
#pragma clang loop vectorize(assume_safety)
#endif
        for (int c = lo; c < hi; ++c) {
            const float kept = Q[4 * c + q] * R[c];
            V[c] = R[c];
            A[c] = kept;
            S[c] = kept / (R[c] > 1.0e-9f ? R[c] : 1.0e-9f);
        }
    }
"""


@wp.func_native(_SHARES)
def share_run(
    lo: int, hi: int, elements: int, planes: int, room: wp.array(dtype=float), state: wp.array(dtype=wp.vec4),
    amount: wp.array(dtype=float), volume: wp.array(dtype=float), share: wp.array(dtype=float),
):  # fmt: skip
    """Amounts, volumes and concentrations of elements."""


@wp.kernel
def shares(
    first: wp.int32, box: Box, span: int, elements: int, planes: int, room: wp.array(dtype=float), state: wp.array(dtype=wp.vec4),
    amount: wp.array(dtype=float), volume: wp.array(dtype=float), share: wp.array(dtype=float),
):  # fmt: skip
    """Amounts, volume and concentrations of each cell before the sweeps."""
    at = run_of(box, span, first + wp.tid())
    own = index_of(box, at[0], at[1], 0)
    share_run(own + at[2], own + at[3], elements, planes, room, state, amount, volume, share)
