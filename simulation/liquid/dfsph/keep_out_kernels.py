# mypy: ignore-errors
"""Warp kernel that keeps particles out of bodies whatever the pressure does: no way of a step leads through a surface."""

import warp as wp

from .boundary_kernels import Bodies, Pairs, Surfaces, at_corners, wall_speed
from .step_slots import Slot

wp.set_module_options({"enable_backward": False})

DT = wp.constant(int(Slot.DT))

__all__ = ["keep_out"]

BOUNCES = wp.constant(4)
"""Faces that one way can be turned aside by; a way that is still blocked is not gone."""
LAYERS = wp.constant(4)
"""Faces seen from behind that a ray passes."""
PLAY = wp.constant(wp.float32(0.01))
"""Least distance from a surface [spacings]."""
SHELL = wp.constant(wp.float32(0.25))
"""Nearer than this [spacings] particles do not come to a surface, so that joints narrower than this hold liquid: at rest it
keeps half a spacing by its pressure."""
MOST_OUT = wp.constant(wp.float32(0.2))
"""A particle that a moving body has run over comes out by so much a step at most [spacings]."""


@wp.func
def first_face(mesh: wp.uint64, start: wp.vec3, way: wp.vec3, play: wp.float32, sheet: wp.int32):
    """Outward normal of the first face that the way meets from outside, and whether there is one."""
    length = wp.length(way)
    if length < 1.0e-9:
        return wp.vec4(0.0, 0.0, 0.0, 0.0)
    ahead = way / length
    at = start - play * ahead
    left = length + 2.0 * play
    for _k in range(LAYERS):
        hit = wp.mesh_query_ray(mesh, at, ahead, left)
        if not hit.result:
            return wp.vec4(0.0, 0.0, 0.0, 0.0)
        slant = wp.dot(hit.normal, ahead)
        if slant < 0.0 or sheet != 0:
            n = hit.normal
            if slant > 0.0:
                n = -n
            return wp.vec4(n[0], n[1], n[2], 1.0)
        skip = hit.t + 1.0e-3 * play
        at = at + skip * ahead
        left = left - skip
        if left <= 0.0:
            return wp.vec4(0.0, 0.0, 0.0, 0.0)
    return wp.vec4(0.0, 0.0, 0.0, 0.0)


@wp.func
def turned(v: wp.vec3, u: wp.vec3, n: wp.vec3, give: wp.float32):
    """A velocity that no longer goes against n, seen from what moves with u; of what gives way, it changes by the share `give`."""
    return v - give * wp.min(wp.dot(v - u, n), 0.0) * n


@wp.kernel
def keep_out(
    first: wp.int32,
    x: wp.array(dtype=wp.vec3),
    lightness: wp.array(dtype=wp.float32),
    volume: wp.array(dtype=wp.float32),
    settings: wp.array(dtype=wp.float32),
    spacing: wp.float32,
    pairs: Pairs,
    bodies: Bodies,
    surfaces: Surfaces,
    v: wp.array(dtype=wp.vec3),
    way: wp.array(dtype=wp.vec3),
    force: wp.array(dtype=wp.vec3),
    back: wp.array(dtype=wp.vec3),
):
    """Turn the way of each particle (its velocity of travel) aside where it leads into a body, and its velocity; what that gives.

    The way is seen from the body, as it moves at the end of the step.
    """
    i = first + wp.tid()
    dt = settings[DT]
    play = PLAY * spacing
    begin = pairs.start[i]
    count = pairs.touched[i]
    for k in range(begin, begin + count):
        force[k] = wp.vec3(0.0, 0.0, 0.0)
        back[k] = wp.vec3(0.0, 0.0, 0.0)
    if lightness[i] > 0.0:
        mass = volume[i] / lightness[i]
        for turn in range(BOUNCES):
            blocked = wp.int32(0)
            for k in range(begin, begin + count):
                b = pairs.body[k]
                kind = surfaces.kind[b]
                if kind != 0:
                    u = wall_speed(pairs, bodies, k, x[i])
                    if bodies.deforms[b] != 0:
                        # What it is expected to have after the step errs by as much as the pressure changes.
                        u = at_corners(bodies.vertex_start, pairs.corner[k], pairs.share[k])
                    give = pairs.give[k]
                    rotation = surfaces.rotation[b]
                    inverse = wp.transpose(rotation)
                    mesh = surfaces.mesh[b]
                    start = inverse * (x[i] - surfaces.position[b])
                    old = v[i]
                    if (kind == 2 or kind == 4) and turn == 0:
                        near = wp.mesh_query_point_sign_normal(mesh, start, spacing)
                        if near.result and near.sign < 0.0:
                            out = wp.mesh_eval_position(mesh, near.face, near.u, near.v) - start
                            depth = wp.length(out)
                            if depth > 1.0e-9:
                                n = rotation * (out / depth)
                                wanted = wp.min(depth + play, MOST_OUT * spacing) / dt
                                way[i] = way[i] + wp.max(wanted - wp.dot(way[i] - u, n), 0.0) * n
                                v[i] = turned(v[i], u, n, give)
                                blocked = 1
                    sheet = wp.int32(0)
                    if kind == 3 or kind == 5:
                        sheet = 1
                    met = first_face(mesh, start, inverse * ((way[i] - u) * dt), play, sheet)
                    if met[3] > 0.0:
                        blocked = 1
                        if turn == BOUNCES - 1:
                            v[i] = v[i] + give * (u - v[i])
                            way[i] = u
                        else:
                            n = rotation * wp.vec3(met[0], met[1], met[2])
                            v[i] = turned(v[i], u, n, give)
                            way[i] = turned(way[i], u, n, 1.0)
                    ahead = inverse * ((way[i] - u) * dt)
                    near = wp.mesh_query_point_no_sign(mesh, start + ahead, SHELL * spacing)
                    if near.result:
                        away = start + ahead - wp.mesh_eval_position(mesh, near.face, near.u, near.v)
                        gap = wp.length(away)
                        if gap > 1.0e-9:
                            n = rotation * (away / gap)
                            if kind == 5:
                                short = wp.min(SHELL * spacing - gap, MOST_OUT * spacing)
                                way[i] = way[i] + (short / dt) * n
                            if wp.dot(way[i] - u, n) < 0.0:
                                v[i] = turned(v[i], u, n, give)
                                way[i] = turned(way[i], u, n, 1.0)
                                blocked = 1
                    change = v[i] - old
                    force[k] = force[k] - (mass / dt) * change
                    back[k] = back[k] + (mass / dt) * change
            if blocked == 0:
                break
