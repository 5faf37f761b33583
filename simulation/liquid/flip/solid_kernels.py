# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Solids on the grid: signed distances at the corners of cells, cut faces, velocities that walls prescribe, wrenches.

Lengths are in cells; the corner of a cell is its lowest one. Owners are rows of boundaries, then of inflows; -1 is the domain.
"""

import warp as wp

from .column_kernels import Columns, cell_at, place_of, vec6i

wp.set_module_options({"enable_backward": False, "max_unroll": 3})

__all__ = [
    "FAR",
    "Moving",
    "Walls",
    "constrain",
    "corner_distances",
    "cut_faces",
    "momentum",
    "near_solid",
    "open_mouths",
    "push_out",
    "push_rows",
    "rub",
    "sample_mesh",
    "touching",
    "vec6d",
    "wall_speed",
    "wrench",
]  # fmt: skip

vec6 = wp.types.vector(length=6, dtype=wp.float32)
vec8 = wp.types.vector(length=8, dtype=wp.float32)
vec27 = wp.types.vector(length=27, dtype=wp.float32)
vec6d = wp.types.vector(length=6, dtype=wp.float64)
FAR = wp.constant(100.0)
SHELL = wp.constant(0.6)
"""Half thickness of a sheet in cells."""
LEAST = wp.constant(0.02)
"""As `grid_kernels.LEAST_OPEN`."""
ALIKE = wp.constant(0.2)
"""Product of two cells' gradients below which a face between them crosses a wall."""
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
def face_center(at: wp.vec3i, axis: int):
    """Centre of a cell's lower face."""
    x = wp.vec3(float(at[0]) + 0.5, float(at[1]) + 0.5, float(at[2]) + 0.5)
    x[axis] = x[axis] - 0.5
    return x


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


@wp.kernel
def corner_distances(
    first: wp.int32, grid: Columns, before: Columns, reuse: int, mesh: wp.uint64, sheet: wp.uint64,
    mesh_owner: wp.array(dtype=wp.int32), sheet_owner: wp.array(dtype=wp.int32), fixed_before: wp.array(dtype=vec8),
    fixed_owner_before: wp.array(dtype=wp.int32), moving: Moving, fixed: wp.array(dtype=vec8),
    fixed_owner: wp.array(dtype=wp.int32), points: wp.array(dtype=vec8), distance: wp.array(dtype=float),
    owner: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Distance to the nearest solid at a cell's corner and at the seven points half a cell beyond it; the corner's owner.

    Distances to fixed solids are kept from step to step.
    """
    c = first + wp.tid()
    at = place_of(grid, c)
    x = wp.vec3(float(at[0]), float(at[1]), float(at[2]))
    d = vec8()
    for s in range(8):
        d[s] = float(FAR)
    who = int(-1)
    if mesh != wp.uint64(0) or sheet != wp.uint64(0):
        known = int(-1)
        if reuse == 1:
            known = cell_at(before, at[0], at[1], at[2])
        if known >= 0:
            d = fixed_before[known]
            who = fixed_owner_before[known]
        else:
            found = mesh_distance(mesh, sheet, x, SHELL)
            face = int(found[1])
            if face >= 0:
                who = mesh_owner[face]
            if face <= -2:
                who = sheet_owner[-2 - face]
            for s in range(8):
                d[s] = found[0]
                if s > 0 and wp.abs(found[0]) < REACH:
                    y = x + 0.5 * wp.vec3(float(s // 4), float((s // 2) % 2), float(s % 2))
                    more = mesh_distance(mesh, sheet, y, SHELL)
                    d[s] = more[0]
    fixed[c] = d
    fixed_owner[c] = who
    for m in range(moving.count):
        low = moving.box_low[m]
        high = moving.box_high[m]
        if x[0] > low[0] and x[1] > low[1] and x[2] > low[2] and x[0] < high[0] and x[1] < high[1] and x[2] < high[2]:
            e = moving_distance(moving, m, x)
            if e < d[0]:
                who = moving.row[m]
            for s in range(8):
                f = float(e)
                if s > 0 and wp.abs(e) < REACH:
                    y = x + 0.5 * wp.vec3(float(s // 4), float((s // 2) % 2), float(s % 2))
                    f = moving_distance(moving, m, y)
                d[s] = wp.min(d[s], f)
    points[c] = d
    distance[c] = d[0]
    owner[c] = who


@wp.func
def corner_part(a: float, b: float, c: float, d: float):
    """Share of a tetrahedron on a's side of a linear cut that parts a from the others."""
    return (a / (a - b)) * (a / (a - c)) * (a / (a - d))


@wp.func
def wedge_part(a: float, b: float, c: float, d: float):
    """Share of a tetrahedron on the side of a and b of a linear cut that parts them from c and d."""
    ac = a / (a - c)
    ad = a / (a - d)
    bc = b / (b - c)
    bd = b / (b - d)
    return bc * bd + ac * ad * (1.0 - bd) + ac * bd * (1.0 - bc)


@wp.func
def open_part(a: float, b: float, c: float, d: float):
    """Share of a tetrahedron where the linear function with these corner values is positive."""
    mask = int(0)
    if a > 0.0:
        mask += 1
    if b > 0.0:
        mask += 2
    if c > 0.0:
        mask += 4
    if d > 0.0:
        mask += 8
    result = float(0.0)
    if mask == 15:
        result = 1.0
    elif mask == 1:
        result = corner_part(a, b, c, d)
    elif mask == 2:
        result = corner_part(b, a, c, d)
    elif mask == 4:
        result = corner_part(c, a, b, d)
    elif mask == 8:
        result = corner_part(d, a, b, c)
    elif mask == 14:
        result = 1.0 - corner_part(a, b, c, d)
    elif mask == 13:
        result = 1.0 - corner_part(b, a, c, d)
    elif mask == 11:
        result = 1.0 - corner_part(c, a, b, d)
    elif mask == 7:
        result = 1.0 - corner_part(d, a, b, c)
    elif mask == 3:
        result = wedge_part(a, b, c, d)
    elif mask == 5:
        result = wedge_part(a, c, b, d)
    elif mask == 9:
        result = wedge_part(a, d, b, c)
    elif mask == 6:
        result = wedge_part(b, c, a, d)
    elif mask == 10:
        result = wedge_part(b, d, a, c)
    elif mask == 12:
        result = wedge_part(c, d, a, b)
    return result


@wp.func
def box_part(a: float, b: float, c: float, d: float, e: float, f: float, g: float, h: float):
    """Open share of a box with distances a b / c d at the corners of its lower side and e f / g h above; six tetrahedra."""
    low = wp.min(wp.min(wp.min(a, b), wp.min(c, d)), wp.min(wp.min(e, f), wp.min(g, h)))
    high = wp.max(wp.max(wp.max(a, b), wp.max(c, d)), wp.max(wp.max(e, f), wp.max(g, h)))
    result = float(1.0)
    if high <= 0.0:
        result = 0.0
    elif low <= 0.0:
        result = (
            open_part(a, b, d, h) + open_part(a, b, f, h) + open_part(a, c, d, h)
            + open_part(a, c, g, h) + open_part(a, e, f, h) + open_part(a, e, g, h)
        ) / 6.0  # fmt: skip
    return result


@wp.func
def value_at(field: wp.array(dtype=float), c: int):
    """A corner's distance; far where the cell does not exist."""
    if c < 0:
        return float(FAR)
    return field[c]


@wp.func
def step_to(near: wp.array(dtype=vec6i), c: int, side: int):
    """The neighbour of a cell, -1 without."""
    if c < 0:
        return -1
    return near[c][side]


@wp.kernel
def find_halves(
    first: wp.int32, near: wp.array(dtype=vec6i), points: wp.array(dtype=vec8), halves: wp.array(dtype=vec6),
    room: wp.array(dtype=float), solid: wp.array(dtype=float),
):  # fmt: skip
    """Open share of the lower and upper half of a cell along each axis, from its eight octants; distance at its centre."""
    c = first + wp.tid()
    own = points[c]
    solid[c] = own[7]
    h = vec6()
    for s in range(6):
        h[s] = 1.0
        if own[7] < 0.0:
            h[s] = 0.0
    if wp.abs(own[7]) < REACH:
        v = vec27()
        x = near[c][1]
        y = near[c][3]
        xy = step_to(near, x, 3)
        for a in range(2):
            for b in range(2):
                base = c
                if a == 1 and b == 0:
                    base = x
                if a == 0 and b == 1:
                    base = y
                if a == 1 and b == 1:
                    base = xy
                for d in range(2):
                    n = base
                    if d == 1:
                        n = step_to(near, base, 5)
                    p = own
                    if n >= 0:
                        p = points[n]
                    for s in range(8):
                        i = 2 * a + s // 4
                        j = 2 * b + (s // 2) % 2
                        k = 2 * d + s % 2
                        if i < 3 and j < 3 and k < 3:
                            v[9 * i + 3 * j + k] = p[s]
        for s in range(6):
            h[s] = 0.0
        for s in range(8):
            i = s // 4
            j = (s // 2) % 2
            k = s % 2
            n = 9 * i + 3 * j + k
            part = 0.25 * box_part(v[n], v[n + 9], v[n + 3], v[n + 12], v[n + 1], v[n + 10], v[n + 4], v[n + 13])
            h[i] = h[i] + part
            h[2 + j] = h[2 + j] + part
            h[4 + k] = h[4 + k] + part
    halves[c] = h
    room[c] = room[c] * 0.5 * (h[0] + h[1])


@wp.kernel
def cut_faces(
    first: wp.int32, near: wp.array(dtype=vec6i), distance: wp.array(dtype=float), owner: wp.array(dtype=wp.int32),
    halves: wp.array(dtype=vec6), opening: wp.array(dtype=wp.vec3), face_owner: wp.array(dtype=wp.vec3i),
):  # fmt: skip
    """Reduce open shares by solids; owner of each face's solid part.

    The share of a face is that of the box of one cell around its centre (Batty et al. 2007), so that pressure pushes a body as
    far out as its surface lies, not as the cells do.
    """
    c = first + wp.tid()
    h = halves[c]
    share = wp.vec3()
    who = wp.vec3i(-1, -1, -1)
    for axis in range(3):
        o = near[c][2 * axis]
        part = h[2 * axis]
        if o >= 0:
            part = 0.5 * (part + halves[o][2 * axis + 1])
        share[axis] = part
        if part < 1.0:
            best = float(FAR)
            w = int(-1)
            p = near[c][1]
            q = near[c][3]
            if axis == 0:
                p = near[c][5]
            if axis == 1:
                q = near[c][5]
            r = int(-1)
            if p >= 0:
                if axis == 0:
                    r = near[p][3]
                elif axis == 1:
                    r = near[p][5]
                else:
                    r = near[p][3]
            for s in range(4):
                n = c
                if s == 1:
                    n = p
                if s == 2:
                    n = q
                if s == 3:
                    n = r
                if n >= 0:
                    if distance[n] < best:
                        best = distance[n]
                        w = owner[n]
            who[axis] = w
    opening[c] = wp.cw_mul(opening[c], share)
    face_owner[c] = who


@wp.func
def rise(near: wp.array(dtype=vec6i), solid: wp.array(dtype=float), c: int):
    """Gradient of the distance to solids at a cell's centre, by central differences."""
    g = wp.vec3()
    for axis in range(3):
        low = near[c][2 * axis]
        high = near[c][2 * axis + 1]
        if low >= 0 and high >= 0:
            g[axis] = 0.5 * (solid[high] - solid[low])
    return g


@wp.kernel
def close_thin(first: wp.int32, near: wp.array(dtype=vec6i), solid: wp.array(dtype=float), opening: wp.array(dtype=wp.vec3)):
    """Faces across a thin wall are closed: the nearest surfaces of their two cells do not look the same way."""
    c = first + wp.tid()
    share = opening[c]
    for axis in range(3):
        o = near[c][2 * axis]
        if o >= 0 and share[axis] < 1.0:
            if solid[c] < 0.0 or solid[o] < 0.0:
                if wp.dot(rise(near, solid, c), rise(near, solid, o)) < ALIKE:
                    share[axis] = 0.0
    opening[c] = share


@wp.kernel
def near_solid(
    first: wp.int32, grid: Columns, solid: wp.array(dtype=float), halves: wp.array(dtype=vec6), spread: wp.array(dtype=float)
):
    """Room around a cell's centre, weighted as density is: 1/8, 3/4, 1/8 along each axis."""
    c = first + wp.tid()
    if solid[c] < 2.5:
        at = place_of(grid, c)
        total = float(0.0)
        for a in range(-1, 2):
            for b in range(-1, 2):
                for d in range(-1, 2):
                    w = float(1.0)
                    if a == 0:
                        w = w * 6.0
                    if b == 0:
                        w = w * 6.0
                    if d == 0:
                        w = w * 6.0
                    n = cell_at(grid, at[0] + a, at[1] + b, at[2] + d)
                    if n >= 0:
                        total += w * 0.5 * (halves[n][0] + halves[n][1])
                    else:
                        total += w
        spread[c] = spread[c] * total / 512.0


@wp.kernel
def open_mouths(
    first: wp.int32, grid: Columns, count: int, base: int, center: wp.array(dtype=wp.vec3), rotation: wp.array(dtype=wp.mat33),
    half: wp.array(dtype=wp.vec3), opening: wp.array(dtype=wp.vec3), face_owner: wp.array(dtype=wp.vec3i),
):  # fmt: skip
    """Faces in the mouth of an inflow have its speed. The third component of `half` is 1 for a disc, -1 for one that is shut."""
    c = first + wp.tid()
    at = place_of(grid, c)
    share = opening[c]
    who = face_owner[c]
    for axis in range(3):
        x = face_center(at, axis)
        for m in range(count):
            h = half[m]
            if h[2] >= 0.0:
                y = wp.transpose(rotation[m]) * (x - center[m])
                inside = wp.abs(y[0]) <= h[0] and wp.abs(y[1]) <= h[1]
                if h[2] > 0.5:
                    inside = (y[0] / h[0]) * (y[0] / h[0]) + (y[1] / h[1]) * (y[1] / h[1]) <= 1.0
                if inside and y[2] >= -1.0 and y[2] <= 0.51 and share[axis] > LEAST:
                    share[axis] = 0.0
                    who[axis] = base + m
    opening[c] = share
    face_owner[c] = who


@wp.kernel
def touching(
    first: wp.int32, near: wp.array(dtype=vec6i), cell: wp.array(dtype=wp.int32), opening: wp.array(dtype=wp.vec3),
    flag: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Rows with a face that is not fully open."""
    r = first + wp.tid()
    c = cell[r]
    hit = int(0)
    for side in range(6):
        face = c
        if side % 2 == 1:
            face = near[c][side]
        if face >= 0:
            if opening[face][side // 2] < 1.0:
                hit = 1
    flag[r] = hit


@wp.kernel
def list_rows(
    first: wp.int32, flag: wp.array(dtype=wp.int32), before: wp.array(dtype=wp.int32), touched: wp.array(dtype=wp.int32)
):
    """Flagged rows, one after the other."""
    r = first + wp.tid()
    if flag[r] == 1:
        touched[before[r]] = r


@wp.func
def shut(share: float):
    """Solid share of a face."""
    if share < LEAST:
        return 1.0
    return 1.0 - share


@wp.kernel
def wrench(
    first: wp.int32, grid: Columns, near: wp.array(dtype=vec6i), cell: wp.array(dtype=wp.int32),
    touched: wp.array(dtype=wp.int32), count: int, block: int, blocks: int, owners: wp.array(dtype=wp.int32),
    opening: wp.array(dtype=wp.vec3), face_owner: wp.array(dtype=wp.vec3i), walls: Walls, q: wp.array(dtype=float),
    sums: wp.array(dtype=vec6d),
):  # fmt: skip
    """Sum of q over the solid shares of faces: along axes, and about the owner's centre [cells], for one owner and block of rows."""
    n = first + wp.tid()
    who = owners[n // blocks]
    b = n % blocks
    about = wp.vec3()
    if who >= 0:
        about = walls.center[who]
    total = vec6d()
    for t in range(b * block, wp.min((b + 1) * block, count)):
        r = touched[t]
        c = cell[r]
        at = place_of(grid, c)
        for side in range(6):
            axis = side // 2
            face = c
            sign = float(-1.0)
            if side % 2 == 1:
                face = near[c][side]
                sign = 1.0
            if face >= 0:
                s = shut(opening[face][axis])
                if s > 0.0 and face_owner[face][axis] == who:
                    f = wp.vec3()
                    f[axis] = sign * s * q[r]
                    x = face_center(at, axis)
                    if side % 2 == 1:
                        x[axis] = x[axis] + 1.0
                    m = wp.cross(x - about, f)
                    total += vec6d(
                        wp.float64(f[0]), wp.float64(f[1]), wp.float64(f[2]),
                        wp.float64(m[0]), wp.float64(m[1]), wp.float64(m[2]),
                    )  # fmt: skip
    sums[n] = total


@wp.kernel
def push_rows(
    first: wp.int32, grid: Columns, near: wp.array(dtype=vec6i), cell: wp.array(dtype=wp.int32),
    touched: wp.array(dtype=wp.int32), opening: wp.array(dtype=wp.vec3), face_owner: wp.array(dtype=wp.vec3i), walls: Walls,
    y: wp.array(dtype=float), scale: float,
):  # fmt: skip
    """Add the flux that moving walls give to each touching cell."""
    r = touched[first + wp.tid()]
    c = cell[r]
    at = place_of(grid, c)
    total = float(0.0)
    for side in range(6):
        axis = side // 2
        face = c
        sign = float(-1.0)
        if side % 2 == 1:
            face = near[c][side]
            sign = 1.0
        if face >= 0:
            s = shut(opening[face][axis])
            if s > 0.0 and face_owner[face][axis] >= 0:
                x = face_center(at, axis)
                if side % 2 == 1:
                    x[axis] = x[axis] + 1.0
                total += sign * s * wall_speed(walls, face_owner[face][axis], x)[axis]
    y[r] = y[r] + scale * total


@wp.kernel
def constrain(
    first: wp.int32, grid: Columns, near: wp.array(dtype=vec6i), lower: wp.vec3, upper: wp.vec3, sides: vec6i, solids: int,
    solid: wp.array(dtype=float), opening: wp.array(dtype=wp.vec3), face_owner: wp.array(dtype=wp.vec3i), walls: Walls,
    was: wp.array(dtype=wp.vec3), ratio: float, now: wp.array(dtype=wp.vec3), drift: wp.array(dtype=wp.vec3),
    now_out: wp.array(dtype=wp.vec3), drift_out: wp.array(dtype=wp.vec3), given: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Closed faces: what moves into the solid is taken away, what slips along it stays.

    `given` is what a face gives to particles beside their own velocity: now - ratio was.
    """
    c = first + wp.tid()
    at = place_of(grid, c)
    u = now[c]
    d = drift[c]
    for axis in range(3):
        k = float(at[axis])
        if (k <= lower[axis] and sides[2 * axis] == 0) or (k >= upper[axis] and sides[2 * axis + 1] == 0):
            u[axis] = 0.0
            d[axis] = 0.0
        elif solids == 1 and opening[c][axis] < LEAST and near[c][2 * axis] >= 0:
            o = near[c][2 * axis]
            normal = wp.vec3()
            v = wp.vec3()
            e = wp.vec3()
            for b in range(3):
                if b == axis:
                    normal[b] = solid[c] - solid[o]
                    v[b] = now[c][b]
                    e[b] = drift[c][b]
                else:
                    low = near[c][2 * b]
                    high = near[c][2 * b + 1]
                    olow = near[o][2 * b]
                    ohigh = near[o][2 * b + 1]
                    normal[b] = 0.25 * (
                        value_at(solid, high) + value_at(solid, ohigh) - value_at(solid, low) - value_at(solid, olow)
                    )
                    count = float(2.0)
                    sv = now[c][b] + now[o][b]
                    se = drift[c][b] + drift[o][b]
                    if high >= 0:
                        sv += now[high][b]
                        se += drift[high][b]
                        count += 1.0
                    if ohigh >= 0:
                        sv += now[ohigh][b]
                        se += drift[ohigh][b]
                        count += 1.0
                    v[b] = sv / count
                    e[b] = se / count
            normal = wp.normalize(normal)
            w = wall_speed(walls, face_owner[c][axis], face_center(at, axis))
            u[axis] = v[axis] - wp.min(wp.dot(v - w, normal), 0.0) * normal[axis]
            d[axis] = e[axis] - wp.min(wp.dot(e - w, normal), 0.0) * normal[axis]
    now_out[c] = u
    drift_out[c] = d
    given[c] = u - ratio * was[c]


@wp.kernel
def rub(
    first: wp.int32, grid: Columns, near: wp.array(dtype=vec6i), lower: wp.vec3, upper: wp.vec3, sides: vec6i, solids: int,
    solid: wp.array(dtype=float), rate: float, now: wp.array(dtype=wp.vec3), now_out: wp.array(dtype=wp.vec3),
):  # fmt: skip
    """Friction of walls on the cells beside them, implicit: u / (1 + rate |u|)."""
    c = first + wp.tid()
    at = place_of(grid, c)
    u = now[c]
    v = u
    for axis in range(3):
        o = near[c][2 * axis]
        x = face_center(at, axis)
        d = float(FAR)
        if solids == 1:
            d = solid[c]
            if o >= 0:
                d = 0.5 * (d + solid[o])
        for side in range(3):
            if side != axis:
                if sides[2 * side] == 0:
                    d = wp.min(d, x[side] - lower[side])
                if sides[2 * side + 1] == 0:
                    d = wp.min(d, upper[side] - x[side])
        if d > 0.0 and d < 1.0:
            speed = wp.length(u)
            if o >= 0:
                speed = 0.5 * (speed + wp.length(now[o]))
            v[axis] = u[axis] / (1.0 + rate * speed)
    now_out[c] = v


@wp.func
def corner_distance(grid: Columns, distance: wp.array(dtype=float), x: wp.vec3):
    """Distance and its gradient at a point, from the corners of its cell."""
    i = int(wp.floor(x[0]))
    j = int(wp.floor(x[1]))
    k = int(wp.floor(x[2]))
    fx = x[0] - float(i)
    fy = x[1] - float(j)
    fz = x[2] - float(k)
    a = cell_at(grid, i, j, k)
    b = cell_at(grid, i, j + 1, k)
    c = cell_at(grid, i + 1, j, k)
    d = cell_at(grid, i + 1, j + 1, k)
    a1 = cell_at(grid, i, j, k + 1)
    b1 = cell_at(grid, i, j + 1, k + 1)
    c1 = cell_at(grid, i + 1, j, k + 1)
    d1 = cell_at(grid, i + 1, j + 1, k + 1)
    if a < 0 or b < 0 or c < 0 or d < 0 or a1 < 0 or b1 < 0 or c1 < 0 or d1 < 0:
        return wp.vec4(0.0, 0.0, 0.0, float(FAR))
    a0 = distance[a]
    b0 = distance[b]
    c0 = distance[c]
    d0 = distance[d]
    at = distance[a1]
    bt = distance[b1]
    ct = distance[c1]
    dt = distance[d1]
    x0 = (1.0 - fy) * ((1.0 - fz) * a0 + fz * at) + fy * ((1.0 - fz) * b0 + fz * bt)
    x1 = (1.0 - fy) * ((1.0 - fz) * c0 + fz * ct) + fy * ((1.0 - fz) * d0 + fz * dt)
    y0 = (1.0 - fx) * ((1.0 - fz) * a0 + fz * at) + fx * ((1.0 - fz) * c0 + fz * ct)
    y1 = (1.0 - fx) * ((1.0 - fz) * b0 + fz * bt) + fx * ((1.0 - fz) * d0 + fz * dt)
    z0 = (1.0 - fx) * ((1.0 - fy) * a0 + fy * b0) + fx * ((1.0 - fy) * c0 + fy * d0)
    z1 = (1.0 - fx) * ((1.0 - fy) * at + fy * bt) + fx * ((1.0 - fy) * ct + fy * dt)
    return wp.vec4(x1 - x0, y1 - y0, z1 - z0, z0 * (1.0 - fz) + z1 * fz)


@wp.kernel
def push_out(
    first: wp.int32, grid: Columns, distance: wp.array(dtype=float), owner: wp.array(dtype=wp.int32), walls: Walls,
    cells_per_speed: float, lower: wp.vec3, upper: wp.vec3, sides: vec6i, position: wp.array(dtype=wp.vec4),
):  # fmt: skip
    """Particles inside solids go to the nearest point outside, where the solid will be at the end of the step."""
    p = first + wp.tid()
    q = position[p]
    x = wp.vec3(q[0], q[1], q[2])
    c = cell_at(grid, int(wp.floor(x[0])), int(wp.floor(x[1])), int(wp.floor(x[2])))
    if c >= 0:
        if distance[c] < 4.0:
            shift = cells_per_speed * wall_speed(walls, owner[c], x)
            moved = int(0)
            for _turn in range(2):
                g = corner_distance(grid, distance, x - shift)
                if g[3] < SKIN:
                    n = wp.normalize(wp.vec3(g[0], g[1], g[2]))
                    x = x + (SKIN - g[3]) * n
                    moved = 1
            if moved == 1:
                for axis in range(3):
                    if sides[2 * axis] == 0:
                        x[axis] = wp.max(x[axis], lower[axis] + 0.001)
                    if sides[2 * axis + 1] == 0:
                        x[axis] = wp.min(x[axis], upper[axis] - 0.001)
                position[p] = wp.vec4(x[0], x[1], x[2], q[3])


@wp.kernel
def momentum(
    first: wp.int32, cells: int, block: int, grid: Columns, near: wp.array(dtype=vec6i), row: wp.array(dtype=wp.int32),
    phi: wp.array(dtype=float), opening: wp.array(dtype=wp.vec3), before: wp.array(dtype=wp.vec3), after: wp.array(dtype=wp.vec3),
    sums: wp.array(dtype=vec6d),
):  # fmt: skip
    """Change of the liquid's momentum on its faces between two velocities, and about the grid's origin, in cells of liquid."""
    n = first + wp.tid()
    total = vec6d()
    for c in range(n * block, wp.min((n + 1) * block, cells)):
        at = place_of(grid, c)
        for axis in range(3):
            o = near[c][2 * axis]
            s = int(-1)
            if o >= 0:
                s = row[o]
            r = row[c]
            share = opening[c][axis]
            if share >= LEAST and (r >= 0 or s >= 0):
                mass = share
                if r < 0:
                    mass = share * wp.clamp(phi[o] / (phi[o] - wp.max(phi[c], 1.0e-3)), 0.05, 1.0)
                elif s < 0:
                    theta = float(0.5)
                    if o >= 0:
                        theta = wp.clamp(phi[c] / (phi[c] - wp.max(phi[o], 1.0e-3)), 0.05, 1.0)
                    mass = share * theta
                f = wp.vec3()
                f[axis] = mass * (after[c][axis] - before[c][axis])
                m = wp.cross(face_center(at, axis), f)
                total += vec6d(
                    wp.float64(f[0]), wp.float64(f[1]), wp.float64(f[2]), wp.float64(m[0]), wp.float64(m[1]), wp.float64(m[2])
                )
    sums[n] = total


@wp.kernel
def take_out(
    first: wp.int32, count: int, center: wp.array(dtype=wp.vec3), rotation: wp.array(dtype=wp.mat33), half: wp.array(dtype=wp.vec3),
    position: wp.array(dtype=wp.vec4), left: wp.array(dtype=wp.int32),
):  # fmt: skip
    """Particles inside an outflow are marked with 2 + its number; they and those that left have no volume any more."""
    p = first + wp.tid()
    x = position[p]
    gone = left[p]
    for m in range(count):
        y = wp.transpose(rotation[m]) * (wp.vec3(x[0], x[1], x[2]) - center[m])
        if gone == 0 and wp.abs(y[0]) <= half[m][0] and wp.abs(y[1]) <= half[m][1] and wp.abs(y[2]) <= half[m][2]:
            gone = 2 + m
    left[p] = gone
    if gone > 0:
        position[p] = wp.vec4(x[0], x[1], x[2], 0.0)
