"""Postures of a rigid body at a frame: what stands, sits, hangs, leans or lies there is at rest and borne as that (R131, R155).

- *at rest*: its centre moves no faster, as seen from the place or from what bears it, than a tenth of its greatest extent per second and what
  `rests_on` takes for at rest. What hangs may sway.
- *borne*: over the interval about the frame others bear half of its weight at least, as of what does not fall. What never moves is asked by `support:held`.
- *stands*: from below, upright: its own z axis within 0.6 rad of the vertical, or as high as its greatest extent would be at that tilt.
- *sits*: from below. *leans*: from below, and it touches the place from the side (`facing.py`).
- *lies*: from below, and no higher than that, unless it is compact by Zingg.
- *hangs*: by a joint, a spring, a rope or a contact above its centre of mass, or from the side by what it is fixed to; what touches it from below
  bears less than half of its weight.

A body that deforms or has several bodies is not measured, nor is what a path moves asked who bears it. Statics: a body is borne where the forces on it balance its weight;
what bears it from above its centre of mass holds it stably, from below only within its base (Goldstein, Classical Mechanics, 1.3).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import compose, pose_of
from ....worlds.errors import EvidenceError
from ....worlds.predicates import RestsOn
from ....worlds.spec import Fastened, Rope, SpringJoint
from ...land.grounds import lands
from ...predicates.events.course import between, course_of
from ...predicates.events.hanging import carried_point
from ...scene.surfaces import surfaces_of
from ...support.afloat import afloat
from ...support.links import links_of
from ...support.touching import contacts_of
from .bounds import BORNE, PACE, SCENERY, TILT, ZINGG
from .rests import still_at

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ....worlds.candidate import Candidate
    from ....worlds.poses import Pose
    from .placed import Place

__all__ = ["is_measured", "why_not"]


def is_measured(candidate: Candidate, thing: str) -> bool:
    """True of one rigid body, whose posture the rules measure."""
    return thing in candidate.solids and thing not in candidate.deforming and len(candidate.entity(thing).bodies) == 1


def why_not(place: Place, pose: Pose, thing: str) -> str | None:
    """Why a thing has not a posture at the frame of a place, in words; None where it has, or where that is not measured."""
    if not is_measured(place.candidate, thing):
        return None
    held = _Held(place, thing)
    if pose == "hang":
        return _hangs(held)
    moves = _moves(place, thing, held)
    if moves is not None or pose in ("sit", "lean"):
        return moves or _borne(held, sides=pose != "lean")
    return _borne(held) or _turned(place, pose, thing)


# ---------------------------------------------------------------- what bears it


class _Held:
    """Bearers of a thing at a frame: bodies from below its centre of mass, and what holds it above that or from the side."""

    def __init__(self, place: Place, thing: str) -> None:
        self.place, self.thing, self.candidate = place, thing, place.candidate
        self.below: list[str] = []
        self.above: list[str] = []
        self.beside: list[str] = []
        center = float(place.center(thing)[2])
        for other in surfaces_of(self.candidate).parts_of:
            if other == thing or not place.touches(thing, other):
                continue
            if self._lowest(other) > center:
                self.above.append(other)
            else:
                (self.below if place.bears(other, thing) else self.beside).append(other)
        for name, height in self._links():
            (self.above if height >= center else self.beside).append(name)
        if self._on_land() or any(frames[min(place.frame, len(frames) - 1)] for frames in self._afloat()):
            self.below.append("what is under it")

    def _lowest(self, other: str) -> float:
        """Least height of the places at which they touch [m]."""
        surfaces = surfaces_of(self.candidate)
        points = contacts_of(surfaces, self.thing, other, self.place.frame).points
        if not len(points):
            points = surfaces.gap(self.thing, other, self.place.frame).point_a[None]
        return float((points @ self.place.turn[2]).min())

    def _links(self) -> Iterator[tuple[str, float]]:
        """Joints, springs, ropes and `fastened` relations that hold it at the frame, with the height at which they do [m]."""
        spec, frame = self.candidate.spec, self.place.frame
        for link in links_of(surfaces_of(self.candidate)):
            if self.thing in (link.a, link.b) and link.holds[min(frame, len(link.holds) - 1)]:
                point = self._end(link.name)
                if point is not None:
                    yield link.name, float(carried_point(self.candidate, self.thing, point)[frame] @ self.place.turn[2])
        for key, relation in spec.graph.relations.items():
            if isinstance(relation, Fastened) and self.thing in (relation.a, relation.b):
                other = relation.a if self.thing == relation.b else relation.b
                if other in self.candidate.solids:
                    yield key, float(self.place.box(other)[1, 2])

    def _end(self, name: str) -> tuple[float, float, float] | None:
        """Point at which a joint or rope holds the thing, in the world as specified [m]; None of a pin."""
        spec = self.candidate.spec
        joint = spec.simulation.joints.get(name)
        if isinstance(joint, SpringJoint):
            return joint.child_point if joint.child == self.thing else joint.parent_point
        if joint is not None:
            return joint.anchor
        rope = spec.entities[name].generator if name in spec.entities else None
        if isinstance(rope, Rope):
            point = rope.points[0] if rope.attach_start == self.thing else rope.points[-1]
            x, y, z = pose_of(spec.entities[name].pose).apply(np.array(point, dtype=np.float64)[None])[0].tolist()
            return (x, y, z)
        return None

    def _on_land(self) -> bool:
        points = self.place.seen(self.thing).triangles.reshape(-1, 3) @ self.place.turn
        lowest = points[np.argsort(points @ self.place.turn[2])[:8]]
        try:
            grounds = [land.heights_at(lowest) for land in lands(self.candidate)]
        except EvidenceError:
            return False
        return any(bool((lowest[:, 2] <= heights + self.place.slack).any()) for heights in grounds)

    def _afloat(self) -> list[np.typing.NDArray[np.bool_]]:
        try:
            return list(afloat(self.candidate, self.thing).values())
        except EvidenceError:
            return []

    def is_fixing(self, other: str) -> bool:
        """True of a nail or bracket below: less wide than the thing, which something else touches from the side."""
        if not self.beside or other not in self.candidate.solids:
            return False
        own, its = (float(np.ptp(self.place.box(n)[:, :2], axis=0).prod()) for n in (self.thing, other))
        return its < own

    def interval(self) -> int:
        """The interval between frames that begins at the frame, or ends there at the last one."""
        return min(self.place.frame, self.candidate.last_frame - 1)

    def share(self) -> float | None:
        """Share of its weight that others bear over that interval; None where nothing tells, or nothing can."""
        if self.candidate.spec.entities[self.thing].motion != "dynamic" or self.candidate.last_frame < 1:
            return None
        try:
            return float(course_of(self.candidate, self.thing).carried[self.interval()])
        except (EvidenceError, KeyError):
            return None

    def from_below(self) -> float | None:
        """Share of its weight that those below it alone bear."""
        if self.share() is None:
            return None
        course, total = course_of(self.candidate, self.thing), 0.0
        weight = course.mass * course.strength * course.step
        for other in self.below:
            try:
                total += float(between(self.candidate, other, self.thing).impulse[self.interval()] @ course.up)
            except (EvidenceError, KeyError):
                return None
        return total / weight if weight > 0.0 else None


def _borne(held: _Held, *, sides: bool = True) -> str | None:
    """Why something does not bear it from below; None where it does, or where nothing can tell.

    Args:
        held: what bears it.
        sides: what touches or holds it from the side may bear it, as a groove or a hinge does.
    """
    motion, share = held.candidate.spec.entities[held.thing].motion, held.share()
    if motion != "dynamic":
        return None
    if share is not None and share < BORNE:
        return f"it falls: others bear {max(share, 0.0):.2g} of its weight, at least {BORNE:g} is asked"
    if held.below:
        return None
    if held.above:
        return f"it hangs by {held.above[0]!r}, and nothing bears it from below"
    return "nothing bears it from below" if not (sides and held.beside) else None


def _hangs(held: _Held) -> str | None:
    """Why nothing holds it from above; None where something does."""
    if held.candidate.spec.entities[held.thing].motion == "kinematic":
        return None
    total, below = held.share(), held.from_below()
    if total is not None and total < BORNE and not held.above:
        return f"it falls: others bear {max(total, 0.0):.2g} of its weight, at least {BORNE:g} is asked"
    standing = [n for n in held.below if not held.is_fixing(n)]
    if standing and (not held.above or (below is not None and below >= BORNE)):
        borne = "" if below is None else f", {below:.2g} of its weight"
        return f"{standing[0]!r} bears it from below{borne}, and it hangs by nothing that holds it above its centre"
    if not held.above and not held.beside and not held.below:
        return "nothing holds it"
    return None


# ---------------------------------------------------------------- rest and posture


def _moves(place: Place, thing: str, held: _Held) -> str | None:
    """Why it is not at rest; None where it is."""
    extent = float(np.linalg.norm(np.ptp(place.box(thing), axis=0)))
    most = max(float(RestsOn.model_fields["max_speed"].default), PACE * extent)
    seen = dict.fromkeys([*(g for g in place.grounds if g != thing), *(n for n in held.below if n in place.candidate.solids)])
    if not seen or still_at(place.candidate, thing, list(seen), place.frame, most=most):
        return None
    return f"it is not at rest: its centre moves faster than {most:.3g} m/s, as seen from {', '.join(seen)}"


def _turned(place: Place, pose: Pose, thing: str) -> str | None:
    """Why it is not turned as what stands, or lies; None where it is."""
    entity, built = place.candidate.spec.entities[thing], place.candidate.entity(thing).bodies[0]
    turn = compose(place.candidate.pose(thing, place.frame, built.name), built.pose.inverse())
    points = place.seen(thing).triangles.reshape(-1, 3) @ place.turn
    own = np.sort(np.ptp(turn.inverse().apply(points), axis=0))
    height, upright = float(np.ptp(place.box(thing)[:, 2])), math.cos(TILT)
    ends = turn.apply(np.array([(0.0, 0.0, 0.0), (0.0, 0.0, 1.0)]))
    axis = abs(float((ends[1] - ends[0]) @ place.turn[2]))
    said = f"it is {height:.3g} m high of {own[2]:.3g} m that it extends at most"
    if pose == "stand" and axis < upright and height < upright * own[2]:
        return f"it lies: {said}, and its own z axis is {math.degrees(math.acos(min(axis, 1.0))):.0f} deg off the vertical"
    scenery = entity.motion == "static" and height > SCENERY
    if pose == "lie" and height > upright * own[2] and own[0] < ZINGG * own[2] and not scenery:
        return f"it stands: {said}"
    return None
