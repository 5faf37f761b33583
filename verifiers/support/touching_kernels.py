"""Contact points of two placed surfaces and the directions in which they can push. Compiled by numba, kept on disk.

The same as the numpy of `touching.py`, step by step: for worlds of thousands of parts, where each step is a few numbers long.
"""

import numpy as np
from numba import njit

__all__ = ["places", "pushes"]


@njit(cache=True, nogil=True)
def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True, nogil=True)
def _cross(a, b, out):
    out[0], out[1], out[2] = a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@njit(cache=True, nogil=True)
def _to_segment(p, a, b):
    """Squared distance of a point to a segment."""
    along, from_a, share, square = 0.0, 0.0, 0.0, 0.0
    for k in range(3):
        along += (b[k] - a[k]) * (b[k] - a[k])
        from_a += (p[k] - a[k]) * (b[k] - a[k])
    share = min(max(from_a / max(along, 2.2250738585072014e-308), 0.0), 1.0)
    for k in range(3):
        gap = p[k] - (a[k] + share * (b[k] - a[k]))
        square += gap * gap
    return square


@njit(cache=True, nogil=True)
def _to_triangle(p, t):
    """Distance of a point to a triangle; `geometry.triangles.nearest_on_triangles`."""
    a, b, c = t[0], t[1], t[2]
    n, m, e, r = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    _cross(b - a, c - a, n)
    square, side, best = max(_dot(n, n), 2.2250738585072014e-308), np.inf, np.inf
    for k in range(3):
        start, end = t[k], t[(k + 1) % 3]
        for i in range(3):
            e[i], r[i] = end[i] - start[i], p[i] - start[i]
        _cross(n, e, m)
        side = min(side, _dot(m, r))
        best = min(best, _to_segment(p, start, end))
    if side >= 0.0:
        height = ((p[0] - a[0]) * n[0] + (p[1] - a[1]) * n[1] + (p[2] - a[2]) * n[2]) / square
        best = min(best, height * height * square)
    return np.sqrt(best)


@njit(cache=True, nogil=True)
def _boxes(points, faces, low, high, reach):
    """Triangles whose boxes come within `reach` of a box: their indices and boxes."""
    kept, boxes = np.empty(len(faces), np.int64), np.empty((len(faces), 2, 3))
    count = 0
    for f in range(len(faces)):
        meets = True
        for k in range(3):
            x, y, z = points[faces[f, 0], k], points[faces[f, 1], k], points[faces[f, 2], k]
            boxes[count, 0, k], boxes[count, 1, k] = min(x, y, z), max(x, y, z)
            if boxes[count, 0, k] > high[k] + reach or boxes[count, 1, k] < low[k] - reach:
                meets = False
                break
        if meets:
            kept[count] = f
            count += 1
    return kept[:count], boxes[:count]


@njit(cache=True, nogil=True)
def _beside(p, box, reach):
    """True if a point is farther from a box than `reach` along an axis."""
    for k in range(3):
        if p[k] < box[0, k] - reach or p[k] > box[1, k] + reach:
            return True
    return False


@njit(cache=True, nogil=True)
def _vertices_near(own, other, faces, low, high, slack, points, apart, count):
    """Vertices of one surface within `slack` of the other, appended to `points`."""
    kept, boxes = _boxes(other, faces, low, high, slack)
    corner = np.empty((3, 3))
    for v in range(len(own)):
        p = own[v]
        if (p < low).any() or (p > high).any():
            continue
        nearest = np.inf
        for k in range(len(kept)):
            if _beside(p, boxes[k], slack):
                continue
            for i in range(3):
                corner[i] = other[faces[kept[k], i]]
            nearest = min(nearest, _to_triangle(p, corner))
        if nearest <= slack:
            points[count], apart[count] = p, nearest
            count += 1
    return count


@njit(cache=True, nogil=True)
def _edges_near(points, edges, low, high):
    kept, count = np.empty(len(edges), np.int64), 0
    for e in range(len(edges)):
        meets = True
        for k in range(3):
            x, y = points[edges[e, 0], k], points[edges[e, 1], k]
            if min(x, y) > high[k] or max(x, y) < low[k]:
                meets = False
        if meets:
            kept[count] = e
            count += 1
    return kept[:count]


@njit(cache=True, nogil=True)
def _segments(p, u, q, v, n, r):
    """Nearest parameters of two segments; `geometry.triangles.segment_points`."""
    tiny = 2.2250738585072014e-308
    uu, vv, uv = _dot(u, u), _dot(v, v), _dot(u, v)
    _cross(u, v, n)
    for k in range(3):
        r[k] = q[k] - p[k]
    square, s = _dot(n, n), 0.0
    if square > 1e-30 * uu * vv:
        across = (r[1] * v[2] - r[2] * v[1]) * n[0] + (r[2] * v[0] - r[0] * v[2]) * n[1] + (r[0] * v[1] - r[1] * v[0]) * n[2]
        s = min(max(across / square, 0.0), 1.0)
    ru, rv = _dot(r, u), _dot(r, v)
    t = min(max((s * uv - rv) / max(vv, tiny), 0.0), 1.0)
    s = min(max((t * uv + ru) / max(uu, tiny), 0.0), 1.0)
    return s, min(max((s * uv - rv) / max(vv, tiny), 0.0), 1.0)


@njit(cache=True, nogil=True)
def places(here, there, faces, more_faces, edges, more_edges, low, high, slack, most_pairs):
    """Vertices of either surface near the other, and crossings of edges, shape (n, 3), and how far apart the surfaces are there."""
    mine, theirs = _edges_near(here, edges, low, high), _edges_near(there, more_edges, low, high)
    crossed = len(mine) * len(theirs)
    if crossed > most_pairs:
        crossed = 0
    points, apart = np.empty((len(here) + len(there) + crossed, 3)), np.empty(len(here) + len(there) + crossed)
    count = _vertices_near(here, there, more_faces, low, high, slack, points, apart, 0)
    count = _vertices_near(there, here, faces, low, high, slack, points, apart, count)
    n, r, u, v = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    for i in range(len(mine) if crossed else 0):
        p, p1 = here[edges[mine[i], 0]], here[edges[mine[i], 1]]
        for j in range(len(theirs)):
            q, q1 = there[more_edges[theirs[j], 0]], there[more_edges[theirs[j], 1]]
            beside = False
            for k in range(3):
                u[k], v[k] = p1[k] - p[k], q1[k] - q[k]
                if min(p[k], p1[k]) > max(q[k], q1[k]) + slack or max(p[k], p1[k]) < min(q[k], q1[k]) - slack:
                    beside = True
            if beside:
                continue
            s, t = _segments(p, u, q, v, n, r)
            square = 0.0
            for k in range(3):
                points[count, k] = p[k] + s * u[k]
                gap = points[count, k] - (q[k] + t * v[k])
                square += gap * gap
            apart[count] = np.sqrt(square)
            if apart[count] <= slack:
                count += 1
    return points[:count], apart[:count]


@njit(cache=True, nogil=True)
def _side(points, faces, low, high, sign):
    """Triangles with area whose boxes meet a box, their outward normals and their boxes."""
    kept, boxes = _boxes(points, faces, low, high, 0.0)
    triangles, normals, own = np.empty((len(kept), 3, 3)), np.empty((len(kept), 3)), np.empty((len(kept), 2, 3))
    count = 0
    for k in range(len(kept)):
        for i in range(3):
            triangles[count, i] = points[faces[kept[k], i]]
        _cross(triangles[count, 1] - triangles[count, 0], triangles[count, 2] - triangles[count, 0], normals[count])
        length = np.sqrt(_dot(normals[count], normals[count]))
        if length > 0.0:
            normals[count] *= sign / length
            own[count] = boxes[k]
            count += 1
    return triangles[:count], normals[:count], own[:count]


@njit(cache=True, nogil=True)
def _nearest(p, triangles, boxes, slack, most):
    """Triangles within `slack` of a point, the `most` nearest ones, in their order."""
    found, distance, count = np.empty(len(triangles), np.int64), np.empty(len(triangles)), 0
    for k in range(len(triangles)):
        if not _beside(p, boxes[k], slack):
            distance[count] = _to_triangle(p, triangles[k])
            if distance[count] <= slack:
                found[count] = k
                count += 1
    if count <= most:
        return found[:count]
    return np.sort(found[np.argsort(distance[:count], kind="mergesort")[:most]])


@njit(cache=True, nogil=True)
def _added(ways, count, first, way, same):
    """Number of directions once `way` is among those from `first` on, unless it is there already."""
    for k in range(first, count):
        alike = True
        for i in range(3):
            if np.rint(ways[k, i] / same) != np.rint(way[i] / same):
                alike = False
                break
        if alike:
            return count
    ways[count] = way
    return count + 1


@njit(cache=True, nogil=True)
def _separates(way, point, mine, theirs, near, more, slack, bend):
    """True if the triangles of one side lie above a plane through a point and those of the other below, up to the slack."""
    for side in range(2):
        triangles, some, sign = (mine, near, 1.0) if side == 0 else (theirs, more, -1.0)
        for k in range(len(some)):
            for c in range(3):
                height, square = 0.0, 0.0
                for i in range(3):
                    gap = sign * (triangles[some[k], c, i] - point[i])
                    height += way[i] * gap
                    square += gap * gap
                if height < -(slack + bend * np.sqrt(square)):
                    return False
    return True


@njit(cache=True, nogil=True)
def _directions(triangles, near, most, same):
    """Directions of the edges of some triangles, each once, at most `most`."""
    ways, count, edge = np.empty((3 * len(near), 3)), 0, np.empty(3)
    for k in range(len(near)):
        for c in range(3):
            largest, square = 0, 0.0
            for i in range(3):
                edge[i] = triangles[near[k], c, i] - triangles[near[k], c - 1, i]
                square += edge[i] * edge[i]
            if square == 0.0:
                continue
            edge /= np.sqrt(square)
            for i in range(1, 3):
                if abs(edge[i]) > abs(edge[largest]):
                    largest = i
            count = _added(ways, count, 0, edge * np.sign(edge[largest]), same)
    return ways[: min(count, most)]


@njit(cache=True, nogil=True)
def _normals(point, mine, theirs, near, more, limits, ways):
    """Number of directions in which the other surface can push the own one at a point, written into `ways`."""
    (triangles, normals, sided), (others, outward, closed) = mine, theirs
    slack, same, bend, most_edges = limits
    count = 0
    for k in range(len(more)):
        count = _added(ways, count, 0, outward[more[k]], same)
    for k in range(len(near)):
        count = _added(ways, count, 0, -normals[near[k]], same)
    for k in range(0 if closed else len(more)):
        count = _added(ways, count, 0, -outward[more[k]], same)
    for k in range(0 if sided else len(near)):
        count = _added(ways, count, 0, normals[near[k]], same)
    kept = 0
    for k in range(count):
        if _separates(ways[k], point, triangles, others, near, more, slack, bend):
            ways[kept] = ways[k]
            kept += 1
    if kept:
        return kept
    one, two = _directions(triangles, near, most_edges, same), _directions(others, more, most_edges, same)
    across, count = np.empty(3), 0
    for sign in (1.0, -1.0):
        for i in range(len(one)):
            for j in range(len(two)):
                _cross(one[i], two[j], across)
                length = np.sqrt(_dot(across, across))
                if length > same:
                    count = _added(ways, count, 0, across * (sign / length), same)
    for k in range(count):
        if _separates(ways[k], point, triangles, others, near, more, slack, bend):
            ways[kept] = ways[k]
            kept += 1
    return kept


@njit(cache=True, nogil=True)
def pushes(points, here, there, faces, more_faces, box, sides, limits, most_near):
    """Directions in which the second surface can push the first at some points: the points, one for each direction, and those.

    `box`: corners around what is looked at. `sides`: for either surface whether it bounds a volume, and 1, or -1 where it is inside out.
    `limits`: slack, what counts as the same direction, bend, most directions of edges.
    """
    mine = _side(here, faces, box[0], box[1], sides[0][1])
    theirs = _side(there, more_faces, box[0], box[1], sides[1][1])
    ways = np.empty((max(4 * most_near, 2 * int(limits[3]) ** 2), 3))
    found, total = np.empty((4 * len(points) + 64, 2, 3)), 0
    for p in range(len(points)):
        near = _nearest(points[p], mine[0], mine[2], limits[0], most_near)
        more = _nearest(points[p], theirs[0], theirs[2], limits[0], most_near)
        if len(near) == 0 or len(more) == 0:
            continue
        own, other = (mine[0], mine[1], sides[0][0]), (theirs[0], theirs[1], sides[1][0])
        count = _normals(points[p], own, other, near, more, limits, ways)
        if total + count > len(found):
            longer = np.empty((2 * len(found) + count, 2, 3))
            longer[:total] = found[:total]
            found = longer
        for k in range(count):
            found[total, 0], found[total, 1] = points[p], ways[k]
            total += 1
    return found[:total, 0].copy(), found[:total, 1].copy()
