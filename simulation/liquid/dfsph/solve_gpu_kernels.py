# mypy: ignore-errors
"""The two passes of an iteration of the pressure solves over packed lists on a GPU; `solve_kernels.py` says what they compute.

They wait for memory. So eight neighbours are on their way at once, accelerations are read as four numbers at a time, and the sums of an
iteration leave a warp as one row.
"""

import warp as wp

from .solve_kernels import BETA, OMEGA, Sums

wp.set_module_options({"enable_backward": False})

__all__ = ["WARP", "accelerate", "relax"]

WARP = 32
"""Threads that run as one and sum what they have."""
WARP_SIZE = wp.constant(WARP)

LIST = """
    constexpr int B = 4;
    const int2* list = reinterpret_cast<const int2*>(near.data) + at;
    int2 w[B], next[B];
    #define LOAD(b, k) next[b] = k + b < count ? __ldg(list + size_t(k + b) * stride) : make_int2(0, 0)
    #define INDEX(b) (w[b].x & 4194303)
    #define X(b) (float)(((w[b].y << 28) >> 18) | ((w[b].x >> 22) & 1023))
    #define Y(b) (float)((w[b].y << 14) >> 18)
    #define Z(b) (float)(w[b].y >> 18)
"""
"""Four neighbours of a packed list (`list_kernels.py`), read while a loop works on the last four; what is beyond its end weighs nothing."""
END = """
    #undef LOAD
    #undef INDEX
    #undef X
    #undef Y
    #undef Z
"""
PUSHED = f"""
    float x = 0.0f, y = 0.0f, z = 0.0f;
#if defined(__CUDA_ARCH__)
    {LIST}
    #pragma unroll
    for (int b = 0; b < B; ++b) LOAD(b, 0);
    for (int k = 0; k < count; k += B) {{
        float s[B];
        #pragma unroll
        for (int b = 0; b < B; ++b) {{ w[b] = next[b]; LOAD(b, k + B); }}
        #pragma unroll
        for (int b = 0; b < B; ++b) s[b] = __ldg(p.data + INDEX(b));
        #pragma unroll
        for (int b = 0; b < B; ++b) {{ x += s[b] * X(b); y += s[b] * Y(b); z += s[b] * Z(b); }}
    }}
    {END}
#endif
    return wp::vec_t<3, wp::float32>(x, y, z);
"""
SPREAD = f"""
    float s = 0.0f;
#if defined(__CUDA_ARCH__)
    {LIST}
    #pragma unroll
    for (int b = 0; b < B; ++b) LOAD(b, 0);
    for (int k = 0; k < count; k += B) {{
        float4 one[B];
        #pragma unroll
        for (int b = 0; b < B; ++b) {{ w[b] = next[b]; LOAD(b, k + B); }}
        #pragma unroll
        for (int b = 0; b < B; ++b) one[b] = __ldg(reinterpret_cast<const float4*>(a.data) + INDEX(b));
        #pragma unroll
        for (int b = 0; b < B; ++b) s += one[b].x * X(b) + one[b].y * Y(b) + one[b].z * Z(b);
    }}
    {END}
#endif
    return s;
"""
PUT = """
#if defined(__CUDA_ARCH__)
    reinterpret_cast<float4*>(a.data)[i] = make_float4(value[0], value[1], value[2], 0.0f);
#endif
"""
OF_WARP = """
#if defined(__CUDA_ARCH__)
    for (int step = 16; step > 0; step /= 2) value += __shfl_down_sync(0xffffffffu, value, step);
#endif
    return value;
"""
Floats, Vectors, List = wp.array(dtype=wp.float32), wp.array(dtype=wp.vec4), wp.array(dtype=wp.vec2i)


@wp.func_native(PUSHED)
def pushed(p: Floats, near: List, at: wp.int32, stride: wp.int32, count: wp.int32) -> wp.vec3:
    """Sum of pressures times gradients over a list, in units."""


@wp.func_native(SPREAD)
def spread(a: Vectors, near: List, at: wp.int32, stride: wp.int32, count: wp.int32) -> wp.float32:
    """Sum of accelerations along gradients over a list, in units."""


@wp.func_native(PUT)
def put(a: Vectors, i: wp.int32, value: wp.vec3):
    """Write a vector and a zero at once."""


@wp.func_native(OF_WARP)
def of_warp(value: wp.float32) -> wp.float32:
    """Sum over the threads of a warp, in its first one."""


@wp.kernel
def accelerate(
    first: wp.int32,
    p: Floats,
    lightness: Floats,
    lean: wp.array(dtype=wp.vec3),
    count: wp.array(dtype=wp.int32),
    near: List,
    row: wp.int32,
    stride: wp.int32,
    unit: wp.float32,
    a: Vectors,
):
    """Acceleration by pressure [m/s^2], and a zero."""
    i = first + wp.tid()
    s = pushed(p, near, i * row, stride, count[i])
    put(a, i, -lightness[i] * (p[i] * lean[i] + unit * s))


@wp.kernel
def relax(
    first: wp.int32,
    total: wp.int32,
    a: Vectors,
    lean: wp.array(dtype=wp.vec3),
    count: wp.array(dtype=wp.int32),
    near: List,
    row: wp.int32,
    stride: wp.int32,
    unit: wp.float32,
    bodies: Floats,
    stiffness: Floats,
    b: Floats,
    volume: Floats,
    settings: Floats,
    p: Floats,
    y: Floats,
    last_y: Floats,
    last_r: Floats,
    sums: wp.array(dtype=Sums),
):
    """One accelerated step of `total` particles by whole warps of threads; `sums` takes a row of each warp.

    What was read is used before it is written over: stores to lines that were still on their way made the pass 2.5 times as long.
    """
    i = first + wp.tid()
    r = wp.float32(0.0)
    was = wp.float32(0.0)
    mine = Sums()
    if i < total:
        s = spread(a, near, i * row, stride, count[i])
        own = a[i]
        r = b[i] + wp.dot(wp.vec3(own[0], own[1], own[2]), lean[i]) - bodies[i] - unit * s
        old = p[i]
        was = y[i]
        change = was - last_y[i]
        stiff = stiffness[i]
        weight = volume[i] * stiff
        fresh = wp.float32(0.0)
        if stiff > 0.0:
            fresh = wp.max(was + settings[OMEGA] * r / stiff, 0.0)
        left = wp.max(r, 0.0)
        if was > 0.0:
            left = wp.abs(r)
        mine = Sums(
            wp.max(r, 0.0),
            left,
            weight * (was - fresh) * (fresh - old),
            volume[i] * change * (last_r[i] - r),
            weight * change * change,
        )
        p[i] = fresh
        y[i] = fresh + settings[BETA] * (fresh - old)
    of_all = Sums(of_warp(mine[0]), of_warp(mine[1]), of_warp(mine[2]), of_warp(mine[3]), of_warp(mine[4]))
    if i % WARP_SIZE == 0:
        sums[i / WARP_SIZE] = of_all
    if i < total:
        last_y[i] = was
        last_r[i] = r
