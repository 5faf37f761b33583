"""Measured value of a number of the specification: of a bound in the story its predicate's, of a body's form as it is built, of its start as it moves."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...worlds.arrays import pose_of
from ...worlds.predicates import Count, Within
from ...worlds.predicates.registry import PREDICATES
from ...worlds.vocabulary import SpecModel
from ..categories.registry import judge_of
from ..predicates.combine import substitute
from ..predicates.evaluators import beat_times, evaluate

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...worlds.arrays import F64
    from ...worlds.candidate import Candidate

__all__ = ["Measured", "is_told", "measured_at"]


class Measured(NamedTuple):
    """A measured value."""

    value: float | None
    """None where there is no evidence."""
    unit: str
    text: str


def is_told(pointer: str) -> bool:
    """True where anything measured tells of the number at a JSON pointer."""
    keys = pointer.strip("/").split("/")
    head, rest = keys[:2], keys[2:]
    if head[:1] == ["story"]:
        return len(keys) > 3 and (
            keys[3] == "predicate" or (keys[1] == "beats" and keys[3:5] in (["frames", "0"], ["frames", "1"]))
        )
    if head[:1] == ["entities"] and rest:
        form = rest[:2] == ["dimensions", "size"] or (rest[0] == "parts" and rest[2:3] == ["shape"] and rest[3] in _FORMS)
        return form or rest[:2] in (["pose", "position"], ["physics", "linear_velocity"])
    return pointer == "/simulation/frames" or (head[:1] == ["materials"] and rest == ["density"])


def measured_at(candidate: Candidate, pointer: str) -> list[Measured]:
    """Measurements of the number at a JSON pointer: of each entity where several are told of; empty where nothing is.

    Raises:
        EvidenceError: an entity is not built, or its motion is damaged.
    """
    keys = pointer.strip("/").split("/")
    if not is_told(pointer):
        return []
    if keys[0] == "story":
        return _of_story(candidate, keys)
    if keys[0] == "entities":
        return _of_entity(candidate, keys[1], keys[2:])
    if keys[0] == "materials":
        return _density(candidate, keys[1])
    fps, plan = candidate.spec.simulation.fps, candidate.spec.simulation
    whole = candidate.frame_count == plan.frames
    return [Measured(candidate.frame_count / fps if whole else None, "s", f"the motion lasts {candidate.frame_count} frames")]


# ---------------------------------------------------------------- the story


def _of_story(candidate: Candidate, keys: Sequence[str]) -> list[Measured]:
    told = getattr(candidate.spec.story, keys[1]).get(keys[2])
    plan = candidate.spec.simulation
    if told is None:
        return []
    if keys[3] == "frames":
        first = beat_times(candidate).first(keys[2])
        return [Measured(None if first is None else first / plan.fps, "s", f"{keys[2]} comes true at frame {first}")]
    frames = told.frames or (0, plan.frames - 1)
    at: object = told.predicate
    each: list[str] = []
    for key in keys[4:-1]:
        if isinstance(at, Count):
            each = list(at.entities)
        at = at[int(key)] if isinstance(at, list) and key.isdigit() else getattr(at, key, None)
        own = getattr(at, "frames", None)
        frames = own if isinstance(own, tuple) else frames
    kind = str(getattr(at, "kind", ""))
    if not isinstance(at, SpecModel) or kind not in PREDICATES or keys[-1] not in PREDICATES[kind].tightens:
        return []
    found = []
    for predicate in [substitute(at, n) for n in each] or [at]:
        outcome = evaluate(candidate, predicate, frames)
        value, unit = outcome.value, outcome.unit
        if isinstance(at, Within):
            value, unit = (None if value is None else value / plan.fps), "s"
        found.append(Measured(None if outcome.status == "unverified" else value, unit, outcome.explanation))
    return found


# ---------------------------------------------------------------- bodies


_FORMS = ("size", "radius", "height")
"""Fields of shapes that extents tell."""


def _of_entity(candidate: Candidate, name: str, keys: Sequence[str]) -> list[Measured]:
    if keys[0] in ("pose", "physics"):
        axis = int(keys[2])
        if keys[0] == "pose":
            bodies = candidate.entity(name).bodies
            if len(bodies) != 1 or np.abs(bodies[0].pose.position).max() > 0.0:
                return []
            value = float(candidate.pose(name, 0, bodies[0].name).position[axis])
            return [Measured(value, "m", f"{name} starts at {value:.3g} m along {'xyz'[axis]}")]
        value = float(judge_of(candidate.spec, name).velocities(candidate, name)[0][axis])
        return [Measured(value, "m/s", f"{name} starts with {value:.3g} m/s along {'xyz'[axis]}")]
    points = _points(candidate, name, keys[1] if keys[0] == "parts" else None)
    if not len(points):
        return []
    extents = np.ptp(points, axis=0)
    if keys[0] == "dimensions":
        value = float(extents[int(keys[2])])
    else:
        field = keys[3]
        value = float(extents[int(keys[4])] if field == "size" else extents[2] if field == "height" else 0.5 * extents[0])
    return [Measured(value, "m", f"{name} is built with {value:.3g} m")]


def _points(candidate: Candidate, name: str, part: str | None) -> F64:
    """Visible vertices of an entity in its frame, or of one part in the frame of its shape [m], shape (n, 3)."""
    built = candidate.entity(name)
    poses = {b.name: b.pose for b in built.bodies}
    points = [poses[p.body].apply(p.render.vertices) for p in built.parts if part is None or p.part == part]
    joined = np.concatenate(points) if points else np.zeros((0, 3))
    if part is None or not len(joined):
        return joined
    own = pose_of(candidate.spec.entities[name].parts[part].pose)
    turn = np.stack([own.apply(axis[None])[0] - own.position for axis in np.eye(3)])
    result: F64 = (joined - own.position) @ turn.T
    return result


def _density(candidate: Candidate, material: str) -> list[Measured]:
    """Density of what is made of one material alone, as built [kg/m^3]."""
    found = []
    for name, entity in candidate.spec.entities.items():
        used = {p.material or entity.material for p in entity.parts.values()} or {entity.material}
        if used != {material} or name not in candidate.built:
            continue
        bodies = candidate.entity(name).bodies
        volume = sum(b.volume for b in bodies)
        if volume > 0.0:
            value = sum(b.mass for b in bodies) / volume
            found.append(Measured(value, "kg/m3", f"{name} has {value:.4g} kg per m3"))
    return found
