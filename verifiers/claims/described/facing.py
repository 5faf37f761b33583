"""*Against*, *behind* and *in front of* between bodies at one frame; directions are level, across gravity.

*Against*: it touches the place from the side, so that they part where it is moved away levelly.

*Behind* and *in front of* have two readings, by who looks and by a front that the place has (Levelt, W. J. M. (1996), Perspective taking and
ellipsis in spatial descriptions, in Language and Space, MIT Press); either counts. Seen by a shot's camera, a thing is behind the place where
the level line from the eye to it crosses the place's outline, and in front where that line, drawn on beyond the thing, does. Of an
asset of the library, whose front is its side at -y, it is behind where a line from it to the front crosses the place, and in front where one to the back does.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from ...scene.bounds import SUPPORT_SLOPE
from ...shots.sight import sight_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ....worlds.arrays import F64
    from .placed import Place

__all__ = ["against", "behind", "in_front"]

FRONT = (0.0, -1.0, 0.0)
"""Front of an asset, in its own frame: `construction/assets/made.py`."""
FAR = 1e6
"""[m] Length of a line that is drawn on without end."""


def against(place: Place, thing: str) -> bool:
    """True where the thing touches the place from the side."""
    for ground in place.grounds:
        if place.touches(thing, ground):
            center, box = place.center(thing)[:2], place.box(ground)[:, :2]
            away = center - np.clip(center, box[0], box[1])
            length = float(np.linalg.norm(away))
            if length > 0.0:
                moved = place.gap(thing, ground, place.turn[:2].T @ (away / length * place.slack))
                if moved - place.gap(thing, ground) >= SUPPORT_SLOPE * place.slack:
                    return True
    return False


def behind(place: Place, thing: str) -> bool:
    """True where the thing is behind the place for a camera, or by the place's own front."""
    return any(_crosses(outline, at, eye) for outline, at, eye in _looks(place, thing)) or any(
        _crosses(outline, at, at + FAR * front) for outline, at, front in _fronts(place, thing)
    )


def in_front(place: Place, thing: str) -> bool:
    """True where the thing is in front of the place for a camera, or by the place's own front."""
    return any(_crosses(outline, at, at + FAR * (at - eye)) for outline, at, eye in _looks(place, thing)) or any(
        _crosses(outline, at, at - FAR * front) for outline, at, front in _fronts(place, thing)
    )


def _looks(place: Place, thing: str) -> Iterator[tuple[F64, F64, F64]]:
    """(outline of a place, level point of the thing, level eye) for the cameras whose shot runs at the frame, all of them where none does."""
    spec, sight = place.candidate.spec, sight_of(place.candidate)
    running = [n for n, s in spec.shots.items() if s.frames[0] <= place.frame <= s.frames[1]]
    for outline, _ in _outlines(place, thing):
        for name in running or spec.shots:
            first, last = spec.shots[name].frames
            eye = place.turn @ np.asarray(sight.camera(name, int(np.clip(place.frame, first, last))).position)
            yield outline, place.center(thing)[:2], eye[:2]


def _fronts(place: Place, thing: str) -> Iterator[tuple[F64, F64, F64]]:
    """(outline, level point of the thing, level way of the front) of those places that are assets."""
    for outline, ground in _outlines(place, thing):
        entity = place.candidate.spec.entities[ground]
        bodies = place.candidate.entity(ground).bodies
        if entity.asset is not None and len(bodies) == 1:
            start, end = place.candidate.pose(ground, place.frame, bodies[0].name).apply(np.array([(0.0, 0.0, 0.0), FRONT]))
            way = (place.turn @ (end - start))[:2]
            length = float(np.linalg.norm(way))
            if length > 0.5:
                yield outline, place.center(thing)[:2], way / length


def _outlines(place: Place, thing: str) -> Iterator[tuple[F64, str]]:
    """Convex outlines of the places as seen along gravity, shape (n, 2), counterclockwise; none of one that the thing stands in or over."""
    for ground in place.grounds:
        points = place.seen(ground).triangles.reshape(-1, 3)[:, :2]
        try:
            hull = points[ConvexHull(points).vertices]
        except QhullError:
            continue  # seen along gravity it is a line
        if not _holds(hull, place.center(thing)[:2]):
            yield hull, ground


def _holds(outline: F64, point: F64) -> bool:
    side = np.roll(outline, -1, axis=0) - outline
    to = point - outline
    return bool((side[:, 0] * to[:, 1] - side[:, 1] * to[:, 0] >= 0.0).all())


def _crosses(outline: F64, start: F64, end: F64) -> bool:
    """True where a level line segment meets a convex outline (Cyrus and Beck 1978)."""
    way, side = end - start, np.roll(outline, -1, axis=0) - outline
    inward = np.stack([-side[:, 1], side[:, 0]], axis=1)
    speed, ahead = inward @ way, ((start - outline) * inward).sum(axis=1)
    if (ahead[speed == 0.0] < 0.0).any():
        return False
    enters = (-ahead[speed > 0.0] / speed[speed > 0.0]).max(initial=0.0)
    leaves = (-ahead[speed < 0.0] / speed[speed < 0.0]).min(initial=1.0)
    return bool(enters <= leaves)
