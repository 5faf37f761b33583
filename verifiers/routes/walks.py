"""Ways that a carrier has between two regions at one frame: surfaces rasterised into columns, layers of floor, and routes over them."""

from __future__ import annotations

import math
from collections.abc import Collection
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ...worlds.arrays import F64
from ...worlds.errors import EvidenceError
from ..predicates.kinematic import region_offset
from .bounds import CELL, RASTER_NOISE, REST, WADING
from .clearances import Obstacles, measure_clearance
from .columns import Columns, Grid, Ints
from .places import frame_of, region_box
from .scene import Ground, scene_of
from .walkable import Carrier, Floor
from .widths import Way, passable, pieces_of, widest_way

if TYPE_CHECKING:
    from ...worlds.spec import Connects
    from ..scene.surfaces import Surfaces

__all__ = ["Walks"]

CELLS_PER_WIDTH = 8.0
CELLS_PER_REGION = 4.0
"""Cells across the carrier, and across the smaller region."""
WHOLE = 200_000
"""Own choice: a scene that takes no more cells than this (20 x 25 m at 5 cm) is searched as a whole, so that all its ways share one floor."""


class Walks:
    """Routes of one connection at one frame."""

    def __init__(
        self, surfaces: Surfaces, relation: Connects, frame: int, margin: float, absent: Collection[str], most: int, *, wide: bool
    ) -> None:
        self.surfaces, self.relation, self.frame, self.most = surfaces, relation, frame, most
        self.carrier = Carrier(relation.width, relation.headroom, math.tan(relation.max_slope), relation.max_step)
        self.scene = scene_of(surfaces, frame, absent)
        low, high = self._area(margin, wide=wide)
        if self.scene.cells(self._finest) <= WHOLE:
            low, high = self.scene.low, self.scene.high
        self.clipped = bool((low > self.scene.low).any() or (high < self.scene.high).any())
        self.low, self.high = np.maximum(low, self.scene.low), np.minimum(high, self.scene.high)

    def _area(self, margin: float, *, wide: bool) -> tuple[F64, F64]:
        flat = np.array([b[:2] for pair in self._regions for b in pair] + [list(w) for w in self.relation.waypoints])
        low, high = flat.min(axis=0), flat.max(axis=0)
        margin = max(margin, float(np.linalg.norm(high - low))) if wide else margin
        return low - margin, high + margin

    @cached_property
    def _regions(self) -> list[tuple[F64, F64]]:
        return [region_box(self.surfaces, n, self.frame) for n in (self.relation.a, self.relation.b)]

    @property
    def _finest(self) -> float:
        """Cell [m] that resolves the carrier and the smaller region."""
        extent = min(float((b[:2] - a[:2]).min()) for a, b in self._regions)
        return min(CELL, self.relation.width / CELLS_PER_WIDTH, extent / CELLS_PER_REGION)

    @cached_property
    def ground(self) -> Ground:
        """The ground of the area, shared by all ways that ask for it.

        Raises:
            EvidenceError: the area is too large, or nothing is there.
        """
        size, cell = self.high - self.low, self._finest
        if (size <= 0.0).any():
            raise EvidenceError(f"regions {self.relation.a!r} and {self.relation.b!r} lie outside everything built")
        coarse = math.sqrt(float(size[0] * size[1]) / self.most)
        if coarse > max(cell, self.relation.width / 4.0):
            raise EvidenceError(
                f"the search area of {size[0]:.4g} x {size[1]:.4g} m needs cells of {coarse:.3g} m, too coarse for a width of "
                f"{self.relation.width:g} m; bring the regions closer together or split the connection with regions between"
            )
        cell = max(cell, coarse)
        count = np.maximum(np.ceil(size / cell).astype(int), 1)
        found = self.scene.ground(Grid(self.low, cell, int(count[0]), int(count[1])), self.high)
        if not len(found.soup.triangles):
            raise EvidenceError(f"regions {self.relation.a!r} and {self.relation.b!r} lie outside everything built")
        return found

    @property
    def bare(self) -> bool:
        """True if nothing but the land lies in the area."""
        return self.scene.bare(self.low, self.high, self.carrier.headroom)

    @property
    def names(self) -> list[str]:
        """Entities and landscapes by the numbers that nodes and triangles carry."""
        return self.scene.names

    @property
    def columns(self) -> Columns:
        """The area, rasterised; errors as `ground`."""
        return self.ground.columns

    def _floor(self, carrier: Carrier, ignore: int) -> Floor:
        """Layers of floor; where water over them is deeper than the carrier wades they are blocked."""
        return self.ground.floor(carrier, ignore, self._wade)

    @property
    def _wade(self) -> float:
        """Depth of water [m] that stops the carrier."""
        return WADING.get(self.relation.carrier, math.inf)

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
        obstacles = self.ground.obstacles(carrier, ignore, self._wade)
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
