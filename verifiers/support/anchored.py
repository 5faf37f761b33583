"""Judges whether joints, springs and rope ends at a fixed point of space end at something (R92, R154).

A joint without a `parent` bears any load. In a drawn world something bears that load: a thing that never moves, on or in whose
surface the point lies, or a landscape. A hinge needs it anywhere on its axis where the body is too; a weld or a slide holds what it touches as well. A
body that nothing drawn is to hold says so itself: `afloat`, with a reason that is printed.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...worlds.arrays import F64, pose_of
from ...worlds.errors import EvidenceError
from ...worlds.spec import HingeJoint, Rope, SpringJoint
from ..land.grounds import lands
from ..rows.answers import row_of
from ..rows.corrections import correction, pointer, say_afloat, set_value
from ..rows.findings import Finding
from ..scene.surfaces import surfaces_of
from .joined import End, missed, on_axis, reach_of, touch
from .questions import ANCHOR
from .stillness import is_still

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Correction, Row
    from ..scene.surfaces import Surfaces

__all__ = ["anchor_lines", "anchored_rows"]


class Anchor(NamedTuple):
    """A joint or rope end at a fixed point of space."""

    name: str
    """Name of the joint or rope."""
    field: str
    """`anchor` or `parent_point` of a joint, `start` or `end` of a rope."""
    kind: str
    """Kind of the joint; `rope`."""
    entity: str
    """Entity that it holds."""
    point: F64
    """[m]"""
    where: tuple[str | int, ...]
    """Steps of the pointer to the point."""
    axis: F64 | None = None
    """Axis of a hinge."""

    @property
    def words(self) -> str:
        """The name it goes by: `hinge 'pivot'`, `the start of rope 'line'`."""
        return f"the {self.field} of rope {self.name!r}" if self.kind == "rope" else f"{self.kind} {self.name!r}"


class Footing(NamedTuple):
    """The thing that never moves and is nearest to an anchor."""

    entity: str
    distance: float
    """[m], 0 where the anchor lies in it"""
    bound: float
    """Largest distance that counts as reached [m]."""
    nearest: F64
    """Point of its surface [m]."""

    @property
    def reached(self) -> bool:
        """True if the anchor lies on or in it."""
        return self.distance <= self.bound


def _anchors(candidate: Candidate) -> Iterator[Anchor]:
    for name, joint in candidate.spec.simulation.joints.items():
        if joint.parent is None:
            field = "parent_point" if isinstance(joint, SpringJoint) else "anchor"
            point = np.array(joint.parent_point if isinstance(joint, SpringJoint) else joint.anchor, dtype=np.float64)
            axis = np.array(joint.axis, dtype=np.float64) if isinstance(joint, HingeJoint) else None
            yield Anchor(name, field, joint.kind, joint.child, point, ("simulation", "joints", name, field), axis)
    for name, entity in candidate.spec.entities.items():
        if isinstance(entity.generator, Rope):
            rope, start = entity.generator, pose_of(entity.pose)
            last = len(rope.points) - 1
            for field, index, to in (("start", 0, rope.attach_start), ("end", last, rope.attach_end)):
                if to == "world":
                    point = start.apply(np.array([rope.points[index]], dtype=np.float64))[0]
                    yield Anchor(name, field, "rope", name, point, ("entities", name, "generator", "points", index))


def anchored_rows(surfaces: Surfaces) -> list[Row]:
    """Rows `support:anchor:<joint or rope>:<field>` of joints, springs and rope ends at a fixed point of space."""
    candidate = surfaces.candidate
    return [
        row_of(candidate, ANCHOR, (one.name, one.field), partial(_anchor, surfaces, one), entities=(one.entity,))
        for one in _anchors(candidate)
    ]


def anchor_lines(candidate: Candidate) -> list[dict[str, str]]:
    """Lines of the approximation register: joints to a place of the world at which nothing is drawn that never moves."""
    anchors = list(_anchors(candidate))
    surfaces = surfaces_of(candidate) if anchors else None
    return [
        {
            "what": f"{one.words} holds {one.entity!r} at a fixed point of space that nothing drawn holds",
            "effect": "it bears any load there",
        }
        for one in anchors
        if surfaces is not None and one.entity not in surfaces.missing and not _drawn(surfaces, one)
    ]


def _drawn(surfaces: Surfaces, anchor: Anchor) -> bool:
    found = _footing(surfaces, anchor)
    return _in_land(surfaces, anchor) or (found is not None and found.reached)


def _radius(surfaces: Surfaces, anchor: Anchor) -> float:
    """The length that a rope's round end reaches beyond its last point [m]; 0 for joints."""
    rope = surfaces.candidate.spec.entities[anchor.entity].generator if anchor.kind == "rope" else None
    return rope.radius if isinstance(rope, Rope) else 0.0


def _footing(surfaces: Surfaces, anchor: Anchor) -> Footing | None:
    """The thing that never moves and is nearest to the anchor; None in a world in which everything moves."""
    best: Footing | None = None
    for name in surfaces.entities:
        if not is_still(surfaces.candidate.spec, name) or name in surfaces.broken:
            continue
        bound = reach_of(surfaces, anchor.entity, name) + _radius(surfaces, anchor)
        found = missed(surfaces, End(name, anchor.point, anchor.where))
        distance = found.distance
        if anchor.axis is not None:
            place = on_axis(surfaces, (anchor.entity, name), anchor.point, anchor.axis, bound)
            distance = max(missed(surfaces, End(n, place, anchor.where)).distance for n in (name, anchor.entity))
        if anchor.kind in ("weld", "slide") and touch(surfaces, anchor.entity, name):
            distance = 0.0
        if best is None or distance - bound < best.distance - best.bound:
            best = Footing(name, distance, bound, found.nearest)
        if best.reached:
            return best
    return best


def _in_land(surfaces: Surfaces, anchor: Anchor) -> bool:
    """True if an anchor lies in or on the ground of a landscape."""
    bound = surfaces.candidate.spec.simulation.limits.contact_gap
    try:
        heights = [land.heights_at(anchor.point[None])[0] for land in lands(surfaces.candidate)]
    except EvidenceError:
        return False
    return any(anchor.point[2] <= height + bound for height in heights)


def _anchor(surfaces: Surfaces, anchor: Anchor) -> Finding:
    surfaces.require(anchor.entity)
    reason, found = surfaces.candidate.spec.entities[anchor.entity].afloat, _footing(surfaces, anchor)
    place = ", ".join(f"{c:.4g}" for c in anchor.point)
    common: dict[str, Any] = {"frames": (0, 0), "extra": [anchor.point.tolist(), reason]}
    if _in_land(surfaces, anchor):
        return Finding("pass", f"{anchor.words} ends in the ground at ({place})", **common)
    if found is not None and found.reached:
        text = f"{anchor.words} ends at {found.entity!r}, which never moves"
        return Finding("pass", text, found.distance, found.bound, entities=(anchor.entity, found.entity), **common)
    if reason is not None:
        return Finding("pass", f"{anchor.words} holds {anchor.entity!r} at a point of space: {reason}", **common)
    text = f"{anchor.words} holds {anchor.entity!r} at ({place}), where nothing is drawn that never moves"
    if anchor.axis is not None:
        text = f"no place on the axis of {anchor.words} is at {anchor.entity!r} and at something drawn that never moves"
    if found is not None:
        text += f": {found.entity!r} is the nearest, {found.distance * 1e3:.4g} mm away, at most {found.bound * 1e3:.4g} mm are allowed"
    return Finding(
        "fail",
        text,
        None if found is None else found.distance,
        None if found is None else found.bound,
        hints=tuple(_corrections(anchor, found)),
        evidence={"place": anchor.point.tolist(), "nearest": None if found is None else found.entity},
        entities=(anchor.entity,) if found is None else (anchor.entity, found.entity),
        **common,
    )


def _corrections(anchor: Anchor, found: Footing | None) -> Iterator[Correction]:
    place, path = [round(float(c), 5) for c in anchor.point], pointer(*anchor.where)
    where = f"{place}" if anchor.axis is None else f"{anchor.entity!r} on the axis"
    yield correction(
        "what holds it is not drawn",
        "shape",
        f"Add a static hook, post, bracket or beam that is held and reaches {where}; then name it as what {anchor.words} joins it to.",
        pointers=("/entities", path),
    )
    if found is not None:
        near = [round(float(c), 5) for c in found.nearest]
        yield correction(
            f"{anchor.words} ends beside {found.entity!r}",
            "joints",
            f"Let it end at {found.entity!r}: its surface is nearest at {near}.",
            pointers=(path,),
            patch=set_value(path, near) if anchor.kind == "spring" else (),
        )
    yield say_afloat(anchor.entity, "it is meant to hang on nothing")
