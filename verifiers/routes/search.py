"""The route of one connection at one frame: the widest way, or the reason why there is none.

The visible surfaces of all entities are rasterised into columns; the route is searched over layers of floor with the
carrier's width, height, slope and step.
"""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from ...worlds.errors import EvidenceError
from .bounds import PITCH, RASTER_NOISE, SAME_HEIGHT, STRETCH
from .clearances import Obstacles
from .land_routes import follow
from .places import TOO_NARROW, TOO_STEEP, RouteResult, failed
from .reasons import why
from .walkable import Carrier, Floor
from .walks import Walks
from .widths import Way

if TYPE_CHECKING:
    from ...worlds.spec import Connects
    from ..scene.surfaces import Surfaces

__all__ = ["find_route"]

MARGINS = (3.0, 20.0)
"""[m] Own choice: the search first looks this far around the box of regions and waypoints, then farther (at least the
box's diagonal)."""
MOST_CELLS = 600_000
"""Own choice: cells of one search, about 1 GB; larger areas get coarser cells down to a quarter of the width."""
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
        near = Walks(surfaces, relation, frame, MARGINS[0], absent, most, wide=False)
        if over_land is not None and near.bare and over_land.evidence["cell_m"] >= relation.width:
            return over_land
        if near.clipped and not near.wide_enough:
            if over_land is not None and near.bare:
                return over_land
            wide = Walks(surfaces, relation, frame, MARGINS[1], absent, most, wide=True)
            return _judge(wide) if over_land is None or wide.wide_enough else over_land
        return _judge(near)
    except EvidenceError:
        if over_land is None:
            raise
        return over_land


def _judge(walks: Walks) -> RouteResult:
    """Verdict at this frame."""
    way, floor, obstacles = walks.direct
    if way is None:
        return why(walks, floor)
    clear, width = 2.0 * way.clearance, walks.relation.width
    evidence = {
        "clear_width_m": clear,
        "narrowest_place": way.place.tolist(),
        "route": _decimate(way.route, walks.columns.grid.cell).tolist(),
        "route_length_m": float(np.linalg.norm(np.diff(way.route, axis=0), axis=1).sum()),
        **_profile(floor, way),
        **walks.searched,
    }
    bound = width - RASTER_NOISE
    capped = clear >= 2.0 * width * (1 - 1e-9)
    if clear < bound:
        beside = _narrow(walks, way, floor, obstacles)
        blame = beside or walks.owners(floor.nodes.owner[np.array([way.node])])
        place = ", ".join(f"{c:.2f}" for c in way.place)
        between = " and ".join(map(repr, beside)) or " and ".join(["the edges of the floor", *map(repr, blame)])
        text = f"the way is {clear:.3f} m wide at ({place}), the carrier needs {width:g} m; narrowed by {between}"
        return failed(TOO_NARROW, text, clear, bound, blame, evidence)
    pitch, where = _pitch(
        way.route, min(STRETCH, max(0.75 * width, 6 * walks.columns.grid.cell)), walks.carrier, walks.columns.grid.cell
    )
    if pitch > max(PITCH, walks.carrier.tangent):
        owner = walks.owners(floor.nodes.owner[way.nodes[where : where + 1]])
        text = f"the stairs rise by {math.atan(pitch):.3f} rad on average, at most {math.atan(PITCH):.3f} rad can be walked"
        return failed(TOO_STEEP, text, math.atan(pitch), math.atan(PITCH), owner, evidence)
    text = f"a route of {evidence['route_length_m']:.2f} m leads from {walks.relation.a!r} to {walks.relation.b!r}, "
    text += f"{'at least ' if capped else ''}{clear:.3f} m wide at its narrowest"
    floors = walks.owners(np.unique(floor.nodes.owner[way.nodes]))
    return RouteResult(True, text, clear, bound, ">=", "m", "", (), evidence, way.route, floors)


def _profile(floor: Floor, way: Way) -> dict[str, Any]:
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


def _narrow(walks: Walks, way: Way, floor: Floor, obstacles: Obstacles) -> tuple[str, ...]:
    """Entities whose surfaces stand nearest to the narrowest place on its sides, the easiest to move first."""
    cell = floor.columns.grid.cell
    near = np.linalg.norm(floor.points[:, :2] - way.place[:2], axis=1) <= way.clearance + 2.0 * cell
    near &= np.abs(floor.points[:, 2] - way.place[2]) <= walks.carrier.step + way.clearance + cell
    labels = np.unique(obstacles.label[near & ~floor.nodes.blocked])
    labels = labels[labels >= 0]
    if len(labels) == 0:
        return ()
    apart = np.linalg.norm(obstacles.point - way.place[:2], axis=1)
    least = np.array([apart[obstacles.start[k] : obstacles.start[k + 1]].min() for k in labels])
    order = np.argsort(least, kind="stable")
    beside = walks.owners(obstacles.owner[labels[order[least[order] <= way.clearance + cell]]])
    # What moves, then what is small, is moved aside more easily than a wall.
    return tuple(sorted(beside, key=lambda n: (walks.is_static(n), walks.size(n))))


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
