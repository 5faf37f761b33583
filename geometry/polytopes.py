"""Convex against convex, exactly, for many relative poses at once.

Separated polytopes: a vertex over a facet gives the distance directly (its plane separates), everything else is a
nearest pair of edges. Overlapping ones: the depth of surface points of one inside the other is concave over each facet,
so its maximum is a linear programme in three variables, solved by a dual simplex batched over poses.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F64, I32
from .triangles import segment_points

if TYPE_CHECKING:
    from .solids import Solid

__all__ = ["Relative", "convex_depth", "edge_distance", "face_separation", "repeats"]

MANY_FACETS = 32
"""Own choice: facets from which on compiled loops look at them; a box has 6."""
PARALLEL = 1e-14
"""Determinant of three unit normals below which they are no basis by double precision."""
PIVOTS = 80
"""Pivots before a programme is handed to the general solver; a box needs about five."""
ROUND = 1e-13
"""Relative rounding of plane heights: a pivot or a witness within it counts as satisfied."""


SAME_POSE = 1e-12
"""Relative poses [m and rotation matrix entries] this close to one already computed reuse its value."""


class Relative(NamedTuple):
    """Poses of a in the frame of b: rotations, shape (f, 3, 3), and translations [m], shape (f, 3)."""

    rotation: F64
    translation: F64

    def take(self, index: NDArray[np.intp] | NDArray[np.bool_]) -> Relative:
        """The poses at `index`."""
        return Relative(self.rotation[index], self.translation[index])

    def forward(self, points: F64) -> F64:
        """Points of a, shape (n, 3), in the frame of b, shape (f, n, 3)."""
        return np.asarray(points @ self.rotation.swapaxes(1, 2) + self.translation[:, None])

    def backward(self, points: F64) -> F64:
        """Points of b, shape (n, 3), in the frame of a, shape (f, n, 3)."""
        return np.asarray((points - self.translation[:, None]) @ self.rotation)

    def inverse(self) -> Relative:
        """The poses of b in the frame of a."""
        back = self.rotation.swapaxes(1, 2)
        return Relative(back, -np.einsum("fij,fj->fi", back, self.translation))


def repeats(poses: Relative, pairs: I32 | None = None) -> NDArray[np.intp]:
    """For each relative pose the earlier one that it repeats within `SAME_POSE`, or itself, shape (f,).

    Args:
        poses: relative poses in the order of frames.
        pairs: which bodies each is of, shape (f, 2); a change of bodies is no repeat.
    """
    count = len(poses.translation)
    flat = np.concatenate([poses.rotation.reshape(-1, 9), poses.translation], axis=1)
    changed = np.ones(count, dtype=bool)
    changed[1:] = np.abs(np.diff(flat, axis=0)).max(axis=1) > SAME_POSE
    if pairs is not None:
        changed[1:] |= (pairs[1:] != pairs[:-1]).any(axis=1)
    anchor = np.maximum.accumulate(np.where(changed, np.arange(count), 0))
    # A slow drift of repeats leaves its anchor after a while: those frames are computed themselves.
    drifted = np.flatnonzero(np.abs(flat - flat[anchor]).max(axis=1) > SAME_POSE)
    anchor[drifted] = drifted
    return anchor


class Witness(NamedTuple):
    """Signed values [m], shape (f,), with a point on a and a point on b, shape (f, 3), both in the frame of b."""

    value: F64
    point_a: F64
    point_b: F64


class Faces(NamedTuple):
    """Verdict of the facet planes of both: separation [m] and, where it is the distance, its witness points."""

    separation: F64
    """Largest plane separation, shape (f,); > 0 proves the bodies apart and bounds the distance from below."""
    exact: NDArray[np.bool_]
    """Where the separation is the distance itself."""
    point_a: F64
    point_b: F64
    direction: F64
    """Unit normal of the separating plane from b towards a, frame of b, shape (f, 3)."""
    slack_ab: F64
    """Depth of vertices of a below planes of b [m], shape (f, facets of b, vertices of a)."""
    slack_ba: F64
    """The same of vertices of b below planes of a."""

    def take(self, index: NDArray[np.intp]) -> Faces:
        """The poses at `index`."""
        return Faces(
            self.separation[index],
            self.exact[index],
            self.point_a[index],
            self.point_b[index],
            self.direction[index],
            self.slack_ab[index],
            self.slack_ba[index],
        )


def _one_side(solid: Solid, vertices: F64, slack: F64, tolerance: float) -> tuple[F64, NDArray[np.bool_], F64, F64, F64]:
    facets = solid.facets
    deepest = slack.max(axis=2)
    facet = deepest.argmin(axis=1)
    rows = np.arange(len(facet))
    vertex = slack[rows, facet].argmax(axis=1)
    separation = -deepest[rows, facet]
    point = vertices[rows, vertex]
    foot = point - separation[:, None] * facets.normals[facet]
    inside = (slack[rows, :, vertex] + separation[:, None] * (facets.normals[facet] @ facets.normals.T)).min(axis=1) >= -tolerance
    return separation, inside, point, foot, facets.normals[facet]


def face_separation(a: Solid, b: Solid, poses: Relative) -> Faces:
    """Separating-axis test over the facet planes of both, with witnesses."""
    tolerance = ROUND * (a.size + b.size)
    va, vb = poses.forward(a.vertices), poses.backward(b.vertices)
    slack_ab = b.facets.offsets[:, None] - b.facets.normals @ va.swapaxes(1, 2)
    slack_ba = a.facets.offsets[:, None] - a.facets.normals @ vb.swapaxes(1, 2)
    sep_b, inside_b, on_a, foot_b, normal_b = _one_side(b, va, slack_ab, tolerance)
    sep_a, inside_a, on_b, foot_a, normal_a = _one_side(a, vb, slack_ba, tolerance)
    use_a = (sep_a > sep_b + tolerance) | ((sep_a >= sep_b - tolerance) & inside_a & ~inside_b)
    other = np.einsum("fij,fkj->fki", poses.rotation, np.stack([foot_a, on_b], axis=1)) + poses.translation[:, None]
    return Faces(
        np.maximum(sep_a, sep_b),
        np.where(use_a, inside_a, inside_b),
        np.where(use_a[:, None], other[:, 0], on_a),
        np.where(use_a[:, None], other[:, 1], foot_b),
        np.where(use_a[:, None], -np.einsum("fij,fj->fi", poses.rotation, normal_a), normal_b),
        slack_ab,
        slack_ba,
    )


def edge_distance(a: Solid, b: Solid, poses: Relative, direction: F64) -> Witness:
    """Least distance between edges of a and edges of b, with its points.

    Args:
        a: one polytope.
        b: the other.
        poses: poses of a in the frame of b; the bodies are apart in all of them.
        direction: unit vectors from b towards a, shape (f, 3): the better they separate, the fewer edges are compared.
    """
    moved = poses.forward(a.vertices)
    height_a = np.einsum("fvi,fi->fv", moved, direction)
    height_b = direction @ b.vertices.T
    top = height_b.max(axis=1, keepdims=True)
    height_a -= top
    height_b -= top
    rows = np.arange(len(moved))
    ends_a, ends_b = moved[:, a.facets.edges], b.vertices[b.facets.edges]
    # Any pair of points bounds the distance from above: the foremost vertex of each with all edges of the other.
    start, along = np.broadcast_arrays(ends_b[None, :, 0], (ends_b[:, 1] - ends_b[:, 0])[None])
    bound = _point_edges(moved[rows, height_a.argmin(axis=1)], start, along)
    bound = np.minimum(
        bound, _point_edges(b.vertices[height_b.argmax(axis=1)], ends_a[:, :, 0], ends_a[:, :, 1] - ends_a[:, :, 0])
    )
    bound = bound * (1.0 + 1e-12) + ROUND * (a.size + b.size)
    # Both nearest points lie in the slab that the bound leaves on either side of the separating plane.
    near_a = height_a[:, a.facets.edges].min(axis=2) <= bound[:, None]
    near_b = height_b[:, b.facets.edges].max(axis=2) >= (height_a.min(axis=1) - bound)[:, None]
    row, i, j = np.nonzero(near_a[:, :, None] & near_b[:, None, :])
    p, q = ends_a[row, i, 0], ends_b[j, 0]
    u, v = ends_a[row, i, 1] - p, ends_b[j, 1] - q
    s, t = segment_points(p, u, q, v)
    point_a, point_b = p + s[:, None] * u, q + t[:, None] * v
    square = ((point_a - point_b) ** 2).sum(axis=1)
    least = np.minimum.reduceat(square, np.searchsorted(row, rows))
    hits = np.flatnonzero(square == least[row])
    first = hits[np.searchsorted(row[hits], rows)]
    return Witness(np.sqrt(square[first]), point_a[first], point_b[first])


def _point_edges(point: F64, start: F64, along: F64) -> F64:
    """Least distance of one point per row, shape (f, 3), to edges, shape (f, e, 3)."""
    gap = point[:, None] - start
    t = np.clip((gap * along).sum(axis=2) / (along * along).sum(axis=2), 0.0, 1.0)
    gap = gap - t[..., None] * along
    return np.asarray(np.sqrt((gap * gap).sum(axis=2).min(axis=1)))


class _Side(NamedTuple):
    """Facets of one solid whose points may lie deep inside the other."""

    surface: Solid
    other: Solid
    poses: Relative
    """`surface` in the frame of `other`."""
    slack: F64


def _vertex_bounds(side: _Side) -> tuple[F64, F64, F64]:
    """Best vertex depth, its point, and per facet an upper bound of the depth, shape (f, facets)."""
    at_vertex = side.slack.min(axis=1)
    k = at_vertex.argmax(axis=1)
    rows = np.arange(len(k))
    point = np.einsum("fij,fj->fi", side.poses.rotation, side.surface.vertices[k]) + side.poses.translation
    return at_vertex[rows, k], point, _facet_bounds(side.slack, side.surface.facets.members)


def _facet_bounds(slack: F64, members: NDArray[np.bool_]) -> F64:
    """Least over the planes of the greatest slack of each facet's vertices, shape (f, facets)."""
    if len(members) >= MANY_FACETS:
        from .facet_kernels import facet_bounds

        facet, corners = np.nonzero(members)
        starts = np.searchsorted(facet, np.arange(len(members) + 1))
        return np.asarray(facet_bounds(np.ascontiguousarray(slack), starts, corners))
    bound = np.empty((len(slack), len(members)))
    for i, member in enumerate(members):
        bound[:, i] = slack[:, :, member].max(axis=2).min(axis=1)
    return bound


def _facet_depth(side: _Side, rows: NDArray[np.intp], facet: NDArray[np.intp]) -> tuple[F64, F64]:
    """Greatest depth below the planes of `other` over one facet per row, and where (frame of `other`)."""
    own, other = side.surface.facets, side.other.facets
    poses = side.poses.take(rows)
    unit = side.surface.size + side.other.size
    origin = own.centers[facet]
    tangents = own.tangents[facet]
    base = np.einsum("fij,fj->fi", poses.rotation, origin) + poses.translation
    turned = np.einsum("fij,fkj->fki", poses.rotation, tangents)
    count_own, count_other = len(own.normals), len(other.normals)
    g = np.zeros((len(rows), 3 + count_own + count_other, 3))
    h = np.empty((len(rows), 3 + count_own + count_other))
    g[:, 0, 2] = g[:, 1, 0] = g[:, 2, 1] = 1.0
    h[:, :3] = 2.0
    g[:, 3 : 3 + count_own, :2] = np.einsum("ki,fci->fkc", own.normals, tangents)
    h[:, 3 : 3 + count_own] = (own.offsets - origin @ own.normals.T) / unit
    g[np.arange(len(rows)), 3 + facet, :2] = 0.0
    g[:, 3 + count_own :, :2] = np.einsum("ki,fci->fkc", other.normals, turned)
    g[:, 3 + count_own :, 2] = 1.0
    h[:, 3 + count_own :] = (other.offsets - base @ other.normals.T) / unit
    x = _maximise_last(g, h)
    point = base + unit * np.einsum("fc,fci->fi", x[:, :2], turned)
    # The depth is read off the planes at the point that was found, not from the programme's own variable.
    return np.asarray((other.offsets - point @ other.normals.T).min(axis=1)), point


def _maximise_last(g: F64, h: F64) -> F64:
    """Maximise x[2] subject to g x <= h, batched: g of shape (f, n, 3), h of shape (f, n), solution (f, 3).

    Dual simplex: the first three rows are a bounding corner that is optimal for themselves; the most violated row
    enters, the ratio test picks the one that leaves.
    """
    count = len(g)
    basis = np.tile(np.arange(3), (count, 1))
    solution = np.zeros((count, 3))
    open_rows = np.arange(count)
    goal = np.array([0.0, 0.0, 1.0])
    for _ in range(PIVOTS):
        gb = g[open_rows[:, None], basis[open_rows]]
        # Facets that are parallel up to rounding make no corner: another method finds it.
        flat = np.abs(np.linalg.det(gb)) < PARALLEL
        for row in open_rows[flat]:
            solution[row] = _general_programme(g[row], h[row])
        open_rows, gb = open_rows[~flat], gb[~flat]
        if not len(open_rows):
            return solution
        inverse = np.linalg.inv(gb)
        x = np.einsum("fij,fj->fi", inverse, h[open_rows[:, None], basis[open_rows]])
        excess = np.einsum("fni,fi->fn", g[open_rows], x) - h[open_rows]
        enter = excess.argmax(axis=1)
        solution[open_rows] = x
        going = excess[np.arange(len(enter)), enter] > ROUND
        if not going.any():
            return solution
        open_rows, inverse, enter = open_rows[going], inverse[going], enter[going]
        dual = goal @ inverse
        share = np.einsum("fi,fij->fj", g[open_rows, enter], inverse)
        ratio = np.where(share > 1e-12, np.maximum(dual, 0.0) / np.where(share > 1e-12, share, 1.0), np.inf)
        # Among ties the largest share leaves: it keeps the basis well conditioned.
        least = ratio.min(axis=1, keepdims=True)
        leave = np.where(ratio <= least + 1e-12, share, -np.inf).argmax(axis=1)
        basis[open_rows, leave] = enter
    for row in open_rows:
        solution[row] = _general_programme(g[row], h[row])
    return solution


def _general_programme(g: F64, h: F64) -> F64:
    from scipy.optimize import linprog

    answer = linprog([0.0, 0.0, -1.0], A_ub=g, b_ub=h, bounds=[(None, None)] * 3, method="highs")
    return np.asarray(answer.x) if answer.x is not None else np.array([0.0, 0.0, -1.0])


def convex_depth(a: Solid, b: Solid, poses: Relative, faces: Faces, enough: float | F64 = np.inf) -> Witness:
    """Greatest depth of surface points of one below the surface of the other, both ways [m], shape (f,).

    Negative where no surface point of either lies inside the other. `point_a` lies on the surface of a and is the
    deep point or, where the deep point belongs to b, the nearest point of a to it. A point as deep as `enough` [m],
    one for all or shape (f,), ends the search.
    """
    sides = (_Side(a, b, poses, faces.slack_ab), _Side(b, a, poses.inverse(), faces.slack_ba))
    value = np.full(len(poses.rotation), -np.inf)
    deep = np.zeros((2, len(value), 3))
    owner = np.zeros(len(value), dtype=int)
    noise = ROUND * (a.size + b.size)
    bounds = []
    for k, side in enumerate(sides):
        best, point, bound = _vertex_bounds(side)
        better = best > value
        value[better], owner[better], deep[k][better] = best[better], k, point[better]
        bounds.append(bound)
    split = bounds[0].shape[1]
    bound = np.concatenate(bounds, axis=1)
    while True:
        facet = bound.argmax(axis=1)
        rows = np.flatnonzero((bound[np.arange(len(value)), facet] > np.maximum(value, 0.0) + noise) & (value < enough))
        if len(rows) == 0:
            break
        for k, side in enumerate(sides):
            mine = rows[(facet[rows] >= split) == bool(k)]
            if len(mine) == 0:
                continue
            best, point = _facet_depth(side, mine, facet[mine] - k * split)
            better = best > value[mine]
            chosen = mine[better]
            value[chosen], owner[chosen], deep[k][chosen] = best[better], k, point[better]
        bound[rows, facet[rows]] = -np.inf
    return _depth_points(sides, value, owner, deep)


def _depth_points(sides: tuple[_Side, _Side], value: F64, owner: NDArray[np.intp], deep: F64) -> Witness:
    points = np.empty((2, len(value), 3))
    for k, side in enumerate(sides):
        rows = np.flatnonzero(owner == k)
        own = deep[k][rows]
        planes = side.other.facets
        slack = planes.offsets - own @ planes.normals.T
        j = slack.argmin(axis=1)
        foot = own + slack[np.arange(len(rows)), j][:, None] * planes.normals[j]
        if k == 1:
            back = sides[0].poses.take(rows)
            own, foot = (np.einsum("fij,fj->fi", back.rotation, x) + back.translation for x in (own, foot))
        points[k][rows], points[1 - k][rows] = own, foot
    return Witness(value, points[0], points[1])
