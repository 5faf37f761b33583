# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Vector work on fields of boxes of cells: sums and largest values of blocks of elements, in an order that threads do not change.

Loops are in C, so that compilers turn them into vector instructions; Warp's own (1.19) stay scalar.
"""

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = ["LOOP", "advance", "greatest", "greatest_of_three", "inner", "next_direction"]

LOOP = """
#if defined(__clang__)
#pragma clang loop vectorize(assume_safety)
#endif
"""
"""Before a loop in C whose turns are independent of each other: clang makes vector instructions of it."""
_GREATEST = (
    """
    const float* V = (const float*)values.data;
    int top = 0;
"""
    + LOOP
    + """
    for (int c = lo; c < hi; ++c) {
        union { float number; int bits; } one;
        one.number = V[c];
        const int size = one.bits & 0x7fffffff;  // Sizes of numbers are in the order of their bits.
        top = size > top ? size : top;
    }
    union { int bits; float number; } found;
    found.bits = top;
    return found.number;
"""
)


@wp.func_native(_GREATEST)
def greatest_run(lo: int, hi: int, values: wp.array(dtype=float)) -> float:
    """Largest size of values."""


@wp.func_native(_GREATEST)
def greatest_run_of_three(lo: int, hi: int, values: wp.array(dtype=wp.vec3)) -> float:
    """Largest size of numbers, three an element."""


@wp.kernel
def greatest(first: wp.int32, total: int, block: int, values: wp.array(dtype=float), out: wp.array(dtype=float)):
    """Largest size of blocks of values; one that is no number is the largest of all."""
    b = first + wp.tid()
    out[b] = greatest_run(b * block, wp.min((b + 1) * block, total), values)


@wp.kernel
def greatest_of_three(first: wp.int32, total: int, block: int, values: wp.array(dtype=wp.vec3), out: wp.array(dtype=float)):
    """Largest component of blocks of elements."""
    b = first + wp.tid()
    out[b] = greatest_run_of_three(3 * b * block, 3 * wp.min((b + 1) * block, total), values)


_INNER = """
    // Eight sums side by side, added up at the end.
    double s0 = 0.0, s1 = 0.0, s2 = 0.0, s3 = 0.0, s4 = 0.0, s5 = 0.0, s6 = 0.0, s7 = 0.0;
    const float* A = a.data;
    const float* B = b.data;
    int c = lo;
    for (; c + 8 <= hi; c += 8) {
        s0 += (double)(A[c] * B[c]);
        s1 += (double)(A[c + 1] * B[c + 1]);
        s2 += (double)(A[c + 2] * B[c + 2]);
        s3 += (double)(A[c + 3] * B[c + 3]);
        s4 += (double)(A[c + 4] * B[c + 4]);
        s5 += (double)(A[c + 5] * B[c + 5]);
        s6 += (double)(A[c + 6] * B[c + 6]);
        s7 += (double)(A[c + 7] * B[c + 7]);
    }
    for (; c < hi; ++c)
        s0 += (double)(A[c] * B[c]);
    return ((s0 + s4) + (s1 + s5)) + ((s2 + s6) + (s3 + s7));
"""


@wp.func_native(_INNER)
def inner_run(lo: int, hi: int, a: wp.array(dtype=float), b: wp.array(dtype=float)) -> wp.float64:
    """Sum of products."""


@wp.kernel
def inner(
    first: wp.int32, total: int, block: int, a: wp.array(dtype=float), b: wp.array(dtype=float), sums: wp.array(dtype=wp.float64)
):
    """a b summed over blocks of elements."""
    n = first + wp.tid()
    sums[n] = inner_run(n * block, wp.min((n + 1) * block, total), a, b)


_ADVANCE = (
    """
    const float* P = p.data;
    const float* AP = ap.data;
    float* X = x.data;
    float* R = r.data;
    int top = 0;
"""
    + LOOP
    + """
    for (int c = lo; c < hi; ++c) {
        X[c] += alpha * P[c];
        union { float number; int bits; } left;
        left.number = R[c] - alpha * AP[c];
        R[c] = left.number;
        const int size = left.bits & 0x7fffffff;
        top = size > top ? size : top;
    }
    union { int bits; float number; } found;
    found.bits = top;
    return found.number;
"""
)


@wp.func_native(_ADVANCE)
def advance_run(
    lo: int, hi: int, alpha: float, p: wp.array(dtype=float), ap: wp.array(dtype=float), x: wp.array(dtype=float),
    r: wp.array(dtype=float),
) -> float:  # fmt: skip
    """x += alpha p, r -= alpha A p; largest residual."""


@wp.kernel
def advance(
    first: wp.int32, total: int, block: int, alpha: float, p: wp.array(dtype=float), ap: wp.array(dtype=float),
    x: wp.array(dtype=float), r: wp.array(dtype=float), largest: wp.array(dtype=float),
):  # fmt: skip
    """x += alpha p, r -= alpha A p; largest residual of each block of elements."""
    n = first + wp.tid()
    largest[n] = advance_run(n * block, wp.min((n + 1) * block, total), alpha, p, ap, x, r)


_NEXT = (
    """
    const float* Z = z.data;
    float* P = p.data;
"""
    + LOOP
    + """
    for (int c = lo; c < hi; ++c)
        P[c] = Z[c] + beta * P[c];
"""
)


@wp.func_native(_NEXT)
def next_run(lo: int, hi: int, beta: float, z: wp.array(dtype=float), p: wp.array(dtype=float)):
    """z + beta p."""


@wp.kernel
def next_direction(first: wp.int32, total: int, block: int, beta: float, z: wp.array(dtype=float), p: wp.array(dtype=float)):
    """The next direction, z + beta p."""
    n = first + wp.tid()
    next_run(n * block, wp.min((n + 1) * block, total), beta, z, p)
