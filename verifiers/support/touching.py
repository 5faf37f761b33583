"""Contacts of two entities, and the directions in which they can push: contact points with normals, from visible surfaces."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry import distance_to_surface
from ...geometry.triangles import nearest_on_triangles, segment_points
from ...worlds.arrays import F64, RigidPose, cross, length
from ..scene.bounds import ROUNDING
from ..scene.surfaces import MANY_PARTS
from .bounds import BEND, EDGE_SLACK, SAME_NORMAL

if TYPE_CHECKING:
    from ...geometry import Solid
    from ..scene.shapes import PartSurface
    from ..scene.surfaces import Surfaces

__all__ = ["Contacts", "contacts_of", "hull_corners"]

MOST_PAIRS = 1_000_000
"""Edge pairs or point-triangle pairs that are compared at once."""
MOST_POINTS = 200
"""Own choice: points of two parts at which directions are looked for, those where the surfaces are nearest; flat patches keep their corners."""
MOST_NEAR = 64
"""Own choice: triangles of one surface that are looked at about one point, the nearest ones; a flush corner has a dozen."""
MOST_EDGES = 24
"""Own choice: directions of edges of one surface that are crossed with those of the other at one point; a rim of more is round."""


class Contacts(NamedTuple):
    """Contact of two entities at one frame. A point may occur several times, with different normals."""

    points: F64
    """[m], shape (n, 3)."""
    normals: F64
    """Unit directions in which the second entity can push the first, shape (n, 3)."""
    friction: F64
    """Coulomb coefficient, shape (n,)."""


class _Placed(NamedTuple):
    """A part in its place."""

    pose: RigidPose
    points: F64
    """Its vertices [m], shape (n, 3)."""
    lower: F64
    """Corners of the box around them [m], shape (3,)."""
    upper: F64


class _Side(NamedTuple):
    """Triangles and edges of one part that lie near the other."""

    triangles: F64
    """[m], shape (m, 3, 3)."""
    normals: F64
    """Outward, shape (m, 3)."""
    sided: bool
    """True if outward is known: the surface bounds a volume."""


def contacts_of(surfaces: Surfaces, a: str, b: str, frame: int) -> Contacts:
    """Contacts by which `b` can push `a`; empty where they are farther apart than the contact tolerance.

    Points are the corners of the overlap of the touching faces: vertices of either near the other, and crossings of
    edges. A direction is a contact normal where all of `a` at the point lies on its side and all of `b` on the other.
    """
    if frame > 0:
        return _contacts(surfaces, a, b, frame)
    # Every body of a heap asks for the contacts of its whole heap.
    return surfaces.candidate.memo(("contacts", surfaces, a, b), lambda: _contacts(surfaces, a, b, 0))


def _contacts(surfaces: Surfaces, a: str, b: str, frame: int) -> Contacts:
    nearest = (surfaces.known_gap(a, b) if frame == 0 else None) or surfaces.gap(a, b, frame)
    none = Contacts(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0))
    if nearest.distance > surfaces.contact_gap(a, b):
        return none
    points: list[F64] = []
    normals: list[F64] = []
    friction: list[F64] = []
    touch = _touch_compiled if len(surfaces.parts) >= MANY_PARTS else _touch
    for i, j in _near_parts(surfaces, a, b, frame, max(nearest.distance, 0.0) + EDGE_SLACK):
        one, two = surfaces.parts[i], surfaces.parts[j]
        slack = max(nearest.distance, 0.0) + EDGE_SLACK + one.deviation + two.deviation
        if surfaces.farther(i, j, frame, slack):
            continue
        found, ways = touch(one, two, (_placed(surfaces, i, frame), _placed(surfaces, j, frame)), slack)
        points.append(found)
        normals.append(ways)
        friction.append(np.full(len(found), _friction(surfaces, one, two)))
    if sum(len(p) for p in points) == 0:
        way = nearest.point_a - nearest.point_b if nearest.distance > 0.0 else nearest.point_b - nearest.point_a
        length = float(np.linalg.norm(way))
        if length == 0.0:
            return none
        pair = next(
            _friction(surfaces, surfaces.parts[i], surfaces.parts[j])
            for i in surfaces.parts_of[a]
            for j in surfaces.parts_of[b]
            if (surfaces.parts[i].part, surfaces.parts[j].part) == (nearest.part_a, nearest.part_b)
        )
        return Contacts(0.5 * (nearest.point_a + nearest.point_b)[None], way[None] / length, np.array([pair]))
    return _corners(Contacts(np.concatenate(points), np.concatenate(normals), np.concatenate(friction)))


def _placed(surfaces: Surfaces, part: int, frame: int) -> _Placed:
    """A part in its place, where its shape at frame 0 is at a frame; kept of frame 0, at which many things stand on one."""

    def made() -> _Placed:
        pose = surfaces.track_of(part).at(frame)
        points = pose.apply(surfaces.parts[part].solid.vertices)
        return _Placed(pose, points, points.min(axis=0), points.max(axis=0))

    return made() if frame > 0 else surfaces.candidate.memo(("placed", surfaces, part), made)


def _near_parts(surfaces: Surfaces, a: str, b: str, frame: int, slack: float) -> list[tuple[int, int]]:
    """Pairs of parts of two entities whose boxes come within the slack of `_touch`, in their order; bodies that deform, all of them."""
    rows, columns = surfaces.parts_of[a], surfaces.parts_of[b]
    if surfaces.shapes.soft & {*rows, *columns}:  # `_touch` takes their shape at frame 0
        return list(product(rows, columns))
    (low_a, high_a), (low_b, high_b) = surfaces.tight_boxes(a, frame), surfaces.tight_boxes(b, frame)
    error = [np.array([surfaces.parts[i].deviation for i in side]) for side in (rows, columns)]
    reach = 2.0 * (slack + error[0][:, None] + error[1]) + ROUNDING
    apart = np.maximum(low_a[:, None] - high_b, low_b - high_a[:, None]).max(axis=2)
    return [(rows[m], columns[n]) for m, n in np.argwhere(apart <= reach).tolist()]


def _friction(surfaces: Surfaces, one: PartSurface, two: PartSurface) -> float:
    """Coefficient of a pair at rest: its own, else the larger of the two materials' (as `worlds/spec/entities.py` says)."""
    spec = surfaces.candidate.spec
    for pair in spec.simulation.contacts.values():
        if {pair.a, pair.b} == {one.entity, two.entity} and pair.friction_at_rest is not None:
            return pair.friction_at_rest
    names = [next(p.material for p in surfaces.candidate.entity(s.entity).parts if p.part == s.part) for s in (one, two)]
    return max(spec.materials[n].friction_at_rest if n in spec.materials else 0.0 for n in names)


def _touch(one: PartSurface, two: PartSurface, placed: tuple[_Placed, _Placed], slack: float) -> tuple[F64, F64]:
    (_, here, *box), (_, there, *more) = placed
    low, high = np.maximum(box[0], more[0]) - slack, np.minimum(box[1], more[1]) + slack
    if (low > high).any():
        return np.zeros((0, 3)), np.zeros((0, 3))
    points = _points(one, two, (placed[0].pose, placed[1].pose), (here, there), (low, high), slack)
    if len(points) == 0:
        return np.zeros((0, 3)), np.zeros((0, 3))
    own, other = (_side(placed, part, low, high) for placed, part in ((here, one), (there, two)))
    found, ways = [], []
    for point, near in zip(points, _near(points, own, other, slack), strict=True):
        for way in _normals(point, own, other, near, slack):
            found.append(point)
            ways.append(way)
    return np.array(found).reshape(-1, 3), np.array(ways).reshape(-1, 3)


def _touch_compiled(one: PartSurface, two: PartSurface, placed: tuple[_Placed, _Placed], slack: float) -> tuple[F64, F64]:
    """The same by compiled loops."""
    from .touching_kernels import places, pushes

    (_, here, *box), (_, there, *more) = placed
    low, high = np.maximum(box[0], more[0]) - slack, np.minimum(box[1], more[1]) + slack
    if (low > high).any():
        return np.zeros((0, 3)), np.zeros((0, 3))
    solids = one.solid, two.solid
    faces, edges = [s.faces for s in solids], [s.edges for s in solids]
    points, apart = places(here, there, *faces, *edges, low, high, slack, MOST_PAIRS)
    if len(points) == 0:
        return np.zeros((0, 3)), np.zeros((0, 3))
    sides = tuple((s.closed, _sign(s)) for s in solids)
    limits = (slack, SAME_NORMAL, BEND, float(MOST_EDGES))
    found, ways = pushes(_different(points, apart), here, there, *faces, np.stack([low, high]), sides, limits, MOST_NEAR)
    return found, ways


def _points(
    one: PartSurface,
    two: PartSurface,
    poses: tuple[RigidPose, RigidPose],
    placed: tuple[F64, F64],
    box: tuple[F64, F64],
    slack: float,
) -> F64:
    """Vertices of either near the other, and crossings of edges, shape (n, 3)."""
    low, high = box
    found: list[F64] = []
    apart: list[F64] = []
    for own, solid, pose in ((placed[0], two.solid, poses[1]), (placed[1], one.solid, poses[0])):
        inside = own[((own >= low) & (own <= high)).all(axis=1)]
        if len(inside):
            distance = distance_to_surface(solid, pose.inverse().apply(inside)).distance
            found.append(inside[distance <= slack])
            apart.append(distance[distance <= slack])
    (p, q), (r, s) = (_near_edges(own, part.solid.edges, low, high) for own, part in zip(placed, (one, two), strict=True))
    if 0 < len(p) * len(r) <= MOST_PAIRS:
        u, v = (q - p)[:, None], (s - r)[None]
        t, w = segment_points(p[:, None], u, r[None], v)
        first, second = p[:, None] + t[..., None] * u, r[None] + w[..., None] * v
        distance = length(first - second)
        found.append(first[distance <= slack])
        apart.append(distance[distance <= slack])
    points = np.concatenate(found) if found else np.zeros((0, 3))
    return points if len(points) == 0 else _different(points, np.concatenate(apart))


def _different(points: F64, apart: F64) -> F64:
    """Points of which none is another once more, the first of each; `apart`: how far the surfaces are apart there [m]."""
    places = np.round(points / (0.1 * EDGE_SLACK))
    if len(points) <= MOST_POINTS:
        return points[list(_first(places))]
    _, kept = np.unique(places, axis=0, return_index=True)
    if len(kept) > MOST_POINTS:  # flush faces of many triangles: all are as near, and the corners of the patch must be among them
        kept = _outermost(points, apart, kept)
    return points[np.sort(kept)]


def _sign(solid: Solid) -> float:
    """-1 for a surface that is inside out, as imported ones may be, else 1."""
    return -1.0 if solid.closed and solid.volume < 0.0 else 1.0


def _outermost(points: F64, apart: F64, kept: NDArray[np.intp]) -> NDArray[np.intp]:
    """The `MOST_POINTS` nearest of some points, and of those as near as EDGE_SLACK the farthest in every direction."""
    near = kept[np.argsort(apart[kept], kind="stable")]
    flush = near[apart[near] <= apart[near[0]] + EDGE_SLACK]
    ways = np.array(list(product((-1.0, 0.0, 1.0), repeat=3)))
    corners = flush[np.argmax(points[flush] @ ways.T, axis=0)]
    return np.unique(np.concatenate([corners, near[:MOST_POINTS]]))


def _near_edges(points: F64, edges: NDArray[np.int32], low: F64, high: F64) -> tuple[F64, F64]:
    """Ends of the edges whose boxes meet a box, shapes (n, 3)."""
    ends = points[edges]
    meets = ((ends.min(axis=1) <= high) & (ends.max(axis=1) >= low)).all(axis=1)
    return ends[meets, 0], ends[meets, 1]


def _side(points: F64, part: PartSurface, low: F64, high: F64) -> _Side:
    corner = points[part.solid.faces]
    meets = ((corner.min(axis=1) <= high) & (corner.max(axis=1) >= low)).all(axis=1)
    corner = corner[meets]
    normal = cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    length = np.linalg.norm(normal, axis=1)
    flat = length > 0.0
    return _Side(corner[flat], _sign(part.solid) * normal[flat] / length[flat, None], part.solid.closed)


def _normals(point: F64, own: _Side, other: _Side, near: tuple[NDArray[np.intp], NDArray[np.intp]], slack: float) -> F64:
    """Directions in which the other surface can push the own one at a point, shape (n, 3); empty where none is known.

    `near`: triangles of either side within `slack` [m] of the point.
    """
    if min(len(n) for n in near) == 0:
        return np.zeros((0, 3))
    mine, theirs = own.triangles[near[0]], other.triangles[near[1]]
    # Flush faces lie on both sides of their plane; only their outward normals tell from where they push.
    ways = [other.normals[near[1]], -own.normals[near[0]]]
    ways += [-w for w, side in zip(ways, (other, own), strict=True) if not side.sided]
    kept = _separating(_apart(np.concatenate(ways)), point, mine, theirs, slack)
    if len(kept) == 0:
        edges = [_directions(t) for t in (mine, theirs)]
        across = cross(edges[0][:, None], edges[1][None]).reshape(-1, 3)
        length = np.linalg.norm(across, axis=1)
        across = across[length > SAME_NORMAL] / length[length > SAME_NORMAL, None]
        kept = _separating(_apart(np.concatenate([across, -across])), point, mine, theirs, slack)
    return kept


def _near(points: F64, own: _Side, other: _Side, slack: float) -> list[tuple[NDArray[np.intp], NDArray[np.intp]]]:
    """Indices of the triangles of either side within `slack` [m] of each point, the `MOST_NEAR` nearest ones, in their order."""
    count, triangles = len(own.triangles), np.concatenate([own.triangles, other.triangles])
    step = max(1, MOST_PAIRS // max(len(triangles), 1))
    blocks = [points[k : k + step] for k in range(0, len(points), step)]
    rows = (row for block in blocks for row in nearest_on_triangles(block[:, None], triangles[None]).distance)
    return [(_nearest(row[:count], slack), _nearest(row[count:], slack)) for row in rows]


def _nearest(distance: F64, slack: float) -> NDArray[np.intp]:
    found = np.flatnonzero(distance <= slack)
    if len(found) <= MOST_NEAR:
        return found
    return np.sort(found[np.argsort(distance[found], kind="stable")[:MOST_NEAR]])


def _apart(ways: F64) -> F64:
    """Directions of which none is another once more, shape (n, 3)."""
    return np.asarray(ways[list(_first(np.round(ways / SAME_NORMAL)))])


def _first(keys: F64) -> Iterable[int]:
    """Indices of the rows that are none before once more, in their order; faster than numpy's for some hundreds."""
    first: dict[tuple[float, ...], int] = {}
    for index, key in enumerate(map(tuple, keys.tolist())):
        first.setdefault(key, index)
    return first.values()


def _directions(triangles: F64) -> F64:
    """Directions of the edges of some triangles [1], each once, at most `MOST_EDGES`, shape (n, 3)."""
    edges = (triangles - np.roll(triangles, 1, axis=1)).reshape(-1, 3)
    length = np.linalg.norm(edges, axis=1)
    edges = edges[length > 0.0] / length[length > 0.0, None]
    first = np.take_along_axis(edges, np.abs(edges).argmax(axis=1)[:, None], axis=1)
    return _apart(edges * np.sign(first))[:MOST_EDGES]


def _separating(ways: F64, point: F64, mine: F64, theirs: F64, slack: float) -> F64:
    above, below = (mine - point).reshape(-1, 3), (point - theirs).reshape(-1, 3)
    allowed = [slack + BEND * length(side) for side in (above, below)]
    good = (ways @ above.T >= -allowed[0]).all(axis=1) & (ways @ below.T >= -allowed[1]).all(axis=1)
    return np.asarray(ways[good])


def _corners(contacts: Contacts) -> Contacts:
    """Leave out points inside flat patches: forces at the corners give every force and moment that they could."""
    groups = np.round(np.column_stack([contacts.normals, contacts.friction]) / SAME_NORMAL)
    member: dict[tuple[float, ...], list[int]] = {}
    for row, key in enumerate(map(tuple, groups.tolist())):
        member.setdefault(key, []).append(row)
    kept: list[NDArray[np.intp]] = []
    for rows in member.values():
        index = np.array(rows, dtype=np.intp)
        normal = contacts.normals[index[0]]
        side = np.linalg.svd(normal[None])[2][1:]
        offset = contacts.points[index] - contacts.points[index[0]]
        flat = np.ptp(offset @ normal) <= EDGE_SLACK
        kept.append(index[hull_corners(offset @ side.T)] if flat else index)
    chosen = np.sort(np.concatenate(kept))
    return Contacts(contacts.points[chosen], contacts.normals[chosen], contacts.friction[chosen])


def hull_corners(points: F64) -> NDArray[np.intp]:
    """Indices of the corners of the convex hull of points in the plane, shape (n, 2); its ends where it is a line."""
    from scipy.spatial import ConvexHull, QhullError

    if len(points) <= 3:
        return np.arange(len(points))
    try:
        return np.asarray(ConvexHull(points).vertices, dtype=np.intp)
    except QhullError:
        spread = points - points.mean(axis=0)
        along = spread @ np.linalg.svd(spread)[2][0]
        return np.unique([along.argmin(), along.argmax()])
