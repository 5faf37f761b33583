"""Ways over open land at the scale of landscapes: slope, depth of water, trunks and whatever was built decide.

The land between lattice points is cut into squares. A square is free where none of its triangles is steeper than the
carrier takes, no water stands deeper than it wades, and nothing built reaches into its height. A step from square to
square is free where no trunk or boulder comes within half the width of its line, and diagonal steps cut no corners. So a
way found here is one; a way through a narrow door or over a bridge is left to the fine search (`routes/search.py`).

Cost of one core: 2 s for a landscape of 1024 x 1024 squares with 100,000 trunks.
"""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from ..land.grounds import Land, patches
from ..predicates.kinematic import region_offset
from .columns import Ints, expand
from .places import frame_of, region_box
from .shortest import shortest_way

if TYPE_CHECKING:
    from ...worlds.spec import Connects
    from ..scene.surfaces import Surfaces

__all__ = ["Asked", "Field", "Track", "ground_in"]

MOST_SQUARES = 1_200_000
"""Own choice: squares of one search, about 1 GB."""
SAMPLES = 9
"""Places along each axis of a region at which it is asked for ground."""
WAYS = ((0, 1), (1, 0), (1, 1), (1, -1))
"""Steps (row, column) to four of the eight neighbours; the others are their reverse."""
PAIRS = 4_000_000
"""Squares under triangles that are looked at one by one; beyond, whole entities block their boxes."""

Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Asked:
    """Sizes and limits of the carrier, and the kinds of obstacles that count."""

    width: float
    headroom: float
    tangent: float
    step: float
    wade: float
    stems: bool = True
    built: bool = True


class Track(NamedTuple):
    """A way over squares."""

    route: F64
    """Middles of the squares [m], shape (n, 3)."""
    tangent: float
    """Steepest of its squares."""
    steepest: F64
    """Where [m], shape (3,)."""
    depth: float
    """Deepest water on it [m]."""


class Field:
    """Squares of a landscape within a rectangle."""

    def __init__(self, surfaces: Surfaces, land: Land, frame: int, low: F64, high: F64, width: float, absent: Collection[str]):
        self.surfaces, self.land, self.frame, self.absent = surfaces, land, frame, frozenset(absent)
        rows, cols = land.height.shape
        first = np.clip(np.floor((low - land.low) / land.cell).astype(int), 0, [cols - 2, rows - 2])
        last = np.clip(np.ceil((high - land.low) / land.cell).astype(int), first + 1, [cols - 1, rows - 1])
        count = last - first
        self.whole = bool((first == 0).all() and (last == [cols - 1, rows - 1]).all())
        finest = max(1, int(land.cell / width))  # no smaller than the carrier is wide
        self.split = max(1, min(finest, int(math.sqrt(MOST_SQUARES / max(1, int(count[0]) * int(count[1]))))))
        self.origin = land.low + land.cell * first
        self.cell = land.cell / self.split
        self.shape = int(count[1]) * self.split, int(count[0]) * self.split
        window = np.s_[first[1] : last[1] + 1, first[0] : last[0] + 1]
        self._height, self._water = land.height[window], land.water[window]

    @cached_property
    def tangent(self) -> F64:
        """Steepest slope in each square, infinite where there is no land, shape (rows, cols)."""
        z, side = self._height, self.land.cell
        a, b, d, e = z[:-1, :-1], z[:-1, 1:], z[1:, :-1], z[1:, 1:]
        under, over = np.hypot(b - a, e - b) / side, np.hypot(e - d, d - a) / side
        row, col = np.mgrid[: self.split, : self.split]
        tall = (len(a), self.split, a.shape[1], self.split)
        lower, upper = (np.broadcast_to(v[:, None, :, None], tall) for v in (under, over))
        found = np.where((col > row)[None, :, None], lower, np.where((col < row)[None, :, None], upper, np.maximum(lower, upper)))
        return np.where(np.isfinite(found), found, np.inf).reshape(self.shape)

    @cached_property
    def points(self) -> F64:
        """Middles of the squares on the ground [m], shape (rows * cols, 3)."""
        x, y = (self.origin[k] + self.cell * (np.arange(self.shape[1 - k]) + 0.5) for k in (0, 1))
        flat = np.stack([v.ravel() for v in np.meshgrid(x, y)], axis=1)
        return np.column_stack([flat, self.land.heights_at(flat)])

    @cached_property
    def depth(self) -> F64:
        """Deepest water that may stand in each square [m], shape (rows, cols)."""
        over = np.maximum(self._water - self._height, 0.0)
        over = np.where(np.isfinite(over), over, 0.0)
        worst = np.maximum.reduce([over[:-1, :-1], over[:-1, 1:], over[1:, :-1], over[1:, 1:]])
        return np.repeat(np.repeat(worst, self.split, axis=0), self.split, axis=1)

    @cached_property
    def owner(self) -> dict[tuple[float, float], NDArray[np.int32]]:
        """Entity that reaches into the height of each square, -1 for none, by step and headroom."""
        return {}

    def occupied(self, asked: Asked) -> NDArray[np.int32]:
        """Entity number (in `surfaces.entities`) that stands in the way in each square, -1 for none, shape (rows, cols)."""
        key = (asked.step, asked.headroom)
        if key not in self.owner:
            self.owner[key] = self._occupied(*key)
        return self.owner[key]

    def _occupied(self, step: float, headroom: float) -> NDArray[np.int32]:
        found = np.full(self.shape, -1, dtype=np.int32)
        grounds = {(p.entity, p.part) for p in patches(self.surfaces.candidate.spec, self.land.name)}
        reach = 0.5 * self.cell * self.tangent.ravel() * math.sqrt(2.0)
        z = self.points[:, 2]
        for part in self.surfaces.parts:
            if (part.entity, part.part) in grounds or part.entity in self.absent:
                continue
            pose = self.surfaces.track(part.entity, part.body).at(self.frame)
            corners = pose.apply(part.solid.vertices)[part.solid.faces]
            square, triangle = self._under(corners)
            height = corners[triangle, :, 2]
            hit = (height.max(axis=1) > z[square] - reach[square] + step) & (
                height.min(axis=1) < z[square] + reach[square] + headroom
            )
            found.ravel()[square[hit]] = self.surfaces.entities.index(part.entity)
        return found

    def _under(self, corners: F64) -> tuple[Ints, Ints]:
        """Squares under the boxes of triangles, and which triangle; one box for all where that would be too many."""
        flat = corners[:, :, :2]
        rows, cols = self.shape
        first = np.floor((flat.min(axis=1) - self.origin) / self.cell - 1e-9).astype(np.int64)
        last = np.floor((flat.max(axis=1) - self.origin) / self.cell + 1e-9).astype(np.int64)
        first, last = np.maximum(first, 0), np.minimum(last, [cols - 1, rows - 1])
        span = np.maximum(last - first + 1, 0)
        counts = span[:, 0] * span[:, 1]
        if counts.sum() > PAIRS:
            whole = np.array([[corners.min(axis=(0, 1)), corners.max(axis=(0, 1)), corners.max(axis=(0, 1))]])
            return self._under(whole) if len(corners) > 1 else (np.arange(rows * cols), np.zeros(rows * cols, dtype=np.intp))
        triangle, number = expand(counts)
        across = span[triangle, 0]
        return (first[triangle, 1] + number // across) * cols + first[triangle, 0] + number % across, triangle

    def free(self, asked: Asked) -> Bools:
        """Squares that the carrier can stand in, shape (rows, cols)."""
        free = (self.tangent <= asked.tangent * (1 + 1e-9)) & (self.depth <= asked.wade)
        if asked.built:
            free &= self.occupied(asked) < 0
        if self.cell < asked.width and not free.all():
            from scipy import ndimage

            away = ndimage.distance_transform_edt(free) * self.cell
            free &= away - math.sqrt(0.5) * self.cell >= 0.5 * asked.width
        return free

    def steps(self, asked: Asked, free: Bools) -> list[tuple[Ints, Ints]]:
        """Free steps to four of the neighbours, as (from, to)."""
        rows, cols = self.shape
        number = np.arange(rows * cols).reshape(self.shape)
        blocked = self._barred(asked) if asked.stems else None
        found = []
        for k, (dr, dc) in enumerate(WAYS):
            here = np.s_[: rows - dr, max(0, -dc) : cols - max(0, dc)]
            there = np.s_[dr:, max(0, dc) : cols + min(0, dc)]
            ok = free[here] & free[there]
            if dr and dc:
                ok &= free[dr:, max(0, -dc) : cols - max(0, dc)] & free[: rows - dr, max(0, dc) : cols + min(0, dc)]
            if blocked is not None:
                ok &= ~blocked[k][here]
            found.append((number[here][ok], number[there][ok]))
        return found

    def _barred(self, asked: Asked) -> Bools:
        """Steps, from each square in each of `WAYS`, that pass a trunk or boulder too closely, shape (4, rows, cols)."""
        rows, cols = self.shape
        barred = np.zeros((len(WAYS), rows, cols), dtype=bool)
        far = self.origin + self.cell * np.array([cols, rows])
        stems = self.land.stems.inside(self.origin - asked.width, far + asked.width)
        stems = type(stems)(*(v[stems.top > asked.step] for v in stems))
        for group in _by_reach(stems.radius + 0.5 * asked.width, self.cell):
            place = (stems.foot[group, 1::-1] - self.origin[::-1]) / self.cell - 0.5
            reach = (stems.radius[group] + 0.5 * asked.width) / self.cell
            base = np.floor(place).astype(np.int64)
            margin = math.ceil(float(reach.max())) + 1
            for row in range(-margin, margin + 1):
                for col in range(-margin, margin + 1):
                    r, c = base[:, 0] + row, base[:, 1] + col
                    inside = (r >= 0) & (r < rows) & (c >= 0) & (c < cols)
                    for k, way in enumerate(WAYS):
                        along = np.array(way, dtype=np.float64)
                        arm = place - np.stack([r, c], axis=1)
                        t = np.clip(arm @ along / float(along @ along), 0.0, 1.0)
                        hit = inside & (np.hypot(*(arm - t[:, None] * along).T) < reach)
                        barred[k, r[hit], c[hit]] = True
        return barred

    def stops(self, relation: Connects, free: Bools) -> list[Ints]:
        """Free squares in the first region, around every waypoint and in the last region."""
        found = [self._in_region(relation.a, relation.max_step, free)]
        for waypoint in relation.waypoints:
            away = np.linalg.norm(self.points[:, :2] - np.array(waypoint), axis=1)
            found.append(np.flatnonzero((away <= max(self.cell, 0.5 * relation.width)) & free.ravel()))
        return [*found, self._in_region(relation.b, relation.max_step, free)]

    def _in_region(self, name: str, step: float, free: Bools) -> Ints:
        ground = ground_in(self.surfaces, self.land, name, self.frame, step)
        index = np.floor((ground[:, :2] - self.origin) / self.cell).astype(np.int64)
        rows, cols = self.shape
        index = index[(index >= 0).all(axis=1) & (index < [cols, rows]).all(axis=1)]
        squares = np.unique(index[:, 1] * cols + index[:, 0])
        return np.asarray(squares[free.ravel()[squares]])

    def _graph(self, asked: Asked, free: Bools) -> Any:
        from scipy.sparse import csr_array

        steps = self.steps(asked, free)
        source, target = (np.concatenate([s[k] for s in steps]) for k in (0, 1))
        length = np.concatenate([np.full(len(s[0]), self.cell * math.hypot(*way)) for s, way in zip(steps, WAYS, strict=True)])
        count = self.shape[0] * self.shape[1]
        return csr_array((length, (source, target)), shape=(count, count))

    def exists(self, relation: Connects, asked: Asked) -> bool:
        """True if there is a way."""
        from scipy.sparse.csgraph import connected_components

        free = self.free(asked)
        stops = self.stops(relation, free)
        if any(len(s) == 0 for s in stops):
            return False
        label = connected_components(self._graph(asked, free), directed=False)[1]
        common = set(label[stops[0]].tolist())
        return all(bool(common := common & set(label[s].tolist())) for s in stops[1:])

    def way(self, relation: Connects, asked: Asked) -> Track | None:
        """The shortest way through all stops; None where there is none."""
        free = self.free(asked)
        stops = self.stops(relation, free)
        if any(len(s) == 0 for s in stops):
            return None
        path = shortest_way(self._graph(asked, free), stops)
        if path is None:
            return None
        route, steep = self.points[path], self.tangent.ravel()[path]
        worst = int(np.argmax(steep))
        return Track(route, float(steep[worst]), route[worst], float(self.depth.ravel()[path].max()))

    def least(self, relation: Connects, asked: Asked, knob: str, good: float, bad: float, halvings: int = 8) -> float:
        """By bisection, the value of a limit nearest to `bad` at which there still is a way; it is known at `good`."""
        for _ in range(halvings):
            middle = 0.5 * (good + bad)
            changed: dict[str, Any] = {knob: middle}
            good, bad = (middle, bad) if self.exists(relation, replace(asked, **changed)) else (good, middle)
        return good

    def on_the_way(self, track: Track, asked: Asked) -> list[str]:
        """Entities that stand on a route, in order."""
        index = np.floor((track.route[:, :2] - self.origin) / self.cell).astype(np.int64)
        met = self.occupied(asked)[index[:, 1], index[:, 0]]
        return [self.surfaces.entities[k] for k in dict.fromkeys(met[met >= 0].tolist())]


def ground_in(surfaces: Surfaces, land: Land, region: str, frame: int, step: float) -> F64:
    """Places of a landscape's ground in a region, or under or over it by at most a step [m], shape (n, 3)."""
    shape = surfaces.candidate.spec.graph.regions[region]
    low, high = region_box(surfaces, region, frame)
    x, y = (np.linspace(low[k], high[k], SAMPLES) for k in (0, 1))
    flat = np.stack([v.ravel() for v in np.meshgrid(x, y)], axis=1)
    ground = np.column_stack([flat, land.heights_at(flat)])
    ground = ground[np.isfinite(ground[:, 2])]
    local = ground if shape.relative_to is None else frame_of(surfaces, shape.relative_to, frame).inverse().apply(ground)
    _, offset = region_offset(shape, local)
    inside = (np.abs(offset[:, :2]).max(axis=1, initial=0.0) <= 1e-9) & (np.abs(offset[:, 2]) <= step)
    return np.asarray(ground[inside])


def _by_reach(reach: F64, cell: float) -> list[Ints]:
    """Stems grouped by how many squares they reach over, so that small ones look at few."""
    size = np.ceil(reach / cell).astype(np.int64)
    return [np.flatnonzero(size == k) for k in np.unique(size)]
