"""Wet maps of a baked liquid, frame by frame beside its cache (`worlds/categories/liquid/wet.py` has the channels)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64, I32, RigidPose, rotation_matrix
from ...worlds.built import TriangleMesh
from ...worlds.cache import Cache, digest_arrays, write_container
from ...worlds.canonical import digest_of, source_digest
from ...worlds.categories.liquid.wet import WetMap, wet_folder
from ...worlds.errors import EvidenceError
from .derived_frames import make_frames
from .tracks import Tracks, sweeps

__all__ = ["TOUCH", "WetPart", "map_wet"]

SIZE = 0.5
"""[spacings] Distance of places on surfaces, at least."""
MOST_TEXELS = 150_000
"""Own choice: larger surfaces get places farther apart."""
TOUCH = 1.0
"""[spacings] Liquid this near to a surface wets it: half a spacing to the middle of the particles next to it, and as much of slack."""
BEHIND = 0.25
"""[spacings] by which what wets a surface may be behind it: particles stand a little inside of walls."""
MOST_CUBES = 60_000_000
"""Cubes by which particles far from surfaces are left out; in larger spaces all are asked."""
GAP = 2.5
"""[spacings] of air that end a column of liquid."""


SHIFTS = ((0.0, 0.0), (0.5, 0.0), (0.0, 0.5), (0.5, 0.5))
"""[spacings] Grids of columns, one against another."""


class WetPart(NamedTuple):
    """One part of a solid."""

    names: tuple[str, str, str]
    """Entity, body, part."""
    mesh: TriangleMesh
    """Visible surface in the frame of its body."""
    place: Callable[[int], RigidPose | None]
    """Pose of the body at a frame; None where it does not exist then."""
    still: bool


def map_wet(
    cache: Cache,
    parts: Sequence[WetPart],
    *,
    spacing: float,
    up: F64,
    drying: Sequence[float],
    gap: float,
    progress: Callable[[int, int, str], None] | None = None,
    check: Callable[[], None] | None = None,
) -> WetMap:
    """Make the wet maps of every frame of a complete cache, resuming what is there.

    Args:
        cache: of a liquid instance.
        parts: of the solids that its liquid may reach.
        spacing: of its particles, or size of its cells [m].
        up: unit vector against gravity, shape (3,).
        drying: of the films of its liquids [s].
        gap: surfaces this near to each other touch, and share their films [m].
        progress: called with (done, total, message).
        check: called between frames; raises to stop.

    Raises:
        EvidenceError: particles are missing or altered.
    """
    folder, reader, frames = wet_folder(cache), WetMap(cache), cache.index.frames
    reach = _reach(cache, 2.0 * spacing)
    texels, size = _spread(parts, [reach, *sweeps(parts, reach, frames, spacing)], SIZE * spacing)
    settings = {"size": size, "touch": TOUCH * spacing, "up": up.tolist(), "drying": [float(d) for d in drying], "gap": gap}
    about = _about(parts, texels, settings)
    start = _trusted(reader, about["recipe"], frames)
    if start < frames or reader.count() > frames:
        write_container(folder / "texels.npz", texels)
    groups = [np.flatnonzero(texels["texel/part"] == k) for k in range(len(parts))]
    dries, step = np.array(drying, dtype=np.float64), 1.0 / cache.index.fps
    tracks = Tracks(texels, groups, parts, size=size, gap=gap, drying=dries, step=step)
    for frame in range(start):
        tracks.take(reader.read(frame))

    def make(frame: int) -> tuple[dict[str, Any], frozenset[str]]:
        data = cache.read(frame, ("origin", "particle/position", "particle/fluid", "particle/volume"))
        found = _wet(texels, groups, parts, frame, _Drops.of(data), spacing=spacing, up=up)
        return found | tracks.follow(frame, found), frozenset({"wet"})

    make_frames(reader, start, make, about, progress=progress, check=check)
    return WetMap(cache)


def _about(parts: Sequence[WetPart], texels: dict[str, Any], settings: dict[str, Any]) -> dict[str, Any]:
    settings = settings | {"parts": [list(p.names) for p in parts]}
    digest = digest_arrays(texels)
    recipe = digest_of(settings, digest, source_digest(Path(__file__).parent))
    return {**settings, "texels": digest, "recipe": recipe}


def _trusted(reader: WetMap, recipe: str, frames: int) -> int:
    """Frames at the start that are there, whole and of these particles and surfaces."""
    try:
        if reader.about()["recipe"] != recipe or reader.texels is None:
            return 0
        for frame in range(min(reader.count(), frames)):
            try:
                reader.read(frame)
            except EvidenceError:
                return frame
    except (EvidenceError, KeyError):
        return 0
    return min(reader.count(), frames)


def _reach(cache: Cache, margin: float) -> tuple[F64, F64]:
    """Corners of where particles are at any frame, with a margin [m]."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for frame in range(cache.index.frames):
        data = cache.read(frame, ("origin", "particle/position"))
        points = data["particle/position"]
        points = points[np.isfinite(points).all(axis=1)]
        if len(points):
            low, high = np.minimum(low, points.min(0) + data["origin"]), np.maximum(high, points.max(0) + data["origin"])
    return low - margin, high + margin


def _spread(parts: Sequence[WetPart], reach: Sequence[tuple[F64, F64]], size: float) -> tuple[dict[str, Any], float]:
    """Places on the surfaces that lie within reach (one of some boxes), and their distance [m]."""
    kept: list[tuple[int, F64, F64, F64]] = []
    for number, part in enumerate(parts):
        pose = part.place(0) if part.still else None
        corner = part.mesh.vertices[part.mesh.faces]
        across = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        length = np.linalg.norm(across, axis=1)
        fine = length > 0.0
        if part.still and pose is not None:
            placed = pose.apply(corner.reshape(-1, 3)).reshape(-1, 3, 3)
            least, most = placed.min(axis=1), placed.max(axis=1)
            fine &= np.any([(most >= low).all(axis=1) & (least <= high).all(axis=1) for low, high in reach], axis=0)
        kept.append((number, corner[fine], across[fine] / np.maximum(length[fine], 1e-300)[:, None], 0.5 * length[fine]))
    total = sum(float(a.sum()) for *_, a in kept)
    size = max(size, float(np.sqrt(total / MOST_TEXELS)))
    position, normal, area, owner = [np.zeros((0, 3))], [np.zeros((0, 3))], [np.zeros(0)], [np.zeros(0, dtype=np.int32)]
    for number, corner, outward, own in kept:
        count = np.maximum(np.ceil(own / size**2), 1).astype(np.intp)
        face = np.repeat(np.arange(len(own)), count)
        points = np.einsum("nk,nkx->nx", _within(np.arange(len(face))), corner[face])
        inside = np.ones(len(points), dtype=bool)
        pose = parts[number].place(0) if parts[number].still else None
        if pose is not None:
            placed = pose.apply(points)
            inside &= np.any([((placed >= low) & (placed <= high)).all(axis=1) for low, high in reach], axis=0)
        position.append(points[inside])
        normal.append(outward[face[inside]])
        area.append((own / count)[face[inside]])
        owner.append(np.full(int(inside.sum()), number, dtype=np.int32))
    return {
        "texel/position": np.concatenate(position).astype(np.float32),
        "texel/normal": np.concatenate(normal).astype(np.float32),
        "texel/area": np.concatenate(area).astype(np.float32),
        "texel/part": np.concatenate(owner),
    }, size  # fmt: skip


def _within(k: NDArray[np.intp]) -> F64:
    """Barycentric weights of points spread evenly over triangles, shape (n, 3): the additive recurrence of the plastic number, folded.

    The sequence runs on from one triangle to the next, else slender ones side by side would have theirs in rows.
    """
    u, v = (0.5 + k * 0.7548776662466927) % 1.0, (0.5 + k * 0.5698402909980532) % 1.0
    over = u + v > 1.0
    u, v = np.where(over, 1.0 - u, u), np.where(over, 1.0 - v, v)
    return np.stack([1.0 - u - v, u, v], axis=1)


class _Drops(NamedTuple):
    """The particles of a frame that have a place."""

    position: F64
    """World (n, 3) [m]."""
    fluid: I32
    """Index into `CacheIndex.bodies` (n,)."""
    layer: float
    """By which liquid reaches above the middles of its particles [m]."""

    @classmethod
    def of(cls, data: dict[str, Any]) -> _Drops:
        """The particles of a frame of a cache."""
        position = data["particle/position"].astype(np.float64) + data["origin"]
        whole = np.isfinite(position).all(axis=1)
        layer = 0.5 * float(np.cbrt(data["particle/volume"].mean())) if len(position) else 0.0
        return cls(position[whole], data["particle/fluid"][whole], layer)


def _wet(
    texels: dict[str, Any],
    groups: Sequence[NDArray[np.intp]],
    parts: Sequence[WetPart],
    frame: int,
    drops: _Drops,
    *,
    spacing: float,
    up: F64,
) -> dict[str, Any]:
    """Which places are wet at a frame, how deep and by what."""
    from scipy.spatial import cKDTree

    position, fluid, layer = drops
    rows, depth, kind = [np.zeros(0, dtype=np.int32)], [np.zeros(0, dtype=np.float32)], [np.zeros(0, dtype=np.int32)]
    reach = TOUCH * spacing
    if len(position):
        placed = [_placed(part, texels, mine, frame) for part, mine in zip(parts, groups, strict=True)]
        beside = _beside(
            position, np.concatenate([points for points in placed if points is not None] or [np.zeros((0, 3))]), reach
        )
        some = position[beside]
        # Built loosely: it is asked once, and building costs more than asking.
        tree, top = cKDTree(some, balanced_tree=False, compact_nodes=False), _tops(position, up, spacing)[beside]
        kinds = fluid[beside]
        low, high = position.min(axis=0) - reach, position.max(axis=0) + reach
        for part, mine, points in zip(parts, groups, placed, strict=True):
            pose = part.place(frame)
            if pose is None or points is None or not len(some):
                continue
            near = np.flatnonzero(((points >= low) & (points <= high)).all(axis=1))
            gap, at = tree.query(points[near], distance_upper_bound=reach)
            near, at = near[np.isfinite(gap)], at[np.isfinite(gap)]
            outward = texels["texel/normal"][mine[near]].astype(np.float64) @ rotation_matrix(pose.quaternion).T
            front = ((some[at] - points[near]) * outward).sum(axis=1) >= -BEHIND * spacing
            near, at = near[front], at[front]
            rows.append(mine[near].astype(np.int32))
            depth.append(np.maximum(top[at] + layer - points[near] @ up, 0.0).astype(np.float32))
            kind.append(kinds[at].astype(np.int32))
    joined = np.concatenate(rows)
    order = np.argsort(joined, kind="stable")
    return {"wet/texel": joined[order], "wet/depth": np.concatenate(depth)[order], "wet/fluid": np.concatenate(kind)[order]}


def _placed(part: WetPart, texels: dict[str, Any], mine: NDArray[np.intp], frame: int) -> F64 | None:
    """Places of a part in the world at a frame; None where it has none or does not exist then."""
    pose = part.place(frame) if len(mine) else None
    return None if pose is None else pose.apply(texels["texel/position"][mine].astype(np.float64))


def _beside(position: F64, points: F64, reach: float) -> NDArray[np.bool_]:
    """Particles in a cube of size `reach` [m] that has a place in it or next to it: all that may be within reach of one."""
    from scipy.ndimage import maximum_filter

    if not len(points):
        return np.zeros(len(position), dtype=bool)
    low = np.minimum(position.min(axis=0), points.min(axis=0)) - reach
    shape = ((np.maximum(position.max(axis=0), points.max(axis=0)) - low) / reach).astype(np.intp) + 2
    if shape.astype(np.float64).prod() > MOST_CUBES:
        return np.ones(len(position), dtype=bool)
    grid = np.zeros(tuple(shape), dtype=bool)
    grid[tuple(((points - low) / reach).astype(np.intp).T)] = True
    near = maximum_filter(grid, size=3, mode="constant")
    return np.asarray(near[tuple(((position - low) / reach).astype(np.intp).T)])


def _tops(position: F64, up: F64, spacing: float) -> F64:
    """Height of the top of the column of liquid that every particle is in [m], shape (n,): columns end at gaps of air.

    The highest of four columns, a spacing wide and half of one apart: of a column that a wall cuts only a sliver may hold liquid, whose
    particles stand farther above each other than air is told from liquid.
    """
    side = np.eye(3)[int(np.argmin(np.abs(up)))]
    first = np.cross(up, side)
    first /= np.linalg.norm(first)
    place = position @ np.stack([first, np.cross(up, first)]).T / spacing
    height = position @ up
    tops = [_column_tops(np.floor(place + shift).astype(np.int64), height, spacing) for shift in SHIFTS]
    return np.asarray(np.maximum.reduce(tops))


def _column_tops(cell: NDArray[np.int64], height: F64, spacing: float) -> F64:
    """Tops of the columns of one grid [m], shape (n,); cells (n, 2)."""
    cell = cell - cell.min(axis=0)
    column = cell[:, 0] * (int(cell[:, 1].max()) + 1) + cell[:, 1]
    # One key for column and height: sorted at once, as finely as single precision tells heights.
    level = (height - height.min()) / max(float(np.ptp(height)), 1e-9) * (2**24 - 1)
    order = np.argsort((column << 24) | level.astype(np.int64), kind="stable")
    column, sorted_height = column[order], height[order]
    ends = np.append((np.diff(column) != 0) | (np.diff(sorted_height) > GAP * spacing), True)
    run = np.cumsum(ends) - ends
    result = np.empty(len(height))
    result[order] = sorted_height[np.flatnonzero(ends)][run]
    return result
