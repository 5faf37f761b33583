"""Signed clearance of convex solids, pair by pair. Compiled by numba, kept on disk; `polytopes.py` says how, `convex_batch.py` calls it.

A solid is a run of vertices, of planes (normal . x <= offset inside), of triangles and of edges between planes, in flat arrays.
"""

import numpy as np
from numba import njit

__all__ = ["clearances", "describe", "judge"]

LEFT = -1
"""Not answered here: the deepest point lies inside a facet, or the two may be in one place."""
FACET, EDGES, DEPTH, FAR = 0, 1, 2, 3
"""By which feature a clearance was found; `FAR`: a lower bound."""


@njit(cache=True, nogil=True)
def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True, nogil=True)
def judge(vertices, faces, first_vertex, first_face, size, tolerance, convex):
    """Convexity of closed solids: watertight, and no vertex above any face plane; `Solid.convex`."""
    n = np.empty(3)
    for s in range(len(size)):
        base, last, start, stop = first_vertex[s], first_vertex[s + 1], first_face[s], first_face[s + 1]
        forth, back = np.empty(3 * (stop - start), np.int64), np.empty(3 * (stop - start), np.int64)
        for f in range(stop - start):
            for k in range(3):
                i, j = faces[start + f, k], faces[start + f, (k + 1) % 3]
                forth[3 * f + k], back[3 * f + k] = i * (last - base) + j, j * (last - base) + i
        convex[s] = np.array_equal(np.sort(forth), np.sort(back))
        f = start
        while convex[s] and f < stop:
            a, b, c = vertices[base + faces[f, 0]], vertices[base + faces[f, 1]], vertices[base + faces[f, 2]]
            u, v = b - a, c - a
            n[0], n[1], n[2] = u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]
            n /= np.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
            most = _dot(n, a) + tolerance * size[s]
            for i in range(base, last):
                if _dot(n, vertices[i]) > most:
                    convex[s] = False
                    break
            f += 1


@njit(cache=True, nogil=True)
def describe(vertices, faces, first_vertex, first_face, size, coplanar, normals, offsets, edges, planes, sharp):
    """Planes of convex solids, coplanar triangles as one, and their edges between different planes.

    Of each solid they are written from its first triangle on, edges from three times that; `planes` and `sharp` count them.
    """
    for s in range(len(size)):
        start, stop, base = first_face[s], first_face[s + 1], first_vertex[s]
        count = stop - start
        area, normal = np.empty(count), np.empty((count, 3))
        for f in range(count):
            a, b, c = (
                vertices[base + faces[start + f, 0]],
                vertices[base + faces[start + f, 1]],
                vertices[base + faces[start + f, 2]],
            )
            u, v = b - a, c - a
            normal[f] = np.array([u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]])
            area[f] = np.sqrt(normal[f, 0] ** 2 + normal[f, 1] ** 2 + normal[f, 2] ** 2)
            normal[f] /= area[f]
        kept, slack = 0, coplanar * size[s]
        for f in np.argsort(-area, kind="mergesort"):
            if not _on_a_plane(vertices, base, faces[start + f], normal[f], normals, offsets, start, kept, slack):
                normals[start + kept] = normal[f]
                offsets[start + kept] = _dot(normal[f], vertices[base + faces[start + f, 0]])
                kept += 1
        planes[s] = kept
        found = 0
        for f in range(start, stop):
            for k in range(3):
                i, j = faces[f, k], faces[f, (k + 1) % 3]
                if i < j and _is_sharp(vertices[base + i], vertices[base + j], normals, offsets, start, kept, slack):
                    edges[3 * start + found, 0], edges[3 * start + found, 1] = base + i, base + j
                    found += 1
        sharp[s] = found


@njit(cache=True, nogil=True)
def _on_a_plane(vertices, base, face, normal, normals, offsets, start, kept, slack):
    for p in range(start, start + kept):
        if _dot(normal, normals[p]) > 0.0:
            lowest = 0.0
            for k in range(3):
                lowest = max(lowest, offsets[p] - _dot(normals[p], vertices[base + face[k]]))
            if lowest < slack:
                return True
    return False


@njit(cache=True, nogil=True)
def _is_sharp(a, b, normals, offsets, start, kept, slack):
    """True if an edge lies on more than one plane."""
    count = 0
    for p in range(start, start + kept):
        if offsets[p] - _dot(normals[p], a) < slack and offsets[p] - _dot(normals[p], b) < slack:
            count += 1
            if count > 1:
                return True
    return False


@njit(cache=True, nogil=True)
def _slacks(points, first, last, normals, offsets, start, count, slack):
    """Depth of points below planes [m], into `slack` (planes, points); the plane that separates best, its separation and its point."""
    best, plane, vertex = np.inf, 0, 0
    for p in range(count):
        nx, ny, nz, h = normals[start + p, 0], normals[start + p, 1], normals[start + p, 2], offsets[start + p]
        deepest, nearest = -np.inf, 0
        for v in range(last - first):
            x = points[first + v]
            depth = h - (nx * x[0] + ny * x[1] + nz * x[2])
            slack[p, v] = depth
            if depth > deepest:
                deepest, nearest = depth, v
        if deepest < best:
            best, plane, vertex = deepest, p, nearest
    return -best, plane, vertex


@njit(cache=True, nogil=True)
def _foot_inside(slack, vertex, separation, plane, normals, start, count, tolerance):
    """True if the foot of a vertex on a plane lies on the facet."""
    own = normals[start + plane]
    for p in range(count):
        if slack[p, vertex] + separation * _dot(own, normals[start + p]) < -tolerance:
            return False
    return True


@njit(cache=True, nogil=True)
def _deepest_vertex(slack, planes, count):
    """Greatest depth of a vertex below all planes [m], and which."""
    best, vertex = -np.inf, 0
    for v in range(count):
        depth = np.inf
        for p in range(planes):
            depth = min(depth, slack[p, v])
            if depth <= best:
                break
        if depth > best:
            best, vertex = depth, v
    return best, vertex


@njit(cache=True, nogil=True)
def _facets_deeper(slack, planes, faces, start, stop, than):
    """True if some point of a triangle may be deeper than `than` [m]: no plane proves the contrary by the corners."""
    for f in range(start, stop):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        bound = np.inf
        for p in range(planes):
            bound = min(bound, max(slack[p, a], slack[p, b], slack[p, c]))
            if bound <= than:
                break
        if bound > than:
            return True
    return False


@njit(cache=True, nogil=True)
def _nearest_plane(point, normals, offsets, start, count):
    """The point on the plane of a body that a point in it is nearest to."""
    best, plane = np.inf, 0
    for p in range(count):
        slack = offsets[start + p] - _dot(normals[start + p], point)
        if slack < best:
            best, plane = slack, p
    return point + best * normals[start + plane]


@njit(cache=True, nogil=True)
def _segments(p, u, q, v):
    """Nearest parameters of two segments; `triangles.segment_points`."""
    tiny = np.finfo(np.float64).tiny
    uu, vv, uv = _dot(u, u), _dot(v, v), _dot(u, v)
    r = q - p
    n = np.array([u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]])
    square, s = _dot(n, n), 0.0
    if square > 1e-30 * uu * vv:
        across = (r[1] * v[2] - r[2] * v[1]) * n[0] + (r[2] * v[0] - r[0] * v[2]) * n[1] + (r[0] * v[1] - r[1] * v[0]) * n[2]
        s = min(max(across / square, 0.0), 1.0)
    ru, rv = _dot(r, u), _dot(r, v)
    t = min(max((s * uv - rv) / max(vv, tiny), 0.0), 1.0)
    s = min(max((t * uv + ru) / max(uu, tiny), 0.0), 1.0)
    t = min(max((s * uv - rv) / max(vv, tiny), 0.0), 1.0)
    return s, t


@njit(cache=True, nogil=True)
def _to_edges(point, ends, edges, first, last):
    """Least distance of a point to edges [m]."""
    least = np.inf
    for e in range(first, last):
        start = ends[edges[e, 0]]
        along = ends[edges[e, 1]] - start
        gap = point - start
        t = min(max(_dot(gap, along) / _dot(along, along), 0.0), 1.0)
        gap = gap - t * along
        least = min(least, _dot(gap, gap))
    return np.sqrt(least)


@njit(cache=True, nogil=True)
def _by_edges(on_a, on_b, a, b, edges, way, noise, point_a, point_b):
    """Least distance between edges of two bodies that are apart [m]; `polytopes.edge_distance`.

    `a`, `b`: first and last vertex, first and last edge of each; `way`: from b towards a, the better it separates, the less is compared.
    """
    top, front, near, foot = -np.inf, b[0], np.inf, a[0]
    for v in range(b[0], b[1]):
        height = _dot(on_b[v], way)
        if height > top:
            top, front = height, v
    for v in range(a[0], a[1]):
        height = _dot(on_a[v], way) - top
        if height < near:
            near, foot = height, v
    bound = min(_to_edges(on_a[foot], on_b, edges, b[2], b[3]), _to_edges(on_b[front], on_a, edges, a[2], a[3]))
    bound = bound * (1.0 + 1e-12) + noise
    least = np.inf
    for e in range(a[2], a[3]):
        p, p1 = on_a[edges[e, 0]], on_a[edges[e, 1]]
        if min(_dot(p, way), _dot(p1, way)) - top > bound:
            continue
        u = p1 - p
        for g in range(b[2], b[3]):
            q, q1 = on_b[edges[g, 0]], on_b[edges[g, 1]]
            if max(_dot(q, way), _dot(q1, way)) - top < near - bound:
                continue
            v = q1 - q
            s, t = _segments(p, u, q, v)
            x, y = p + s * u, q + t * v
            square = _dot(x - y, x - y)
            if square < least:
                least = square
                point_a[:], point_b[:] = x, y
    return np.sqrt(least)


@njit(cache=True, nogil=True)
def _forward(rotation, move, x):
    out = np.empty(3)
    for i in range(3):
        out[i] = rotation[i, 0] * x[0] + rotation[i, 1] * x[1] + rotation[i, 2] * x[2] + move[i]
    return out


@njit(cache=True, nogil=True)
def clearances(pairs, rotation, move, skip_above, enough, bodies, numbers, scratch, value, point_a, point_b, found):
    """Clearance of pairs at poses of the first in the frame of the second [m], with its points in that frame.

    `bodies`: vertices, normals, offsets, faces, edges. `numbers` (solids, 7): first and last vertex, first plane, planes, last triangle,
    first and last edge. `scratch`: moved vertices of both, and two tables. `found` says how, `LEFT` where another has to answer.
    """
    vertices, normals, offsets, faces, edges, size = bodies
    on_a, in_a, slack_ab, slack_ba = scratch
    for k in range(len(pairs)):
        i, j = pairs[k, 0], pairs[k, 1]
        a, b = numbers[i], numbers[j]
        turn, go = rotation[k], move[k]
        for v in range(a[0], a[1]):
            on_a[v] = _forward(turn, go, vertices[v])
        for v in range(b[0], b[1]):
            x = vertices[v] - go
            for c in range(3):
                in_a[v, c] = x[0] * turn[0, c] + x[1] * turn[1, c] + x[2] * turn[2, c]
        wide = size[i] + size[j]
        ab = slack_ab[: b[3] * (a[1] - a[0])].reshape(b[3], a[1] - a[0])
        ba = slack_ba[: a[3] * (b[1] - b[0])].reshape(a[3], b[1] - b[0])
        sep_b, plane_b, vertex_a = _slacks(on_a, a[0], a[1], normals, offsets, b[2], b[3], ab)
        sep_a, plane_a, vertex_b = _slacks(in_a, b[0], b[1], normals, offsets, a[2], a[3], ba)
        separation = max(sep_a, sep_b)
        if separation > skip_above[k]:
            value[k], found[k] = separation, FAR
            continue
        tolerance = 1e-13 * wide
        inside_b = _foot_inside(ab, vertex_a, sep_b, plane_b, normals, b[2], b[3], tolerance)
        inside_a = _foot_inside(ba, vertex_b, sep_a, plane_a, normals, a[2], a[3], tolerance)
        use_a = sep_a > sep_b + tolerance or (sep_a >= sep_b - tolerance and inside_a and not inside_b)
        if use_a:
            way = -_forward(turn, np.zeros(3), normals[a[2] + plane_a])
        else:
            way = normals[b[2] + plane_b].copy()
        if separation > 0.0 and ((use_a and inside_a) or (not use_a and inside_b)):
            value[k], found[k] = separation, FACET
            if use_a:
                own = in_a[b[0] + vertex_b]
                point_a[k] = _forward(turn, go, own - sep_a * normals[a[2] + plane_a])
                point_b[k] = _forward(turn, go, own)
            else:
                point_a[k] = on_a[a[0] + vertex_a]
                point_b[k] = point_a[k] - sep_b * way
            continue
        if separation <= 0.0:
            value_a, deep_a = _deepest_vertex(ab, b[3], a[1] - a[0])
            value_b, deep_b = _deepest_vertex(ba, a[3], b[1] - b[0])
            deepest, noise = max(value_a, value_b), 1e-12 * wide
            than = max(deepest, 0.0) + tolerance
            if deepest < enough[k] and (
                _facets_deeper(ab, b[3], faces, a[2], a[4], than) or _facets_deeper(ba, a[3], faces, b[2], b[4], than)
            ):
                found[k] = LEFT
                continue
            if deepest > -noise:
                value[k], found[k] = -deepest, DEPTH
                if abs(deepest) <= noise and separation < -noise:
                    found[k] = LEFT  # they may be in one place
                elif value_a >= value_b:
                    point_a[k] = on_a[a[0] + deep_a]
                    point_b[k] = _nearest_plane(point_a[k], normals, offsets, b[2], b[3])
                else:
                    own = in_a[b[0] + deep_b]
                    point_b[k] = _forward(turn, go, own)
                    point_a[k] = _forward(turn, go, _nearest_plane(own, normals, offsets, a[2], a[3]))
                continue
        sides = (a[0], a[1], a[5], a[6]), (b[0], b[1], b[5], b[6])
        gap = _by_edges(on_a, vertices, sides[0], sides[1], edges, way, tolerance, point_a[k], point_b[k])
        value[k], found[k] = gap, EDGES
