# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Forces on faces: buoyancy, viscosity, vorticity confinement (Fedkiw, Stam and Jensen 2001, doi:10.1145/383259.383260)."""

import warp as wp

from .box_kernels import Box, along, count_of, has_face, index_of, is_cell, place_of, row_at, run_of, upper

wp.set_module_options({"enable_backward": False})

__all__ = ["buoy", "confine", "curl", "middle", "spread"]


_BUOY = """
    const float* R = density.data;
    float* V = (float*)velocity.data + axis;
#if defined(__clang__)
#pragma clang loop vectorize(assume_safety)
#endif
    for (int k = lo; k < hi; ++k) {
        const float rho = 0.5f * (R[lower + k] + R[own + k]);
        V[3 * (own + k)] += push * (rho - 1.0f) / (expands == 1 ? rho : 1.0f);
    }
"""


@wp.func_native(_BUOY)
def buoy_row(
    own: int, lower: int, lo: int, hi: int, axis: int, push: float, expands: int, density: wp.array(dtype=float),
    velocity: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Buoyancy on the lower faces of a row of cells."""


@wp.kernel
def buoy(
    first: wp.int32, box: Box, span: int, gravity: wp.vec3, seconds: float, expands: int, density: wp.array(dtype=float),
    velocity: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Gravity less that of the ambient air; divided by the density where that counts, else by the ambient one (Boussinesq)."""
    at = run_of(box, span, first + wp.tid())
    own = index_of(box, at[0], at[1], 0)
    for axis in range(3):
        ends = wp.vec3i(box.nx, box.ny, box.nz)
        if box.wraps[axis] == 0:
            ends[axis] = ends[axis] + 1
        if gravity[axis] != 0.0 and at[0] < ends[0] and at[1] < ends[1]:
            lo = at[2]
            hi = wp.min(at[3], ends[2])
            lower = own - 1
            push = seconds * gravity[axis]
            if axis < 2:
                lower = row_at(box, axis, at[0], at[1], -1)
            elif box.wraps[2] == 1 and lo == 0:
                buoy_row(own, own + box.nz - 1, 0, 1, axis, push, expands, density, velocity)
                lo = 1
            buoy_row(own, lower, lo, hi, axis, push, expands, density, velocity)


@wp.kernel
def spread(
    first: wp.int32, box: Box, number: float, no_slip: wp.array(dtype=wp.int32), velocity: wp.array(dtype=wp.vec3),
    out: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Viscosity over a step of `number` = viscosity time / cell^2; sides without slip hold the gas beside them, others let it pass."""
    c = first + wp.tid()
    at = place_of(box, c)
    v = velocity[c]
    for axis in range(3):
        if has_face(box, at, axis):
            here = velocity[c][axis]
            total = float(0.0)
            for side in range(6):
                a = side // 2
                step = 2 * (side - 2 * a) - 1
                n = count_of(box, a)
                last = n - 1
                if a == axis and box.wraps[a] == 0:
                    last = n
                x = at[a] + step
                if box.wraps[a] == 1:
                    x = (x + n) % n
                if x >= 0 and x <= last:
                    to = at
                    to[a] = x
                    total += velocity[index_of(box, to[0], to[1], to[2])][axis] - here
                elif a != axis and no_slip[side] == 1:
                    total += -2.0 * here
            v[axis] = here + number * total
    out[c] = v


@wp.func
def middle(box: Box, velocity: wp.array(dtype=wp.vec3), at: wp.vec3i):
    """Velocity at the centre of a cell, clamped to the box or repeated."""
    i = along(box, 0, 0, at[0])
    j = along(box, 1, 0, at[1])
    k = along(box, 2, 0, at[2])
    c = index_of(box, i, j, k)
    here = wp.vec3i(i, j, k)
    v = velocity[c]
    return 0.5 * wp.vec3(
        v[0] + velocity[upper(box, here, 0)][0], v[1] + velocity[upper(box, here, 1)][1], v[2] + velocity[upper(box, here, 2)][2]
    )


@wp.kernel
def curl(first: wp.int32, box: Box, size: float, velocity: wp.array(dtype=wp.vec3), out: wp.array(dtype=wp.vec3)):
    """Vorticity at the centres of cells [1/s]."""
    c = first + wp.tid()
    at = place_of(box, c)
    w = wp.vec3(0.0, 0.0, 0.0)
    if is_cell(box, at):
        dx = middle(box, velocity, at + wp.vec3i(1, 0, 0)) - middle(box, velocity, at - wp.vec3i(1, 0, 0))
        dy = middle(box, velocity, at + wp.vec3i(0, 1, 0)) - middle(box, velocity, at - wp.vec3i(0, 1, 0))
        dz = middle(box, velocity, at + wp.vec3i(0, 0, 1)) - middle(box, velocity, at - wp.vec3i(0, 0, 1))
        w = wp.vec3(dy[2] - dz[1], dz[0] - dx[2], dx[1] - dy[0]) / (2.0 * size)
    out[c] = w


@wp.kernel
def confine(first: wp.int32, box: Box, push: float, vorticity: wp.array(dtype=wp.vec3), velocity: wp.array(dtype=wp.vec3)):
    """Vorticity confinement: `push` is strength times cell size times time [m s]; the force at a face is that of the mean of its cells."""
    c = first + wp.tid()
    at = place_of(box, c)
    v = velocity[c]
    for axis in range(3):
        if has_face(box, at, axis):
            total = float(0.0)
            for s in range(2):
                to = at
                to[axis] = at[axis] - s
                i = along(box, 0, 0, to[0])
                j = along(box, 1, 0, to[1])
                k = along(box, 2, 0, to[2])
                g = wp.vec3(0.0, 0.0, 0.0)
                for a in range(3):
                    up = wp.vec3i(i, j, k)
                    down = wp.vec3i(i, j, k)
                    up[a] = along(box, a, 0, up[a] + 1)
                    down[a] = along(box, a, 0, down[a] - 1)
                    g[a] = wp.length(vorticity[index_of(box, up[0], up[1], up[2])]) - wp.length(
                        vorticity[index_of(box, down[0], down[1], down[2])]
                    )
                n = g / (wp.length(g) + 1.0e-12)
                total += wp.cross(n, vorticity[index_of(box, i, j, k)])[axis]
            v[axis] = v[axis] + 0.5 * push * total
    velocity[c] = v
