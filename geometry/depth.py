"""Depth of one surface inside another, for meshes of any shape.

Depth of a in b is the largest distance to the surface of b over points of the surface of a inside b. Candidates are
vertices and points spanned by the intersection curve; then the triangles that could still hold a deeper point are
split, largest bound first. The distance to one triangle is convex, so its value at the corners bounds the whole piece, and
so does every mean of such distances: along a ridge, where triangles on either side are equally near, only their mean is tight.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F64, I32
from .clipped import clipped
from .inside import contains, distance_to_surface, nearest_faces
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
HEIGHTS = 2_000_000
"""Heights of points above planes per chunk."""
CURVE_POINTS = 12
"""Intersection points per triangle whose midpoints are tried."""


SIDES = ((0, 1), (1, 2), (2, 0))
"""Pairs of three things."""


class Deep(NamedTuple):
    """Depth [m] (0 where nothing is inside), the deep point and the nearest point of the other surface, shape (3,)."""

    depth: float
    point: F64
    foot: F64


def _evaluate(other: Solid, points: F64, best: Deep, *, within: F64 | float = np.inf) -> Deep:
    """The deepest of `points` if it beats `best`, visited by falling upper bound; none is deeper than `within` [m], shape (n,)."""
    if len(points) == 0:
        return best
    bound = np.minimum(other.vertex_tree.query(points)[0], within)
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


def surface_depth(
    surface: Solid,
    pose: Relative,
    other: Solid,
    pairs: I32,
    *,
    noise: float,
    tolerance: float = 0.0,
    known: float = 0.0,
    enough: float = np.inf,
) -> Deep:
    """Depth of `surface` inside the closed solid `other`.

    Args:
        surface: the surface whose points may be inside.
        pose: its one pose in the frame of `other`.
        other: the solid; an open one has no inside and gives 0.
        pairs: crossing or touching triangles as (triangle of surface, triangle of other), shape (k, 2).
        noise: depths [m] up to this are not refined.
        tolerance: the depth may be too small by this [m] besides `PRECISION`.
        known: depths [m] up to this are of no interest: thin bodies hold many that a deeper one elsewhere makes idle.
        enough: a depth [m] that ends the search: whoever asks need not know how much deeper it goes.

    Returns:
        Depth and points in the frame of `other`; where nothing is deeper than `known`, that, and no points.
    """
    nothing = Deep(known, np.zeros(3), np.zeros(3))
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
    # Every vertex is asked: triangles that touch in an edge or a corner may miss in `pairs`, so that an uncut surface may go on.
    vertex_inside = contains(other, moved)
    best = _evaluate(other, moved[vertex_inside], nothing)
    if len(pairs):
        triangles = pose.forward(surface.triangles[pairs[:, 0]].reshape(-1, 3)).reshape(-1, 3, 3)
        points, within = _curve_points(triangles, other.triangles[pairs[:, 1]], pairs[:, 0])
        best = _evaluate(other, points, best, within=within)
    if best.depth <= noise or best.depth >= enough:
        return best
    inner = vertex_inside[faces]
    whole = moved[faces[inner.any(axis=1) & ~cut]]
    pieces = np.concatenate([whole, *clipped(moved[faces], inner, np.flatnonzero(near), pairs, other, noise)])
    return _refine(pieces, other, best, max(noise, tolerance), enough)


def _curve_points(triangles: F64, others: F64, triangle: I32) -> tuple[F64, F64]:
    """Midpoints between points where the other surface cuts each triangle: they lie in the cut's own scale.

    `triangles` and `others` are pairs of corners, shape (k, 3, 3); `triangle` names the first of each pair. With each point comes
    how far the nearest of the cuts that it was made of is, at most [m].
    """
    names, first = np.unique(triangle, return_index=True)
    pierced = triangle_pair_segments(triangles, others)
    cut = np.repeat(triangle, pierced.shape[1])
    owner = np.concatenate([cut, np.repeat(names, 3)])
    points = np.concatenate([pierced.reshape(-1, 3), triangles[first].reshape(-1, 3)])
    on_other = np.arange(len(owner)) < len(cut)
    real = ~np.isnan(points[:, 0])
    order = np.argsort(owner[real], kind="stable")
    owner, points, on_other = owner[real][order], points[real][order], on_other[real][order]
    found, within = [np.empty((0, 3))], [np.empty(0)]
    stops = np.searchsorted(owner, names, side="right")
    for i, j in zip(np.searchsorted(owner, names), stops, strict=True):
        group, known = points[i:j], on_other[i:j]
        if len(group) > CURVE_POINTS:
            some = np.linspace(0, len(group) - 1, CURVE_POINTS).astype(int)
            group, known = group[some], known[some]
        p, q = np.triu_indices(len(group), 1)
        middle = group.mean(axis=0)
        found.extend((0.5 * (group[p] + group[q]), middle[None]))
        half = 0.5 * np.linalg.norm(group[p] - group[q], axis=1)
        nearest = np.linalg.norm(group[known] - middle, axis=1).min(initial=np.inf)
        within.extend((np.where(known[p] | known[q], half, np.inf), np.array([nearest])))
    return np.concatenate(found), np.concatenate(within)


class _Samples(NamedTuple):
    """Points on the surface with what is known of them; all arrays share their leading axes."""

    point: F64
    depth: F64
    """Signed depth [m]: distance to the other surface, negative outside of it; of a convex one to the nearest plane."""
    face: NDArray[np.intp]
    """Nearest triangle of the other surface, of a convex one the facet of that plane."""

    def take(self, index: NDArray[np.intp] | NDArray[np.bool_]) -> _Samples:
        return _Samples(self.point[index], self.depth[index], self.face[index])


def _sample(other: Solid, points: F64) -> _Samples:
    flat, shape = points.reshape(-1, 3), points.shape[:-1]
    if other.convex:
        depth, face = _below_planes(other, flat)
    else:
        distance, _, face = nearest_faces(other, flat)
        depth = np.where(contains(other, flat), distance, -distance)
    return _Samples(points, depth.reshape(shape), face.reshape(shape))


def _below_planes(other: Solid, points: F64) -> tuple[F64, NDArray[np.intp]]:
    """Depth [m] of points, shape (n, 3), below the planes of a convex solid, the least one, and whose facet that is.

    Inside it is the distance to the surface; outside no point lies deeper than a plane says.
    """
    facets = other.facets
    depth, face = np.empty(len(points)), np.empty(len(points), dtype=np.intp)
    step = max(1, HEIGHTS // len(facets.offsets))
    for i in range(0, len(points), step):
        below = facets.offsets - points[i : i + step] @ facets.normals.T
        face[i : i + step] = below.argmin(axis=1)
        depth[i : i + step] = below[np.arange(len(below)), face[i : i + step]]
    return depth, face


def _refine(pieces: F64, other: Solid, best: Deep, noise: float, enough: float) -> Deep:
    """Split triangles, shape (n, 3, 3), until none can hold a point deeper than the best found, or that is `enough`: largest bound first."""
    pool = _sample(other, pieces)
    best = _deepest(pool, other, best)
    upper = _upper(pool, other)
    for _ in range(ROUNDS):
        open_ones = upper > best.depth * (1.0 + PRECISION) + noise
        pool, upper = pool.take(open_ones), upper[open_ones]
        if len(upper) == 0 or best.depth >= enough:
            break
        order = np.argsort(-upper, kind="stable")
        corners, rest = pool.take(order[:PIECES]), order[PIECES:]
        best = _deepest(_peaks(corners, other), other, best)
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
    return np.asarray(np.minimum((corners.depth + reach).min(axis=1), _corner_bound(corners, other)))


def _deepest(samples: _Samples, other: Solid, best: Deep) -> Deep:
    k = np.unravel_index(int(samples.depth.argmax()), samples.depth.shape)
    if samples.depth[k] <= best.depth:
        return best
    distance, foot = distance_to_surface(other, samples.point[k][None])
    return Deep(float(distance[0]), samples.point[k], foot[0]) if distance[0] > best.depth else best


def _peaks(corners: _Samples, other: Solid) -> _Samples:
    """Where the bound of each piece says that it is deepest: on a ridge itself, which midpoints of sides may never meet."""
    weights = _least_mixture(-_heights(corners, other).swapaxes(1, 2))[1]
    return _sample(other, np.einsum("ni,nik->nk", weights, corners.point))


def _heights(corners: _Samples, other: Solid) -> F64:
    """Distance [m] of each corner to what is nearest to each of them, shape (n, 3 corners, 3): convex over the piece.

    To the triangle, of a convex solid to the plane: signed, and tight whatever the size of its facets.
    """
    if other.convex:
        normals, offsets = other.facets.normals[corners.face], other.facets.offsets[corners.face]
        return np.asarray(offsets[:, None] - corners.point @ normals.swapaxes(1, 2))
    return nearest_on_triangles(corners.point[:, :, None], other.triangles[corners.face][:, None]).distance


def _corner_bound(corners: _Samples, other: Solid) -> F64:
    """Upper bound of the depth over each piece from what is nearest to its corners.

    Corners nearest to coplanar triangles bound it as one triangle would where those cover its shadow on their plane. A hole
    between them could hide a deeper point from this bound, not from the candidates of the intersection curve (own choice:
    without it, seams of parallel surfaces would split for ever).
    """
    mixed = _least_mixture(_heights(corners, other))[0]
    if other.convex:
        return mixed
    plane = other.coplanar[corners.face]
    flat = (plane == plane[:, :1]).all(axis=1)
    return np.asarray(np.where(flat, np.minimum(mixed, np.abs(corners.depth).max(axis=1)), mixed))


def _least_mixture(value: F64) -> tuple[F64, F64]:
    """The mean of three convex functions whose largest corner value is least: an upper bound of the least of them over a triangle.

    A mean is convex too, and nowhere below the least of the three. It is the value of a matrix game, whose best weights equalise
    as many corners as they mix functions (von Neumann, doi:10.1007/BF01448847): all such are tried. Weights that rounding spoils
    still give a bound. With `-value` transposed, the weights are those of the corners where the game says that the peak is.

    Args:
        value: of each function at each corner, shape (n, 3 corners, 3 functions).

    Returns:
        The bounds, shape (n,), and the weights of the functions, shape (n, 3).
    """
    count = len(value)
    tried = [np.broadcast_to(np.eye(3), (count, 3, 3))]
    with np.errstate(divide="ignore", invalid="ignore"):
        for j, k in SIDES:
            lead = value[:, :, j] - value[:, :, k]
            for a, b in SIDES:
                share = np.clip((value[:, b, k] - value[:, a, k]) / (lead[:, a] - lead[:, b]), 0.0, 1.0)
                pair = np.zeros((count, 1, 3))
                pair[:, 0, j] = np.where(np.isnan(share), 1.0, share)
                pair[:, 0, k] = 1.0 - pair[:, 0, j]
                tried.append(pair)
        rows = value[:, :2] - value[:, 2:]
        level = np.cross(rows[:, 0], rows[:, 1])
        full = np.maximum(level / level.sum(axis=1, keepdims=True), 0.0)
        full /= full.sum(axis=1, keepdims=True)
    tried.append(np.where(np.isfinite(full).all(axis=1, keepdims=True), full, 1.0 / 3.0)[:, None])
    weights = np.concatenate(tried, axis=1)
    bound = np.einsum("nij,nmj->nmi", value, weights).max(axis=2)
    rows_of, least = np.arange(count), bound.argmin(axis=1)
    return bound[rows_of, least], weights[rows_of, least]


def _split(corners: _Samples, middle: _Samples) -> _Samples:
    """Four pieces of each: `middle` holds the midpoints of sides 01, 12, 20."""
    parts = ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5))
    both = _Samples(*(np.concatenate(pair, axis=1) for pair in zip(corners, middle, strict=True)))
    count = len(both.point)
    rows = np.tile(np.arange(count), len(parts))[:, None]
    columns = np.repeat(np.array(parts), count, axis=0)
    return _Samples(both.point[rows, columns], both.depth[rows, columns], both.face[rows, columns])


def crossing_excursion(one: F64, two: F64, *, noise: float) -> float:
    """Greatest depth to which triangles of two open sheets reach through each other [m]; 0 where they only touch.

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
