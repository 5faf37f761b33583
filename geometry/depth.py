"""Depth of one surface inside another, for meshes of any shape.

Depth of a in b is the largest distance to the surface of b over points of the surface of a inside b. Candidates are
vertices and points spanned by the intersection curve; then the triangles that could still hold a deeper point are
split, largest bound first. The distance to one triangle is convex, so its value at the corners bounds the whole piece.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F64, I32
from .inside import contains, distance_to_surface, nearest_faces
from .solids import connected
from .triangles import nearest_on_triangles, triangle_pair_segments

if TYPE_CHECKING:
    from .polytopes import Relative
    from .solids import Solid

__all__ = ["Deep", "crossing_excursion", "surface_depth"]

PRECISION = 0.004
"""Own choice: refinement ends when no piece can be deeper than the best by more than this fraction (1 % is promised)."""
PIECES = 600
"""Pieces split per round, largest bound first."""
ROUNDS = 60
"""Own choice: rounds after which refinement ends in any case; random overlaps need about ten."""
CURVE_POINTS = 12
"""Intersection points per triangle whose midpoints are tried."""


class Deep(NamedTuple):
    """Depth [m] (0 where nothing is inside), the deep point and the nearest point of the other surface, shape (3,)."""

    depth: float
    point: F64
    foot: F64


def _evaluate(other: Solid, points: F64, best: Deep) -> Deep:
    """The deepest of `points` if it beats `best`; points are visited by falling upper bound."""
    if len(points) == 0:
        return best
    bound = other.vertex_tree.query(points)[0]
    order = np.argsort(-bound)
    step = 64
    while len(order):
        order = order[bound[order] > best.depth]
        block, order = order[:step], order[step:]
        if len(block) == 0:
            break
        distance, foot = distance_to_surface(other, points[block])
        deeper = np.flatnonzero(distance > best.depth)
        deeper = deeper[contains(other, points[block[deeper]])]
        if len(deeper):
            k = deeper[distance[deeper].argmax()]
            best = Deep(float(distance[k]), points[block[k]], foot[k])
        step = min(4 * step, 4096)
    return best


def surface_depth(surface: Solid, pose: Relative, other: Solid, pairs: I32, *, noise: float, tolerance: float = 0.0) -> Deep:
    """Depth of `surface` inside the closed solid `other`.

    Args:
        surface: the surface whose points may be inside.
        pose: its one pose in the frame of `other`.
        other: the solid; an open one has no inside and gives 0.
        pairs: crossing or touching triangles as (triangle of surface, triangle of other), shape (k, 2).
        noise: depths [m] up to this are not refined.
        tolerance: the depth may be too small by this [m] besides `PRECISION`.

    Returns:
        Depth and points in the frame of `other`.
    """
    nothing = Deep(0.0, np.zeros(3), np.zeros(3))
    if not other.closed:
        return nothing
    if len(pairs) == 0:
        near = contains(other, pose.forward(surface.component_heads)[0])[surface.component[surface.faces[:, 0]]]
    else:
        center = pose.backward(other.sphere_center[None])[0, 0]
        low, high = surface.face_bounds
        near = ((low <= center + other.sphere_radius) & (high >= center - other.sphere_radius)).all(axis=1)
    if not near.any():
        return nothing
    cut = np.zeros(len(surface.faces), dtype=bool)
    cut[pairs[:, 0]] = True
    cut = cut[near]
    used, index = np.unique(surface.faces[near], return_inverse=True)
    faces = index.reshape(-1, 3)
    moved = pose.forward(surface.vertices[used])[0]
    # Vertices joined by triangles that nothing cuts are all inside or all outside.
    kept = faces[~cut]
    label = connected(len(used), np.concatenate([kept[:, [0, 1]], kept[:, [1, 2]]]))
    vertex_inside = contains(other, moved[np.unique(label, return_index=True)[1]])[label]
    best = _evaluate(other, moved[vertex_inside], nothing)
    if len(pairs):
        triangles = pose.forward(surface.triangles[pairs[:, 0]].reshape(-1, 3)).reshape(-1, 3, 3)
        best = _evaluate(other, _curve_points(triangles, other.triangles[pairs[:, 1]], pairs[:, 0]), best)
    if best.depth <= noise:
        return best
    return _refine(moved[faces[cut | vertex_inside[faces].any(axis=1)]], other, best, max(noise, tolerance))


def _curve_points(triangles: F64, others: F64, triangle: I32) -> F64:
    """Midpoints between points where the other surface cuts each triangle: they lie in the cut's own scale.

    `triangles` and `others` are pairs of corners, shape (k, 3, 3); `triangle` names the first of each pair.
    """
    names, first = np.unique(triangle, return_index=True)
    pierced = triangle_pair_segments(triangles, others)
    owner = np.concatenate([np.repeat(triangle, pierced.shape[1]), np.repeat(names, 3)])
    points = np.concatenate([pierced.reshape(-1, 3), triangles[first].reshape(-1, 3)])
    real = ~np.isnan(points[:, 0])
    order = np.argsort(owner[real], kind="stable")
    owner, points = owner[real][order], points[real][order]
    found = [np.empty((0, 3))]
    stops = np.searchsorted(owner, names, side="right")
    for i, j in zip(np.searchsorted(owner, names), stops, strict=True):
        group = points[i:j]
        if len(group) > CURVE_POINTS:
            group = group[np.linspace(0, len(group) - 1, CURVE_POINTS).astype(int)]
        p, q = np.triu_indices(len(group), 1)
        found.extend((0.5 * (group[p] + group[q]), group.mean(axis=0, keepdims=True)))
    return np.concatenate(found)


class _Samples(NamedTuple):
    """Points on the surface with what is known of them; all arrays share their leading axes."""

    point: F64
    distance: F64
    face: NDArray[np.intp]
    """Nearest triangle of the other surface."""
    inside: NDArray[np.bool_]

    def take(self, index: NDArray[np.intp] | NDArray[np.bool_]) -> _Samples:
        return _Samples(self.point[index], self.distance[index], self.face[index], self.inside[index])


def _sample(other: Solid, points: F64) -> _Samples:
    flat = points.reshape(-1, 3)
    distance, _, face = nearest_faces(other, flat)
    shape = points.shape[:-1]
    return _Samples(points, distance.reshape(shape), face.reshape(shape), contains(other, flat).reshape(shape))


def _refine(pieces: F64, other: Solid, best: Deep, noise: float) -> Deep:
    """Split triangles, shape (n, 3, 3), until none can hold a point deeper than the best found: largest bound first."""
    pool = _sample(other, pieces)
    best = _deepest(pool, other, best)
    upper = _upper(pool, other)
    for _ in range(ROUNDS):
        open_ones = upper > best.depth * (1.0 + PRECISION) + noise
        pool, upper = pool.take(open_ones), upper[open_ones]
        if len(upper) == 0:
            break
        order = np.argsort(-upper, kind="stable")
        corners, rest = pool.take(order[:PIECES]), order[PIECES:]
        middle = _sample(other, 0.5 * (corners.point + np.roll(corners.point, -1, axis=1)))
        best = _deepest(middle, other, best)
        parts = _split(corners, middle)
        pool = _Samples(*(np.concatenate(pair) for pair in zip(parts, pool.take(rest), strict=True)))
        upper = np.concatenate([_upper(parts, other), upper[rest]])
    return best


def _upper(corners: _Samples, other: Solid) -> F64:
    """Upper bound of the depth over each piece: signed depth changes no faster than one moves, and `_corner_bound`."""
    sides = np.linalg.norm(corners.point - np.roll(corners.point, -1, axis=1), axis=2)
    # Farthest that a point of the piece lies from each corner.
    reach = np.maximum(sides, np.roll(sides, 1, axis=1))
    signed = np.where(corners.inside, corners.distance, -corners.distance)
    return np.asarray(np.minimum((signed + reach).min(axis=1), _corner_bound(corners, other)))


def _deepest(samples: _Samples, other: Solid, best: Deep) -> Deep:
    depth = np.where(samples.inside, samples.distance, 0.0)
    k = np.unravel_index(int(depth.argmax()), depth.shape)
    if depth[k] <= best.depth:
        return best
    foot = nearest_on_triangles(samples.point[k], other.triangles[samples.face[k]]).point
    return Deep(float(depth[k]), samples.point[k], foot)


def _corner_bound(corners: _Samples, other: Solid) -> F64:
    """Upper bound of the distance over each piece from what is nearest to its corners.

    The distance to one convex triangle is convex, so that its largest corner value bounds the piece. Corners nearest to
    coplanar triangles bound it alike where those cover its shadow on their plane. A hole between them could hide a
    deeper point from this bound, not from the candidates of the intersection curve (own choice: without it, seams of
    parallel surfaces would split for ever).
    """
    nearest = other.triangles[corners.face]
    single = nearest_on_triangles(corners.point[:, :, None], nearest[:, None]).distance.max(axis=1).min(axis=1)
    plane = other.coplanar[corners.face]
    flat = (plane == plane[:, :1]).all(axis=1)
    return np.asarray(np.where(flat, np.minimum(single, corners.distance.max(axis=1)), single))


def _split(corners: _Samples, middle: _Samples) -> _Samples:
    """Four pieces of each: `middle` holds the midpoints of sides 01, 12, 20."""
    parts = ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5))
    point, distance, face, inside = (np.concatenate([c, m], axis=1) for c, m in zip(corners, middle, strict=True))
    both = _Samples(point, distance, face, inside)
    count = len(point)
    rows = np.tile(np.arange(count), len(parts))[:, None]
    columns = np.repeat(np.array(parts), count, axis=0)
    return _Samples(both.point[rows, columns], both.distance[rows, columns], both.face[rows, columns], both.inside[rows, columns])


def crossing_excursion(one: F64, two: F64, *, noise: float) -> float:
    """How far triangles of two open sheets reach through each other [m]; 0 where they only touch.

    For each crossing pair the corners of one rise on both sides of the plane of the other; the smaller rise, the
    smaller of the two ways, the largest over the pairs. Sheets cut into small triangles thus give less, never 0.

    Args:
        one: triangles of one sheet, shape (k, 3, 3), in a common frame.
        two: for each of them a triangle of the other sheet that it may cross, same shape.
        noise: intersection segments [m] shorter than this are touches.
    """
    if len(one) == 0:
        return 0.0
    pierced = triangle_pair_segments(one, two)
    filled = np.where(np.isnan(pierced), np.inf, pierced).min(axis=1), np.where(np.isnan(pierced), -np.inf, pierced).max(axis=1)
    with np.errstate(invalid="ignore"):
        length = np.nan_to_num(np.linalg.norm(filled[1] - filled[0], axis=1), nan=0.0, posinf=0.0)
    reach = np.minimum(_through(one, two), _through(two, one))
    return float(reach[(length > noise) & (reach > noise)].max(initial=0.0))


def _through(one: F64, two: F64) -> F64:
    normal = np.cross(two[:, 1] - two[:, 0], two[:, 2] - two[:, 0])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    height = np.einsum("nki,ni->nk", one - two[:, :1], normal)
    return np.asarray(np.minimum(height.max(axis=1), -height.min(axis=1)))
