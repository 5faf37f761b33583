# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Distances to solids: from meshes and from grids in bodies' frames, kept at half cells; particles pushed out of solids.

Lengths are in cells; the corner of a cell is its lowest one. Owners are rows of boundaries, then of inflows; -1 is the domain.
"""

import warp as wp

from ...grids.columns import Columns, cell_at, place_of, vec6i

wp.set_module_options({"enable_backward": False, "max_unroll": 3})

__all__ = ["FAR", "REACH", "SHELL", "Moving", "Walls", "corner_distances", "push_out", "sample_mesh", "vec8", "wall_speed"]

vec8 = wp.types.vector(length=8, dtype=wp.float32)
FAR = wp.constant(100.0)
SHELL = wp.constant(0.6)
"""Half thickness of a sheet in cells."""
REACH = wp.constant(2.0)
"""Cells whose corner is farther from solids than this are not cut."""
SKIN = wp.constant(0.05)
"""Distance in cells at which particles are kept from solids."""


@wp.struct
class Moving:
    """Distance grids of moving boundaries, each in its body's frame, and where the bodies are [cells]."""

    count: wp.int32
    row: wp.array(dtype=wp.int32)
    first: wp.array(dtype=wp.int32)
    size: wp.array(dtype=wp.vec3i)
    lower: wp.array(dtype=wp.vec3)
    step: wp.array(dtype=float)
    distance: wp.array(dtype=float)
    position: wp.array(dtype=wp.vec3)
    rotation: wp.array(dtype=wp.mat33)
    box_low: wp.array(dtype=wp.vec3)
    box_high: wp.array(dtype=wp.vec3)


@wp.struct
class Walls:
    """Motion of owners: velocity of the centre [m/s], angular velocity [1/s], centre [cells]; size of a cell [m]."""

    velocity: wp.array(dtype=wp.vec3)
    spin: wp.array(dtype=wp.vec3)
    center: wp.array(dtype=wp.vec3)
    cell: float


@wp.func
def wall_speed(walls: Walls, owner: int, x: wp.vec3):
    """Velocity of an owner's material at a point [m/s]."""
    v = wp.vec3()
    if owner >= 0:
        v = walls.velocity[owner] + walls.cell * wp.cross(walls.spin[owner], x - walls.center[owner])
    return v


@wp.func
def mesh_distance(mesh: wp.uint64, sheet: wp.uint64, x: wp.vec3, shell: float):
    """Signed distance and nearest face; faces of sheets come as -2 - face."""
    d = float(FAR)
    face = int(-1)
    if mesh != wp.uint64(0):
        q = wp.mesh_query_point_sign_winding_number(mesh, x, 1.0e6, 2.0, 0.5)
        if q.result:
            p = wp.mesh_eval_position(mesh, q.face, q.u, q.v)
            d = q.sign * wp.length(x - p)
            face = q.face
    if sheet != wp.uint64(0):
        q = wp.mesh_query_point_no_sign(sheet, x, 1.0e6)
        if q.result:
            p = wp.mesh_eval_position(sheet, q.face, q.u, q.v)
            e = wp.length(x - p) - shell
            if e < d:
                d = e
                face = -2 - q.face
    return wp.vec2(d, float(face))


@wp.kernel
def sample_mesh(
    first: wp.int32, mesh: wp.uint64, sheet: wp.uint64, lower: wp.vec3, step: float, size: wp.vec3i, shell: float, offset: int,
    distance: wp.array(dtype=float),
):  # fmt: skip
    """Signed distances at the nodes of a box."""
    n = first + wp.tid()
    i = n // (size[1] * size[2])
    j = (n // size[2]) % size[1]
    k = n % size[2]
    x = lower + step * wp.vec3(float(i), float(j), float(k))
    d = mesh_distance(mesh, sheet, x, shell)
    distance[offset + n] = d[0]


@wp.func
def moving_distance(moving: Moving, m: int, x: wp.vec3):
    """Distance of a point to a moving boundary; beyond its grid, at least that to the grid."""
    local = wp.transpose(moving.rotation[m]) * (x - moving.position[m])
    t = (local - moving.lower[m]) / moving.step[m]
    n = moving.size[m]
    out = float(0.0)
    for d in range(3):
        top = float(n[d] - 1) - 1.0e-3
        if t[d] < 0.0:
            out = wp.max(out, -t[d])
            t[d] = 0.0
        if t[d] > top:
            out = wp.max(out, t[d] - top)
            t[d] = top
    i = int(t[0])
    j = int(t[1])
    k = int(t[2])
    fx = t[0] - float(i)
    fy = t[1] - float(j)
    fz = t[2] - float(k)
    s = moving.first[m] + (i * n[1] + j) * n[2] + k
    a = n[1] * n[2]
    b = n[2]
    c00 = moving.distance[s] * (1.0 - fx) + moving.distance[s + a] * fx
    c01 = moving.distance[s + 1] * (1.0 - fx) + moving.distance[s + a + 1] * fx
    c10 = moving.distance[s + b] * (1.0 - fx) + moving.distance[s + a + b] * fx
    c11 = moving.distance[s + b + 1] * (1.0 - fx) + moving.distance[s + a + b + 1] * fx
    d0 = c00 * (1.0 - fy) + c10 * fy
    d1 = c01 * (1.0 - fy) + c11 * fy
    return d0 * (1.0 - fz) + d1 * fz + out * moving.step[m]


@wp.func
def owner_at(found: wp.vec2, mesh_owner: wp.array(dtype=wp.int32), sheet_owner: wp.array(dtype=wp.int32)):
    """Owner of the face that `mesh_distance` found."""
    face = int(found[1])
    who = int(-1)
    if face >= 0:
        who = mesh_owner[face]
    if face <= -2:
        who = sheet_owner[-2 - face]
    return who


@wp.func
def face_slot(s: int):
    """Place in a cell's owners of one of its eight points: the corner (0), centres of the lower faces (1 to 3), none (-1)."""
    slot = int(-1)
    if s == 0:
        slot = 0
    if s == 3:
        slot = 1
    if s == 5:
        slot = 2
    if s == 6:
        slot = 3
    return slot


@wp.kernel
def corner_distances(
    first: wp.int32, grid: Columns, before: Columns, reuse: int, mesh: wp.uint64, sheet: wp.uint64,
    mesh_owner: wp.array(dtype=wp.int32), sheet_owner: wp.array(dtype=wp.int32), fixed_before: wp.array(dtype=vec8),
    fixed_owner_before: wp.array(dtype=wp.vec4i), moving: Moving, fixed: wp.array(dtype=vec8),
    fixed_owner: wp.array(dtype=wp.vec4i), points: wp.array(dtype=vec8), owner: wp.array(dtype=wp.vec4i),
    mover: wp.array(dtype=wp.vec4i),
):  # fmt: skip
    """Distance to the nearest solid at a cell's corner and at the seven points half a cell beyond it; whose solid is nearest to the corner and to the
    centres of the cell's three lower faces, and which moving one, -1 for none.

    Distances to fixed solids are kept from step to step.
    """
    c = first + wp.tid()
    at = place_of(grid, c)
    x = wp.vec3(float(at[0]), float(at[1]), float(at[2]))
    d = vec8()
    for s in range(8):
        d[s] = float(FAR)
    who = wp.vec4i(-1, -1, -1, -1)
    if mesh != wp.uint64(0) or sheet != wp.uint64(0):
        known = int(-1)
        if reuse == 1:
            known = cell_at(before, at[0], at[1], at[2])
        if known >= 0:
            d = fixed_before[known]
            who = fixed_owner_before[known]
        else:
            found = mesh_distance(mesh, sheet, x, SHELL)
            one = owner_at(found, mesh_owner, sheet_owner)
            who = wp.vec4i(one, one, one, one)
            for s in range(8):
                d[s] = found[0]
                if s > 0 and wp.abs(found[0]) < REACH:
                    y = x + 0.5 * wp.vec3(float(s // 4), float((s // 2) % 2), float(s % 2))
                    more = mesh_distance(mesh, sheet, y, SHELL)
                    d[s] = more[0]
                    slot = face_slot(s)
                    if slot > 0:
                        who[slot] = owner_at(more, mesh_owner, sheet_owner)
    fixed[c] = d
    fixed_owner[c] = who
    nearest = wp.vec4(float(FAR), float(FAR), float(FAR), float(FAR))
    mine = wp.vec4i(-1, -1, -1, -1)
    for m in range(moving.count):
        low = moving.box_low[m]
        high = moving.box_high[m]
        if x[0] > low[0] and x[1] > low[1] and x[2] > low[2] and x[0] < high[0] and x[1] < high[1] and x[2] < high[2]:
            e = moving_distance(moving, m, x)
            for s in range(8):
                f = float(e)
                if s > 0 and wp.abs(e) < REACH:
                    y = x + 0.5 * wp.vec3(float(s // 4), float((s // 2) % 2), float(s % 2))
                    f = moving_distance(moving, m, y)
                slot = face_slot(s)
                if slot >= 0:
                    if f < nearest[slot]:
                        nearest[slot] = f
                        mine[slot] = moving.row[m]
                    if f < d[s]:
                        who[slot] = moving.row[m]
                d[s] = wp.min(d[s], f)
    points[c] = d
    owner[c] = who
    mover[c] = mine


@wp.func
def point_distance(grid: Columns, points: wp.array(dtype=vec8), i: int, j: int, k: int):
    """Distance at a point of the lattice of half cells; far beyond the grid."""
    c = cell_at(grid, i // 2, j // 2, k // 2)
    if c < 0:
        return float(FAR)
    return points[c][4 * (i % 2) + 2 * (j % 2) + k % 2]


@wp.func
def near_distance(grid: Columns, points: wp.array(dtype=vec8), x: wp.vec3):
    """Distance and its gradient [per half cell] at a point, from the corners of the half cell around it; far where one is missing."""
    i = int(wp.floor(2.0 * x[0]))
    j = int(wp.floor(2.0 * x[1]))
    k = int(wp.floor(2.0 * x[2]))
    fx = 2.0 * x[0] - float(i)
    fy = 2.0 * x[1] - float(j)
    fz = 2.0 * x[2] - float(k)
    a0 = point_distance(grid, points, i, j, k)
    b0 = point_distance(grid, points, i, j + 1, k)
    c0 = point_distance(grid, points, i + 1, j, k)
    d0 = point_distance(grid, points, i + 1, j + 1, k)
    at = point_distance(grid, points, i, j, k + 1)
    bt = point_distance(grid, points, i, j + 1, k + 1)
    ct = point_distance(grid, points, i + 1, j, k + 1)
    dt = point_distance(grid, points, i + 1, j + 1, k + 1)
    if wp.max(wp.max(wp.max(a0, b0), wp.max(c0, d0)), wp.max(wp.max(at, bt), wp.max(ct, dt))) >= FAR:
        return wp.vec4(0.0, 0.0, 0.0, float(FAR))
    x0 = (1.0 - fy) * ((1.0 - fz) * a0 + fz * at) + fy * ((1.0 - fz) * b0 + fz * bt)
    x1 = (1.0 - fy) * ((1.0 - fz) * c0 + fz * ct) + fy * ((1.0 - fz) * d0 + fz * dt)
    y0 = (1.0 - fx) * ((1.0 - fz) * a0 + fz * at) + fx * ((1.0 - fz) * c0 + fz * ct)
    y1 = (1.0 - fx) * ((1.0 - fz) * b0 + fz * bt) + fx * ((1.0 - fz) * d0 + fz * dt)
    z0 = (1.0 - fx) * ((1.0 - fy) * a0 + fy * b0) + fx * ((1.0 - fy) * c0 + fy * d0)
    z1 = (1.0 - fx) * ((1.0 - fy) * at + fy * bt) + fx * ((1.0 - fy) * ct + fy * dt)
    return wp.vec4(x1 - x0, y1 - y0, z1 - z0, z0 * (1.0 - fz) + z1 * fz)


@wp.kernel
def push_out(
    first: wp.int32, grid: Columns, points: wp.array(dtype=vec8), owner: wp.array(dtype=wp.vec4i), walls: Walls,
    cells_per_speed: float, lower: wp.vec3, upper: wp.vec3, sides: vec6i, position: wp.array(dtype=wp.vec4),
    velocity: wp.array(dtype=wp.vec4),
):  # fmt: skip
    """Particles inside solids go to the nearest point outside, where the solid will be at the end of the step.

    Drops, which feel no pressure (the fourth component of velocity), lose their velocity into the solid: no face does that for them.
    """
    p = first + wp.tid()
    q = position[p]
    x = wp.vec3(q[0], q[1], q[2])
    c = cell_at(grid, int(wp.floor(x[0])), int(wp.floor(x[1])), int(wp.floor(x[2])))
    if c >= 0:
        if points[c][0] < 4.0:
            shift = cells_per_speed * wall_speed(walls, owner[c][0], x)
            moved = int(0)
            v = velocity[p]
            for _turn in range(2):
                g = near_distance(grid, points, x - shift)
                if g[3] < SKIN:
                    n = wp.normalize(wp.vec3(g[0], g[1], g[2]))
                    x = x + (SKIN - g[3]) * n
                    moved = 1
                    if v[3] == 0.0:
                        into = wp.dot(wp.vec3(v[0], v[1], v[2]) - wall_speed(walls, owner[c][0], x), n)
                        if into < 0.0:
                            v = v - into * wp.vec4(n[0], n[1], n[2], 0.0)
            if moved == 1:
                velocity[p] = v
                for axis in range(3):
                    if sides[2 * axis] == 0:
                        x[axis] = wp.max(x[axis], lower[axis] + 0.001)
                    if sides[2 * axis + 1] == 0:
                        x[axis] = wp.min(x[axis], upper[axis] - 0.001)
                position[p] = wp.vec4(x[0], x[1], x[2], q[3])
