"""Reason why a carrier has no way: the limit, or the entity, without which there is one."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from .bounds import RASTER_NOISE, SAME_HEIGHT, THRESHOLD
from .columns import Ints
from .places import BLOCKED, GAP, NO_FLOOR, STEP_TOO_HIGH, TOO_LOW, TOO_STEEP, RouteResult, failed
from .walkable import Carrier, Floor, standing
from .walks import Walks
from .widths import Way, reachable

__all__ = ["why"]

STEEPEST = 1.4
"""[rad] Slopes up to this are tried when looking for the reason of a failure."""
SEARCH = 8
"""Halvings when the measured value of a failure is searched."""
SUSPECTS = 8
"""Entities that are tried as the one that blocks the way."""


def why(walks: Walks, floor: Floor) -> RouteResult:
    """There is no way at all: find out which limit, or which entity, is the reason."""
    start, *_, goal = walks.stops(floor)
    for name, nodes in ((walks.relation.a, start), (walks.relation.b, goal)):
        if len(nodes) == 0:
            text = f"region {name!r} has no floor on which the carrier can stand"
            return failed(NO_FLOOR, text, 0.0, walks.relation.width, (), walks.searched)
    found = _too_low(walks) or _too_steep(walks) or _step_too_high(walks) or _blocked(walks, floor, start)
    return found or _gap(walks, floor, start)


def _limit(walks: Walks, good: float, bad: float, carrier_of: Callable[[float], Carrier]) -> tuple[float, Way, Floor]:
    """Bisect between a value that lets the carrier through and one that does not."""
    for _ in range(SEARCH):
        middle = 0.5 * (good + bad)
        good, bad = (middle, bad) if walks.exists(carrier_of(middle)) else (good, middle)
    way, floor, _ = walks.way(carrier_of(good))
    assert way is not None
    return good, way, floor


def _too_low(walks: Walks) -> RouteResult | None:
    def lower(height: float) -> Carrier:
        return replace(walks.carrier, headroom=height)

    least = walks.carrier.step + 0.2 * (walks.relation.headroom - walks.carrier.step)
    if least <= 0.0 or not walks.exists(lower(least)):
        return None
    _, way, floor = _limit(walks, least, walks.relation.headroom, lower)
    ceiling = floor.nodes.ceiling[way.nodes]
    k = int(np.argmin(ceiling))
    height = float(ceiling[k])
    blame = walks.owners(floor.nodes.blocker[way.nodes[k : k + 1]])
    under = ", ".join(map(repr, blame))
    text = f"the clear height is {height:.3f} m under {under}, the carrier needs {walks.relation.headroom:g} m"
    return failed(TOO_LOW, text, height, walks.relation.headroom, blame, walks.searched)


def _too_steep(walks: Walks) -> RouteResult | None:
    def steeper(angle: float) -> Carrier:
        return replace(walks.carrier, tangent=math.tan(angle))

    if walks.relation.max_slope >= STEEPEST or not walks.exists(steeper(STEEPEST)):
        return None
    _, way, floor = _limit(walks, STEEPEST, walks.relation.max_slope, steeper)
    slope = floor.nodes.tangent[way.nodes]
    k = int(np.argmax(slope))
    angle = math.atan(float(slope[k]))
    blame = walks.owners(floor.nodes.owner[way.nodes[k : k + 1]])
    text = f"{', '.join(map(repr, blame))} slopes {angle:.3f} rad, the carrier takes {walks.relation.max_slope:g} rad"
    return failed(TOO_STEEP, text, angle, walks.relation.max_slope, blame, walks.searched)


def _step_too_high(walks: Walks) -> RouteResult | None:
    def higher(step: float) -> Carrier:
        return replace(walks.carrier, step=step)

    most = THRESHOLD * walks.relation.max_step
    if most >= walks.relation.headroom or not walks.exists(higher(most)):
        return None
    _, way, floor = _limit(walks, most, walks.relation.max_step, higher)
    height, owner = _highest_step(walks, floor, way)
    blame = walks.owners(np.array([owner]))
    text = f"a step of {height:.3f} m leads onto {', '.join(map(repr, blame))}, the carrier takes {walks.relation.max_step:g} m"
    return failed(STEP_TOO_HIGH, text, height, walks.relation.max_step, blame, walks.searched)


def _highest_step(walks: Walks, floor: Floor, way: Way) -> tuple[float, int]:
    """Highest rise between nodes of a way, or thing that is stepped over on it [m], and the entity stepped onto."""
    z, owner = floor.nodes.z[way.nodes], floor.nodes.owner[way.nodes]
    best, onto = 0.0, -1
    if len(z) > 1:
        rise = np.diff(z)
        k = int(np.argmax(np.abs(rise)))
        best, onto = float(abs(rise[k])), int(owner[k + 1] if rise[k] > 0 else owner[k])
    group, piece, _ = standing(
        walks.columns, walks.carrier, floor.nodes.cell[way.nodes], z, floor.nodes.gradient[way.nodes], ignore=-1
    )
    over = walks.columns.pieces.high[piece] - z[group]
    over = np.where(over <= floor.carrier.step + SAME_HEIGHT, over, 0.0)
    if len(over) and over.max() > best:
        k = int(np.argmax(over))
        best, onto = float(over[k]), int(walks.columns.soup.owner[walks.columns.pieces.triangle[piece[k]]])
    return best, onto


def _blocked(walks: Walks, floor: Floor, start: Ints) -> RouteResult | None:
    """The entity without which there is a way; those that border on the reachable floor are tried."""
    reached = reachable(floor, start)
    beside = floor.links[reached]
    beside = np.unique(beside[beside >= 0])
    blockers = floor.nodes.blocker[beside[floor.nodes.blocked[beside]]]
    blockers, count = np.unique(blockers[blockers >= 0], return_counts=True)
    size = np.array([walks.size(walks.names[k]) for k in blockers])
    for k in blockers[np.lexsort((-count, size))][:SUSPECTS]:
        if walks.exists(walks.carrier, int(k)):
            text = f"{walks.names[k]!r} blocks the way from {walks.relation.a!r} to {walks.relation.b!r}"
            return failed(BLOCKED, text, 0.0, walks.relation.width - RASTER_NOISE, (walks.names[k],), walks.searched)
    return None


def _gap(walks: Walks, floor: Floor, start: Ints) -> RouteResult:
    from scipy.spatial import cKDTree

    goal = walks.stops(floor)[-1]
    near, far = reachable(floor, start), reachable(floor, goal)
    distance, index = cKDTree(floor.points[near]).query(floor.points[far])
    k = int(np.argmin(distance))
    one, two = floor.points[near][index[k]], floor.points[far][k]
    width = float(distance[k])
    places = " and ".join("(" + ", ".join(f"{c:.2f}" for c in p) + ")" for p in (one, two))
    blame = walks.owners(floor.nodes.owner[np.flatnonzero(far)[k : k + 1]])
    text = f"the floor is interrupted by {width:.3f} m between {places}"
    found = failed(GAP, text, width, walks.columns.grid.cell, blame, walks.searched)
    return found._replace(evidence={**found.evidence, "from": one.tolist(), "to": two.tolist()})
