"""Measures of a thing on its visible surfaces: seats and tops from above, treads, leaves of doors, extents."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64, RigidPose, pose_of, rotation_matrix
from ...worlds.errors import EvidenceError
from ...worlds.spec import HingeJoint
from .bounds import (
    CELLS,
    FOOTROOM,
    LEAF_THIN,
    LEVEL_QUANTILE,
    LEVEL_SHARE,
    MIDDLE,
    SAME_TREAD,
    TREAD_AREA,
    TREAD_DEPTH,
    TREAD_SHARE,
)

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["Thing", "measured", "thing_of"]


class Thing(NamedTuple):
    """Surfaces of one thing in the frame of its main entity, z up."""

    triangles: F64
    """Corners [m], shape (n, 3, 3), of all its bodies that joints tie to the main one."""
    leaves: tuple[F64, ...]
    """Width and height of bodies that turn about upright axes, however far they are turned, or would if they were not fixed [m], shape (2,)."""

    @property
    def low(self) -> F64:
        """Least corner [m], shape (3,)."""
        return np.asarray(self.triangles.min(axis=(0, 1)))

    @property
    def high(self) -> F64:
        """Greatest corner [m], shape (3,)."""
        return np.asarray(self.triangles.max(axis=(0, 1)))

    @property
    def size(self) -> F64:
        """Extents [m], shape (3,)."""
        return np.asarray(self.high - self.low)


def thing_of(candidate: Candidate, main: str) -> Thing:
    """Surfaces of an entity and of the bodies of its thing that hang on it, where they are built.

    Raises:
        EvidenceError: nothing visible was built.
    """
    spec = candidate.spec
    asset = spec.entities[main].asset
    own = {main, *(asset.bodies if asset is not None else ())}
    joints = [j for j in spec.simulation.joints.values() if j.kind in ("hinge", "slide", "ball", "weld")]
    inner = [(j.child, j.parent) for j in joints if j.parent is not None and {j.child, j.parent} <= own]
    fixed = _fixed_bodies(candidate, main)
    tied = {main} | {n for ends in inner for n in ends} | set(fixed)
    start = _pose(candidate, main)
    back = rotation_matrix(start.quaternion).T
    found = []
    for name in sorted(tied & set(spec.entities)):
        pose = _pose(candidate, name)
        turn = back @ rotation_matrix(pose.quaternion)
        shift = back @ (pose.position - start.position)
        found += [t @ turn.T + shift for t in _surfaces(candidate, name)]
    if not found:
        raise EvidenceError(f"entity {main!r} has no visible geometry; call place_object")
    hinged = [
        j.child for j in joints if isinstance(j, HingeJoint) and j.child in own and abs(j.axis[2]) > 0.9 * np.linalg.norm(j.axis)
    ]
    leaves = []
    for name in [*hinged, *(n for n in fixed if _upright_plate(candidate, n))]:
        corners = np.concatenate([t.reshape(-1, 3) for t in _surfaces(candidate, name)] or [np.zeros((1, 3))])
        leaves.append(np.array([_across(corners), float(np.ptp(corners[:, 2]))]))
    return Thing(np.concatenate(found), tuple(leaves))


def _fixed_bodies(candidate: Candidate, main: str) -> list[str]:
    """Further bodies of a static thing that are static themselves and hang on no joint: a door that stays shut."""
    spec = candidate.spec
    asset = spec.entities[main].asset
    if asset is None or spec.entities[main].motion != "static":
        return []
    hung = {j.child for j in spec.simulation.joints.values()}
    return [n for n in asset.bodies if n in spec.entities and n not in hung and spec.entities[n].motion == "static"]


def _upright_plate(candidate: Candidate, name: str) -> bool:
    """True of a body that is as thin as a leaf and stands upright, whichever way it is turned."""
    from scipy.spatial import ConvexHull, QhullError

    corners = np.concatenate([t.reshape(-1, 3) for t in _surfaces(candidate, name)] or [np.zeros((1, 3))])
    try:
        area = float(ConvexHull(corners[:, :2]).volume)
    except (QhullError, ValueError):
        return False
    wide, tall = _across(corners), float(np.ptp(corners[:, 2]))
    return area <= LEAF_THIN * wide * min(wide, tall)


def _pose(candidate: Candidate, name: str) -> RigidPose:
    """Declared pose of an entity: sizes do not depend on what happens before frame 0."""
    return pose_of(candidate.spec.entities[name].pose)


def _surfaces(candidate: Candidate, name: str) -> list[F64]:
    """Corners of the triangles of an entity's parts in its own frame [m]."""
    built = candidate.entity(name)
    bodies = {b.name: b.pose for b in built.bodies}
    return [bodies[p.body].apply(p.render.vertices)[p.render.faces] for p in built.parts if len(p.render.faces)]


def measured(thing: Thing, measure: str) -> float | None:
    """One measure [m]; None where the thing has nothing to measure it on."""
    return _TAKEN[measure](thing)


def _level(thing: Thing) -> float | None:
    """Height above its lowest point of what is uppermost in the middle of its footprint, where backs and arms do not reach."""
    low, size = thing.low, thing.size
    at = low[:2] + size[:2] * (0.5 - 0.5 * MIDDLE)
    steps = (np.arange(CELLS) + 0.5) / CELLS * MIDDLE
    points = np.stack(np.meshgrid(at[0] + steps * size[0], at[1] + steps * size[1]), axis=-1).reshape(-1, 2)
    heights = _tops(thing.triangles, points)
    there = heights[np.isfinite(heights)]
    return float(np.quantile(there, LEVEL_QUANTILE) - low[2]) if len(there) else None


def _tops(triangles: F64, points: F64) -> F64:
    """Height of the uppermost surface over each point (x, y) [m], shape (n,); -inf where there is none."""
    found = np.full(len(points), -np.inf)
    low, high = triangles[:, :, :2].min(axis=1), triangles[:, :, :2].max(axis=1)
    box = points.min(axis=0), points.max(axis=0)
    near = np.flatnonzero((high >= box[0]).all(axis=1) & (low <= box[1]).all(axis=1))
    a, b, c = (triangles[near, k] for k in range(3))
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    flat = np.abs(area) > 1e-12
    near, a, b, c, area = near[flat], a[flat], b[flat], c[flat], area[flat]
    for k in range(len(near)):
        inside = np.flatnonzero(((points >= low[near[k]]) & (points <= high[near[k]])).all(axis=1))
        if len(inside) == 0:
            continue
        p = points[inside]
        u = ((p[:, 0] - a[k, 0]) * (c[k, 1] - a[k, 1]) - (p[:, 1] - a[k, 1]) * (c[k, 0] - a[k, 0])) / area[k]
        v = ((b[k, 0] - a[k, 0]) * (p[:, 1] - a[k, 1]) - (b[k, 1] - a[k, 1]) * (p[:, 0] - a[k, 0])) / area[k]
        hit = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1 + 1e-9)
        z = a[k, 2] + u * (b[k, 2] - a[k, 2]) + v * (c[k, 2] - a[k, 2])
        found[inside[hit]] = np.maximum(found[inside[hit]], z[hit])
    return found


def _open_above(triangles: F64, points: F64) -> NDArray[np.bool_]:
    """True for points over which nothing is within `FOOTROOM`, shape (n,)."""
    free = np.ones(len(points), dtype=bool)
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    for k, (x, y, z) in enumerate(points):
        near = (low[:, 0] <= x) & (high[:, 0] >= x) & (low[:, 1] <= y) & (high[:, 1] >= y)
        over = near & (high[:, 2] > z + SAME_TREAD / 10) & (low[:, 2] < z + FOOTROOM)
        if over.any():
            top = _tops(triangles[over], np.array([[x, y]]))[0]
            free[k] = not top > z + SAME_TREAD / 10
    return free


class _Treads(NamedTuple):
    heights: F64
    """Above the lowest point [m], rising, shape (n,)."""
    centers: F64
    """Middle of each from above [m], shape (n, 2)."""


def _treads(thing: Thing) -> _Treads | None:
    """Level pieces of stairs on which one can stand, by height; narrow ones are rails and strings, a plate at the foot is none."""
    t = thing.triangles
    normals = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
    double = np.linalg.norm(normals, axis=1)
    longest = np.linalg.norm(t - np.roll(t, 1, axis=1), axis=2).max(axis=1)
    kept = np.flatnonzero((normals[:, 2] > LEVEL_SHARE * double) & (double > TREAD_DEPTH * longest))
    kept = kept[_open_above(t, t[kept].mean(axis=1))]
    heights = t[kept, :, 2].mean(axis=1) - thing.low[2]
    areas, middles = 0.5 * double[kept], t[kept, :, :2].mean(axis=1)
    order = np.argsort(heights)
    groups = np.split(order, np.flatnonzero(np.diff(heights[order]) > SAME_TREAD) + 1)
    groups = [g for g in groups if len(g) and heights[g[0]] > SAME_TREAD and areas[g].sum() >= TREAD_AREA]
    if not groups:
        return None
    least = TREAD_SHARE * float(np.median([areas[g].sum() for g in groups]))
    groups = [g for g in groups if areas[g].sum() >= least]
    if len(groups) > 2 and heights[groups[0][0]] < 0.5 * float(np.median(np.diff([heights[g[0]] for g in groups]))):
        groups = groups[1:]
    return _Treads(
        np.array([float(np.average(heights[g], weights=areas[g])) for g in groups]),
        np.array([np.average(middles[g], weights=areas[g], axis=0) for g in groups]),
    )


def _rises(thing: Thing) -> F64 | None:
    treads = _treads(thing)
    return None if treads is None else np.diff(np.concatenate([[0.0], treads.heights]))


def _rise(thing: Thing) -> float | None:
    rises = _rises(thing)
    return None if rises is None else float(rises.max())


def _uneven(thing: Thing) -> float | None:
    rises = _rises(thing)
    return None if rises is None else float(np.ptp(rises))


def _going(thing: Thing) -> float | None:
    treads = _treads(thing)
    if treads is None or len(treads.heights) < 2:
        return None
    return float(np.linalg.norm(np.diff(treads.centers, axis=0), axis=1).min())


def _leaf(which: int) -> Callable[[Thing], float | None]:
    return lambda thing: max((float(s[which]) for s in thing.leaves), default=None)


def _across(points: F64) -> float:
    """Longer side of the narrowest rectangle about points from above [m]: of a plate, whichever way it is turned, its width."""
    from scipy.spatial import ConvexHull, QhullError

    flat = points[:, :2]
    try:
        corners = flat[ConvexHull(flat).vertices]
    except (QhullError, ValueError):
        return float(np.linalg.norm(np.ptp(flat, axis=0)))
    edges = np.roll(corners, -1, axis=0) - corners
    along = edges / np.linalg.norm(edges, axis=1)[:, None]
    normal = np.stack([-along[:, 1], along[:, 0]], axis=1)
    deep, wide = np.ptp(corners @ normal.T, axis=0), np.ptp(corners @ along.T, axis=0)
    narrowest = int(np.argmin(deep))
    return float(wide[narrowest])


def _sorted(place: int) -> Callable[[Thing], float | None]:
    return lambda thing: float(np.sort(thing.size)[place])


_TAKEN: Mapping[str, Callable[[Thing], float | None]] = {
    "level": _level,
    "height": lambda t: float(t.size[2]),
    "length": lambda t: float(max(t.size[:2])),
    "width": lambda t: float(min(t.size[:2])),
    "longest": _sorted(2),
    "middle": _sorted(1),
    "least": _sorted(0),
    "leaf_width": _leaf(0),
    "leaf_height": _leaf(1),
    "rise": _rise,
    "rises": _uneven,
    "going": _going,
}
