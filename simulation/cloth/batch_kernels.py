# mypy: ignore-errors
"""Warp kernels that begin a batch of steps on a GPU, and keep what it changes so that it can be taken back."""

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = ["begin", "expect", "keep"]


@wp.kernel
def keep(
    first: wp.int32,
    sheets: wp.int32,
    x: wp.array(dtype=wp.vec3d),
    v: wp.array(dtype=wp.vec3d),
    u: wp.array(dtype=wp.vec3d),
    reaction: wp.array(dtype=wp.vec3d),
    held_back: wp.array(dtype=wp.vec3d),
    kept_x: wp.array(dtype=wp.vec3d),
    kept_v: wp.array(dtype=wp.vec3d),
    kept_u: wp.array(dtype=wp.vec3d),
    kept_reaction: wp.array(dtype=wp.vec3d),
    kept_back: wp.array(dtype=wp.vec3d),
):
    """Copy what steps change."""
    i = first + wp.tid()
    kept_x[i] = x[i]
    kept_u[i] = u[i]
    if i < sheets:
        kept_v[i] = v[i]
        kept_reaction[i] = reaction[i]
        kept_back[i] = held_back[i]


@wp.kernel
def begin(
    first: wp.int32,
    sheets: wp.int32,
    aims: wp.array(dtype=wp.float64),
    x: wp.array(dtype=wp.vec3d),
    v: wp.array(dtype=wp.vec3d),
    clock: wp.array(dtype=wp.float64),
    reach: wp.array(dtype=wp.float64),
    span: wp.array(dtype=wp.float64),
    allowed: wp.array(dtype=wp.float64),
    anchor: wp.array(dtype=wp.vec3d),
    plan: wp.array(dtype=wp.vec3d),
    u: wp.array(dtype=wp.vec3d),
    part: wp.array(dtype=wp.float64),
    many: wp.array(dtype=wp.int32),
    sums: wp.array(dtype=wp.int64),
    book: wp.array(dtype=wp.int64),
):
    """Vertices are expected to go on as they do; nothing is found, pressed or given yet. `aims`: step and time [s] since bodies' states were given; reaches of the search [m] within sheets and for
    solids; its span [s]; how far vertices may stray [m]."""
    k = first + wp.tid()
    if k < book.shape[0]:
        book[k] = wp.int64(0)
    if k == 0:
        clock[0] = aims[0]
        clock[1] = aims[1]
        clock[2] = wp.float64(0.0)
        reach[0] = aims[2]
        reach[1] = aims[3]
        span[0] = aims[4]
        allowed[0] = aims[5]
    if k < many.shape[0]:
        many[k] = 0
        for c in range(3):
            sums[3 * k + c] = wp.int64(0)
    if k < sheets:
        part[k] = wp.float64(1.0)
        anchor[k] = x[k]
        plan[k] = v[k]
        u[k] = v[k]


@wp.kernel
def expect(first: wp.int32, u: wp.array(dtype=wp.vec3d), plan: wp.array(dtype=wp.vec3d)):
    """Vertices that bodies lead are expected to go where these do."""
    i = first + wp.tid()
    plan[i] = u[i]
