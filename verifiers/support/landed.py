"""Static things that stand on a landscape: on its actual surface, not over it, not hanging over a slope, not buried."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from ..land.grounds import Land, Patch, lands, patches
from ..routes.columns import heights_of
from ..rows.answers import row_of, rows_of
from ..rows.corrections import say_afloat
from ..rows.findings import Finding
from .bounds import BASE, BROAD, HANGING, LEFT, LEVEL_BASE, OVER_EDGE, SUNK
from .free_bodies import along_up, placement
from .questions import GROUND

if TYPE_CHECKING:
    from ...worlds.requirements import Row
    from ..scene.surfaces import Surfaces

__all__ = ["Ground", "landed_rows"]

POINTS = 12_000
"""Places under an entity that are looked at."""
PAIRS = 2_000_000
FINE = 16
"""Places along a small underside at least."""
BINS = 48


class _Grid(NamedTuple):
    """Ground as heights over a rectangle, each cell cut from south-west to north-east."""

    low: F64
    cell: F64
    height: F64
    owner: str

    def at(self, points: F64) -> F64:
        """Height at points [m], shape (n,); NaN beside it."""
        last = np.array(self.height.shape[::-1]) - 1
        local = (points - self.low) / self.cell
        inside = ((local >= -1e-9) & (local <= last + 1e-9)).all(axis=1)
        index = np.clip(np.floor(local).astype(np.int64), 0, last - 1)
        u, v = np.clip(local - index, 0.0, 1.0).T
        col, row = index.T
        z = self.height
        a, b, d, e = z[row, col], z[row, col + 1], z[row + 1, col], z[row + 1, col + 1]
        found = a + np.where(u >= v, (b - a) * u + (e - b) * v, (e - d) * u + (d - a) * v)
        return np.where(inside, found, np.nan)


class _Standing(NamedTuple):
    """An entity over the ground."""

    entity: str
    points: F64
    """Its underside [m], shape (n, 3)."""
    base: NDArray[np.bool_]
    """Which of them belong to a broad level base, shape (n,)."""
    gap: F64
    """Height of each over the ground [m], shape (n,); NaN beside the land."""
    owner: str
    """Ground entity or landscape beneath."""
    land: str
    """The landscape."""


class Ground:
    """The landscapes of a candidate beneath its static things, and the entities cut from them."""

    def __init__(self, surfaces: Surfaces) -> None:
        self.surfaces = surfaces

    @cached_property
    def lands(self) -> list[tuple[Land, list[_Grid], frozenset[str]]]:
        """Every landscape, the ground entities cut from it as grids, and their names.

        Raises:
            EvidenceError: one is not built from its present specification.
        """
        found = []
        for land in lands(self.surfaces.candidate):
            cut = patches(self.surfaces.candidate.spec, land.name)
            grids = [g for p in cut if (g := _patch_grid(self.surfaces, p)) is not None]
            found.append((land, grids, frozenset(p.entity for p in cut)))
        return found

    @cached_property
    def _known(self) -> dict[tuple[int, ...], tuple[_Standing, ...]]:
        return {}

    def standing(self, entity: str, parts: tuple[int, ...] | None = None) -> tuple[_Standing, ...]:
        """The entity, or some parts of it, over each landscape that it is over."""
        rows = self.surfaces.parts_of[entity] if parts is None else parts
        if rows not in self._known:
            places = (_under(self.surfaces, land, grids, entity, rows) for land, grids, cut in self.lands if entity not in cut)
            self._known[rows] = tuple(s for s in places if s is not None)
        return self._known[rows]

    def over(self, entity: str) -> bool:
        """True if the entity is over a landscape."""
        return bool(self.standing(entity))

    def touched(self, entity: str, parts: tuple[int, ...]) -> bool:
        """True if some parts of the entity reach a landscape."""
        return any(float(np.nanmin(s.gap)) <= _tolerance(self.surfaces, s) for s in self.standing(entity, parts))

    def beneath(self, entity: str, parts: tuple[int, ...]) -> tuple[float, str] | None:
        """Height of some parts over the landscape beneath them [m], and its name; None where there is none."""
        found = [(float(np.nanmin(s.gap)), s.owner) for s in self.standing(entity, parts)]
        return min(found, default=None)


def landed_rows(surfaces: Surfaces, ground: Ground) -> list[Row]:
    """Rows `support:ground:<entity>` of static entities over landscapes at frame 0; none without landscapes.

    Entities that touch others are judged together: one of them must stand, and those that do must stand well.
    """
    candidate = surfaces.candidate
    if not candidate.spec.terrains:
        return []
    return rows_of(candidate, GROUND, (), partial(_rows, surfaces, ground))


def _rows(surfaces: Surfaces, ground: Ground) -> list[Row]:
    found: list[Row] = []
    for k, (_, _, cut) in enumerate(ground.lands):
        names = [n for n in surfaces.entities if surfaces.is_static(n) and n not in cut]
        standing = {n: s for n in names for s in ground.standing(n) if s.land == ground.lands[k][0].name}
        for group in _groups(surfaces, list(standing)):
            found += [row_of(surfaces.candidate, GROUND, (n,), one) for n, one in _judge(surfaces, [standing[n] for n in group])]
    return found


def _patch_grid(surfaces: Surfaces, patch: Patch) -> _Grid | None:
    """The visible top of a ground entity; None where it is no grid."""
    part = next(
        (surfaces.parts[i] for i in surfaces.parts_of.get(patch.entity, ()) if surfaces.parts[i].part == patch.part), None
    )
    if part is None:
        return None
    solid = part.solid
    top = surfaces.track(part.entity, part.body).at(0).apply(solid.vertices[np.unique(solid.faces[solid.face_normals[:, 2] > 0])])
    x, y = np.unique(np.round(top[:, 0], 9)), np.unique(np.round(top[:, 1], 9))
    if len(x) * len(y) != len(top) or len(x) < 2 or len(y) < 2:
        return None
    order = np.lexsort((np.round(top[:, 0], 9), np.round(top[:, 1], 9)))
    cell = np.array([(x[-1] - x[0]) / (len(x) - 1), (y[-1] - y[0]) / (len(y) - 1)])
    return _Grid(np.array([x[0], y[0]]), cell, top[order, 2].reshape(len(y), len(x)), patch.entity)


def _under(surfaces: Surfaces, land: Land, grids: list[_Grid], entity: str, parts: tuple[int, ...]) -> _Standing | None:
    """The underside of parts of an entity and its height over the ground; None where it is not over the land."""
    corners = np.concatenate(
        [surfaces.track(entity, p.body).at(0).apply(p.solid.vertices)[p.solid.faces] for p in (surfaces.parts[i] for i in parts)]
    )
    low, high = corners[:, :, :2].min(axis=(0, 1)), corners[:, :, :2].max(axis=(0, 1))
    lattices = [(land.low, np.full(2, land.cell)), *((g.low, g.cell) for g in grids)]
    lattice = np.concatenate([_lattice(start, cell, low, high) for start, cell in lattices])
    points, base = _underside(corners, min(0.5 * land.cell, float((high - low).max()) / FINE), lattice)
    ground = land.heights_at(points[:, :2])
    owner = land.name
    for grid in grids:
        here = grid.at(points[:, :2])
        ground = np.where(np.isfinite(here), here, ground)
        owner = grid.owner if np.isfinite(here).any() else owner
    if not np.isfinite(ground).any():
        return None
    return _Standing(entity, points, base, points[:, 2] - ground, owner, land.name)


def _lattice(start: F64, cell: F64, low: F64, high: F64) -> F64:
    """Lattice points within a rectangle [m], shape (n, 2); none where there would be very many."""
    first, last = np.ceil((low - start) / cell).astype(int), np.floor((high - start) / cell).astype(int)
    if (last < first).any() or int(np.prod(last - first + 1)) > POINTS:
        return np.zeros((0, 2))
    x, y = (start[k] + cell[k] * np.arange(first[k], last[k] + 1) for k in (0, 1))
    return np.stack([v.ravel() for v in np.meshgrid(x, y)], axis=1)


def _over_lattice(corners: F64, lattice: F64) -> F64:
    """Points of triangles over lattice points [m], shape (n, 3): there the ground has its summits."""
    if len(corners) * len(lattice) > PAIRS or not len(lattice):
        return np.zeros((0, 3))
    pair = np.repeat(np.arange(len(corners)), len(lattice))
    at = np.tile(lattice, (len(corners), 1))
    z, covered, _, _ = heights_of(corners[pair], at)
    return np.column_stack([at, z])[covered]


def _underside(corners: F64, spacing: float, lattice: F64) -> tuple[F64, NDArray[np.bool_]]:
    """Places on the lowest surface over each spot of the footprint [m], shape (n, 3), and which lie on a broad level base."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.maximum(np.linalg.norm(normal, axis=1), 1e-300)
    down = normal[:, 2] < -1e-6 * size
    if not down.any():  # open or inside out
        down[:] = True
    corners, facing, area = corners[down], -normal[down, 2] / size[down], 0.5 * size[down]
    level = (facing >= LEVEL_BASE) & (corners[:, :, 2].max(axis=1) <= corners[:, :, 2].min() + BASE)
    wide = np.ptp(corners[:, :, :2], axis=(0, 1))
    level &= float(area[level].sum()) >= BROAD * float(wide[0] * wide[1])
    points, flat = _sampled(corners, level, spacing)
    summits = _over_lattice(corners[level], lattice)
    points, flat = np.concatenate([points, summits]), np.concatenate([flat, np.ones(len(summits), dtype=bool)])
    low, size = points[:, :2].min(axis=0), np.maximum(np.ptp(points[:, :2], axis=0), 1e-9)
    spot = np.minimum((points[:, :2] - low) / size * BINS, BINS - 1).astype(np.int64)
    key = spot[:, 0] * BINS + spot[:, 1]
    least = np.full(BINS * BINS, np.inf)
    np.minimum.at(least, key, points[:, 2])
    keep = points[:, 2] <= least[key] + BASE
    return points[keep], flat[keep]


def _sampled(corners: F64, level: NDArray[np.bool_], spacing: float) -> tuple[F64, NDArray[np.bool_]]:
    """Places on triangles at most about `spacing` apart, and the mark of their triangle."""
    edge = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    parts = np.clip(np.ceil(edge / spacing), 1, 64).astype(np.int64)
    while (total := int(((parts + 1) * (parts + 2) // 2).sum())) > POINTS and parts.max() > 1:
        parts = np.maximum(1, (parts * min(0.9, np.sqrt(POINTS / total))).astype(np.int64))
    found, marks = [], []
    for count in np.unique(parts):
        i, j = (k.ravel() for k in np.mgrid[: count + 1, : count + 1])
        share = np.stack([i, j, count - i - j], axis=1)[i + j <= count] / count
        found.append(np.einsum("sk,tkc->tsc", share, corners[parts == count]).reshape(-1, 3))
        marks.append(np.repeat(level[parts == count], len(share)))
    return np.concatenate(found), np.concatenate(marks)


def _groups(surfaces: Surfaces, names: list[str]) -> Iterator[list[str]]:
    """Entities that touch, directly or through others of them."""
    left, among = dict.fromkeys(names), set(names)
    touching: dict[str, set[str]] = {n: set() for n in names}
    for (a, b), gap in surfaces.first.items():
        if a in among and b in among and gap <= surfaces.contact_gap(a, b):
            touching[a].add(b)
            touching[b].add(a)
    while left:
        group, waiting = [], [next(iter(left))]
        while waiting:
            name = waiting.pop()
            if name in left:
                del left[name]
                group.append(name)
                waiting += sorted(touching[name])
        yield group


def _judge(surfaces: Surfaces, group: list[_Standing]) -> Iterator[tuple[str, Finding]]:
    nearest = {s.entity: float(np.nanmin(s.gap)) for s in group}
    reach = {s.entity: _tolerance(surfaces, s) for s in group}
    standing = [s for s in group if nearest[s.entity] <= reach[s.entity]]
    if not standing and any(surfaces.candidate.spec.entities[s.entity].afloat is None for s in group):
        lowest = min(group, key=lambda s: nearest[s.entity])
        yield lowest.entity, _floats(surfaces, lowest, nearest[lowest.entity], reach[lowest.entity])
    for one in standing:
        yield one.entity, _stands(surfaces, one, reach[one.entity], alone=len(group) == 1)


def _tolerance(surfaces: Surfaces, one: _Standing) -> float:
    own = max(surfaces.parts[i].deviation for i in surfaces.parts_of[one.entity])
    return float(surfaces.candidate.spec.simulation.limits.contact_gap + own)


def _floats(surfaces: Surfaces, one: _Standing, gap: float, bound: float) -> Finding:
    place = one.points[int(np.nanargmin(one.gap))]
    text = f"{one.entity!r} floats {gap:.4g} m over {one.owner!r} at ({place[0]:.2f}, {place[1]:.2f}), and touches nothing that stands"
    move = placement(surfaces, one.entity, along_up(surfaces, LEFT - gap), f"{one.entity!r} is placed above the ground")
    hover = say_afloat(one.entity, "it is meant to hover")
    return _answer(surfaces, one, Finding("fail", text, gap, bound, hints=(move, hover)), place)


def _stands(surfaces: Surfaces, one: _Standing, reach: float, *, alone: bool) -> Finding:
    known = np.isfinite(one.gap)
    points, gap = one.points[known], one.gap[known]
    deepest = int(np.argmin(gap))
    sunk, allowed = -float(gap[deepest]), max(SUNK, surfaces.allowed_depth(one.entity, one.owner))
    base = one.base[known]
    alone &= bool(base.any())
    widest = int(np.argmax(np.where(base, gap, -np.inf)))
    hanging = float(gap[widest]) if base.any() else 0.0
    lift = along_up(surfaces, sunk)
    if sunk > allowed:
        place = points[deepest]
        text = (
            f"{one.entity!r} is buried: {one.owner!r} stands {sunk:.4g} m above its underside at ({place[0]:.2f}, {place[1]:.2f})"
        )
        mend = placement(surfaces, one.entity, lift, "it stands in the slope: raise it, or level the ground with a flatten layer")
        return _answer(surfaces, one, Finding("fail", text, sunk, allowed, hints=(mend,)), place)
    if alone and hanging > HANGING:
        place = points[widest]
        text = f"{one.entity!r} hangs {hanging:.4g} m over {one.owner!r} at ({place[0]:.2f}, {place[1]:.2f})"
        mend = placement(surfaces, one.entity, None, "its base is level and the ground is not: level it, or give it a foundation")
        return _answer(surfaces, one, Finding("fail", text, hanging, HANGING, hints=(mend,)), place)
    over = _outside(points[gap <= max(reach, HANGING), :2], surfaces.candidate.center(one.entity, 0)[:2]) if alone else 0.0
    if over > OVER_EDGE:
        text = f"the centre of {one.entity!r} lies {over:.4g} m outside the places at which it stands on {one.owner!r}"
        mend = placement(surfaces, one.entity, None, "it overhangs and would tip")
        return _answer(surfaces, one, Finding("fail", text, over, OVER_EDGE, hints=(mend,)), points[widest])
    text = f"{one.entity!r} stands on {one.owner!r}: at most {max(sunk, 0.0):.3g} m in it, {max(hanging, 0.0):.3g} m over it under its base"
    return _answer(surfaces, one, Finding("pass", text, max(sunk, 0.0), allowed), points[deepest])


def _outside(stands: F64, center: F64) -> float:
    """Distance of a point from the convex hull of places in the plane [m]; 0 inside."""
    from .resting import outside

    return max(0.0, outside(stands - center)) if len(stands) else float("inf")


def _answer(surfaces: Surfaces, one: _Standing, found: Finding, place: F64) -> Finding:
    return replace(
        found,
        evidence={"ground": one.owner, "place": place.tolist()},
        entities=(one.entity,) if one.owner not in surfaces.entities else (one.entity, one.owner),
        frames=(0, 0),
        predicate=f"{one.entity} stands on the ground: within {HANGING:g} m under its base, at most as deep in it as declared",
        extra=[surfaces.allowed_depth(one.entity, one.owner), one.owner],
    )
