"""Geometry of words of place between bodies at one frame; heights are taken along gravity.

- *on*: it touches the place, its centre is above the lowest point of that, and the place bears it from below, or nothing else does.
- *in*: its centre lies in the convex hull of the place.
- *under*, *above*: one of them is under the other as seen along gravity (`outlines.py`).
- *beside*: they overlap in height, stand no farther apart than the larger is long, and neither is in, or under the other.
- *between*: its centre projects between those of two places, nearer to their line than half their distance.
- *edge*: it is within its own size of a side of the place's box, as seen from above.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ...scene.bounds import SUPPORT_SLOPE
from ...scene.surfaces import surfaces_of
from .bounds import NEAR, TOUCHING
from .outlines import Seen, frame_along, in_hull, is_under

if TYPE_CHECKING:
    from ....worlds.arrays import F64
    from ....worlds.candidate import Candidate

__all__ = ["TESTS", "Place"]


class Place:
    """Bodies at a frame, turned so that the third axis points against gravity."""

    def __init__(self, candidate: Candidate, grounds: list[str], frame: int) -> None:
        self.candidate, self.frame = candidate, frame
        self.grounds = [g for g in grounds if g in candidate.solids]
        self.turn = frame_along(np.array(candidate.spec.simulation.gravity, dtype=np.float64))
        self.slack = TOUCHING * candidate.spec.simulation.limits.contact_gap
        self._seen: dict[str, Seen] = {}

    def seen(self, body: str) -> Seen:
        """Its triangles and centre."""
        if body not in self._seen:
            parts = self.candidate.entity(body).parts
            corners = [self.candidate.surface(body, p.part, self.frame)[p.render.faces] for p in parts]
            self._seen[body] = Seen(np.concatenate(corners) @ self.turn.T, self.turn @ self.candidate.center(body, self.frame))
        return self._seen[body]

    def box(self, body: str) -> F64:
        """Least and greatest corner [m], shape (2, 3)."""
        points = self.seen(body).triangles.reshape(-1, 3)
        return np.stack([points.min(axis=0), points.max(axis=0)])

    def center(self, body: str) -> F64:
        """Centre of mass [m]."""
        return self.seen(body).center

    def touches(self, a: str, b: str) -> bool:
        """True where their surfaces are as near as those that touch."""
        return _apart(self.box(a), self.box(b)) <= self.slack and self.gap(a, b) <= self.slack

    def gap(self, a: str, b: str, lifted: float = 0.0) -> float:
        """Distance of their surfaces [m], with the first lifted against gravity."""
        offset = self.turn[2] * lifted if lifted else None
        return surfaces_of(self.candidate).gap(a, b, self.frame, offset=offset).distance

    def bears(self, below: str, above: str) -> bool:
        """True where a body that touches another stands in the way of its falling: lifted, that parts from it.

        The least rise of their distance per lift is that of checks of support (`SUPPORT_SLOPE`).
        """
        return self.gap(above, below, self.slack) - self.gap(above, below) >= SUPPORT_SLOPE * self.slack

    def under(self, lower: str, upper: str) -> bool:
        """True where one body lies under another as seen along gravity."""
        return is_under(self.seen(lower), self.seen(upper), self.slack)


def _on(place: Place, thing: str) -> bool:
    for ground in place.grounds:
        if place.center(thing)[2] > place.box(ground)[0, 2] and place.touches(thing, ground):
            others = (n for n in surfaces_of(place.candidate).parts_of if n not in (thing, *place.grounds))
            if place.bears(ground, thing) or not any(place.touches(thing, n) and place.bears(n, thing) for n in others):
                return True
    return False


def _in(place: Place, thing: str) -> bool:
    return any(in_hull(place.seen(g).triangles.reshape(-1, 3), place.center(thing)) for g in place.grounds)


def _vertical(place: Place, thing: str, *, above: bool) -> bool:
    return any(place.under(g, thing) if above else place.under(thing, g) for g in place.grounds)


def _beside(place: Place, thing: str) -> bool:
    own = place.box(thing)
    for ground in place.grounds:
        box = place.box(ground)
        level = own[0, 2] <= box[1, 2] and box[0, 2] <= own[1, 2]
        reach = NEAR * max(float(np.ptp(own, axis=0).max()), float(np.ptp(box, axis=0).max()))
        if (
            level
            and _apart(own, box) <= reach
            and not (_in(place, thing) or place.under(thing, ground) or place.under(ground, thing))
        ):
            return True
    return False


def _between(place: Place, thing: str) -> bool:
    center = place.center(thing)
    for a, b in itertools.combinations(place.grounds, 2):
        start, way = place.center(a), place.center(b) - place.center(a)
        length = float(np.linalg.norm(way))
        share = float((center - start) @ way) / max(length**2, 1e-12)
        if 0.0 < share < 1.0 and np.linalg.norm(center - start - share * way) <= 0.5 * length:
            return True
    return False


def _edge(place: Place, thing: str) -> bool:
    own, center = place.box(thing), place.center(thing)
    reach = float(np.ptp(own, axis=0)[:2].max())
    for box in map(place.box, place.grounds):
        near = np.minimum(np.abs(center[:2] - box[0, :2]), np.abs(box[1, :2] - center[:2])).min() <= reach
        if near and _apart(own, box) <= reach:
            return True
    return False


def _apart(a: F64, b: F64) -> float:
    """Distance of two boxes [m]; 0 where they meet."""
    return float(np.linalg.norm(np.maximum(np.maximum(a[0] - b[1], b[0] - a[1]), 0.0)))


TESTS: dict[str, Callable[[Place, str], bool]] = {
    "on": _on,
    "in": _in,
    "under": partial(_vertical, above=False),
    "above": partial(_vertical, above=True),
    "beside": _beside,
    "between": _between,
    "edge": _edge,
}
"""Rules of words about a thing at a frame."""
