"""Openings for fluids: whether a ball of the declared width fits all along some way between two regions (R21, R94).

Space is cut into cubes; the distance of points within them to the visible surfaces tells the widest way. A liquid does not
rise above the top of the region that it leaves. An opening that is there is only *resolved* when the fluid's own solver
has enough cells across it, so without a fluid that states its resolution the row stays unverified.

Cost: 0.2 to 2 s for two tanks of 1 m and a pipe of 5 to 30 cm.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.inside import contains
from ...worlds.arrays import F64
from ...worlds.errors import EvidenceError
from ..predicates.kinematic import region_offset
from .bounds import CELLS_ACROSS, OPENING_NOISE
from .columns import Ints
from .places import BLOCKED, NO_SPACE, TOO_NARROW, UNRESOLVED, RouteResult, failed, frame_of, region_box
from .shortest import shortest_way

if TYPE_CHECKING:
    from ...worlds.spec import Connects
    from ..scene.surfaces import Surfaces

__all__ = ["find_conduit"]

CUBES_ACROSS = 6.0
"""Cubes of the search across the declared width."""
MOST_CUBES = 4_000_000
MOST_SAMPLES = 3_000_000
"""Own choices: about 1 GB."""
MARGIN = 3.0
"""Widths around both regions in which a way is searched."""
HALVINGS = 4
ERROR = 0.9
"""[cubes] By how much the distance between cubes can be short of the best distance within them: half a diagonal and more."""
ROUNDS = 200
WAYS = np.array([w for w in itertools.product((-1.0, 0.0, 1.0), repeat=3) if np.count_nonzero(w) in (1, 3)])
"""Where a point may move in its cube: across faces, and across corners, since the nearest of several walls makes ridges."""


def find_conduit(surfaces: Surfaces, relation: Connects, frame: int) -> RouteResult:
    """The widest way for a fluid at one frame.

    Raises:
        EvidenceError: the space is too large to search, or no fluid says how finely it is resolved.
    """
    space = _Space(surfaces, relation, frame)
    found = space.finding()
    if not found.ok:
        return found
    cells = {n: e.physics.flow_cell for n, e in surfaces.candidate.spec.entities.items() if e.physics.flow_cell}
    if not cells:
        raise EvidenceError(f"{found.text}, but no liquid or gas states the resolution at which it would flow there; declare one")
    name, cell = max(cells.items(), key=lambda c: c[1])
    across, evidence = found.measured / cell, {**found.evidence, "solver_cells_across": found.measured / cell}
    if across < CELLS_ACROSS:
        text = f"the opening is {found.measured:.4g} m wide, {across:.2g} cells of {name!r}, which needs {CELLS_ACROSS:g} across"
        return failed(UNRESOLVED, text, across, CELLS_ACROSS, (name,), evidence)
    return found._replace(evidence=evidence)


class _Space:
    """Cubes around two regions, and how far their points are from the visible surfaces."""

    def __init__(self, surfaces: Surfaces, relation: Connects, frame: int) -> None:
        self.surfaces, self.relation, self.frame = surfaces, relation, frame
        boxes = [region_box(surfaces, n, frame) for n in (relation.a, relation.b)]
        margin = MARGIN * relation.width
        low = np.minimum(boxes[0][0], boxes[1][0]) - margin
        high = np.maximum(boxes[0][1], boxes[1][1]) + margin
        for x, y in relation.waypoints:
            low[:2], high[:2] = np.minimum(low[:2], (x - margin, y - margin)), np.maximum(high[:2], (x + margin, y + margin))
        fluids = {n: e.physics for n, e in surfaces.candidate.spec.entities.items() if e.physics.flow_cell}
        self.walls = [p for p in surfaces.parts if p.entity not in fluids]
        self.liquid = bool(fluids) and all(p.levels for p in fluids.values())
        if self.liquid:
            high[2] = float(boxes[0][1][2])
        self.cell = relation.width / CUBES_ACROSS
        self.low = low
        self.shape = np.maximum(np.ceil((high - low) / self.cell).astype(int), 1)
        if float(np.prod(self.shape.astype(float))) > MOST_CUBES:
            raise EvidenceError(
                f"the space of {' x '.join(f'{s:.3g}' for s in high - low)} m needs more than {MOST_CUBES} cubes for a width of "
                f"{relation.width:g} m; bring the regions closer together or split the connection with regions between"
            )
        self.samples, self.owner = self._samples(high)

    def _samples(self, high: F64) -> tuple[F64, Ints]:
        """Points of all visible surfaces in the space, at most half a cube apart [m], shape (n, 3), and their entities."""
        found, owner = [np.zeros((0, 3))], [np.zeros(0, dtype=np.intp)]
        count = 0
        low, reach = self.low - self.relation.width, high + self.relation.width
        names = list(self.surfaces.entities)
        for part in self.walls:
            pose = self.surfaces.track(part.entity, part.body).at(self.frame)
            triangles = pose.apply(part.solid.vertices)[part.solid.faces]
            while len(triangles):
                near = (triangles.max(axis=1) >= low).all(axis=1) & (triangles.min(axis=1) <= reach).all(axis=1)
                triangles = triangles[near]
                longest = np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=2).max(axis=1, initial=0.0)
                small = longest <= 0.5 * self.cell
                done = _distinct(triangles[small].reshape(-1, 3), self.low, 0.0625 * self.cell)
                found.append(done)
                owner.append(np.full(len(done), names.index(part.entity)))
                count += len(done)
                triangles = _split(triangles[~small])
                if count + len(triangles) > MOST_SAMPLES:
                    raise EvidenceError(
                        f"the surfaces around {self.relation.a!r} and {self.relation.b!r} are too large to sample at this width"
                    )
        return np.concatenate(found), np.concatenate(owner)

    def _centers(self, flat: Ints) -> F64:
        return np.asarray(self.low + self.cell * (np.stack(np.unravel_index(flat, tuple(self.shape)), axis=-1) + 0.5))

    def _stop(self, name: str, points: F64) -> NDArray[np.bool_]:
        """Points in a region and in no solid."""
        region = self.surfaces.candidate.spec.graph.regions[name]
        if region.relative_to is not None:
            points = frame_of(self.surfaces, region.relative_to, self.frame).inverse().apply(points)
        return np.asarray(region_offset(region, points)[0] >= 0.0)

    def _free(self, points: F64) -> NDArray[np.bool_]:
        free = np.ones(len(points), dtype=bool)
        for part in self.walls:
            if part.solid.closed:
                pose = self.surfaces.track(part.entity, part.body).at(self.frame)
                rows = np.flatnonzero(free)
                free[rows[contains(part.solid, pose.inverse().apply(points[rows]))]] = False
        return free

    def finding(self) -> RouteResult:
        """The widest way, judged by its width alone."""
        from scipy.ndimage import distance_transform_edt
        from scipy.spatial import cKDTree

        width, cell = self.relation.width, self.cell
        index = np.floor((self.samples - self.low) / cell).astype(int)
        inside = ((index >= 0) & (index < self.shape)).all(axis=1)
        taken = np.zeros(tuple(self.shape), dtype=bool)
        taken[tuple(index[inside].T)] = True
        cap = 0.5 * width + 2.0 * cell
        clear = np.full(taken.shape, cap)
        if taken.any():
            clear = np.minimum(np.asarray(distance_transform_edt(~taken)) * cell + ERROR * cell, cap)
        every = self._centers(np.arange(taken.size))
        stops = []
        for name in (self.relation.a, self.relation.b):
            rows = np.flatnonzero(self._stop(name, every))
            rows = rows[self._free(every[rows])]
            if len(rows) == 0:
                text = f"region {name!r} has no open space that a fluid could take"
                return failed(NO_SPACE, text, 0.0, width, (), {"cell_m": cell})
            stops.append(rows)
        ways = [
            np.flatnonzero(np.linalg.norm(every[:, :2] - np.array(w), axis=1) <= 0.5 * width) for w in self.relation.waypoints
        ]
        stops = [stops[0], *ways, stops[1]]
        tree = cKDTree(self.samples) if len(self.samples) else None
        path, points = self._widest_way(clear, every, stops, tree, cap)
        route, measured = points[path], clear.ravel()[path]
        k = int(np.argmin(measured))
        place, least = route[k], float(measured[k])
        if tree is not None and len(path) > 1:
            middle = 0.5 * (route[1:] + route[:-1])
            between = np.asarray(tree.query(middle)[0])
            k = int(np.argmin(between))
            place, least = (middle[k], float(between[k])) if between[k] < least else (place, least)
        return self._judge(2.0 * least, place, route)

    def _widest_way(self, clear: F64, points: F64, stops: list[Ints], tree: Any, cap: float) -> tuple[Ints, F64]:
        """Cubes of the widest way, and the best points in them; `clear` becomes exact where it decides.

        Distances begin too large. Those along the widest way are made exact, with their neighbours, until the widest way
        is exact all along: then no other can be wider.
        """
        exact, flat = clear.ravel() >= cap, clear.ravel()
        reach = np.array([[i, j, k] for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1)])
        points = points.copy()
        for _ in range(ROUNDS):
            widest = _widest(clear, stops)
            path = _path(clear >= widest, points, stops)
            open_cubes = path[~exact[path]]
            closed = widest < 0.25 * self.relation.width  # even what is too large is far too small: how small matters little
            if len(open_cubes) == 0 or tree is None or closed:
                return path, points
            around = np.stack(np.unravel_index(open_cubes, clear.shape), axis=-1)[:, None] + reach
            around = np.clip(around, 0, self.shape - 1).reshape(-1, 3)
            near = np.unique(np.ravel_multi_index(tuple(around.T), clear.shape))
            near = near[~exact[near]]
            points[near], flat[near] = _centred(tree, points[near], self.cell)
            flat[near] = np.minimum(flat[near], cap)
            exact[near] = True
        raise EvidenceError(
            f"{ROUNDS} rounds did not settle the widest opening between {self.relation.a!r} and {self.relation.b!r}"
        )

    def _judge(self, clear: float, place: F64, route: F64) -> RouteResult:
        width, bound = self.relation.width, (1.0 - OPENING_NOISE) * self.relation.width
        evidence: dict[str, Any] = {
            "clear_width_m": clear,
            "narrowest_place": place.tolist(),
            "route": route[:: max(1, len(route) // 50)].tolist(),
            "cell_m": self.cell,
            "liquid": self.liquid,
        }
        where = ", ".join(f"{c:.3f}" for c in place)
        if clear >= bound:
            text = f"an opening of at least {min(clear, width):.4g} m leads from {self.relation.a!r} to {self.relation.b!r}"
            return RouteResult(True, text, clear, bound, ">=", "m", "", (), evidence, route)
        names = list(self.surfaces.entities)
        near = np.linalg.norm(self.samples - place, axis=1)
        blame = tuple(names[k] for k in dict.fromkeys(self.owner[np.argsort(near, kind="stable")[:200]].tolist()))
        closed = clear < 2.0 * self.cell
        text = f"the way is {'closed' if closed else f'{clear:.4g} m wide'} at ({where}) by {', '.join(map(repr, blame))}, the fluid needs {width:g} m"
        return failed(BLOCKED if closed else TOO_NARROW, text, clear, bound, blame, evidence)


def _distinct(points: F64, origin: F64, apart: float) -> F64:
    """Points without those that share a cube of edge `apart` with another."""
    index = np.floor((points - origin) / apart).astype(np.int64)
    key = (index[:, 0] * 2_000_003 + index[:, 1]) * 2_000_003 + index[:, 2]
    return np.asarray(points[np.unique(key, return_index=True)[1]])


def _split(triangles: F64) -> F64:
    """Each triangle in two across its longest edge."""
    if len(triangles) == 0:
        return triangles
    edges = np.linalg.norm(np.roll(triangles, -1, axis=1) - triangles, axis=2)
    order = (edges.argmax(axis=1)[:, None] + np.arange(3)) % 3
    turned = np.take_along_axis(triangles, order[:, :, None], axis=1)
    middle = 0.5 * (turned[:, 0] + turned[:, 1])
    one = np.stack([turned[:, 0], middle, turned[:, 2]], axis=1)
    return np.concatenate([one, np.stack([middle, turned[:, 1], turned[:, 2]], axis=1)])


def _joined(keep: NDArray[np.bool_], stops: list[Ints]) -> bool:
    from scipy.ndimage import label

    pieces = np.asarray(label(keep)[0]).ravel()
    common: set[int] | None = None
    for stop in stops:
        here = set(np.unique(pieces[stop]).tolist()) - {0}
        common = here if common is None else common & here
    return bool(common)


def _widest(clear: F64, stops: list[Ints]) -> float:
    """Largest clearance at which all stops are joined, 0 where only a way through surfaces joins them [m]."""
    values = np.unique(clear)
    low, high = 0, len(values) - 1
    if high < 0 or not _joined(clear >= values[0], stops):
        return 0.0
    while low < high:
        middle = (low + high + 1) // 2
        low, high = (middle, high) if _joined(clear >= values[middle], stops) else (low, middle - 1)
    return float(values[low])


def _centred(tree: Any, points: F64, cell: float) -> tuple[F64, F64]:
    """Move points within their cubes to where they are farthest from all surfaces: pattern search with halved steps."""
    best, place = np.asarray(tree.query(points)[0]), points.copy()
    step = 0.25 * cell
    for _ in range(HALVINGS):
        for _ in range(2):
            for way in WAYS:
                trial = np.clip(place + step * way, points - 0.5 * cell, points + 0.5 * cell)
                found = np.asarray(tree.query(trial)[0])
                better = found > best
                place[better], best[better] = trial[better], found[better]
        step *= 0.5
    return place, best


def _path(keep: NDArray[np.bool_], points: F64, stops: list[Ints]) -> Ints:
    """Flat cubes of a shortest way over kept cubes through all stops."""
    from scipy.sparse import csr_array

    flat = np.arange(keep.size).reshape(keep.shape)
    source, target = [], []
    for axis in range(3):
        one, two = np.take(flat, range(keep.shape[axis] - 1), axis), np.take(flat, range(1, keep.shape[axis]), axis)
        both = keep.ravel()[one] & keep.ravel()[two]
        source.append(one[both])
        target.append(two[both])
    a, b = np.concatenate(source), np.concatenate(target)
    length = np.linalg.norm(points[a] - points[b], axis=1) + 1e-9
    graph: Any = csr_array((length, (a, b)), shape=(keep.size, keep.size))
    found = shortest_way(graph, [s[keep.ravel()[s]] for s in stops])
    assert found is not None  # as wide as the widest way through all stops
    return found
