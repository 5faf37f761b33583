"""Joints and drivers whose change makes something that is asked of their bodies easier (R157).

A joint that comes, or leaves less room, helps what is to stay; one that goes, or leaves more room, helps what is to happen. A driver
that goes, pushes less or for a shorter time helps what is to stay under it, unless it owns a beat, which asks for its effect; what a
stronger one brings about is a matter of agency (`verifiers/story/agency.py`). Where a predicate tells neither, both count.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from .arrays import pose_of, rotation_matrix
from .predicate_base import atoms_of, entities_of
from .predicates.registry import PREDICATES
from .quoting import listed
from .references import references
from .spec import SpecModel, WorldSpec
from .spec.simulation import Driver, Joint

__all__ = ["holding_weakenings"]

_MOST_NAMED = 4
_PLACES = frozenset({"anchor", "parent_point", "child_point", "collide", "damping", "stiffness", "friction", "rest_length"})
"""Fields of a joint that say where it sits, or that are quantities of nature (`weakened.py`)."""
_SAME_WAY = 1e-5
"""[1] Poses and axes are written with six digits."""
Asked = Mapping[str, Mapping[str, None]]
"""By entity: beats and requirements, in the order of the story."""


def holding_weakenings(before: WorldSpec, after: WorldSpec, bodies: Collection[str] | None = None) -> Iterator[str]:
    """Joints and drivers by whose change beats and requirements of `before` are easier to meet, in words.

    Args:
        before: the specification before the edit.
        after: the one after it.
        bodies: entities about which something is asked; default all.
    """
    stays, moves = ({n: who for n, who in side.items() if bodies is None or n in bodies} for side in _asked(before))
    was, now = before.simulation, after.simulation
    kept = [j.model_dump() for j in now.joints.values()]
    old = [j.model_dump() for j in was.joints.values()]
    for key, joint in was.joints.items():
        place, other = f"/simulation/joints/{key}", now.joints.get(key)
        if other is None and joint.model_dump() not in kept:
            yield from _line(f"{place} ({joint.kind} of {_ends(joint)}) removed", _bodies(before, joint), moves)
        elif other is not None:
            more, less = _room(joint, other, turned=_turned_along(before, after, joint, other))
            sides = (moves if more else {}, stays if less else {})
            told = f"{place} ({joint.kind} of {_ends(joint)}) changed"
            yield from _line(told, {*_bodies(before, joint), *_bodies(after, other)}, *sides)
    for key, joint in now.joints.items():
        if key not in was.joints and joint.model_dump() not in old:
            yield from _line(f"/simulation/joints/{key} ({joint.kind} of {_ends(joint)}) added", _bodies(after, joint), stays)
    left, owners = [d.model_dump() for d in now.drivers.values()], {beat.owner for beat in after.story.beats.values()}
    for key, driver in was.drivers.items():
        told, over = f"/simulation/drivers/{key} ({driver.kind})", now.drivers.get(key)
        if over is None and driver.model_dump() not in left:
            yield from _line(f"{told} removed", _bodies(before, driver), stays)
        elif (
            over is not None
            and key not in owners
            and (_acts_less(driver, over) or set(_bodies(after, over)) < set(_bodies(before, driver)))
        ):
            yield from _line(f"{told} acts less", _bodies(before, driver), stays)


def _asked(spec: WorldSpec) -> tuple[Asked, Asked]:
    """Who asks that something lasts of each entity, and who that something happens to it."""
    stays: dict[str, dict[str, None]] = {}
    moves: dict[str, dict[str, None]] = {}
    for holder, noun in ((spec.story.beats, "beat"), (spec.story.requirements, "requirement")):
        for key, item in holder.items():
            for atom, turned in _atoms(item.predicate, getattr(item, "never", False)):
                info = PREDICATES[atom.kind]
                lasts = info.lasting or getattr(atom, "when", "") == "always"
                sides = ((stays if turned else moves),) if info.event else (stays,) if lasts and not turned else (stays, moves)
                for side in sides:
                    for name in entities_of(atom) or entities_of(item.predicate):
                        side.setdefault(name, {})[f"{noun} {key!r}"] = None
    return stays, moves


def _atoms(predicate: SpecModel, turned: bool) -> Iterator[tuple[Any, bool]]:
    """Predicates that hold no others, each with whether it is denied."""
    if atoms_of(predicate) == [predicate]:
        yield predicate, turned
        return
    denied = turned != (getattr(predicate, "kind", "") == "not")
    for name in type(predicate).model_fields:
        value = getattr(predicate, name)
        for inner in value if isinstance(value, list) else [value]:
            if isinstance(inner, SpecModel):
                yield from _atoms(inner, denied)


def _turned_along(before: WorldSpec, after: WorldSpec, old: Joint, new: Joint) -> bool:
    """True if the axis of a joint is where it was on its child: both were turned together."""
    axes = []
    for spec, joint in ((before, old), (after, new)):
        child, axis = spec.entities.get(joint.child), getattr(joint, "axis", None)
        if child is None or axis is None:
            return False
        axes.append(rotation_matrix(pose_of(child.pose).quaternion[None])[0].T @ np.array(axis, dtype=np.float64))
    one, two = (axis / max(float(np.linalg.norm(axis)), 1e-300) for axis in axes)
    return bool(np.abs(one - two).max() < _SAME_WAY)


def _room(old: Joint, new: Joint, *, turned: bool) -> tuple[bool, bool]:
    """(More, less): which room another joint leaves its bodies; both where it holds others, or along another axis on its child."""
    was, now = (j.model_dump(exclude={*_PLACES, *(("axis",) if turned else ())}) for j in (old, new))
    changed = {k for k in {*was, *now} if was.get(k) != now.get(k)}
    if not changed:
        return False, False
    if changed == {"range"}:
        (low, high), (least, most) = (r or (-math.inf, math.inf) for r in (was["range"], now["range"]))
        return least < low or most > high, least > low or most < high
    if "kind" in changed and (old.parent, old.child) == (new.parent, new.child) and "weld" in (old.kind, new.kind):
        return old.kind == "weld", new.kind == "weld"
    return True, True


def _acts_less(old: Driver, new: Driver) -> bool:
    """True if some strength of a driver is smaller, or it lasts less long."""
    was, now = old.model_dump(exclude_none=True), new.model_dump(exclude_none=True)
    if was == now:
        return False
    if old.kind != new.kind or _kind_of_field(was) != _kind_of_field(now):
        return True
    span, other = (float(d.get("end", math.inf)) - float(d.get("start", 0.0)) for d in (was, now))
    strengths = zip(_strengths(was), _strengths(now), strict=False)
    return other < span or any(b < a for a, b in strengths)


def _kind_of_field(driver: Mapping[str, Any]) -> Any:
    return driver.get("field", {}).get("kind")


def _strengths(driver: Mapping[str, Any]) -> list[float]:
    """Sizes of what a driver pushes with, blows with or turns with."""
    held = {**driver, **driver.get("field", {})}
    names = ("force", "torque", "velocity", "max_effort", "speed", "acceleration", "updraft")
    return [math.hypot(*v) if isinstance(v, list | tuple) else abs(v) for n in names if (v := held.get(n, 0.0)) is not None]


def _bodies(spec: WorldSpec, holder: SpecModel) -> set[str]:
    """Entities that a joint or driver acts on; all of them for a field that names none."""
    joint = spec.simulation.joints.get(getattr(holder, "joint", ""))
    named = {*_named(holder), *(_named(joint) if joint else ())}
    return named or (set(spec.entities) if getattr(holder, "kind", "") == "field" else set())


def _named(holder: SpecModel) -> Iterator[str]:
    return (name for _, target, name in references(holder, "") if target in ("entity", "node"))


def _ends(joint: Joint) -> str:
    return f"{joint.parent or 'the world'} and {joint.child}"


def _line(told: str, bodies: Iterable[str], *sides: Asked) -> Iterator[str]:
    """The line of a change where something is asked of its bodies that it makes easier."""
    names = dict.fromkeys(who for side in sides for body in sorted(bodies) for who in side.get(body, ()))
    if names:
        yield f"{told}, by which {listed([*names], _MOST_NAMED)} may be easier to meet"
