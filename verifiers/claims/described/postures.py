"""Postures of a body at a frame: what stands, sits, hangs, leans or lies there is at rest and borne as that (R131, R155).

- *at rest*: its centre moves no faster, as seen from the place or from what bears it, than a tenth of its greatest extent per second and what
  `rests_on` takes for at rest. What hangs may sway.
- *borne*: over the interval about the frame others bear half of its weight at least, as of what does not fall. What never moves is asked by `support:held`.
- *stands*: from below, upright: its own z axis within 0.6 rad of the vertical, or as high as its greatest extent would be at that tilt.
- *sits*: from below. *leans*: from below, and it touches the place from the side (`facing.py`).
- *lies*: from below, and no higher than that, unless it is compact by Zingg.
- *hangs*: by a joint, a spring, a rope or a contact above its centre of mass, or from the side by what it is fixed to; what touches it from below
  bears less than half of its weight.

What has several bodies is turned as the heaviest of them, what deforms as its best rigid fit; where it *stands* it keeps the share of its height at rest
that is left at that tilt. Of both it is unverified where no record tells who bears them. What a path moves is not asked who bears it. Statics: a body is borne where the forces on it balance its weight;
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
from ...support.pinned import pinned_vertices
from ...support.touching import contacts_of
from .bounds import BORNE, PACE, SCENERY, TILT, ZINGG
from .rests import still_at

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ....worlds.candidate import Candidate
    from ....worlds.poses import Pose
    from .placed import Place

__all__ = ["is_measured", "untold", "why_not"]


def is_measured(candidate: Candidate, thing: str) -> bool:
    """True of what has a surface of its own; liquids, gases and grains have no posture."""
    return thing in candidate.solids


def untold(place: Place, pose: Pose, thing: str) -> str | None:
    """Why nothing tells who bears a thing that deforms or has several bodies; None where something does, and of one rigid body.

    Args:
        place: bodies at a frame.
        pose: that its words say.
        thing: the body.
    """
    candidate = place.candidate
    soft, count = thing in candidate.deformables, len(candidate.entity(thing).bodies)
    if (not soft and count == 1) or candidate.spec.entities[thing].motion != "dynamic" or candidate.last_frame < 1:
        return None
    held, what = _Held(place, thing), "deforms" if soft else f"has {count} bodies"
    if held.share() is None:
        return f"no record tells who bears {thing!r}, which {what}: {held.missing}"
    if pose == "hang" and held.above and held.standing() and held.from_below() is None:
        return f"no record tells how much of the weight of {thing!r}, which {what}, {held.standing()[0]!r} bears from below"
    return None


def why_not(place: Place, pose: Pose, thing: str) -> str | None:
    """Why a thing has not a posture at the frame of a place, in words; None where it has, or has none by what it is."""
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
        self.missing = ""
        """Why its share is not known."""
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
                point, pinned = self._end(link.name), self._pinned(link.name)
                if pinned is not None:
                    yield link.name, pinned
                elif point is not None:
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

    def _pinned(self, name: str) -> float | None:
        """Height of the highest vertex of the thing that a pin holds [m]; None of what is no pin of it."""
        entity, key = self.candidate.spec.entities[self.thing], name.partition(":")[2]
        if not name.startswith(f"{self.thing}:") or key not in getattr(entity.physics, "pins", {}):
            return None
        rest = [p.simulation.vertices for p in self.candidate.entity(self.thing).parts if p.simulation is not None]
        if not rest:
            return None
        points = np.concatenate(rest)
        which = pinned_vertices(entity, key, points)
        soft = self.candidate.deforming.get(self.thing)
        placed = pose_of(entity.pose).apply(points) if soft is None else soft.positions(self.place.frame)
        return float((placed[which] @ self.place.turn[2]).max()) if len(which) else None

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

    def standing(self) -> list[str]:
        """Bearers from below, but for nails and brackets."""
        return [n for n in self.below if not self.is_fixing(n)]

    def interval(self) -> int:
        """The interval between frames that begins at the frame, or ends there at the last one."""
        return min(self.place.frame, self.candidate.last_frame - 1)

    def share(self) -> float | None:
        """Share of its weight that others bear over that interval; None where nothing tells, or nothing can."""
        if self.candidate.spec.entities[self.thing].motion != "dynamic" or self.candidate.last_frame < 1:
            return None
        try:
            return float(course_of(self.candidate, self.thing).carried[self.interval()])
        except (EvidenceError, KeyError) as error:
            self.missing = str(error)
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
    standing = held.standing()
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
    entity, built = place.candidate.spec.entities[thing], max(place.candidate.entity(thing).bodies, key=lambda b: b.mass)
    turn = compose(place.candidate.pose(thing, place.frame, built.name), built.pose.inverse())
    points = place.seen(thing).triangles.reshape(-1, 3) @ place.turn
    own = np.sort(np.ptp(turn.inverse().apply(points), axis=0))
    height, upright = float(np.ptp(place.box(thing)[:, 2])), math.cos(TILT)
    ends = turn.apply(np.array([(0.0, 0.0, 0.0), (0.0, 0.0, 1.0)]))
    axis = abs(float((ends[1] - ends[0]) @ place.turn[2]))
    said = f"it is {height:.3g} m high of {own[2]:.3g} m that it extends at most"
    if pose == "stand" and axis < upright and height < upright * own[2]:
        return f"it lies: {said}, and its own z axis is {math.degrees(math.acos(min(axis, 1.0))):.0f} deg off the vertical"
    rest = _rest_height(place.candidate, thing)
    if pose == "stand" and rest is not None and height < upright * rest:
        return f"it has sunk in on itself: {said}, and it is {rest:.3g} m high at rest"
    scenery = entity.motion == "static" and height > SCENERY
    if pose == "lie" and height > upright * own[2] and own[0] < ZINGG * own[2] and not scenery:
        return f"it stands: {said}"
    return None


def _rest_height(candidate: Candidate, thing: str) -> float | None:
    """Extent along its own z axis of what deforms, in its rest shape [m]; None of what does not."""
    if thing not in candidate.deformables:
        return None
    parts = [p.simulation.vertices for p in candidate.entity(thing).parts if p.simulation is not None]
    return float(np.ptp(np.concatenate(parts)[:, 2])) if parts else None
