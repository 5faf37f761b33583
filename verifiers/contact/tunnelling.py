"""Bodies that pass through each other between two written frames, where no inspected frame shows it (R108).

Criterion. Between two frames each body moves on the cubic through its recorded velocities and turns at a constant rate
(`geometry/motions.py`), which is exact where only gravity acts. A passage is an overlap on the way deeper than
`TUNNEL_SHARE` of the thinner of the two walls, unless

- the engine felt it: the pair is in the contact log of that frame, its collision shapes never overlapped that deep at
  a step, and a step is too short to hide such a depth; or
- the path is bent: contacts, joints or drivers changed the velocities by more than gravity does, and one of the other
  paths that the end states allow is free: straight; free flight up to the first logged contact and after the last; or
  the cubic displaced in its middle by no more than the change of velocity can explain.

A body that begins on one side of a wall and ends on the other has no free path. Depth is Lipschitz in the travel, so
that intervals with less relative travel than twice the wanted depth hide nothing and are not tested. Nor are those in
which two bodies of one entity moved as one, as pieces do whose bond holds: at both ends they stand to each other alike
to rounding, and they turned alike, so that the path on which they keep their places is free.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry import (
    Lowest,
    Motion,
    Solid,
    Sweep,
    candidate_pairs,
    lowest_clearance,
    lowest_clearances,
    points_travel,
    relative_travel,
    signed_clearance,
)
from ...worlds.arrays import F64, RigidPose, quaternion_product, rotation_matrix
from ..scene.own_bodies import joined
from .bounds import BENT, BEYOND, PRECISION, ROUNDING, TUNNEL_SHARE
from .flights import Flight, reconstructed
from .paths import Paths

if TYPE_CHECKING:
    from ..scene.shapes import PartSurface
    from ..scene.surfaces import Surfaces

__all__ = ["Passage", "Passages", "find_passages"]

BENDS = 6
"""Displacements tried, each away from the deepest place of the last."""


class Passage(NamedTuple):
    """An entity went through another between `frame - 1` and `frame`."""

    entity: str
    through: str
    frame: int
    point: F64
    """Deepest place on the way [m], shape (3,)."""
    travel: float
    """Upper bound of the relative travel in that frame [m]."""
    depth: float
    """Overlap found on the way [m]; the deepest may be more."""
    bound: float
    """Depth up to which it is no passage [m]."""
    parts: tuple[str, str]
    """Parts of the two."""
    felt: bool
    """True if the engine logged a contact of the pair in that frame."""


class Passages(NamedTuple):
    """Passages that were found, and the number of frame-to-frame motions of pairs that were tested."""

    found: list[Passage]
    inspected: int


def find_passages(surfaces: Surfaces, *, known: Collection[tuple[str, str]] = ()) -> Passages:
    """All pairs of which one moves, frame to frame; the first passage of each pair of entities.

    Args:
        surfaces: what is inspected.
        known: pairs that need no test, because they fail at a written frame.

    Raises:
        EvidenceError: something moves too far between two frames.
    """
    if surfaces.frames < 2 or not surfaces.parts:
        return Passages([], 0)
    search = Paths(surfaces)
    low, high = search.boxes()
    cases: list[_Case] = []
    for i, j in candidate_pairs(low, high, 0.0):
        a, b = surfaces.parts[i], surfaces.parts[j]
        if (a.entity, b.entity) in known or (b.entity, a.entity) in known or not _concerns(surfaces, a, b):
            continue
        if {i, j} & surfaces.shapes.soft:
            continue  # no rigid motion joins two shapes: `elastic` rows bound what deforming bodies travel per step
        meet = np.flatnonzero((np.maximum(low[i] - high[j], low[j] - high[i]) <= 0.0).all(axis=1))
        case = _case(search, i, j, meet)
        if case is not None:
            cases.append(case)
    first: dict[tuple[str, str], Passage] = {}
    asked = [c.sweep()._replace(names=" and ".join(surfaces.parts[k].entity for k in (c.i, c.j))) for c in cases]
    for case, lowest in zip(cases, lowest_clearances(asked), strict=True):
        passage = _judge(search, case, lowest)
        if passage is not None:
            key = (passage.entity, passage.through)
            if key not in first or passage.frame < first[key].frame:
                first[key] = passage
    inspected = sum(len(c.meet) for c in cases)
    return Passages(sorted(first.values(), key=lambda p: (p.frame, p.entity, p.through)), inspected)


def _concerns(surfaces: Surfaces, a: PartSurface, b: PartSurface) -> bool:
    if a.entity == b.entity:
        if a.body == b.body:
            return False
        order = [body.name for body in surfaces.candidate.entity(a.entity).bodies]
        return abs(order.index(a.body) - order.index(b.body)) > joined(surfaces, a.entity)
    return not (surfaces.is_static(a.entity) and surfaces.is_static(b.entity))


def _case(search: Paths, i: int, j: int, meet: NDArray[np.intp]) -> _Case | None:
    """Test of two parts whose boxes meet in the intervals `meet`; None where nothing moves far enough."""
    surfaces = search.surfaces
    a, b = surfaces.parts[i], surfaces.parts[j]
    noise, allowed = surfaces.noise(a.entity, b.entity), surfaces.allowed_depth(a.entity, b.entity)
    one, two = search.body(a).flight, search.body(b).flight
    if a.entity == b.entity:
        meet = meet[~_as_one(one.motion.take(meet), two.motion.take(meet), search.radius[j])]
    travel = relative_travel(
        one.motion.take(meet), search.radius[i], two.motion.take(meet), search.radius[j], np.zeros(len(meet)), np.ones(len(meet))
    )
    fast = travel > 2.0 * noise
    meet, travel = meet[fast], travel[fast]
    if len(meet) == 0:
        return None
    walls = min(search.wall(i), search.wall(j))
    # Two open sheets have no wall: any crossing counts.
    bound = allowed + (max(TUNNEL_SHARE * walls, noise) if np.isfinite(walls) else noise)
    meet = meet[travel > 2.0 * bound]
    if len(meet) == 0:
        return None
    # What overlaps at a written frame fails there.
    floor = -(allowed + noise)
    return _Case(i, j, a.solid, one, b.solid, two, meet, floor, bound, PRECISION * bound)


def _as_one(a: Motion, b: Motion, radius: float) -> NDArray[np.bool_]:
    """Intervals in which b, of some radius about its centre [m], keeps its place against a at both ends and turns with it, shape (n,)."""
    places = []
    for motion, other, s in ((a, b, 0.0), (a, b, 1.0)):
        time = np.full(len(motion), s)
        back = motion.at(time)[1] * np.array([1.0, -1.0, -1.0, -1.0])
        way = np.einsum("nij,nj->ni", rotation_matrix(back), other.centers(time) - motion.centers(time))
        places.append((way, quaternion_product(back, other.at(time)[1])))
    (first, turned), (last, turned_last) = places
    # Either sign is the same orientation; an angle of x changes a unit quaternion by x / 2.
    turn = 2.0 * np.minimum(np.linalg.norm(turned_last - turned, axis=1), np.linalg.norm(turned_last + turned, axis=1))
    whole = np.linalg.norm(b.turn - a.turn, axis=1) > np.pi
    return np.asarray((np.linalg.norm(last - first, axis=1) + radius * turn <= ROUNDING) & ~whole)


def _judge(search: Paths, case: _Case, low: Lowest) -> Passage | None:
    """The first passage among the intervals of one case, given their lowest clearances."""
    a, b = search.surfaces.parts[case.i], search.surfaces.parts[case.j]
    deep = np.flatnonzero((low.value < -case.bound) & (low.ends.min(axis=1) >= case.floor))
    for k in deep:
        interval, travel = int(case.meet[k]), case.points_travel(search, int(case.meet[k]))
        felt = search.log.gap(a.entity, b.entity, interval + 1)
        if felt is not None and _felt_in_time(search.surfaces, a.entity, b.entity, felt, case.bound, travel):
            continue
        if case.bent_free(search, case.i, case.j, interval):
            continue
        here = case.meet[[k]]
        point = case.witness(case.flight_a.motion.take(here), case.flight_b.motion.take(here), float(low.time[k]))[1]
        one, two = _order(search, a, b, interval)
        depth, parts = -float(low.value[k]), (one.part, two.part)
        return Passage(one.entity, two.entity, interval + 1, point, travel, depth, case.bound, parts, felt is not None)
    return None


def _order(search: Paths, a: PartSurface, b: PartSurface, interval: int) -> tuple[PartSurface, PartSurface]:
    """The faster one first; a static one never."""
    path = []
    for part in (a, b):
        control = search.body(part).flight.motion.control[interval]
        path.append((not search.surfaces.is_static(part.entity), float(np.linalg.norm(control[3] - control[0]))))
    return (a, b) if path[0] >= path[1] else (b, a)


def _felt_in_time(surfaces: Surfaces, a: str, b: str, gap: float, bound: float, travel: float) -> bool:
    """True if the contact log of the frame rules a passage out."""
    plan = surfaces.candidate.spec.simulation
    steps = [s.settings.step for s in plan.rigid.values() if a in s.members and b in s.members]
    if not steps or not np.isfinite(gap):
        return False
    per_step = travel * max(steps) * plan.fps
    return gap >= -bound and per_step <= 2.0 * bound


@dataclass(frozen=True)
class _Case:
    """Two parts, the intervals to be tested and the depth that matters between them."""

    i: int
    j: int
    """The parts."""
    solid_a: Solid
    flight_a: Flight
    solid_b: Solid
    flight_b: Flight
    meet: NDArray[np.intp]
    """Intervals in which they may meet, shape (n,)."""
    floor: float
    """[m] Intervals with a lower clearance at one of their ends are not tested."""
    bound: float
    precision: float

    def sweep(self) -> Sweep:
        """The question whether the two get deeper than the bound between written frames."""
        one, two = self.flight_a.motion.take(self.meet), self.flight_b.motion.take(self.meet)
        return Sweep(self.solid_a, one, self.solid_b, two, -self.bound, self.precision, first_found=True, ends_above=self.floor)

    def lowest(self, motion_a: Motion, motion_b: Motion, *, deepest: bool = False) -> Lowest:
        """Some clearance below minus the bound per motion where there is one; about the lowest if asked."""
        return lowest_clearance(
            Sweep(self.solid_a, motion_a, self.solid_b, motion_b, -self.bound, self.precision, first_found=not deepest)
        )

    def witness(self, motion_a: Motion, motion_b: Motion, time: float) -> tuple[F64, F64]:
        """The way a must move to get out, unit, shape (3,), and the deep point [m], for the one motion of each."""
        s = np.array([time])
        (pa, qa), (pb, qb) = motion_a.at(s), motion_b.at(s)
        found = signed_clearance(self.solid_a, RigidPose(pa[0], qa[0]), self.solid_b, RigidPose(pb[0], qb[0]))
        way = found.point_b - found.point_a
        length = float(np.linalg.norm(way))
        return (way / length if length > 0.0 else np.zeros(3)), found.point_a

    def points_travel(self, search: Paths, interval: int) -> float:
        """Upper bound of the way that points of the two can move against each other in an interval [m]."""
        here = np.array([interval])
        motions = self.flight_a.motion.take(here), self.flight_b.motion.take(here)
        radii = search.radius[self.i], search.radius[self.j]
        return float(points_travel(motions[0], radii[0], motions[1], radii[1], np.zeros(1), np.ones(1))[0])

    def bent_free(self, search: Paths, i: int, j: int, interval: int) -> bool:
        """True if forces other than gravity bent the paths enough for one of the other plausible paths to be free."""
        radius_a, radius_b = search.radius[i], search.radius[j]
        slack = float(self.flight_a.slack(radius_a)[interval] + self.flight_b.slack(radius_b)[interval])
        if slack <= BENT * self.bound:
            return False
        here = np.array([interval])
        motion_a, motion_b = self.flight_a.motion.take(here), self.flight_b.motion.take(here)
        if self._free([(motion_a.straight(), motion_b.straight())]):
            return True
        a, b = search.surfaces.parts[i].entity, search.surfaces.parts[j].entity
        times = [search.log.times(n, interval + 1, search.step) for n in (a, b)]
        if any(times):
            pieces = reconstructed(self.flight_a, times[0], self.flight_b, times[1], interval)
            if self._free(pieces):
                return True
        return self._displaced(motion_a, motion_b, slack)

    def _free(self, pieces: list[tuple[Motion, Motion]]) -> bool:
        return all(float(self.lowest(one, two).value[0]) >= -self.bound for one, two in pieces)

    def _displaced(self, motion_a: Motion, motion_b: Motion, slack: float) -> bool:
        """True if the cubic of a, displaced in its middle by at most `slack` [m], is free."""
        total = np.zeros(3)
        low = self.lowest(motion_a, motion_b, deepest=True)
        value, time = float(low.value[0]), float(low.time[0])
        for _ in range(BENDS):
            away, _point = self.witness(motion_a.bent(total[None]), motion_b, time)
            height = max(4.0 * time * (1.0 - time), 1e-3)
            total = total + BEYOND * (self.precision - value) / height * away
            if float(np.linalg.norm(total)) > slack:
                return False
            low = self.lowest(motion_a.bent(total[None]), motion_b, deepest=True)
            value, time = float(low.value[0]), float(low.time[0])
            if value >= -self.bound:
                return True
        return False
