"""Joints by which something opens: of generated things whose kind has doors, drawers or lids, and of bodies that are called so."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...worlds.arrays import F64, RigidPose, quaternion_product, rotation_matrix
from ...worlds.predicate_base import atoms_of, entities_of
from ...worlds.predicates import Contact
from ...worlds.predicates.events import PairEvent
from ...worlds.spec import HingeJoint, Rope, SlideJoint, SpringJoint, WeldJoint
from .bounds import CARRIED_MASS, CARRIED_SIZE, DRAWN_SHARE, LEVEL, OPEN_ANGLE, OPEN_SHARE, PUSHED_MASS
from .kinds import OPENINGS, function_of, head_noun

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.spec import WorldSpec
    from ..scene.surfaces import Surfaces

__all__ = ["Opening", "assembly_of", "openings_of"]


class Opening(NamedTuple):
    """A joint by which something opens, and what moves with it."""

    joint: str
    child: str
    slides: bool
    anchor: F64
    """World [m], shape (3,)."""
    axis: F64
    """Unit vector, shape (3,)."""
    low: float
    """End of the range [rad] or [m], at most 0."""
    high: float
    """Other end, at least 0."""
    moving: frozenset[str]
    """Entities that go along: hung on the child, fastened to it, standing on it."""
    aside: frozenset[str]
    """Entities that are no obstacles: of the same thing, standing on what tilts, met on purpose."""
    hung: frozenset[str]
    """Entities that hold it: what of them is at the child where the world stands is its mount, the rest an obstacle."""
    welded: str | None
    """Another entity to which the child is welded, if there is one."""
    share: float
    """Share of the range that its function asks for [1]."""
    angle: float
    """Angle that is enough for a hinge, whatever its range [rad]."""
    reason: str
    """Reason of both."""
    pushed: frozenset[str]
    """Free things that are so light that what opens pushes them away."""

    @property
    def span(self) -> float:
        """Length of the range [rad] or [m]."""
        return self.high - self.low

    @property
    def needed(self) -> float:
        """Share of the range that must be free [1]."""
        return self.share if self.slides else min(self.share, self.angle / self.span)

    @property
    def unit(self) -> str:
        """Unit of positions of the joint."""
        return "m" if self.slides else "rad"

    def radius(self, points: F64) -> float:
        """Largest travel of points [m], shape (n, 3), per unit of the joint's position."""
        if self.slides:
            return 1.0
        arms = points - self.anchor
        return float(np.linalg.norm(arms - np.outer(arms @ self.axis, self.axis), axis=1).max())

    def poses(self, start: RigidPose, positions: F64) -> tuple[F64, F64]:
        """Poses of a body that goes along, at positions of the joint: places (n, 3) [m] and quaternions (n, 4)."""
        count = len(positions)
        if self.slides:
            return start.position + np.outer(positions, self.axis), np.tile(start.quaternion, (count, 1))
        half = 0.5 * positions
        turn = np.concatenate([np.cos(half)[:, None], np.sin(half)[:, None] * self.axis], axis=1)
        places = self.anchor + np.einsum("nij,j->ni", rotation_matrix(turn), start.position - self.anchor)
        return places, quaternion_product(turn, np.tile(start.quaternion, (count, 1)))


def openings_of(surfaces: Surfaces) -> list[Opening]:
    """All joints with a range by which something opens, in the order of the specification."""
    candidate, spec = surfaces.candidate, surfaces.candidate.spec
    assembly = candidate.memo("assemblies", lambda: assembly_of(spec))
    solid = set(surfaces.entities)
    asked = [(n, j) for n, j in spec.simulation.joints.items() if isinstance(j, HingeJoint | SlideJoint) and j.range is not None]
    away = candidate.memo(_Groups, lambda: _groups(candidate)).carried
    wanted = [
        (name, joint)
        for name, joint in asked
        if joint.child in solid and joint.child not in away and _span(joint) > 0.0 and _opens(spec, name, joint.child, assembly)
    ]
    leaves = frozenset(j.child for _, j in wanted if not surfaces.is_static(j.child))
    return [_opening(surfaces, name, joint, assembly, leaves) for name, joint in wanted]


def _span(joint: HingeJoint | SlideJoint) -> float:
    assert joint.range is not None
    return max(joint.range[1], 0.0) - min(joint.range[0], 0.0)


def assembly_of(spec: WorldSpec) -> dict[str, str]:
    """Main entity of the generated thing to which each entity belongs."""
    return {
        name: main for main, entity in spec.entities.items() if entity.asset is not None for name in (main, *entity.asset.bodies)
    }


def _opens(spec: WorldSpec, joint: str, child: str, assembly: Mapping[str, str]) -> bool:
    """True if a joint opens something: its body is called so, or its thing is of a kind whose joints do."""
    if head_noun(spec.entities[child].role) in OPENINGS.nouns:
        return True
    main = assembly.get(child)
    record = spec.entities[main].asset if main is not None and main in spec.entities else None
    return record is not None and record.generator in OPENINGS.generators and not joint.endswith(OPENINGS.other_joints)


def _opening(
    surfaces: Surfaces, name: str, joint: HingeJoint | SlideJoint, assembly: Mapping[str, str], leaves: frozenset[str]
) -> Opening:
    """A joint with what moves, and what is no obstacle: other leaves swing away themselves."""
    candidate, spec, child = surfaces.candidate, surfaces.candidate.spec, joint.child
    assert joint.range is not None
    axis = np.array(joint.axis, dtype=np.float64)
    axis /= np.linalg.norm(axis)
    slides = isinstance(joint, SlideJoint)
    moving = _with(spec, {child})
    own = {n for n in spec.entities if assembly.get(n) is not None and assembly[n] == assembly.get(child)}
    carried = _carried(surfaces, moving, {*own} - moving)
    level = slides or abs(float(axis[2])) > math.cos(LEVEL * 2 * math.pi)
    hung = _linked(spec, child) - moving - own
    light = candidate.memo(_Groups, lambda: _groups(candidate)).pushed - moving - carried
    record = spec.entities[assembly[child]].asset if assembly.get(child) in spec.entities else None
    function = function_of(record.generator if record is not None else None, name)
    return Opening(
        name,
        child,
        slides,
        np.array(joint.anchor, dtype=np.float64),
        axis,
        min(joint.range[0], 0.0),
        max(joint.range[1], 0.0),
        frozenset(moving | carried if level else moving),
        frozenset((own | carried | light | leaves | _met(spec, child) | _ropes(spec, moving)) - moving),
        frozenset(hung),
        _welded(candidate, child, moving, name),
        DRAWN_SHARE if slides else OPEN_SHARE,
        OPEN_ANGLE if function is None else function.angle,
        "" if function is None else function.source,
        frozenset(light),
    )


def _with(spec: WorldSpec, start: set[str]) -> set[str]:
    """Entities that go along with some: what hangs on them by joints, one after the other."""
    moving, more = set(start), True
    while more:
        further = {
            j.child
            for j in spec.simulation.joints.values()
            if not isinstance(j, SpringJoint) and j.parent in moving and j.child not in moving
        }
        moving |= further
        more = bool(further)
    return moving


def _carried(surfaces: Surfaces, moving: Iterable[str], but: set[str]) -> set[str]:
    """Entities that stand on moving ones, one on the other: as declared, or as contacts show."""
    spec, found, fresh = surfaces.candidate.spec, set[str](), set(moving)
    relations = [r for r in spec.graph.relations.values() if r.kind in ("supports", "contains", "fastened")]
    near: dict[str, list[str]] = surfaces.candidate.memo("near at the start", lambda: _near(surfaces))
    all_moving = set(moving)
    while fresh:
        told = {r.b for r in relations if r.a in fresh} | {r.a for r in relations if r.kind == "fastened" and r.b in fresh}
        told |= {
            other
            for name in fresh
            for other in near.get(name, ())
            if other not in found and surfaces.carries(name, other, until=1)[0] and not surfaces.is_static(other)
        }
        dynamic = {n for n in told if n in spec.entities and not surfaces.is_static(n)}
        fresh = dynamic - found - all_moving - but
        found |= fresh
    return found


def _near(surfaces: Surfaces) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for (a, b), distance in surfaces.first.items():
        if distance <= surfaces.contact_gap(a, b):
            found.setdefault(a, []).append(b)
            found.setdefault(b, []).append(a)
    return found


def _linked(spec: WorldSpec, child: str) -> set[str]:
    """Entities that joints and `fastened` relations tie to the child, over others too."""
    ties = [(j.parent, j.child) for j in spec.simulation.joints.values() if j.parent is not None]
    ties += [(r.a, r.b) for r in spec.graph.relations.values() if r.kind == "fastened"]
    found, fresh = {child}, {child}
    while fresh:
        fresh = {b for a, b in ties if a in fresh} | {a for a, b in ties if b in fresh}
        fresh -= found
        found |= fresh
    return found - {child}


def _met(spec: WorldSpec, child: str) -> set[str]:
    """Entities that the story has the child meet: what it pushes or jams against stands there on purpose."""
    story = [b.predicate for b in spec.story.beats.values()]
    story += [r.predicate for r in spec.story.requirements.values() if not r.never]
    atoms = [a for predicate in story for a in atoms_of(predicate) if isinstance(a, Contact | PairEvent)]
    return {n for atom in atoms if child in entities_of(atom) for n in entities_of(atom)} - {child}


def _ropes(spec: WorldSpec, moving: Iterable[str]) -> set[str]:
    """Ropes tied to what moves: they give way."""
    names = set(moving)
    return {
        n
        for n, e in spec.entities.items()
        if isinstance(e.generator, Rope) and {e.generator.attach_start, e.generator.attach_end} & names
    }


class _Groups(NamedTuple):
    """Entities that joints and `fastened` relations tie together, by what a person can do with them."""

    pushed: frozenset[str]
    """So light that what opens pushes them away."""
    carried: frozenset[str]
    """So light and small that one takes them up to open them."""


def _groups(candidate: Candidate) -> _Groups:
    """Free things that weigh little with all that joints tie to them, and that nothing holds in place."""
    spec = candidate.spec
    group = {n: n for n in spec.entities}

    def head(name: str) -> str:
        while group[name] != name:
            group[name] = group[group[name]]
            name = group[name]
        return name

    tied = [(j.child, j.parent) for j in spec.simulation.joints.values()]
    tied += [(r.a, r.b) for r in spec.graph.relations.values() if r.kind == "fastened"]
    held = {child for child, parent in tied if parent is None}
    for a, b in tied:
        if b in group and a in group:
            group[head(b)] = head(a)
    mass: dict[str, float] = {}
    size: dict[str, float] = {}
    for name, entity in spec.entities.items():
        free = entity.motion == "dynamic" and name not in held and entity.generator is None and name in candidate.built
        weight = sum(b.mass for b in candidate.built[name].bodies) if free else math.inf
        mass[head(name)] = mass.get(head(name), 0.0) + weight
        size[head(name)] = max(size.get(head(name), 0.0), *entity.dimensions.size)
    return _Groups(
        frozenset(n for n in spec.entities if mass[head(n)] <= PUSHED_MASS),
        frozenset(n for n in spec.entities if mass[head(n)] <= CARRIED_MASS and size[head(n)] <= CARRIED_SIZE),
    )


def _welded(candidate: Candidate, child: str, moving: set[str], joint: str) -> str | None:
    """Entity that holds the child shut: outside of what moves to which it is welded too."""
    for name, other in candidate.spec.simulation.joints.items():
        if name != joint and isinstance(other, WeldJoint) and child in (other.child, other.parent):
            end = other.parent if other.child == child else other.child
            if end is None or end not in moving:
                return end or "the world"
    return None
