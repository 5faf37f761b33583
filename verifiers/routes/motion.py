"""When a known route has to be searched again, because something moves: into it, from under it, or its regions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64, rotation_matrix
from .bounds import FITS, STILL

if TYPE_CHECKING:
    from ...worlds.spec import Connects
    from ..scene.surfaces import Surfaces
    from .places import RouteResult

__all__ = ["disturbances", "travellers"]


def travellers(surfaces: Surfaces, relation: Connects) -> tuple[str, ...]:
    """Entities that may be what is carried: dynamic, and no larger than the declared object.

    A ball that rolls along its own chute is in the way of no other; at the ends of the interval it counts.
    """
    if relation.carrier != "object":
        return ()
    found = []
    for name in surfaces.entities:
        if surfaces.candidate.spec.entities[name].motion != "dynamic":
            continue
        size = np.sort(np.array(surfaces.candidate.spec.entities[name].dimensions.size))
        if size[1] <= FITS * relation.width and size[2] <= FITS * max(relation.width, relation.headroom):
            found.append(name)
    return tuple(found)


def disturbances(surfaces: Surfaces, relation: Connects, known: RouteResult, since: int, last: int) -> int | None:
    """First frame after `since` at which the route of `known` is in doubt; None where it holds up to `last`.

    Boxes decide, so that a frame may be searched needlessly, never missed: a part that moved since and whose box
    comes within half the width of the route, or a part, floor of the route or carrier of a region, that moved at all.
    """
    if known.route is None or last <= since:
        return None
    frames = np.arange(since, last + 1)
    doubt = np.zeros(len(frames), dtype=bool)
    regions = (surfaces.candidate.spec.graph.regions[n].relative_to for n in (relation.a, relation.b))
    bearing = {*known.floors, *(r for r in regions if r is not None)}
    passing = set(travellers(surfaces, relation))
    low, high = known.route.min(axis=0), known.route.max(axis=0)
    reach = np.array([0.5 * relation.width, 0.5 * relation.width, 0.0])
    low, high = low - reach, high + reach + np.array([0.0, 0.0, relation.headroom])
    if relation.carrier == "fluid":  # the route is the middle of the opening, not the foot of what travels
        low[2] -= 0.5 * relation.width
    for part in surfaces.parts:
        if surfaces.is_static(part.entity):
            continue
        corners = _corners(surfaces, part.entity, part.body, part.solid.lower, part.solid.upper, frames)
        moved = np.abs(corners - corners[:1]).max(axis=(1, 2)) > STILL
        if part.entity in bearing:
            doubt |= moved
            continue
        least, most = corners.min(axis=1), corners.max(axis=1)
        near = np.flatnonzero(moved & (most >= low).all(axis=1) & (least <= high).all(axis=1))
        if part.entity in passing:
            near = near[near == len(frames) - 1]
        doubt[near] |= _meets(known.route, relation, least[near], most[near])
    return int(frames[np.argmax(doubt)]) if doubt.any() else None


def _corners(surfaces: Surfaces, entity: str, body: str, low: F64, high: F64, frames: NDArray[np.intp]) -> F64:
    """World corners of a part's box over frames [m], shape (frames, 8, 3)."""
    track = surfaces.track(entity, body).take(frames)
    local = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])
    return np.asarray(np.einsum("fij,cj->fci", rotation_matrix(track.quaternion), local) + track.position[:, None])


def _meets(route: F64, relation: Connects, low: F64, high: F64) -> NDArray[np.bool_]:
    """True where each box, shapes (n, 3), comes within half the width of a route and the height of what travels on it."""
    reach = 0.5 * relation.width
    apart = np.maximum(np.maximum(low[:, None, :2] - route[:, :2], route[:, :2] - high[:, None, :2]), 0.0)
    beside = np.linalg.norm(apart, axis=2) < reach
    below = reach if relation.carrier == "fluid" else 0.0
    level = (high[:, None, 2] > route[:, 2] - below) & (low[:, None, 2] < route[:, 2] + relation.headroom)
    return np.asarray((beside & level).any(axis=1))
