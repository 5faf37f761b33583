"""Geometry of words of place between bodies at one frame; heights are taken along gravity.

- *on*: it touches the place, its centre is above the lowest point of that, and the place bears it from below, or nothing else does.
- *in*: its centre lies in the convex hull of the place.
- *under*, *above*: one of them is under the other as seen along gravity (`outlines.py`).
- *beside*: they overlap in height, stand no farther apart than the geometric mean of their lengths, and neither is in, or under the other.
- *between*: its centre projects between those of two places, nearer to their line than half their distance.
- *edge*: it is within its own size of a side of the place's box, as seen from above.
- *against*, *behind*, *in front of*: see `facing.py`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from functools import partial

import numpy as np

from ....worlds.arrays import F64
from ...scene.surfaces import surfaces_of
from .bounds import NEAR
from .facing import against, behind, in_front
from .outlines import in_hull
from .placed import Place, apart

__all__ = ["TESTS", "near", "touching"]


def _on(place: Place, thing: str) -> bool:
    for ground in place.grounds:
        if place.center(thing)[2] > place.box(ground)[0, 2] and place.touches(thing, ground):
            others = (n for n in surfaces_of(place.candidate).parts_of if n not in (thing, *place.grounds))
            if place.bears(ground, thing) or not any(place.touches(thing, n) and place.bears(n, thing) for n in others):
                return True
    return False


def touching(place: Place, thing: str) -> bool:
    """True where the thing touches the place, from whatever side."""
    return any(place.touches(thing, g) for g in place.grounds)


def _in(place: Place, thing: str) -> bool:
    return any(in_hull(place.seen(g).triangles.reshape(-1, 3), place.center(thing)) for g in place.grounds)


def _vertical(place: Place, thing: str, *, above: bool) -> bool:
    return any(place.under(g, thing) if above else place.under(thing, g) for g in place.grounds)


def _beside(place: Place, thing: str) -> bool:
    own = place.box(thing)
    for ground in place.grounds:
        box = place.box(ground)
        level = own[0, 2] <= box[1, 2] and box[0, 2] <= own[1, 2]
        if level and near(own, box) and not (_in(place, thing) or place.under(thing, ground) or place.under(ground, thing)):
            return True
    return False


def near(a: F64, b: F64) -> bool:
    """True where two boxes, lower and upper corners (2, 3) [m], stand no farther apart than the geometric mean of their lengths."""
    return apart(a, b) <= NEAR * math.sqrt(float(np.ptp(a, axis=0).max()) * float(np.ptp(b, axis=0).max()))


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
        if near and apart(own, box) <= reach:
            return True
    return False


TESTS: dict[str, Callable[[Place, str], bool]] = {
    "on": _on,
    "in": _in,
    "under": partial(_vertical, above=False),
    "above": partial(_vertical, above=True),
    "beside": _beside,
    "between": _between,
    "edge": _edge,
    "against": against,
    "behind": behind,
    "front": in_front,
}
"""Rules of words about a thing at a frame."""
