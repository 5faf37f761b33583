"""Warnings about beats that ask a body on a hinge for a way of its centre that the hinge does not leave it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import F64, pose_of
from ..extents import shape_volume
from ..predicates import atoms_of
from ..problems import Problem
from ..spec import HingeJoint

if TYPE_CHECKING:
    from ..spec import Entity, WorldSpec

__all__ = ["turning_in_place"]

WAYS = frozenset({"rises", "falls", "drifts", "goes_uphill", "displacement"})
"""Kinds that measure a way of the centre of `entity`; `lifts` and `lowers` measure that of `other`."""
OF_OTHER = frozenset({"lifts", "lowers"})
MIDDLED = frozenset({"box", "sphere", "cylinder", "capsule"})
"""Shapes whose centre of mass is their origin."""


def turning_in_place(spec: WorldSpec) -> Iterator[Problem]:
    """Beats about the way of a body that turns on a hinge of the world or of what is static, whose centre comes less far than is asked."""
    for name, beat in spec.story.beats.items():
        for atom in atoms_of(beat.predicate):
            kind = getattr(atom, "kind", "")
            field = "entity" if kind in WAYS else "other" if kind in OF_OTHER else ""
            entity = getattr(atom, field, "") if field else ""
            reach = _reach(spec, entity)
            if reach is None:
                continue
            size = spec.entities[entity].dimensions.size
            least = max(
                0.0 if kind == "displacement" else 0.5 * min(size),
                getattr(atom, "min", None) or 0.0 if field == "entity" else 0.0,
            )
            if reach[0] < least:
                yield Problem(
                    f"/story/beats/{name}",
                    f"the centre of {entity!r} is {reach[1]:.3g} m from the axis of hinge {reach[2]!r} and comes {reach[0]:.3g} m at most; {kind} asks for "
                    f"{least:.3g} m of it: its ends move, its centre stays. Ask `tilts` or `joint_angle` of {entity!r}, or what its end does to "
                    "another body (`lifts`, `throws`, `hits`), which goes by the end that touches it",
                )


def _reach(spec: WorldSpec, entity: str) -> tuple[float, float, str] | None:
    """Farthest that a hinge lets the centre of a body come [m], its distance from the axis [m], and the hinge; None where none fixes that."""
    contract = spec.entities.get(entity)
    center = None if contract is None else _center(spec, contract)
    for name, joint in spec.simulation.joints.items():
        if joint.child != entity or not isinstance(joint, HingeJoint) or center is None:
            continue
        if joint.parent is not None and spec.entities[joint.parent].motion != "static":
            continue
        axis = np.array(joint.axis, dtype=np.float64)
        axis /= np.linalg.norm(axis)
        arm = center - np.array(joint.anchor, dtype=np.float64)
        away = float(np.linalg.norm(arm - (arm @ axis) * axis))
        turn = math.pi if joint.range is None else min(math.pi, max(abs(v) for v in joint.range))
        return 2.0 * away * math.sin(0.5 * turn), away, name
    return None


def _center(spec: WorldSpec, contract: Entity) -> F64 | None:
    """Centre of mass in the world at frame 0 [m]; None where the shapes do not tell it."""
    total, moment = 0.0, np.zeros(3)
    for part in contract.parts.values():
        volume, material = shape_volume(part.shape), spec.materials.get(part.material or contract.material)
        if part.shape.kind not in MIDDLED or volume is None or material is None:
            return None
        mass = volume * material.density
        total, moment = total + mass, moment + mass * pose_of(part.pose).position
    result: F64 | None = pose_of(contract.pose).apply((moment / total)[None])[0] if total > 0.0 else None
    return result
