"""The scene at one frame as ways see it: surfaces in columns and layers of floor, made once for all connections that ask the same."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...worlds.arrays import F64
from ...worlds.errors import EvidenceError
from ..land.grounds import Land, lands, patches, stem_triangles, surface_triangles
from .clearances import Obstacles, measure_clearance
from .columns import Columns, Grid, Soup, rasterise
from .walkable import Carrier, Floor, lay_floor

if TYPE_CHECKING:
    from ..scene.surfaces import Surfaces

__all__ = ["Ground", "Scene", "scene_of"]

KEPT = 2
"""Own choice: scenes kept, and grounds of each; one of 600,000 cells takes about 1 GB."""


class _Reach(NamedTuple):
    """Where a part lies: number of its entity and of itself, and its box [m]."""

    entity: int
    part: int
    low: F64
    high: F64


class Scene:
    """All visible surfaces at one frame but those that are absent; obtain it with `scene_of`."""

    def __init__(self, surfaces: Surfaces, frame: int, absent: Collection[str]) -> None:
        self.surfaces, self.frame = surfaces, frame
        self.names = [n for n in surfaces.entities if n not in absent]
        """Entities, then what landscapes consist of, by the numbers that triangles carry."""
        self.lands = lands(surfaces.candidate)
        self.waters: dict[int, Land] = {}
        """Water of landscapes by its number."""
        self._land_numbers: list[int] = []
        self._parts = self._reaches()
        for land in self.lands:
            self._land_numbers.append(len(self.names))
            self.names += [land.name, f"plants of {land.name}", f"water of {land.name}"]
            self.waters[len(self.names) - 1] = land
        ends = [(p.low[:2], p.high[:2]) for p in self._parts] + [(land.low, land.high) for land in self.lands]
        if not ends:
            raise EvidenceError("the scene has no visible surface; call build_terrain or place_object")
        self.low, self.high = np.min([e[0] for e in ends], axis=0), np.max([e[1] for e in ends], axis=0)
        self._grounds: dict[object, Ground] = {}

    def _reaches(self) -> list[_Reach]:
        number = {n: k for k, n in enumerate(self.names)}
        found = []
        for name in self.names:
            low, high = self.surfaces.tight_boxes(name, self.frame)
            found += [_Reach(number[name], i, low[k], high[k]) for k, i in enumerate(self.surfaces.parts_of[name])]
        return found

    def cells(self, cell: float) -> float:
        """Cells of a size [m] that cover the rectangle around all there is."""
        size = self.high - self.low
        return float(size[0] * size[1]) / (cell * cell)

    def _top(self, headroom: float) -> float:
        """Height [m] above which nothing concerns who goes over the land."""
        return max((float(np.nanmax(land.height)) for land in self.lands), default=math.inf) + headroom

    def bare(self, low: F64, high: F64, headroom: float) -> bool:
        """True if nothing but the land lies in a rectangle, below the highest ground and the headroom [m]."""
        spec = self.surfaces.candidate.spec
        grounds = {(p.entity, p.part) for land in self.lands for p in patches(spec, land.name)}
        for reach in self._parts:
            part = self.surfaces.parts[reach.part]
            if (part.entity, part.part) not in grounds and _meets(reach, low, high):
                corners = self._corners(reach, low, high)
                if len(corners) and corners[:, :, 2].min() <= self._top(headroom):
                    return False
        return True

    def _corners(self, reach: _Reach, low: F64, high: F64) -> F64:
        """Triangles of a part that reach into a rectangle [m], shape (t, 3, 3)."""
        part = self.surfaces.parts[reach.part]
        solid = self.surfaces.shapes.solid(reach.part, self.frame)
        corners = self.surfaces.track(part.entity, part.body).at(self.frame).apply(solid.vertices)[solid.faces]
        flat = corners[:, :, :2]
        return np.asarray(corners[((flat.max(axis=1) >= low) & (flat.min(axis=1) <= high)).all(axis=1)])

    def ground(self, grid: Grid, high: F64) -> Ground:
        """The ground over the cells of a grid, which ends at the corner `high` [m]."""
        key = (grid.origin.tobytes(), high.tobytes(), grid.cell)
        if key not in self._grounds:
            if len(self._grounds) >= KEPT:
                self._grounds.pop(next(iter(self._grounds)))
            self._grounds[key] = Ground(grid, self._soup(grid.origin, high), self.waters)
        return self._grounds[key]

    def _soup(self, low: F64, high: F64) -> Soup:
        candidate = self.surfaces.candidate
        drawn = {(n, p.part) for n in self.surfaces.entities for p in candidate.entity(n).parts if not p.collision}
        found = [_pile(np.zeros((0, 3, 3)), 0, closed=False, solid=False)]
        for reach in (p for p in self._parts if _meets(p, low, high)):
            part = self.surfaces.parts[reach.part]
            solid = (part.entity, part.part) not in drawn
            found.append(_pile(self._corners(reach, low, high), reach.entity, closed=part.solid.closed, solid=solid))
        for number, land in zip(self._land_numbers, self.lands, strict=True):
            surface = surface_triangles(land, low, high, patches(candidate.spec, land.name))
            found.append(_pile(surface, number, closed=False, solid=True))
            found.append(_pile(stem_triangles(land.stems.inside(low, high)), number + 1, closed=False, solid=True))
        return Soup(*(np.concatenate(column) for column in zip(*found, strict=True)))


@dataclass
class Ground:
    """A rectangle of a scene in columns, with the floors that carriers have on it."""

    grid: Grid
    soup: Soup
    waters: dict[int, Land]
    _floors: dict[object, Floor] = field(default_factory=dict)
    _obstacles: dict[object, Obstacles] = field(default_factory=dict)

    @cached_property
    def columns(self) -> Columns:
        """The triangles, rasterised."""
        return rasterise(self.soup, self.grid)

    def floor(self, carrier: Carrier, ignore: int, wade: float) -> Floor:
        """Layers of floor for a carrier, blocked where water over them is deeper than it wades [m]; entity `ignore` is as if absent."""
        key = (carrier, wade)
        if ignore < 0 and key in self._floors:
            return self._floors[key]
        floor = lay_floor(self.columns, carrier, ignore=ignore)
        for number, land in self.waters.items():
            deep = land.depths_at(floor.points) > wade
            if number != ignore and deep.any():
                nodes = floor.nodes
                nodes = nodes._replace(blocked=nodes.blocked | deep, blocker=np.where(deep, number, nodes.blocker))
                floor = replace(floor, nodes=nodes)
        if ignore < 0:
            self._floors[key] = floor
        return floor

    def obstacles(self, carrier: Carrier, ignore: int, wade: float) -> Obstacles:
        """Clearance of every node of a floor, at most the width of the carrier."""
        key = (carrier, wade)
        if ignore < 0 and key in self._obstacles:
            return self._obstacles[key]
        found = measure_clearance(self.floor(carrier, ignore, wade), carrier.width, ignore=ignore)
        if ignore < 0:
            self._obstacles[key] = found
        return found


def scene_of(surfaces: Surfaces, frame: int, absent: Collection[str]) -> Scene:
    """The scene at a frame without some entities; the last few are kept.

    Raises:
        EvidenceError: nothing is built.
    """
    kept: dict[object, Scene] = surfaces.candidate.memo(Scene, dict)
    key = (frame, frozenset(absent))
    if key not in kept:
        if len(kept) >= KEPT:
            kept.pop(next(iter(kept)))
        kept[key] = Scene(surfaces, frame, absent)
    return kept[key]


def _meets(reach: _Reach, low: F64, high: F64) -> bool:
    return bool((reach.high[:2] >= low).all() and (reach.low[:2] <= high).all())


def _pile(corners: F64, owner: int, *, closed: bool, solid: bool) -> Soup:
    count = len(corners)
    return Soup(corners, np.full(count, owner, dtype=np.intp), np.full(count, closed), np.full(count, solid))
