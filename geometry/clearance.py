"""Signed clearance between two surfaces: exact distance when apart, depth of the deepest surface point when not.

Depth is the largest distance to the other's surface over the surface points inside it, taken both ways. It is the
largest visible interpenetration, not the translation that would end it. Convex pairs take the route of `polytopes`;
others python-fcl for the distance of triangle soups and `depth` for what fcl cannot tell (overlap, containment).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F64, I32, RigidPose, length, rotation_matrix
from .depth import Deep, crossing_excursion, surface_depth
from .inside import contains, distance_to_surface
from .polytopes import Relative, convex_depth, edge_distance, face_separation, repeats
from .triangles import triangle_pair

if TYPE_CHECKING:
    from .solids import Solid

__all__ = ["Clearance", "clearance_series", "examine", "measure", "query_noise", "relative_poses", "signed_clearance"]

NOISE = 1e-12
"""Rounding of one query relative to the size of the bodies (see `query_noise`)."""
SMALL_WORK = 4000
"""Plane-vertex products up to which a convex pair is swept over all frames at once."""
SMALL_EDGES = 400
"""Edge pairs up to which all are compared; fcl's tree takes over above."""
FEW = 8
"""Up to this many poses single fcl queries beat a vectorised sweep over edges."""
BLOCK = 1_500_000
"""Array elements per vectorised block."""
CONTACTS = 200_000
SPREAD = 8
"""Own choice: vertices that are asked whether two bodies are in one place."""


@dataclass(frozen=True)
class Clearance:
    """Signed clearance of two surfaces at one pair of poses."""

    distance: float
    """[m]; negative is minus the depth of the deepest surface point."""
    point_a: F64
    """Point of the surface of a in the world [m], shape (3,)."""
    point_b: F64
    """Point of the surface of b in the world [m], shape (3,); the two are |distance| apart."""
    method: str
    """`facet`, `edges`, `mesh` (apart), `depth` (overlap), `coincident` (equal surfaces), `crossing` (open sheets)."""


def query_noise(size: float) -> float:
    """Largest error of a clearance near contact [m], for bodies of `size` [m] (S1): eps of penetration checks.

    Measured (`tests/geometry/test_query_noise.py`): over random flush and corner contacts |error| reaches 1.3e-15 of the
    size at the origin and 2.3e-14 at 100 sizes from it. Meshes count as flat and convex within 1e-9 of their size
    (`solids`), so eps is 1e-9 as well: vertices read from a file round far more than the query does.
    """
    return 1e-9 * size


def relative_poses(pose_a: tuple[F64, F64], pose_b: tuple[F64, F64]) -> Relative:
    """Poses of a in the frame of b from their positions (f, 3) and unit quaternions (f, 4) in the world."""
    rotation_a, rotation_b = rotation_matrix(pose_a[1]), rotation_matrix(pose_b[1])
    back = rotation_b.swapaxes(-1, -2)
    offset = np.einsum("fij,fj->fi", back, pose_a[0] - pose_b[0])
    return Relative(back @ rotation_a, offset)


def _box_gap(a: Solid, b: Solid, poses: Relative) -> F64:
    """Lower bound of the distance from the bounding boxes, in either frame [m], shape (f,)."""
    bounds = []
    for one, two, relative in ((a, b, poses), (b, a, poses.inverse())):
        center = relative.rotation @ one.sphere_center + relative.translation - two.sphere_center
        half = np.abs(relative.rotation) @ (0.5 * (one.upper - one.lower)) + 0.5 * (two.upper - two.lower)
        bounds.append(length(np.maximum(np.abs(center) - half, 0.0)))
    return np.asarray(np.maximum(bounds[0], bounds[1]))


class _Mesh:
    """fcl objects of one pair; a moves in the frame of b."""

    def __init__(self, a: Solid, b: Solid, *, witness: bool, named: list[tuple[int, int]] | None = None) -> None:
        import fcl

        self.fcl = fcl
        self.a, self.b, self.witness, self.named = a, b, witness, named
        self.request = fcl.DistanceRequest()

    @cached_property
    def bodies(self) -> tuple[Any, Any]:
        """Both as fcl takes them; most convex pairs are answered without."""
        return self.fcl.CollisionObject(self.a.bvh), self.fcl.CollisionObject(self.b.bvh)

    def place(self, poses: Relative, index: int) -> None:
        self.bodies[0].setTransform(self.fcl.Transform(poses.rotation[index], poses.translation[index]))

    def distance(self) -> tuple[float, int, int]:
        """Distance [m] of the soups (0 or less where they cross) and the nearest triangles."""
        result: Any = self.fcl.DistanceResult()
        value = self.fcl.distance(*self.bodies, self.request, result)
        return float(value), result.b1, result.b2

    def nearest(self, one: Relative, i: int, j: int) -> tuple[F64, F64]:
        """Nearest points of triangle i of a and triangle j of b, in the frame of b; zeros where nobody asks, or who asks gets their names."""
        if self.named is not None:
            self.named.append((i, j))
        if not self.witness or self.named is not None:
            return np.zeros(3), np.zeros(3)
        return triangle_pair(one.forward(self.a.triangles[i])[0], self.b.triangles[j])

    def crossings(self) -> I32:
        """Pairs of triangles that cross or touch, shape (k, 2)."""
        request = self.fcl.CollisionRequest(num_max_contacts=CONTACTS, enable_contact=True)
        result = self.fcl.CollisionResult()
        self.fcl.collide(*self.bodies, request, result)
        pairs = np.array([(c.b1, c.b2) for c in result.contacts], dtype=np.int32).reshape(-1, 2)
        return np.asarray(np.unique(pairs, axis=0))


class Care(NamedTuple):
    """Exactness that is wanted of depths [m]; one value for all poses, or one for each, shape (f,)."""

    tolerance: float = 0.0
    """They may be too small by this besides `depth.PRECISION`: a search that needs no more is much faster."""
    enough: float | F64 = np.inf
    """From here on it is no matter how deep: the answer may be any depth from there on."""
    idle: float | F64 = 0.0
    """Up to here it is no matter how deep: minus this may be the answer for surfaces that touch."""


EXACT = Care()


class _Care(NamedTuple):
    """The same at one pose."""

    tolerance: float = 0.0
    enough: float = np.inf
    idle: float = 0.0


@dataclass
class _Found:
    """Results in the frame of b, one per pose."""

    value: F64
    point_a: F64
    point_b: F64
    method: NDArray[np.str_]

    def put(self, index: NDArray[np.intp], value: F64, point_a: F64, point_b: F64, method: str) -> None:
        self.value[index], self.point_a[index], self.point_b[index], self.method[index] = value, point_a, point_b, method


def examine(
    a: Solid,
    b: Solid,
    poses: Relative,
    *,
    witness: bool,
    cares: Sequence[_Care] | None = None,
    named: list[tuple[int, int]] | None = None,
) -> _Found:
    """Clearance at each relative pose, with its points if `witness`; with `named`, the triangles that those are on are told instead."""
    count = len(poses.translation)
    found = _Found(np.empty(count), np.empty((count, 3)), np.empty((count, 3)), np.full(count, "", dtype="<U10"))
    mesh = _Mesh(a, b, witness=witness, named=named)
    if not (a.convex and b.convex):
        for k in range(count):
            _general(mesh, poses, k, found, _Care() if cares is None else cares[k])
        return found
    everything = np.arange(count)
    # Every solid has four facets at least: of large ones they are not looked for before they are needed.
    if 4 * (len(a.vertices) + len(b.vertices)) > SMALL_WORK or _work(a, b) > SMALL_WORK:
        overlapping = [k for k in range(count) if not _apart_by_mesh(mesh, poses, k, found)]
        everything = np.array(overlapping, dtype=np.intp)
    if len(everything) == 0:
        return found
    work = _work(a, b)
    enough, step = np.array([c.enough for c in cares or [_Care()] * count]), max(1, BLOCK // work)
    for i in range(0, len(everything), step):
        _convex_block(mesh, poses, everything[i : i + step], found, enough)
    return found


def _work(a: Solid, b: Solid) -> int:
    """Plane-vertex products of a convex pair."""
    return len(a.facets.normals) * len(b.vertices) + len(b.facets.normals) * len(a.vertices)


def _apart_by_mesh(mesh: _Mesh, poses: Relative, k: int, found: _Found) -> bool:
    """Fill pose k by fcl if the surfaces are apart and neither contains the other's first vertex."""
    a, b = mesh.a, mesh.b
    mesh.place(poses, k)
    value, i, j = mesh.distance()
    if value <= NOISE * (a.size + b.size):
        return False
    one = poses.take(np.array([k]))
    if contains(b, one.forward(a.vertices[:1])[0])[0] or contains(a, one.backward(b.vertices[:1])[0])[0]:
        return False
    found.put(np.array([k]), np.array(value), *mesh.nearest(one, i, j), "mesh")
    return True


def _convex_block(mesh: _Mesh, poses: Relative, index: NDArray[np.intp], found: _Found, enough: F64) -> None:
    a, b = mesh.a, mesh.b
    noise = NOISE * (a.size + b.size)
    here = poses.take(index)
    faces = face_separation(a, b, here)
    apart = faces.separation > 0.0
    simple = apart & faces.exact
    found.put(index[simple], faces.separation[simple], faces.point_a[simple], faces.point_b[simple], "facet")
    meeting = np.flatnonzero(~apart)
    by_edges = [np.flatnonzero(apart & ~faces.exact)]
    if len(meeting):
        some = faces.take(meeting)
        deep = convex_depth(a, b, here.take(meeting), some, enough[index[meeting]])
        inside = deep.value > -noise
        put = meeting[inside]
        found.put(index[put], -deep.value[inside], deep.point_a[inside], deep.point_b[inside], "depth")
        by_edges.append(meeting[~inside])
        level = inside & (np.abs(deep.value) <= noise) & (some.separation < -noise)
        for k in meeting[level]:
            _coincident(mesh, poses, int(index[k]), found)
    rest = np.concatenate(by_edges)
    if len(rest) == 0:
        return
    pairs = len(a.facets.edges) * len(b.facets.edges)
    if pairs > SMALL_EDGES or len(rest) <= FEW:
        for k in rest:
            mesh.place(poses, int(index[k]))
            value, i, j = mesh.distance()
            points = mesh.nearest(here.take(np.array([k])), i, j)
            found.put(index[k : k + 1], np.array(max(value, 0.0)), *points, "edges")
        return
    step = max(1, BLOCK // (10 * pairs))
    for s in range(0, len(rest), step):
        block = rest[s : s + step]
        found.put(index[block], *edge_distance(a, b, here.take(block), faces.direction[block]), "edges")


def _coincident(mesh: _Mesh, poses: Relative, k: int, found: _Found) -> bool:
    """Surfaces that meet without going inside each other: the bodies may still be the same. Then they overlap fully."""
    a, b = mesh.a, mesh.b
    one = poses.take(np.array([k]))
    noise = 1e3 * NOISE * (a.size + b.size)
    if a.interior_point is None or b.interior_point is None:
        return False
    for point in (one.forward(a.interior_point[None])[0], b.interior_point[None]):
        local = one.backward(point)[0]
        if not (contains(b, point)[0] and contains(a, local)[0]):
            continue
        on_a, on_b = distance_to_surface(a, local), distance_to_surface(b, point)
        depth = min(on_a.distance[0], on_b.distance[0])
        if depth > noise:
            found.put(np.array([k]), np.array(-depth), one.forward(on_a.point)[0], point, "coincident")
            return True
    return False


def _flush(a: Solid, b: Solid, one: Relative, noise: float) -> bool:
    """True if some vertices of a, spread over it, lie in the surface of b: bodies in one place pass, those that overlap or rest seldom."""
    some = a.vertices[np.linspace(0, len(a.vertices) - 1, SPREAD).astype(np.intp)]
    return bool(distance_to_surface(b, one.forward(some)[0]).distance.max() <= noise)


def _is_copy(a: Solid, b: Solid, one: Relative, noise: float) -> bool:
    """True if a and b are the same closed mesh in the same place: all their triangles touch, so ask nothing else."""
    if not (a.closed and b.closed) or a.vertices.shape != b.vertices.shape or a.faces.shape != b.faces.shape:
        return False
    return np.array_equal(a.faces, b.faces) and bool(np.abs(one.forward(a.vertices)[0] - b.vertices).max() <= noise)


def _general(mesh: _Mesh, poses: Relative, k: int, found: _Found, care: _Care) -> None:
    a, b = mesh.a, mesh.b
    noise = NOISE * (a.size + b.size)
    here = np.array([k])
    one = poses.take(here)
    if _is_copy(a, b, one, noise) and _coincident(mesh, poses, k, found):
        return
    mesh.place(poses, k)
    value, i, j = mesh.distance()
    touching = value <= noise
    if not touching and not (_holds(b, one.forward(a.component_heads)[0]) or _holds(a, one.backward(b.component_heads)[0])):
        found.put(here, np.array(value), *mesh.nearest(one, i, j), "mesh")
        return
    pairs = mesh.crossings() if touching else np.empty((0, 2), dtype=np.int32)
    into_b, into_a = _both_ways(a, b, one, pairs, noise, care)
    if max(into_a.depth, into_b.depth) > max(noise, care.idle):
        point_a, point_b, depth = _deep_points(one, into_b, into_a)
        found.put(here, np.array(-depth), point_a, point_b, "depth")
        return
    level = -care.idle if care.idle > noise and (a.closed or b.closed) else max(value, 0.0)
    found.put(here, np.array(level), *mesh.nearest(one, i, j), "mesh")
    if not touching:
        return
    if a.closed and b.closed:
        if care.idle <= noise or _flush(a, b, one, 1e3 * noise):
            _coincident(mesh, poses, k, found)
    elif not a.closed and not b.closed:
        triangles = one.forward(a.triangles[pairs[:, 0]].reshape(-1, 3)).reshape(-1, 3, 3)
        reach = crossing_excursion(triangles, b.triangles[pairs[:, 1]], noise=noise)
        if reach > noise:
            found.put(here, np.array(-reach), *mesh.nearest(one, i, j), "crossing")


def _both_ways(a: Solid, b: Solid, one: Relative, pairs: I32, noise: float, care: _Care) -> tuple[Deep, Deep]:
    """Depth of a inside b and of b inside a, the lesser one 0 where the search had no need of it.

    The thicker body is asked first: a sheet through it is nowhere as deep in itself, which a search of its own, for a plateau of
    half its thickness all along the cut, would take thousands of times as long to say.
    """
    ways = [(a, one, b, pairs), (b, one.inverse(), a, pairs[:, ::-1])]
    turn = _thickness(a) > _thickness(b)
    first, second = ways[::-1] if turn else ways
    found = surface_depth(*first, noise=noise, tolerance=care.tolerance, known=care.idle, enough=care.enough)
    deeper = found
    if found.depth < care.enough:
        deeper = surface_depth(*second, noise=noise, tolerance=care.tolerance, known=found.depth, enough=care.enough)
    if deeper.depth <= found.depth:
        deeper = Deep(0.0, deeper.point, deeper.foot)
    return (deeper, found) if turn else (found, deeper)


def _thickness(solid: Solid) -> float:
    """Volume over surface [m]; 0 of an open surface."""
    return solid.volume / solid.area if solid.closed else 0.0


def _holds(solid: Solid, points: F64) -> bool:
    return solid.closed and bool(contains(solid, points).any())


def _deep_points(one: Relative, into_b: Deep, into_a: Deep) -> tuple[F64, F64, float]:
    if into_b.depth >= into_a.depth:
        return into_b.point, into_b.foot, into_b.depth
    moved = one.forward(np.stack([into_a.foot, into_a.point]))[0]
    return moved[0], moved[1], into_a.depth


def signed_clearance(a: Solid, pose_a: RigidPose, b: Solid, pose_b: RigidPose) -> Clearance:
    """Exact signed clearance of two surfaces, with the points it is taken between.

    Args:
        a: one surface, in its own frame.
        pose_a: its pose in the world.
        b: the other surface.
        pose_b: its pose in the world.
    """
    relative = relative_poses((pose_a[0][None], pose_a[1][None]), (pose_b[0][None], pose_b[1][None]))
    found = examine(a, b, relative, witness=True)
    points = pose_b.apply(np.stack([found.point_a[0], found.point_b[0]]))
    return Clearance(float(found.value[0]), points[0], points[1], str(found.method[0]))


def clearance_series(a: Solid, poses_a: tuple[F64, F64], b: Solid, poses_b: tuple[F64, F64], *, skip_above: float) -> F64:
    """Signed clearance per frame [m], shape (frames,).

    Frames whose bounding boxes are farther apart than `skip_above` [m] get that gap, a lower bound; the others the
    value of `signed_clearance`. Frames that repeat a relative pose reuse its value.

    Args:
        a: one surface.
        poses_a: positions (frames, 3) and unit quaternions (frames, 4) of a.
        b: the other surface.
        poses_b: the same for b.
        skip_above: bounding-box gap [m] from which on a lower bound is enough.
    """
    poses = relative_poses(poses_a, poses_b)
    result = _box_gap(a, b, poses)
    near = np.flatnonzero(result <= skip_above)
    if len(near) == 0:
        return result
    anchor = repeats(poses.take(near))
    compute = np.flatnonzero(anchor == np.arange(len(near)))
    values = np.empty(len(near))
    values[compute] = examine(a, b, poses.take(near[compute]), witness=False).value
    result[near] = values[anchor]
    return result


def measure(a: Solid, b: Solid, poses: Relative, *, skip_above: float | F64 = np.inf, care: Care = EXACT) -> F64:
    """Signed clearance at each relative pose [m], shape (f,); the gap of the bounding boxes where that is above `skip_above`."""
    result = _box_gap(a, b, poses)
    near = np.flatnonzero(result <= skip_above)
    if len(near):
        deep, shallow = (np.broadcast_to(v, result.shape)[near] for v in (care.enough, care.idle))
        cares = [_Care(care.tolerance, *map(float, pair)) for pair in zip(deep, shallow, strict=True)]
        result[near] = examine(a, b, poses.take(near), witness=False, cares=cares).value
    return result
