"""Ways that a carrier has between two regions at one frame: surfaces rasterised into columns, layers of floor, and routes over them."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ...worlds.arrays import F64
from ...worlds.errors import EvidenceError
from ..land.grounds import Land, lands, patches, stem_triangles, surface_triangles
from ..predicates.kinematic import region_offset
from .bounds import CELL, RASTER_NOISE, REST, WADING
from .clearances import Obstacles, measure_clearance
from .columns import Columns, Grid, Ints, Soup, rasterise
from .places import frame_of, region_box
from .walkable import Carrier, Floor, lay_floor
from .widths import Way, passable, pieces_of, widest_way

if TYPE_CHECKING:
    from ...worlds.spec import Connects
    from ..scene.surfaces import Surfaces

__all__ = ["Walks"]

CELLS_PER_WIDTH = 8.0
CELLS_PER_REGION = 4.0
"""Cells across the carrier, and across the smaller region."""


class Walks:
    """Routes of one connection at one frame."""

    def __init__(
        self, surfaces: Surfaces, relation: Connects, frame: int, margin: float, absent: Collection[str], most: int, *, wide: bool
    ) -> None:
        self.surfaces, self.relation, self.frame, self.most = surfaces, relation, frame, most
        self.carrier = Carrier(relation.width, relation.headroom, math.tan(relation.max_slope), relation.max_step)
        self.names = [n for n in surfaces.entities if n not in absent]
        self.entity_count = len(self.names)
        self.lands = lands(surfaces.candidate)
        self.waters: dict[int, Land] = {}
        self.bare = False
        """True if nothing but the land lies in the area."""
        low, high = self._area(margin, wide=wide)
        self.soup, scene_low, scene_high = self._soup(low, high)
        self.clipped = bool((low > scene_low).any() or (high < scene_high).any())
        self.low, self.high = np.maximum(low, scene_low), np.minimum(high, scene_high)

    def _area(self, margin: float, *, wide: bool) -> tuple[F64, F64]:
        boxes = [region_box(self.surfaces, n, self.frame) for n in (self.relation.a, self.relation.b)]
        flat = np.array([b[:2] for pair in boxes for b in pair] + [list(w) for w in self.relation.waypoints])
        low, high = flat.min(axis=0), flat.max(axis=0)
        margin = max(margin, float(np.linalg.norm(high - low))) if wide else margin
        return low - margin, high + margin

    def _soup(self, low: F64, high: F64) -> tuple[Soup, F64, F64]:
        """Triangles that reach into a rectangle, and the corners of the rectangle around all there are."""
        found: list[Soup] = []
        candidate = self.surfaces.candidate
        drawn = {(n, p.part) for n in self.names for p in candidate.entity(n).parts if not p.collision}
        grounds = {(p.entity, p.part) for land in self.lands for p in patches(candidate.spec, land.name)}
        index = {n: k for k, n in enumerate(self.names)}
        ends = [(land.low, land.high) for land in self.lands]
        top = max((float(np.nanmax(land.height)) for land in self.lands), default=math.inf) + self.carrier.headroom
        self.bare = True
        for part in (p for p in self.surfaces.parts if p.entity in index):
            pose = self.surfaces.track(part.entity, part.body).at(self.frame)
            corners = pose.apply(part.solid.vertices)[part.solid.faces]
            flat = corners[:, :, :2]
            ends.append((flat.min(axis=(0, 1)), flat.max(axis=(0, 1))))
            corners = corners[((flat.max(axis=1) >= low) & (flat.min(axis=1) <= high)).all(axis=1)]
            aloft = len(corners) == 0 or corners[:, :, 2].min() > top
            self.bare &= aloft or (part.entity, part.part) in grounds
            found.append(
                _pile(corners, index[part.entity], closed=part.solid.closed, solid=(part.entity, part.part) not in drawn)
            )
        for land in self.lands:
            surface = surface_triangles(land, low, high, patches(candidate.spec, land.name))
            stems = stem_triangles(land.stems.inside(low, high))
            for name, triangles in ((land.name, surface), (f"plants of {land.name}", stems)):
                found.append(_pile(triangles, len(self.names), closed=False, solid=True))
                self.names.append(name)
            self.waters[len(self.names)] = land
            self.names.append(f"water of {land.name}")
        if not found:
            raise EvidenceError("the scene has no visible surface; call build_terrain or place_object")
        soup = Soup(*(np.concatenate(column) for column in zip(*found, strict=True)))
        return soup, np.min([e[0] for e in ends], axis=0), np.max([e[1] for e in ends], axis=0)

    @cached_property
    def columns(self) -> Columns:
        """The scene, rasterised.

        Raises:
            EvidenceError: the area is too large, or nothing is there.
        """
        low, high = self.low, self.high
        if (low >= high).any() or not len(self.soup.triangles):
            raise EvidenceError(f"regions {self.relation.a!r} and {self.relation.b!r} lie outside everything built")
        boxes = [region_box(self.surfaces, n, self.frame) for n in (self.relation.a, self.relation.b)]
        extent = min(float((b[:2] - a[:2]).min()) for a, b in boxes)
        cell = min(CELL, self.relation.width / CELLS_PER_WIDTH, extent / CELLS_PER_REGION)
        size = high - low
        coarse = math.sqrt(float(size[0] * size[1]) / self.most)
        if coarse > max(cell, self.relation.width / 4.0):
            raise EvidenceError(
                f"the search area of {size[0]:.4g} x {size[1]:.4g} m needs cells of {coarse:.3g} m, too coarse for a width of "
                f"{self.relation.width:g} m; bring the regions closer together or split the connection with regions between"
            )
        cell = max(cell, coarse)
        count = np.maximum(np.ceil(size / cell).astype(int), 1)
        return rasterise(self.soup, Grid(low, cell, int(count[0]), int(count[1])))

    def _floor(self, carrier: Carrier, ignore: int) -> Floor:
        """Layers of floor; where water over them is deeper than the carrier wades they are blocked."""
        floor = lay_floor(self.columns, carrier, ignore=ignore)
        wade = WADING.get(self.relation.carrier, math.inf)
        for number, land in self.waters.items():
            deep = land.depths_at(floor.points) > wade
            if number != ignore and deep.any():
                nodes = floor.nodes
                nodes = nodes._replace(blocked=nodes.blocked | deep, blocker=np.where(deep, number, nodes.blocker))
                floor = replace(floor, nodes=nodes)
        return floor

    def _in_region(self, floor: Floor, name: str) -> Ints:
        """Free nodes whose foot stands in a region, or under it by at most a step; no small rests behind walls."""
        region = self.surfaces.candidate.spec.graph.regions[name]
        points = floor.points
        if region.relative_to is not None:
            points = frame_of(self.surfaces, region.relative_to, self.frame).inverse().apply(points)
        _, offset = region_offset(region, points)
        inside = (np.abs(offset[:, :2]).max(axis=1) <= 1e-9) & (np.abs(offset[:, 2]) <= self.carrier.step)
        return pieces_of(floor, inside & ~floor.nodes.blocked, REST)

    def stops(self, floor: Floor) -> list[Ints]:
        """Free nodes in the first region, near each waypoint, and in the second region."""
        reach = max(1.5 * floor.columns.grid.cell, 0.5 * self.relation.width)
        stops = [self._in_region(floor, self.relation.a)]
        for waypoint in self.relation.waypoints:
            near = np.linalg.norm(floor.points[:, :2] - np.array(waypoint), axis=1) <= reach
            stops.append(np.asarray(np.flatnonzero(near & ~floor.nodes.blocked)))
        return [*stops, self._in_region(floor, self.relation.b)]

    def way(self, carrier: Carrier, ignore: int = -1) -> tuple[Way | None, Floor, Obstacles]:
        """The widest way for a carrier, as if the entity number `ignore` were absent."""
        floor = self._floor(carrier, ignore)
        obstacles = measure_clearance(floor, carrier.width, ignore=ignore)
        return widest_way(floor, obstacles, self.stops(floor), 0.5 * carrier.width, carrier.width), floor, obstacles

    @property
    def searched(self) -> dict[str, float | bool]:
        """Evidence of how the search was made."""
        return {"cell_m": self.columns.grid.cell, "search_clipped": self.clipped}

    @cached_property
    def direct(self) -> tuple[Way | None, Floor, Obstacles]:
        """The widest way for the carrier as declared."""
        return self.way(self.carrier)

    @property
    def wide_enough(self) -> bool:
        """True if the widest way suffices."""
        way = self.direct[0]
        return way is not None and 2.0 * way.clearance >= self.relation.width - RASTER_NOISE

    def exists(self, carrier: Carrier, ignore: int = -1) -> bool:
        """True if the carrier has a way of half its width at least."""
        floor = self._floor(carrier, ignore)
        stops = self.stops(floor)
        if not passable(floor, None, stops, 0.0):
            return False
        obstacles = measure_clearance(floor, 0.5 * carrier.width, ignore=ignore)
        return passable(floor, obstacles, stops, 0.25 * carrier.width)

    def is_static(self, name: str) -> bool:
        """True if an entity or a landscape never moves."""
        return name not in self.surfaces.entities or self.surfaces.is_static(name)

    def size(self, name: str) -> float:
        """Diagonal of an entity [m]; infinite for landscapes."""
        return self.surfaces.size(name) if name in self.surfaces.entities else math.inf

    def owners(self, index: Ints) -> tuple[str, ...]:
        """Names of entities by their numbers, each once; -1 is nobody."""
        return tuple(self.names[i] for i in dict.fromkeys(int(k) for k in index if k >= 0))


def _pile(corners: F64, owner: int, *, closed: bool, solid: bool) -> Soup:
    count = len(corners)
    return Soup(corners, np.full(count, owner, dtype=np.intp), np.full(count, closed), np.full(count, solid))
