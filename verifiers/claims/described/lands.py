"""Land that words name: its share of pictures, and its slope.

Rays are cast from the camera at the height field and the water on it, and at the solids before it; plants are not.
"""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ....worlds.claim_targets import targets_of
from ....worlds.errors import EvidenceError
from ...land.grounds import land_of, patches
from ...shots.sight import sight_of
from ...shots.views import samples

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ....geometry import Camera
    from ....worlds.arrays import F64
    from ....worlds.candidate import Candidate
    from ....worlds.spec import WorldSpec
    from ....worlds.spec.terrain import Zone
    from ...land.grounds import Land

__all__ = ["Shown", "lands_of", "share_of_pictures", "slopes"]

SIZE = (80, 45)
"""[pixels] Own choice: of a picture in which land is looked for; land is large."""
STEPS = 160
"""Own choice: places along a ray that are looked at, ever farther apart."""
HALVINGS = 8
"""Own choice: of the way between two such places, to where a ray meets the land."""
NOWHERE = -1e6
"""[m] Height of what is no land."""
LOOKS = 5
"""Own choice: frames of each shot."""
WATERS = ("hydrology", "lakes", "rivers", "sea", "water")
"""Parts of a terrain that are water."""


class Shown(NamedTuple):
    """Share of a picture that land fills."""

    share: float
    where: str


def lands_of(spec: WorldSpec, name: str) -> list[str]:
    """Pointers of a claim that lead to land."""
    return [p for p in targets_of(spec.claims, name) if p.startswith("/terrains/") and p.split("/")[2] in spec.terrains]


def share_of_pictures(candidate: Candidate, pointer: str, enough: float) -> Shown:
    """Largest share of a picture that the land of a pointer fills, over some frames of every shot.

    Raises:
        EvidenceError: it is not built from its present specification.
    """
    land, best = land_of(candidate, pointer.split("/")[2]), Shown(0.0, "in no picture")
    for name, shot in candidate.spec.shots.items():
        last = min(shot.frames[1], candidate.last_frame)
        for frame in samples((shot.frames[0], last), LOOKS) if last >= shot.frames[0] else ():
            points = _hits(candidate, land, name, frame)
            if len(points):
                share = float(_within(candidate.spec, land, pointer, points[:, :2]).sum()) / (SIZE[0] * SIZE[1])
                best = max(best, Shown(share, f"in shot {name!r} at frame {frame}"))
            if best.share >= enough:
                return best
    return best


def slopes(candidate: Candidate, pointer: str) -> F64:
    """Slopes of the land of a pointer, tangent, one per cell."""
    land = land_of(candidate, pointer.split("/")[2])
    rows, cols = land.height.shape
    grid = np.stack(np.meshgrid(np.arange(cols), np.arange(rows)), axis=-1).reshape(-1, 2) * land.cell + land.low
    slope = land.saved.field("slope").ravel()
    return np.asarray(slope[_within(candidate.spec, land, pointer, grid) & np.isfinite(slope)])


def _hits(candidate: Candidate, land: Land, shot: str, frame: int) -> F64:
    """Places where rays of a picture meet the land first, shape (n, 3)."""
    camera = replace(sight_of(candidate).camera(shot, frame), width=SIZE[0], height=SIZE[1])
    key = ("land in view", land.name, camera.position.tobytes(), camera.target.tobytes(), camera.fov_deg)
    points = candidate.memo(key, lambda: _cast(land, camera))
    depth = (camera.position - points) @ camera.axes[2]
    return np.asarray(points[np.isfinite(depth) & (np.nan_to_num(depth) <= _solids(candidate, camera, frame))])


def _cast(land: Land, camera: Camera) -> F64:
    """Place at which the ray of each pixel meets ground or water, NaN where it does not, shape (pixels, 3)."""
    eye, directions = camera.rays()
    flat, surface = directions.reshape(-1, 3), _surface(land)
    farthest = 2.0 * float(np.linalg.norm(land.high - land.low)) + float(np.abs(eye).max())
    found = np.full((len(flat), 3), np.nan)
    open_, before = np.arange(len(flat)), 0.0
    for step in np.geomspace(0.1 * min(land.cell, 1.0), farthest, STEPS):
        under = eye[2] + step * flat[open_, 2] <= _level(land, surface, eye + step * flat[open_])
        hit = open_[under]
        near, far = np.full(len(hit), before), np.full(len(hit), step)
        for _ in range(HALVINGS):
            middle = 0.5 * (near + far)
            points = eye + middle[:, None] * flat[hit]
            below = points[:, 2] <= _level(land, surface, points)
            near, far = np.where(below, near, middle), np.where(below, middle, far)
        found[hit] = eye + far[:, None] * flat[hit]
        open_, before = open_[~under], float(step)
        if not len(open_):
            break
    return found


def _surface(land: Land) -> F64:
    """Height of ground or water at the lattice points [m], far below where there is no land."""
    return np.nan_to_num(np.maximum(land.height, land.water), nan=NOWHERE, neginf=NOWHERE)


def _level(land: Land, surface: F64, points: F64) -> F64:
    """Height of ground or water at points, shape (n,), far below off the land."""
    index, share = land.places(points)
    v, u = share.T
    row, col = np.maximum(index, 0).T
    low = surface[row, col] * (1 - u) + surface[row, col + 1] * u
    high = surface[row + 1, col] * (1 - u) + surface[row + 1, col + 1] * u
    return np.where(index[:, 0] >= 0, low * (1 - v) + high * v, NOWHERE)


def _solids(candidate: Candidate, camera: Camera, frame: int) -> F64:
    """Depth of the nearest solid along the viewing axis, per pixel; infinite where there is none. Grounds cut from a landscape are land."""
    grounds = {p.entity for name in candidate.spec.terrains for p in patches(candidate.spec, name)}
    return sight_of(candidate).depth(camera, frame, without=grounds).astype(np.float64).ravel()


def _within(spec: WorldSpec, land: Land, pointer: str, points: F64) -> NDArray[np.bool_]:
    """Which points, shape (n, 2), lie in what a pointer names: a zone, a layer with a place, water, or all of the land."""
    keys = pointer.strip("/").split("/")[2:]
    terrain = spec.terrains[land.name]
    if keys and keys[0] in WATERS:
        index, _ = land.places(points)
        wet = np.isfinite(land.water)
        return np.asarray((index[:, 0] >= 0) & wet[np.maximum(index[:, 0], 0), np.maximum(index[:, 1], 0)])
    if len(keys) > 1 and keys[0] == "zones" and keys[1] in terrain.zones:
        return _in_zone(terrain.zones[keys[1]], points)
    layer = terrain.layers.get(keys[1]) if len(keys) > 1 and keys[0] == "layers" else None
    zone = getattr(layer, "zone", None)
    if zone in terrain.zones:
        return _in_zone(terrain.zones[zone], points)
    center, radius = getattr(layer, "center", None), getattr(layer, "radius", None)
    if center is not None and radius is not None:
        return np.asarray(np.linalg.norm(points - np.array(center), axis=1) <= radius)
    return np.ones(len(points), dtype=bool)


def _in_zone(zone: Zone, points: F64) -> NDArray[np.bool_]:
    if zone.center is not None and zone.radius is not None:
        return np.asarray(np.linalg.norm(points - np.array(zone.center), axis=1) <= zone.radius)
    if zone.line is not None and zone.width is not None:
        return np.asarray(_from_line(np.array(zone.line), points) <= 0.5 * zone.width)
    if zone.polygon is None:
        raise EvidenceError("a zone has no outline")
    corner = np.array(zone.polygon)
    inside = np.zeros(len(points), dtype=bool)
    for a, b in zip(corner, np.roll(corner, -1, axis=0), strict=True):
        crosses = (a[1] > points[:, 1]) != (b[1] > points[:, 1])
        at = a[0] + (points[:, 1] - a[1]) * (b[0] - a[0]) / np.where(b[1] == a[1], np.inf, b[1] - a[1])
        inside ^= crosses & (points[:, 0] < at)
    return inside


def _from_line(line: F64, points: F64) -> F64:
    """Distance of points from a polyline, shape (n,)."""
    best = np.full(len(points), np.inf)
    for a, b in itertools.pairwise(line):
        share = np.clip((points - a) @ (b - a) / max(float((b - a) @ (b - a)), 1e-12), 0.0, 1.0)
        best = np.minimum(best, np.linalg.norm(points - a - share[:, None] * (b - a), axis=1))
    return best
