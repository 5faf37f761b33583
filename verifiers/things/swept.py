"""Poses of what opens over its range against everything that stands there: how far it gets, and what it hits first."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...geometry import apart, turned_boxes
from ...geometry.clearance import Care, measure, relative_poses
from ...worlds.arrays import F64, RigidPose
from .bounds import COARSE, EXACT, FINE, GRAZE

if TYPE_CHECKING:
    from ..scene.surfaces import Surfaces
    from .openings import Opening

__all__ = ["Hit", "Reach", "reach_of", "way_boxes"]

ARCS = 24
"""Poses over a range whose boxes hold what moves, with the height of the arc between two added."""
AT_ONCE = 8
"""Positions measured together of convex surfaces."""
TOUCH = 1e-7
"""[m] Surfaces that are nearer meet."""
CARE = Care(tolerance=0.25 * GRAZE, enough=2.0 * GRAZE)
"""[m] Of depths: found to a quarter of what is allowed, and no deeper than needed."""


class Hit(NamedTuple):
    """Something that stops a joint."""

    position: float
    """Last free position of the joint [rad] or [m], from where the world stands."""
    mover: int
    """Part that hits, by its place in `surfaces.parts`."""
    obstacle: int
    """Part that is hit."""


class Reach(NamedTuple):
    """Free way of a joint in both directions; a hit of None is the end of the range."""

    low: float
    high: float
    below: Hit | None
    above: Hit | None
    near: tuple[str, ...]
    """Entities that come into the box of the way."""


def reach_of(surfaces: Surfaces, opening: Opening) -> Reach:
    """Free way of a joint from where the world stands at frame 0."""
    pairs = _pairs(surfaces, opening)
    ends: list[Hit | None] = []
    for end in (opening.low, opening.high):
        first: Hit | None = None
        for i, j in pairs if end else ():
            limit = end if first is None else first.position
            at = _free_until(_Pair(surfaces, opening, i, j), limit) if limit else None
            if at is not None:
                first = Hit(at, i, j)
        ends.append(first)
    below, above = ends
    return Reach(
        opening.low if below is None else below.position,
        opening.high if above is None else above.position,
        below,
        above,
        tuple(dict.fromkeys(surfaces.parts[j].entity for _, j in pairs)),
    )


def _rows(surfaces: Surfaces, opening: Opening) -> list[int]:
    return [i for name in sorted(opening.moving) for i in surfaces.parts_of.get(name, ())]


def _start(surfaces: Surfaces, part: int) -> RigidPose:
    return surfaces.track_of(part).at(0)


def _pairs(surfaces: Surfaces, opening: Opening) -> list[tuple[int, int]]:
    """Parts that move and parts that come into the box of their way, nearest boxes of the world first."""
    zero = np.zeros(1, dtype=np.intp)
    low, high = (b[:, 0] for b in surfaces.boxes(zero))
    aside = opening.moving | opening.aside
    open_parts = np.array([p.entity not in aside and i not in surfaces.shapes.soft for i, p in enumerate(surfaces.parts)])
    found = []
    for i in _rows(surfaces, opening):
        box = _way_box(surfaces, opening, i)
        near = np.flatnonzero(open_parts & (low <= box[1]).all(axis=1) & (high >= box[0]).all(axis=1))
        found += [(i, int(j)) for j in near if not _mount(surfaces, opening, i, int(j))]
    return found


def _way_box(surfaces: Surfaces, opening: Opening, part: int) -> tuple[F64, F64]:
    """World box of a part over the whole range [m], shapes (3,)."""
    solid, start = surfaces.parts[part].solid, _start(surfaces, part)
    count = 2 if opening.slides else ARCS
    places, turns = opening.poses(start, np.linspace(opening.low, opening.high, count))
    half = 0.5 * (solid.upper - solid.lower)
    low, high = turned_boxes(solid.sphere_center[None], half[None], np.array([solid.sphere_radius]), places[None], turns[None])
    bulge = 0.0 if opening.slides else _radius(surfaces, opening, part) * (1.0 - np.cos(0.5 * opening.span / (count - 1)))
    return low[0].min(axis=0) - bulge, high[0].max(axis=0) + bulge


def _radius(surfaces: Surfaces, opening: Opening, part: int) -> float:
    return opening.radius(_start(surfaces, part).apply(surfaces.parts[part].solid.vertices))


def _mount(surfaces: Surfaces, opening: Opening, mover: int, obstacle: int) -> bool:
    """True for a part of what holds the child that is at it where the world stands: a hinge post, a rail."""
    a, b = surfaces.parts[mover].entity, surfaces.parts[obstacle].entity
    if b not in opening.hung:
        return False
    return bool(
        _clearance(surfaces, opening, mover, obstacle, np.zeros(1), 2.0 * surfaces.reach)[0] <= surfaces.contact_gap(a, b)
    )


def _clearance(surfaces: Surfaces, opening: Opening, mover: int, obstacle: int, positions: F64, skip: float) -> F64:
    """Signed clearance of two parts with the joint at some positions [m], shape (n,); a lower bound above `skip`."""
    count = len(positions)
    other = _start(surfaces, obstacle)
    fixed = np.tile(other.position, (count, 1)), np.tile(other.quaternion, (count, 1))
    poses = relative_poses(opening.poses(_start(surfaces, mover), positions), fixed)
    one, two = surfaces.parts[mover].solid, surfaces.parts[obstacle].solid
    return measure(one, two, poses, skip_above=skip, care=CARE)


def _allowed(surfaces: Surfaces, mover: int, obstacle: int) -> float:
    a, b = surfaces.parts[mover].entity, surfaces.parts[obstacle].entity
    return GRAZE + surfaces.noise(a, b) + surfaces.allowed_depth(a, b)


class _Pair(NamedTuple):
    """A part that moves and one in its way."""

    surfaces: Surfaces
    opening: Opening
    mover: int
    obstacle: int

    @property
    def convex(self) -> bool:
        """True if both are: then depths cost little, and are measured at once."""
        parts = self.surfaces.parts
        return parts[self.mover].solid.convex and parts[self.obstacle].solid.convex

    def gaps(self, positions: F64, skip: float) -> F64:
        """Clearances at positions [m]; of surfaces that are not convex 0 where they meet."""
        found = np.zeros(len(positions))
        some = np.arange(len(positions)) if self.convex else np.flatnonzero([not self.meets(float(q)) for q in positions])
        found[some] = _clearance(self.surfaces, self.opening, self.mover, self.obstacle, positions[some], skip)
        return found

    def meets(self, position: float) -> bool:
        """True if the surfaces touch or cross, or one holds the other."""
        parts, start = self.surfaces.parts, _start(self.surfaces, self.mover)
        place, turn = self.opening.poses(start, np.array([position]))
        two = parts[self.obstacle].solid
        return not apart(
            parts[self.mover].solid, RigidPose(place[0], turn[0]), two, _start(self.surfaces, self.obstacle), gap=TOUCH
        )

    def first_hit(self, positions: F64, *, apart_first: bool) -> int | None:
        """The first of positions, in their order, at which they overlap by more than is allowed.

        Depths of surfaces that are not convex take long: those that are apart where the world stands hit where they first meet.
        """
        if not self.convex and apart_first:
            return next((k for k, q in enumerate(positions) if self.meets(float(q))), None)
        allowed, step = _allowed(self.surfaces, self.mover, self.obstacle), AT_ONCE if self.convex else 1
        for start in range(0, len(positions), step):
            some = positions[start : start + step]
            deep = np.flatnonzero(_clearance(self.surfaces, self.opening, self.mover, self.obstacle, some, FINE) < -allowed)
            if len(deep):
                return start + int(deep[0])
        return None


def _free_until(pair: _Pair, end: float) -> float | None:
    """Last free position on the way to `end` before one part hits the other; None where it does not."""
    speed = _radius(pair.surfaces, pair.opening, pair.mover)
    travel = abs(end) * speed
    coarse = np.linspace(0.0, end, max(2, int(np.ceil(travel / COARSE)) + 1))
    gaps = pair.gaps(coarse, COARSE)
    free = bool(gaps[0] > 0.0)
    if not free and pair.first_hit(np.zeros(1), apart_first=False) is not None:
        return 0.0
    stride = travel / (len(coarse) - 1)
    # Where both ends of a stretch are farther away together than it is long, nothing between is hit.
    for k in np.flatnonzero(gaps[:-1] + gaps[1:] <= stride):
        fine = np.linspace(coarse[k], coarse[k + 1], max(2, int(np.ceil(stride / FINE)) + 1))
        at = pair.first_hit(fine[1:], apart_first=free)
        if at is not None:
            return _bisected(pair, (float(fine[at]), float(fine[at + 1])), speed, apart_first=free)
    return None


def _bisected(pair: _Pair, between: tuple[float, float], speed: float, *, apart_first: bool) -> float:
    """Last free position between a free one and one where they overlap."""
    free, hit = between
    while abs(hit - free) * speed > EXACT:
        middle = 0.5 * (free + hit)
        stops = pair.first_hit(np.array([middle]), apart_first=apart_first) is not None
        free, hit = (free, middle) if stops else (middle, hit)
    return free


def way_boxes(surfaces: Surfaces, opening: Opening, between: tuple[float, float]) -> tuple[F64, F64]:
    """World boxes that hold each moving part on stretches of its way between two positions [m], shapes (n, 3)."""
    lows, highs = [], []
    for i in _rows(surfaces, opening):
        solid, start = surfaces.parts[i].solid, _start(surfaces, i)
        travel = (between[1] - between[0]) * _radius(surfaces, opening, i)
        positions = np.linspace(*between, max(2, int(np.ceil(travel / COARSE)) + 1))
        places, turns = opening.poses(start, positions)
        half = 0.5 * (solid.upper - solid.lower)
        low, high = turned_boxes(
            solid.sphere_center[None], half[None], np.array([solid.sphere_radius]), places[None], turns[None]
        )
        lows.append(np.minimum(low[0, :-1], low[0, 1:]))
        highs.append(np.maximum(high[0, :-1], high[0, 1:]))
    return np.concatenate(lows), np.concatenate(highs)
