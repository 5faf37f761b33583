"""The route of one connection at one frame: the widest way, or the reason why there is none.

The visible surfaces of all entities are rasterised into columns; the route is searched over layers of floor with the
carrier's width, height, slope and step.
"""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from ...worlds.errors import EvidenceError
from ..land.grounds import Land, lands, patches, stem_triangles, surface_triangles
from ..predicates.kinematic import region_offset
from ..rows.questions import Comparison
from .bounds import CELL, PITCH, RASTER_NOISE, REST, SAME_HEIGHT, STRETCH, THRESHOLD, WADING
from .columns import Columns, Grid, Ints, Soup, rasterise
from .land_routes import follow
from .places import RouteResult, frame_of, region_box
from .walkable import Carrier, Floor, Obstacles, lay_floor, measure_clearance, standing
from .widths import Way, passable, pieces_of, reachable, widest_way

if TYPE_CHECKING:
    from ...worlds.spec import Connects
    from ..scene.surfaces import Surfaces

__all__ = ["find_route"]

CELLS_PER_WIDTH = 8.0
CELLS_PER_REGION = 4.0
MARGINS = (3.0, 20.0)
"""[m] Own choice: the search first looks this far around the box of regions and waypoints, then farther (at least the
box's diagonal)."""
MOST_CELLS = 600_000
"""Own choice: cells of one search, about 1 GB; larger areas get coarser cells down to a quarter of the width."""
STEEPEST = 1.4
"""[rad] Slopes up to this are tried when looking for the reason of a failure."""
SEARCH = 8
"""Halvings when the measured value of a failure is searched."""
SUSPECTS = 8
"""Entities that are tried as the one that blocks the way."""
OPEN_CELLS = 150_000
"""Own choice: cells of a search beside one over open land, which has judged the land already."""


def find_route(surfaces: Surfaces, relation: Connects, frame: int, *, absent: Collection[str] = ()) -> RouteResult:
    """Search nearby first; only what fails there is searched again in a wider area.

    Args:
        surfaces: the candidate's surfaces.
        relation: the connection.
        frame: at which frame.
        absent: entities that are no part of the scene, because they are what travels.

    Raises:
        EvidenceError: the search area is too large, or nothing is there to walk on.
    """
    over_land = follow(surfaces, relation, frame, absent)
    if over_land is not None and over_land.ok:
        return over_land
    most = MOST_CELLS if over_land is None else OPEN_CELLS
    try:
        near = _Search(surfaces, relation, frame, MARGINS[0], absent, most, wide=False)
        if over_land is not None and near.bare and over_land.evidence["cell_m"] >= relation.width:
            return over_land
        if near.clipped and not near.wide_enough:
            if over_land is not None and near.bare:
                return over_land
            wide = _Search(surfaces, relation, frame, MARGINS[1], absent, most, wide=True)
            return wide.finding() if over_land is None or wide.wide_enough else over_land
        return near.finding()
    except EvidenceError:
        if over_land is None:
            raise
        return over_land


class _Search:
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
        """Whether nothing but the land lies in the area."""
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

    def _stops(self, floor: Floor) -> list[Ints]:
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
        return widest_way(floor, obstacles, self._stops(floor), 0.5 * carrier.width, carrier.width), floor, obstacles

    @cached_property
    def direct(self) -> tuple[Way | None, Floor, Obstacles]:
        """The widest way for the carrier as declared."""
        return self.way(self.carrier)

    @property
    def wide_enough(self) -> bool:
        """Whether the widest way suffices."""
        way = self.direct[0]
        return way is not None and 2.0 * way.clearance >= self.relation.width - RASTER_NOISE

    def exists(self, carrier: Carrier, ignore: int = -1) -> bool:
        """Whether the carrier has a way of half its width at least."""
        floor = self._floor(carrier, ignore)
        stops = self._stops(floor)
        if not passable(floor, None, stops, 0.0):
            return False
        obstacles = measure_clearance(floor, 0.5 * carrier.width, ignore=ignore)
        return passable(floor, obstacles, stops, 0.25 * carrier.width)

    def finding(self) -> RouteResult:
        """Verdict at this frame."""
        way, floor, obstacles = self.direct
        if way is None:
            return self._why(floor)
        clear, width = 2.0 * way.clearance, self.relation.width
        evidence = {
            "clear_width_m": clear,
            "narrowest_place": way.place.tolist(),
            "route": _decimate(way.route, self.columns.grid.cell).tolist(),
            "route_length_m": float(np.linalg.norm(np.diff(way.route, axis=0), axis=1).sum()),
            **self._profile(floor, way),
            "cell_m": self.columns.grid.cell,
            "search_clipped": self.clipped,
        }
        bound = width - RASTER_NOISE
        capped = clear >= 2.0 * width * (1 - 1e-9)
        if clear < bound:
            beside = self._narrow(way, floor, obstacles)
            blame = beside or self._owners(floor.nodes.owner[np.array([way.node])])
            place = ", ".join(f"{c:.2f}" for c in way.place)
            between = " and ".join(map(repr, beside)) or " and ".join(["the edges of the floor", *map(repr, blame)])
            text = f"the way is {clear:.3f} m wide at ({place}), the carrier needs {width:g} m; narrowed by {between}"
            return RouteResult(False, text, clear, bound, ">=", "m", "too narrow", blame, evidence)
        pitch, where = _pitch(
            way.route, min(STRETCH, max(0.75 * width, 6 * self.columns.grid.cell)), self.carrier, self.columns.grid.cell
        )
        if pitch > max(PITCH, self.carrier.tangent):
            owner = self._owners(floor.nodes.owner[way.nodes[where : where + 1]])
            text = f"the stairs rise by {math.atan(pitch):.3f} rad on average, at most {math.atan(PITCH):.3f} rad can be walked"
            return RouteResult(False, text, math.atan(pitch), math.atan(PITCH), "<=", "rad", "too steep", owner, evidence)
        text = f"a route of {evidence['route_length_m']:.2f} m leads from {self.relation.a!r} to {self.relation.b!r}, "
        text += f"{'at least ' if capped else ''}{clear:.3f} m wide at its narrowest"
        floors = self._owners(np.unique(floor.nodes.owner[way.nodes]))
        return RouteResult(True, text, clear, bound, ">=", "m", "", (), evidence, way.route, floors)

    def _profile(self, floor: Floor, way: Way) -> dict[str, Any]:
        """Least headroom, steepest slope and highest step along the middle of the way, and where."""
        places = floor.points[way.nodes]
        ceiling, slope = floor.nodes.ceiling[way.nodes], floor.nodes.tangent[way.nodes]
        rise = np.abs(np.diff(floor.nodes.z[way.nodes])) if len(way.nodes) > 1 else np.zeros(1)
        run = np.linalg.norm(np.diff(places[:, :2], axis=0), axis=1) if len(way.nodes) > 1 else np.ones(1)
        step = np.maximum(rise - run * np.maximum(slope[:-1], slope[1:]) if len(way.nodes) > 1 else rise, 0.0)
        low, steep, high = int(np.argmin(ceiling)), int(np.argmax(slope)), int(np.argmax(step))
        return {
            "headroom_m": float(ceiling[low]) if np.isfinite(ceiling[low]) else None,
            "lowest_place": places[low].tolist() if np.isfinite(ceiling[low]) else None,
            "steepest_rad": math.atan(float(slope[steep])),
            "steepest_place": places[steep].tolist(),
            "highest_step_m": float(step[high]),
            "highest_step_place": places[high].tolist(),
        }

    def _is_static(self, name: str) -> bool:
        return name not in self.surfaces.entities or self.surfaces.is_static(name)

    def _size(self, name: str) -> float:
        return self.surfaces.size(name) if name in self.surfaces.entities else math.inf

    def _owners(self, index: Ints) -> tuple[str, ...]:
        return tuple(self.names[i] for i in dict.fromkeys(int(k) for k in index if k >= 0))

    def _narrow(self, way: Way, floor: Floor, obstacles: Obstacles) -> tuple[str, ...]:
        """Whose surfaces stand nearest to the narrowest place on its sides, the one to move first."""
        cell = floor.columns.grid.cell
        near = np.linalg.norm(floor.points[:, :2] - way.place[:2], axis=1) <= way.clearance + 2.0 * cell
        near &= np.abs(floor.points[:, 2] - way.place[2]) <= self.carrier.step + way.clearance + cell
        labels = np.unique(obstacles.label[near & ~floor.nodes.blocked])
        labels = labels[labels >= 0]
        if len(labels) == 0:
            return ()
        apart = np.linalg.norm(obstacles.point - way.place[:2], axis=1)
        least = np.array([apart[obstacles.start[k] : obstacles.start[k + 1]].min() for k in labels])
        order = np.argsort(least, kind="stable")
        beside = self._owners(obstacles.owner[labels[order[least[order] <= way.clearance + cell]]])
        # What moves, then what is small, is moved aside more easily than a wall.
        return tuple(sorted(beside, key=lambda n: (self._is_static(n), self._size(n))))

    def _why(self, floor: Floor) -> RouteResult:
        """There is no way at all: find out which limit, or which entity, is the reason."""
        start, *_, goal = self._stops(floor)
        for name, nodes in ((self.relation.a, start), (self.relation.b, goal)):
            if len(nodes) == 0:
                text = f"region {name!r} has no floor on which the carrier can stand"
                return self._finding(text, 0.0, self.relation.width, ">=", "m", "no floor", ())
        for search in (self._too_low, self._too_steep, self._step_too_high, self._blocked):
            found = search(floor, start)
            if found is not None:
                return found
        return self._gap(floor, start)

    def _finding(
        self, text: str, measured: float, bound: float, comparison: Comparison, unit: str, reason: str, blame: tuple[str, ...]
    ) -> RouteResult:
        evidence = {"cell_m": self.columns.grid.cell, "search_clipped": self.clipped}
        return RouteResult(False, text, measured, bound, comparison, unit, reason, blame, evidence)

    def _limit(self, good: float, bad: float, carrier_of: Any) -> tuple[float, Way, Floor]:
        """Bisect between a value that lets the carrier through and one that does not."""
        for _ in range(SEARCH):
            middle = 0.5 * (good + bad)
            good, bad = (middle, bad) if self.exists(carrier_of(middle)) else (good, middle)
        way, floor, _ = self.way(carrier_of(good))
        assert way is not None
        return good, way, floor

    def _too_low(self, _floor: Floor, _start: Ints) -> RouteResult | None:
        def lower(height: float) -> Carrier:
            return replace(self.carrier, headroom=height)

        least = self.carrier.step + 0.2 * (self.relation.headroom - self.carrier.step)
        if least <= 0.0 or not self.exists(lower(least)):
            return None
        _, way, floor = self._limit(least, self.relation.headroom, lower)
        ceiling = floor.nodes.ceiling[way.nodes]
        k = int(np.argmin(ceiling))
        height = float(ceiling[k])
        blame = self._owners(floor.nodes.blocker[way.nodes[k : k + 1]])
        under = ", ".join(map(repr, blame))
        text = f"the clear height is {height:.3f} m under {under}, the carrier needs {self.relation.headroom:g} m"
        return self._finding(text, height, self.relation.headroom, ">=", "m", "too low", blame)

    def _too_steep(self, _floor: Floor, _start: Ints) -> RouteResult | None:
        def steeper(angle: float) -> Carrier:
            return replace(self.carrier, tangent=math.tan(angle))

        if self.relation.max_slope >= STEEPEST or not self.exists(steeper(STEEPEST)):
            return None
        _, way, floor = self._limit(STEEPEST, self.relation.max_slope, steeper)
        slope = floor.nodes.tangent[way.nodes]
        k = int(np.argmax(slope))
        angle = math.atan(float(slope[k]))
        blame = self._owners(floor.nodes.owner[way.nodes[k : k + 1]])
        text = f"{', '.join(map(repr, blame))} slopes {angle:.3f} rad, the carrier takes {self.relation.max_slope:g} rad"
        return self._finding(text, angle, self.relation.max_slope, "<=", "rad", "too steep", blame)

    def _step_too_high(self, _floor: Floor, _start: Ints) -> RouteResult | None:
        def higher(step: float) -> Carrier:
            return replace(self.carrier, step=step)

        most = THRESHOLD * self.relation.max_step
        if most >= self.relation.headroom or not self.exists(higher(most)):
            return None
        _, way, floor = self._limit(most, self.relation.max_step, higher)
        height, owner = self._highest_step(floor, way)
        blame = self._owners(np.array([owner]))
        text = (
            f"a step of {height:.3f} m leads onto {', '.join(map(repr, blame))}, the carrier takes {self.relation.max_step:g} m"
        )
        return self._finding(text, height, self.relation.max_step, "<=", "m", "step too high", blame)

    def _highest_step(self, floor: Floor, way: Way) -> tuple[float, int]:
        """Highest rise between nodes of a way, or thing that is stepped over on it [m], and the entity stepped onto."""
        z, owner = floor.nodes.z[way.nodes], floor.nodes.owner[way.nodes]
        best, onto = 0.0, -1
        if len(z) > 1:
            rise = np.diff(z)
            k = int(np.argmax(np.abs(rise)))
            best, onto = float(abs(rise[k])), int(owner[k + 1] if rise[k] > 0 else owner[k])
        group, piece, _ = standing(
            self.columns, self.carrier, floor.nodes.cell[way.nodes], z, floor.nodes.gradient[way.nodes], ignore=-1
        )
        over = self.columns.pieces.high[piece] - z[group]
        over = np.where(over <= floor.carrier.step + SAME_HEIGHT, over, 0.0)
        if len(over) and over.max() > best:
            k = int(np.argmax(over))
            best, onto = float(over[k]), int(self.columns.soup.owner[self.columns.pieces.triangle[piece[k]]])
        return best, onto

    def _blocked(self, floor: Floor, start: Ints) -> RouteResult | None:
        """The entity without which there is a way; those that border on the reachable floor are tried."""
        reached = reachable(floor, start)
        beside = floor.links[reached]
        beside = np.unique(beside[beside >= 0])
        blockers = floor.nodes.blocker[beside[floor.nodes.blocked[beside]]]
        blockers, count = np.unique(blockers[blockers >= 0], return_counts=True)
        size = np.array([self._size(self.names[k]) for k in blockers])
        for k in blockers[np.lexsort((-count, size))][:SUSPECTS]:
            if self.exists(self.carrier, int(k)):
                text = f"{self.names[k]!r} blocks the way from {self.relation.a!r} to {self.relation.b!r}"
                return self._finding(text, 0.0, self.relation.width - RASTER_NOISE, ">=", "m", "blocked", (self.names[k],))
        return None

    def _gap(self, floor: Floor, start: Ints) -> RouteResult:
        from scipy.spatial import cKDTree

        goal = self._stops(floor)[-1]
        near, far = reachable(floor, start), reachable(floor, goal)
        distance, index = cKDTree(floor.points[near]).query(floor.points[far])
        k = int(np.argmin(distance))
        one, two = floor.points[near][index[k]], floor.points[far][k]
        width = float(distance[k])
        places = " and ".join("(" + ", ".join(f"{c:.2f}" for c in p) + ")" for p in (one, two))
        blame = self._owners(floor.nodes.owner[np.flatnonzero(far)[k : k + 1]])
        text = f"the floor is interrupted by {width:.3f} m between {places}"
        found = self._finding(text, width, self.columns.grid.cell, "<=", "m", "gap", blame)
        return found._replace(evidence={**found.evidence, "from": one.tolist(), "to": two.tolist()})


def _pile(corners: F64, owner: int, *, closed: bool, solid: bool) -> Soup:
    count = len(corners)
    return Soup(corners, np.full(count, owner, dtype=np.intp), np.full(count, closed), np.full(count, solid))


def _decimate(route: F64, tolerance: float) -> F64:
    """Ramer-Douglas-Peucker: the fewest corners that stay within `tolerance` of the route."""
    keep: NDArray[np.bool_] = np.zeros(len(route), dtype=bool)
    keep[[0, -1]] = True
    waiting = [(0, len(route) - 1)]
    while waiting:
        first, last = waiting.pop()
        if last - first < 2:
            continue
        along = route[last] - route[first]
        offset = route[first + 1 : last] - route[first]
        t = np.clip(offset @ along / max(float(along @ along), 1e-12), 0.0, 1.0)
        away = np.linalg.norm(offset - t[:, None] * along, axis=1)
        k = int(np.argmax(away))
        if away[k] > tolerance:
            keep[first + 1 + k] = True
            waiting += [(first, first + 1 + k), (first + 1 + k, last)]
    return np.asarray(route[keep])


def _pitch(route: F64, stretch: float, carrier: Carrier, cell: float) -> tuple[float, int]:
    """Steepest mean rise / run from step to step over a stretch [m] that climbs more than two steps, and where it begins.

    A route sees a step at the next centre of a cell, so the run is taken one cell [m] longer than it was seen.
    """
    run = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(route[:, :2], axis=0), axis=1))])
    steps = 1 + np.flatnonzero(np.abs(np.diff(route[:, 2])) > carrier.tangent * np.diff(run) + SAME_HEIGHT)
    if len(steps) < 2:
        return 0.0, 0
    run, height = run[steps], route[steps, 2]
    end = np.minimum(np.searchsorted(run, run + stretch), len(run) - 1)
    rise, length = np.abs(height[end] - height), run[end] - run
    rate = np.where((rise > 2.0 * carrier.step) & (length > 0.5 * stretch), rise / (length + cell), 0.0)
    k = int(np.argmax(rate))
    return float(rate[k]), int(steps[k])
